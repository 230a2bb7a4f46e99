//! The steps of a method in lanes: what every method has, and the state of the lanes that it moves.

use super::lanes::{Lanes, MAX_LANES};
use super::number::{Number, load_phase, store_phase};
use crate::NUMBERS;
use crate::start::{STEP, TIME, TIME_LOW};
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::phase::Phase;

/// A method's steps, in lanes of `N`.
pub(super) trait LaneStepper<N: Number> {
    /// What decides the lengths of the steps.
    type Control: Copy;
    /// The motion in a step of all lanes, as far as the method knows it.
    type Motion;

    /// Computes the motion that begins in a state.
    fn motion(dynamics: &LaneDynamics<N>, state: &LaneState<N>) -> Self::Motion;
    /// Returns the step along a motion.
    fn step(
        dynamics: &LaneDynamics<N>,
        control: &Self::Control,
        state: &LaneState<N>,
        motion: &Self::Motion,
    ) -> LaneStep<N>;
    /// Returns the length of the step that is tried next.
    fn next_length(control: &Self::Control, state: &LaneState<N>, step: &LaneStep<N>)
    -> N::Leading;
}

/// The pendulum in reduced units, in all lanes.
pub(super) struct LaneDynamics<N: Number> {
    pub pendulum: Pendulum<N>,
    pub inverse_scale: [N; 2],
}

impl<N: Number> LaneDynamics<N> {
    #[inline(always)]
    pub(super) fn load(set: <N::Leading as Lanes>::Set, exact: &Pendulum<Dd>) -> Self {
        let number = N::exactly(<N::Leading as Lanes>::splat(set, 1.0));
        let lanes = |value: f64| [value; MAX_LANES];
        let scale = exact.to_f64().momentum_scale();
        LaneDynamics {
            pendulum: exact.map(|Dd { hi, lo }| N::load(set, &lanes(hi), &lanes(lo))),
            inverse_scale: [number.lit(1.0 / scale[0]), number.lit(1.0 / scale[1])],
        }
    }
}

/// A step of all lanes.
pub(super) struct LaneStep<N: Number> {
    /// The state after it.
    pub next: Phase<N>,
    pub length: N::Leading,
    /// Negative in lanes where the step is taken.
    pub excess: N::Leading,
}

/// The state of all lanes in registers.
#[derive(Clone, Copy)]
pub(super) struct LaneState<N: Number> {
    pub phase: Phase<N>,
    pub time: N::Leading,
    pub time_low: N::Leading,
    /// Length of the step that is tried next.
    pub step: N::Leading,
}

impl<N: Number> LaneState<N> {
    #[inline(always)]
    pub(super) fn load(
        set: <N::Leading as Lanes>::Set,
        rows: &[[f64; MAX_LANES]; NUMBERS],
    ) -> Self {
        LaneState {
            phase: load_phase(set, rows),
            time: <N::Leading as Lanes>::load(set, &rows[TIME]),
            time_low: <N::Leading as Lanes>::load(set, &rows[TIME_LOW]),
            step: <N::Leading as Lanes>::load(set, &rows[STEP]),
        }
    }

    #[inline(always)]
    pub(super) fn store(&self, rows: &mut [[f64; MAX_LANES]; NUMBERS]) {
        store_phase(&self.phase, rows);
        self.time.store(&mut rows[TIME]);
        self.time_low.store(&mut rows[TIME_LOW]);
        self.step.store(&mut rows[STEP]);
    }

    /// Takes a step in the lanes that take it.
    #[inline(always)]
    pub(super) fn advance<M: LaneStepper<N>>(&mut self, control: &M::Control, step: &LaneStep<N>) {
        let LaneStep { next, length, excess } = step;
        for (value, next) in self.phase.iter_mut().zip(next) {
            *value = next.select(*excess, *value);
        }
        let (time, low) = self.time.fast_two_sum(self.time_low + *length);
        self.time = Lanes::select(time, *excess, self.time);
        self.time_low = Lanes::select(low, *excess, self.time_low);
        self.step = M::next_length(control, self, step);
    }
}
