//! Steps of the classical Runge–Kutta method on unit vectors and momenta, all of one length, for what
//! pendulums gather. Flips are found in angles (`fixed.rs`).

use super::number::Number;
use super::stepper::{LaneDynamics, LaneState, LaneStep, LaneStepper};
use flipmap_numbers::Real;
use flipmap_pendulum::phase::rk4;

/// Steps of the classical Runge–Kutta method.
pub(super) struct Rk4Steps;

impl<N: Number> LaneStepper<N> for Rk4Steps {
    type Control = ();
    type Motion = ();

    #[inline(always)]
    fn motion(_: &LaneDynamics<N>, _: &LaneState<N>) {}

    #[inline(always)]
    fn step(dynamics: &LaneDynamics<N>, (): &(), state: &LaneState<N>, (): &()) -> LaneStep<N> {
        LaneStep {
            next: rk4(&dynamics.pendulum, &state.phase, N::exactly(state.step)),
            length: state.step,
            // Every step is taken.
            excess: state.step.lit(-1.0),
        }
    }

    #[inline(always)]
    fn next_length((): &(), state: &LaneState<N>, _: &LaneStep<N>) -> N::Leading {
        state.step
    }
}
