//! Passes of the top that are not the last one: a pendulum goes on beyond them.

use crate::physics::Pendulum;
use crate::physics::crossing::StepState;

/// Sine of the angle beyond the top at which a bob that has passed it is put: far below any
/// rounding, but with a sign.
const BARELY: f64 = 1e-30;

/// The state `top`, in which `bob` passes the top, with the bob beyond it.
pub(super) fn beyond_top(top: &StepState<f64>, bob: usize, anticlockwise: bool) -> StepState<f64> {
    let mut beyond = *top;
    beyond.phase[2 * bob + 1] = if anticlockwise { -BARELY } else { BARELY };
    beyond
}

/// Height, as a sine, to which a bob that passes the top would rise beyond it if its acceleration
/// there turned it round.
pub(super) fn height_beyond(pendulum: &Pendulum<f64>, top: &StepState<f64>, bob: usize) -> f64 {
    let [x1, y1, x2, y2, ..] = top.phase;
    let pull = pendulum.acceleration_towards([(y1, x1), (y2, x2)], top.speed);
    top.speed[bob].powi(2) / (2.0 * pull[bob].abs()).max(1e-300)
}
