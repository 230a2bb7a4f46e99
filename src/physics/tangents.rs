//! Tangents of a motion: its derivatives by all four numbers of the start, θ1, θ2, ω1/ω0 and ω2/ω0
//! with ω0 = √(g/l1), in which speeds are those in reduced units.

use super::Pendulum;
use super::dual::Dual;
use super::phase::Phase;
use super::real::Real;

/// A state with its derivatives by the four numbers of its start.
pub type Tangents<T> = Phase<Dual<4, T>>;

/// A state with the tangents of a start: the derivatives by its own numbers. `pendulum` is in
/// reduced units.
#[inline(always)]
pub fn released<T: Real>(pendulum: &Pendulum<T>, phase: &Phase<T>) -> Tangents<T> {
    let [x1, y1, x2, y2, p1, p2] = *phase;
    let [w1, w2] = pendulum.speeds(phase);
    let (zero, one) = (w1.lit(0.0), w1.lit(1.0));
    let along = |value: T, place: usize, by: T| {
        let mut slope = [zero; 4];
        slope[place] = by;
        Dual { value, slope }
    };
    let [x1, y1] = [along(x1, 0, -y1), along(y1, 0, x1)];
    let [x2, y2] = [along(x2, 1, -y2), along(y2, 1, x2)];
    let [w1, w2] = [along(w1, 2, one), along(w2, 3, one)];
    let dual = pendulum.map(Dual::<4, T>::new);
    let coupling = dual.c * (x1 * x2 + y1 * y2);
    let momenta = [dual.a * w1 + coupling * w2, coupling * w1 + dual.b * w2];
    // Their values are known to more digits than the speeds give.
    [x1, y1, x2, y2, Dual { value: p1, ..momenta[0] }, Dual { value: p2, ..momenta[1] }]
}

/// Natural logarithm of the largest singular value of the tangent map, from the start to a state
/// with its tangents; `pendulum` is in reduced units.
pub fn log_growth(pendulum: &Pendulum<f64>, state: &Tangents<f64>) -> f64 {
    let [x1, y1, x2, y2, ..] = state;
    let turned = |x: &Dual<4>, y: &Dual<4>, k: usize| x.value * y.slope[k] - y.value * x.slope[k];
    let [w1, w2] = pendulum.map(Dual::new).speeds(state);
    let column = |k: usize| [turned(x1, y1, k), turned(x2, y2, k), w1.slope[k], w2.slope[k]];
    largest_singular_value([0, 1, 2, 3].map(column)).ln()
}

/// The largest singular value of a matrix, from its columns: one-sided Jacobi rotations make them
/// orthogonal (Demmel and Veselić, *Jacobi's method is more accurate than QR*, 1992).
pub fn largest_singular_value(mut columns: [[f64; 4]; 4]) -> f64 {
    let dot = |a: &[f64; 4], b: &[f64; 4]| (0..4).map(|i| a[i] * b[i]).sum::<f64>();
    let scale = columns.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if !(scale.is_finite() && scale > 0.0) {
        return scale;
    }
    columns.as_flattened_mut().iter_mut().for_each(|x| *x /= scale);
    for _ in 0..SWEEPS {
        for i in 0..4 {
            for j in i + 1..4 {
                let (a, b) = (columns[i], columns[j]);
                let product = dot(&a, &b);
                if product == 0.0 {
                    continue;
                }
                let zeta = (dot(&b, &b) - dot(&a, &a)) / (2.0 * product);
                let tan = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let cos = 1.0 / tan.hypot(1.0);
                let sin = cos * tan;
                columns[i] = std::array::from_fn(|k| cos * a[k] - sin * b[k]);
                columns[j] = std::array::from_fn(|k| sin * a[k] + cos * b[k]);
            }
        }
    }
    scale * columns.iter().map(|column| dot(column, column)).fold(0.0, f64::max).sqrt()
}

/// Number of sweeps over all pairs of columns; the rotations converge quadratically.
const SWEEPS: u32 = 8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::State;
    use crate::physics::transport::transported;

    #[test]
    fn singular_values_are_those_of_known_matrices() {
        let (sin, cos) = 0.7f64.sin_cos();
        let turned = [[cos, sin, 0.0, 0.0], [-sin, cos, 0.0, 0.0], [0.0, 0.0, 3e7, 0.0]];
        let value = largest_singular_value([turned[0], turned[1], turned[2], [0.0; 4]]);
        assert!((value / 3e7 - 1.0).abs() < 1e-15);
        let shear = largest_singular_value([
            [1.0, 0.0, 0.0, 0.0],
            [2.0, 1.0, 0.0, 0.0],
            [0.0; 4],
            [0.0; 4],
        ]);
        assert!((shear - (1.0 + 2f64.sqrt())).abs() < 1e-14, "{shear}");
    }

    #[test]
    fn at_the_start_nothing_has_grown() {
        let pendulum = Pendulum::points([1.0, 0.3], [1.0, 0.7], 1.0).reduced().0;
        let phase = pendulum.phase(&State { angle: [0.4, -2.0], speed: [1.5, -0.3] });
        assert!(log_growth(&pendulum, &released(&pendulum, &phase)).abs() < 1e-14);
    }

    #[test]
    fn tangents_are_differences_of_neighbours() {
        let pendulum = Pendulum::points([1.0, 0.3], [1.0, 0.7], 1.0).reduced().0;
        let start = State { angle: [0.4, -2.0], speed: [1.5, -0.3] };
        let dual = pendulum.map(Dual::<4>::new);
        let scale = pendulum.momentum_scale().map(|scale| Dual::new(1.0 / scale));
        let mut state = released(&pendulum, &pendulum.phase(&start));
        for _ in 0..40 {
            let step = Dual::new(0.05);
            let trial = crate::physics::embedded::dop853(&dual, scale, &state, step);
            state = crate::physics::embedded::plus(&state, &trial.change);
        }
        for k in 0..4 {
            let ends = [-1e-6, 1e-6].map(|by| {
                let mut moved = start;
                if k < 2 {
                    moved.angle[k] += by
                } else {
                    moved.speed[k - 2] += by
                }
                transported(&pendulum, &pendulum.phase(&moved), 2.0)
            });
            for i in 0..6 {
                let slope = (ends[1][i] - ends[0][i]) / 2e-6;
                assert!((slope - state[i].slope[k]).abs() < 1e-7, "{i} {k}");
            }
        }
    }
}
