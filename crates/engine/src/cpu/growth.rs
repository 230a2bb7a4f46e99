//! Growth: pendulums with the tangents of their motion, whose slopes have the digits of the leading
//! part.

use super::gather_loop::Observer;
use super::lanes::{Lanes, MAX_LANES, row};
use super::number::Number;
use super::stepper::{LaneDynamics, LaneState, LaneStep, LaneStepper};
use crate::start::end_with_growth;
use crate::{Carried, FinalState, IntegratorState};
use flipmap_numbers::Real;
use flipmap_numbers::dual::{Dual, Narrow};
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::tangents::LARGE;

/// A number with its derivatives with respect to the four numbers of the start.
pub(super) type WithTangents<N> = Dual<4, N, <N as Number>::Leading>;

impl<N: Number + Narrow<N::Leading>> Number for WithTangents<N> {
    type Leading = N::Leading;

    #[inline(always)]
    fn load(set: <N::Leading as Lanes>::Set, high: &[f64], low: &[f64]) -> Self {
        Dual::new(N::load(set, high, low))
    }
    #[inline(always)]
    fn store(self, high: &mut [f64], low: &mut [f64]) {
        self.value.store(high, low);
    }
    #[inline(always)]
    fn exactly(leading: N::Leading) -> Self {
        Dual::new(N::exactly(leading))
    }
    #[inline(always)]
    fn leading(self) -> N::Leading {
        self.value.leading()
    }
    #[inline(always)]
    fn select(self, test: N::Leading, other: Self) -> Self {
        let mut selected = other;
        selected.value = self.value.select(test, other.value);
        for (slope, other) in selected.slope.iter_mut().zip(self.slope) {
            *slope = Lanes::select(other, test, *slope);
        }
        selected
    }
    #[inline(always)]
    fn changed(phase: &Phase<Self>, change: &Phase<Self>) -> Phase<Self> {
        flipmap_pendulum::embedded::plus(phase, change)
    }
}

/// The logarithms of the factors by which the lanes' slopes were scaled down.
pub(super) struct SlopeScales {
    log_scale: [f64; MAX_LANES],
}

impl<N: Number + Narrow<N::Leading>> Observer<WithTangents<N>> for SlopeScales {
    type Wanted = ();

    #[inline(always)]
    fn begin(
        set: <N::Leading as Lanes>::Set,
        (): (),
        _: &LaneDynamics<WithTangents<N>>,
        state: &mut LaneState<WithTangents<N>>,
        starts: &[&IntegratorState; MAX_LANES],
    ) -> Self {
        let slopes = starts.map(IntegratorState::slopes);
        for (i, number) in state.phase.iter_mut().enumerate() {
            for (k, slope) in number.slope.iter_mut().enumerate() {
                *slope = <N::Leading as Lanes>::load(set, &slopes.map(|slopes| slopes[i][k]));
            }
        }
        SlopeScales { log_scale: starts.map(IntegratorState::log_scale) }
    }

    #[inline(always)]
    fn see<M: LaneStepper<WithTangents<N>>>(
        &mut self,
        _: &LaneDynamics<WithTangents<N>>,
        _: &M::Control,
        _: &LaneState<WithTangents<N>>,
        _: &LaneStep<WithTangents<N>>,
    ) {
    }

    /// Scales down the slopes of a lane where they have grown large.
    #[inline(always)]
    fn rest(&mut self, set: <N::Leading as Lanes>::Set, state: &mut LaneState<WithTangents<N>>) {
        let mut most = state.time.lit(0.0);
        for number in &state.phase {
            for slope in number.slope {
                most = most.max(slope.abs());
            }
        }
        let mut factor = [0.0; MAX_LANES];
        Lanes::store(most, &mut factor);
        for (factor, log_scale) in factor.iter_mut().zip(&mut self.log_scale) {
            *factor = if *factor > LARGE { 1.0 / LARGE } else { 1.0 };
            *log_scale -= factor.ln();
        }
        let factor = <N::Leading as Lanes>::load(set, &factor);
        for number in &mut state.phase {
            for slope in &mut number.slope {
                *slope = *slope * factor;
            }
        }
    }

    fn carried(&self, state: &LaneState<WithTangents<N>>) -> [Carried; MAX_LANES] {
        let rows = state.phase.map(|number| number.slope.map(row));
        std::array::from_fn(|lane| Carried::Tangents {
            slopes: rows.map(|rows| rows.map(|row| row[lane])),
            log_scale: self.log_scale[lane],
        })
    }

    fn end(reduced: &Pendulum<f64>, left: &IntegratorState) -> FinalState {
        end_with_growth(reduced, left)
    }
}
