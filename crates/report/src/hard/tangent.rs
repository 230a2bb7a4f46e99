//! The tangent map of the motion: rates at which neighbours separate, by dual numbers.

use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::transport::transported_as;
use flipmap_pendulum::{Pendulum, State};

/// A number with its derivatives along the four directions.
type Dual = flipmap_numbers::dual::Dual<4>;

/// Four directions away from a state, each δθ1, δθ2, δp1, δp2: canonical coordinates, in which the
/// motion preserves volumes.
type TangentFrame = [[f64; 4]; 4];

/// Time between two orthonormalisations of the frame.
const STRETCH: f64 = 1.0;

/// The finite-time Lyapunov spectrum of a release from rest at `angle` over `time`, largest first,
/// per unit of time: the frame is carried along and made orthonormal at regular intervals (Benettin
/// et al., Meccanica 15, 1980).
pub(crate) fn spectrum(pendulum: &Pendulum<f64>, angle: [f64; 2], time: f64) -> [f64; 4] {
    let mut phase = pendulum.phase(&State::rest(angle));
    let mut frame: TangentFrame =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let stretches = (time / STRETCH).round().max(1.0) as usize;
    let stretch = time / stretches as f64;
    let mut sums = [0.0; 4];
    for _ in 0..stretches {
        (phase, frame) = carried(pendulum, &phase, &frame, stretch);
        let growth = straightened(&mut frame);
        for (sum, growth) in sums.iter_mut().zip(growth) {
            *sum += growth.ln() / time;
        }
    }
    sums
}

/// The phase and the frame after `time`, on dual numbers.
fn carried(
    pendulum: &Pendulum<f64>,
    phase: &Phase<f64>,
    frame: &TangentFrame,
    time: f64,
) -> (Phase<f64>, TangentFrame) {
    let dual = pendulum.map(Dual::new);
    let inverse_scale = pendulum.momentum_scale().map(|scale| Dual::new(1.0 / scale));
    let state = with_slopes(phase, frame);
    let value = |number: Dual| number.value;
    without_slopes(&transported_as(&dual, inverse_scale, &state, time, value))
}

/// The phase as dual numbers along the frame: δθ moves a unit vector by (−y, x) δθ.
fn with_slopes(phase: &Phase<f64>, frame: &TangentFrame) -> Phase<Dual> {
    let [x1, y1, x2, y2, _, _] = *phase;
    let by = [(-y1, 0), (x1, 0), (-y2, 1), (x2, 1), (1.0, 2), (1.0, 3)];
    std::array::from_fn(|i| {
        let (factor, coordinate) = by[i];
        Dual { value: phase[i], slope: std::array::from_fn(|k| factor * frame[k][coordinate]) }
    })
}

fn without_slopes(state: &Phase<Dual>) -> (Phase<f64>, TangentFrame) {
    let phase = state.map(|number| number.value);
    let [x1, y1, x2, y2, p1, p2] = state;
    let turn = |x: &Dual, y: &Dual, k: usize| x.value * y.slope[k] - y.value * x.slope[k];
    let frame =
        std::array::from_fn(|k| [turn(x1, y1, k), turn(x2, y2, k), p1.slope[k], p2.slope[k]]);
    (phase, frame)
}

/// Makes the frame orthonormal (Gram and Schmidt) and returns the growth of each direction.
fn straightened(frame: &mut TangentFrame) -> [f64; 4] {
    let dot = |a: &[f64; 4], b: &[f64; 4]| (0..4).map(|i| a[i] * b[i]).sum::<f64>();
    let mut growth = [0.0; 4];
    for k in 0..4 {
        let mut direction = frame[k];
        // For nearly parallel directions two passes are enough, one is not.
        for _ in 0..2 {
            for before in &frame[..k] {
                let along = dot(before, &direction);
                direction = std::array::from_fn(|i| direction[i] - along * before[i]);
            }
        }
        growth[k] = dot(&direction, &direction).sqrt();
        frame[k] = direction.map(|x| x / growth[k]);
    }
    growth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_swings_do_not_part() {
        let unit = Pendulum::points([1.0; 2], [1.0; 2], 1.0);
        for exponent in spectrum(&unit, [1e-3, 1e-3], 200.0) {
            assert!(exponent.abs() < 0.02, "{exponent}");
        }
    }

    #[test]
    fn slopes_are_those_of_differences() {
        let unit = Pendulum::points([1.0, 2.0], [1.0, 0.6], 1.0);
        let phase = unit.phase(&State { angle: [1.0, -2.0], speed: [0.5, 1.0] });
        let frame: TangentFrame = [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.3, 0.1, 0.2, 1.0],
        ];
        let state = with_slopes(&phase, &frame);
        let flow = unit.map(Dual::new).derivative(&state);
        for k in 0..4 {
            let nudged = |sign: f64| {
                unit.derivative(&std::array::from_fn(|i| {
                    phase[i] + sign * 1e-6 * state[i].slope[k]
                }))
            };
            let (up, down) = (nudged(1.0), nudged(-1.0));
            for i in 0..6 {
                let slope = (up[i] - down[i]) / 2e-6;
                assert!((slope - flow[i].slope[k]).abs() < 1e-8, "{i} {k}");
            }
        }
        assert_eq!(without_slopes(&state).0, phase);
    }
}
