//! Tangents of a motion: its derivatives with respect to the four numbers of the start, θ1, θ2,
//! ω1/ω0 and ω2/ω0 with ω0 = √(g/l1); the speeds are thus in reduced units.

use crate::Pendulum;
use crate::phase::Phase;
use crate::transport::transported_as;
use flipmap_numbers::dual::Dual;
use flipmap_numbers::real::Real;

/// A state with its derivatives with respect to the four numbers of its start.
pub type Tangents<T, S = T> = Phase<Dual<4, T, S>>;

/// Slope above which all slopes are divided by this power of two, so that none overflows in f32
/// within a stretch of steps. The division is exact.
pub const LARGE: f64 = (1u64 << 40) as f64;

/// Longest reduced time over which a tangent map is followed in one piece.
const MAX_PIECE: f64 = 16.0;

/// A state with the tangents of a start: its derivatives with respect to its own four numbers.
/// `pendulum` is in reduced units.
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
    // The momenta's own values are known to more digits than the speeds give.
    [x1, y1, x2, y2, Dual { value: p1, ..momenta[0] }, Dual { value: p2, ..momenta[1] }]
}

/// The product of the tangent maps along an orbit, one after another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentMap {
    /// Columns of the map, scaled down so that none overflows.
    columns: [[f64; 4]; 4],
    /// Natural logarithm of the factor by which they were scaled down.
    log_scale: f64,
}

impl TangentMap {
    /// The map of a start to itself.
    pub fn identity() -> Self {
        let columns = std::array::from_fn(|k| std::array::from_fn(|i| f64::from(u8::from(i == k))));
        TangentMap { columns, log_scale: 0.0 }
    }

    /// The map continued along the orbit for the reduced time `by` from `phase`, where this map
    /// ends.
    #[must_use]
    pub fn followed_by(&self, pendulum: &Pendulum<f64>, phase: &Phase<f64>, by: f64) -> Self {
        // In pieces, so that no slope overflows.
        let pieces = (by.abs() / MAX_PIECE).ceil().max(1.0);
        let piece = by / pieces;
        let (mut map, mut phase) = (*self, *phase);
        for _ in 0..pieces as u64 {
            (map, phase) = map.followed_by_piece(pendulum, &phase, piece);
        }
        map
    }

    /// The map after a short time, and the state then.
    fn followed_by_piece(
        &self,
        pendulum: &Pendulum<f64>,
        phase: &Phase<f64>,
        by: f64,
    ) -> (Self, Phase<f64>) {
        let scale = pendulum.momentum_scale().map(|scale| Dual::new(1.0 / scale));
        let dual = pendulum.map(Dual::<4>::new);
        let start = released(pendulum, phase);
        let state = transported_as(&dual, scale, &start, by, |number| number.value);
        let step = nudges(pendulum, &state);
        let columns = self.columns.map(|column| {
            std::array::from_fn(|i| (0..4).map(|k| step[k][i] * column[k]).sum::<f64>())
        });
        let largest = columns.as_flattened().iter().fold(1.0, |most: f64, x| most.max(x.abs()));
        let columns = columns.map(|column| column.map(|x| x / largest));
        let map = TangentMap { columns, log_scale: self.log_scale + largest.ln() };
        (map, state.map(|number| number.value))
    }

    /// The map of a neighbour, to first order in the relative difference of the two maps. The nudge
    /// that grows faster than all others becomes `here` on this orbit and `there` on the
    /// neighbour's.
    #[must_use]
    pub(crate) fn of_neighbour(&self, here: [f64; 4], there: [f64; 4]) -> Self {
        let dot = |a: &[f64; 4], b: &[f64; 4]| (0..4).map(|i| a[i] * b[i]).sum::<f64>();
        let square = dot(&here, &here);
        let columns = self.columns.map(|column| {
            let share = dot(&here, &column) / square;
            std::array::from_fn(|i| column[i] + share * (there[i] - here[i]))
        });
        TangentMap { columns, ..*self }
    }

    /// The derivatives of the state `phase`, to which the map leads, with respect to the four
    /// numbers of the start, and the natural logarithm of the factor by which they were scaled
    /// down.
    pub fn slopes(&self, pendulum: &Pendulum<f64>, phase: &Phase<f64>) -> (Phase<[f64; 4]>, f64) {
        let through = |own: [f64; 4]| {
            self.columns.map(|column| (0..4).map(|j| own[j] * column[j]).sum::<f64>())
        };
        (released(pendulum, phase).map(|number| through(number.slope)), self.log_scale)
    }

    /// Natural logarithm of the largest singular value.
    pub fn log_growth(&self) -> f64 {
        largest_singular_value(self.columns).ln() + self.log_scale
    }
}

/// Natural logarithm of the largest singular value of the tangent map, from the start to a state
/// with its tangents; `pendulum` is in reduced units.
pub fn log_growth(pendulum: &Pendulum<f64>, state: &Tangents<f64>) -> f64 {
    largest_singular_value(nudges(pendulum, state)).ln()
}

/// The derivatives of a state's own four numbers, θ1, θ2 and the reduced speeds, from those of its
/// unit vectors and momenta; one row for each direction.
pub(super) fn nudges<const N: usize>(
    pendulum: &Pendulum<f64>,
    state: &Phase<Dual<N>>,
) -> [[f64; 4]; N] {
    let [x1, y1, x2, y2, ..] = state;
    let turned = |x: &Dual<N>, y: &Dual<N>, k: usize| x.value * y.slope[k] - y.value * x.slope[k];
    let [w1, w2] = pendulum.map(Dual::new).speeds(state);
    std::array::from_fn(|k| [turned(x1, y1, k), turned(x2, y2, k), w1.slope[k], w2.slope[k]])
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
    use crate::State;
    use crate::embedded::{Pair, plus};
    use crate::transport::transported;

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
    fn maps_one_after_another_are_the_map_of_the_whole() {
        let pendulum = Pendulum::points([1.0, 0.3], [1.0, 0.7], 1.0).reduced().0;
        let start = pendulum.phase(&State { angle: [0.4, -2.0], speed: [1.5, -0.3] });
        let whole = TangentMap::identity().followed_by(&pendulum, &start, 8.0).log_growth();
        let (mut map, mut phase) = (TangentMap::identity(), start);
        for _ in 0..16 {
            map = map.followed_by(&pendulum, &phase, 0.5);
            phase = transported(&pendulum, &phase, 0.5);
        }
        assert!(whole > 2.0 && (map.log_growth() - whole).abs() < 1e-8, "{whole}");
        // The time is so long that slopes would overflow by far; no exponent above 1 is known for
        // this pendulum.
        let long = TangentMap::identity().followed_by(&pendulum, &start, 4000.0).log_growth();
        assert!(long > 100.0 && long < 4000.0, "{long}");
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
            let trial = Pair::Dop853.trial(&dual, scale, &state, step);
            state = plus(&state, &trial.change);
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
