//! Extremes along a motion: the nearest return to the start, and others of
//! [`flipmap_pendulum::extremum`]. A step in which the rate of the quantity changes its sign is
//! searched by shorter steps from the same beginning, in all lanes at once.

use super::gather_loop::Observer;
use super::lanes::{Lanes, MAX_LANES, row};
use super::number::Number;
use super::stepper::{LaneDynamics, LaneState, LaneStep, LaneStepper};
use crate::integrator_state::Sought;
use crate::start::end_with_extremum;
use crate::{Carried, FinalState, IntegratorState};
use flipmap_numbers::Real;
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::extremum::{Extremum, Measure};

/// Most shorter steps in the search for an extreme.
const MOST_TRIALS: u32 = 30;
/// Part of a step to which the time of an extreme is found.
const PART: f64 = 1e-9;

/// The search for the extremes of the pendulums in all lanes.
pub(super) struct Search<N: Number> {
    measure: Measure<N>,
    /// The rate of the measure in the lanes' states.
    rate: N::Leading,
    /// Negative in lanes where an extreme counts.
    counts: N::Leading,
    /// The extremes so far, and the reduced times at which they occurred.
    best: [[f64; MAX_LANES]; 2],
}

impl<N: Number> Observer<N> for Search<N> {
    type Wanted = Extremum;

    #[inline(always)]
    fn begin(
        set: <N::Leading as Lanes>::Set,
        wanted: Extremum,
        dynamics: &LaneDynamics<N>,
        state: &mut LaneState<N>,
        starts: &[&IntegratorState; MAX_LANES],
    ) -> Self {
        let sought = starts.map(IntegratorState::sought);
        let mut start = state.phase;
        for (i, number) in start.iter_mut().enumerate() {
            *number = N::load(set, &sought.map(|search| search.start[i]), &[0.0; MAX_LANES]);
        }
        let LaneDynamics { pendulum, inverse_scale } = *dynamics;
        let measure = Measure { extremum: wanted, pendulum, inverse_scale, start };
        let counts = sought.map(|search| if search.counts { -1.0 } else { 0.0 });
        Search {
            rate: measure.rate(&state.phase).leading(),
            measure,
            counts: <N::Leading as Lanes>::load(set, &counts),
            best: [0, 1].map(|i| sought.map(|search| search.best[i])),
        }
    }

    #[inline(always)]
    fn see<M: LaneStepper<N>>(
        &mut self,
        dynamics: &LaneDynamics<N>,
        control: &M::Control,
        state: &LaneState<N>,
        step: &LaneStep<N>,
    ) {
        let rate = self.measure.rate(&step.next).leading();
        let taken = rate.lit(-1.0).where_negative(step.excess);
        let falls = taken.where_negative(rate);
        let leaves = falls.where_negative(-self.rate);
        // The rate at the end is 0 or positive where it is not negative.
        let turns = (taken - falls).where_negative(self.rate).where_negative(self.counts);
        if turns.any_less(rate.lit(0.0)) {
            self.look::<M>(dynamics, control, state, (step.length, rate), turns);
        }
        self.counts = self.counts.min(leaves);
        self.rate = Lanes::select(rate, step.excess, self.rate);
    }

    #[inline(always)]
    fn rest(&mut self, _: <N::Leading as Lanes>::Set, _: &mut LaneState<N>) {}

    fn carried(&self, _: &LaneState<N>) -> [Carried; MAX_LANES] {
        let mut start = [[0.0; MAX_LANES]; 6];
        for (numbers, number) in start.iter_mut().zip(&self.measure.start) {
            *numbers = row(number.leading());
        }
        let counts = row(self.counts);
        std::array::from_fn(|lane| {
            Carried::Extremum(Sought {
                start: start.map(|row| row[lane]),
                counts: counts[lane] < 0.0,
                best: self.best.map(|row| row[lane]),
            })
        })
    }

    fn end(_: &Pendulum<f64>, left: &IntegratorState) -> FinalState {
        end_with_extremum(left)
    }
}

impl<N: Number> Search<N> {
    /// Finds the extremes in a step of `length` with the rate `rate` at its end, in lanes where
    /// `turns` is negative.
    #[inline(always)]
    fn look<M: LaneStepper<N>>(
        &mut self,
        dynamics: &LaneDynamics<N>,
        control: &M::Control,
        state: &LaneState<N>,
        (length, rate): (N::Leading, N::Leading),
        turns: N::Leading,
    ) {
        let mut zero = Bracket::new([self.rate, rate], length);
        let enough = length * length.lit(PART);
        // A lane that is done waits, so that its answer does not depend on the others.
        let (mut by, mut square, mut busy) = (length, rate, turns);
        for _ in 0..MOST_TRIALS {
            let next = zero.next();
            let tried = LaneState { step: next, ..*state };
            let motion = M::motion(dynamics, &tried);
            let after = M::step(dynamics, control, &tried, &motion).next;
            zero.narrow(next, self.measure.rate(&after).leading());
            square = Lanes::select(self.measure.square(&after).leading(), busy, square);
            let moved = (next - by).abs();
            by = Lanes::select(next, busy, by);
            busy = busy.where_negative(enough - moved);
            if !busy.any_less(enough.lit(0.0)) {
                break;
            }
        }
        self.keep(state, [by, square, turns]);
    }

    /// Keeps the extremes `by` after a state, given as squares, in lanes where `turns` is negative
    /// and they are beyond those before.
    #[inline(always)]
    fn keep(&mut self, state: &LaneState<N>, [by, square, turns]: [N::Leading; 3]) {
        let [time, low, by, square, turns] =
            [row(state.time), row(state.time_low), row(by), row(square), row(turns)];
        for lane in (0..<N::Leading as Lanes>::COUNT).filter(|&lane| turns[lane] < 0.0) {
            let value = square[lane].sqrt();
            if self.measure.extremum.is_beyond(value, self.best[0][lane]) {
                self.best[0][lane] = value;
                self.best[1][lane] = time[lane] + (low[lane] + by[lane]);
            }
        }
    }
}

/// A zero of the rate between two lengths of a step: false position with the Illinois rule, which
/// halves the value at an end that is kept twice in a row (Dowell and Jarratt 1971).
struct Bracket<L> {
    low: L,
    high: L,
    at_low: L,
    at_high: L,
    /// Negative where the low end was kept last, positive where the high one.
    kept: L,
}

impl<L: Lanes> Bracket<L> {
    #[inline(always)]
    fn new([at_low, at_high]: [L; 2], length: L) -> Self {
        Bracket { low: length.lit(0.0), high: length, at_low, at_high, kept: length.lit(0.0) }
    }

    /// The next place to try, between the ends.
    #[inline(always)]
    fn next(&self) -> L {
        let Bracket { low, high, at_low, at_high, .. } = *self;
        let place = (low * at_high - high * at_low) / (at_high - at_low);
        place.max(low).min(high)
    }

    /// Goes on with the part in which the rate changes its sign.
    #[inline(always)]
    fn narrow(&mut self, place: L, rate: L) {
        let (half, one) = (place.lit(0.5), place.lit(1.0));
        let below = rate;
        let slack = Lanes::select(self.at_high * half, -self.kept, self.at_high);
        let tight = Lanes::select(self.at_low * half, self.kept, self.at_low);
        let (low, at_low) =
            (Lanes::select(place, below, self.low), Lanes::select(rate, below, tight));
        self.high = Lanes::select(self.high, below, place);
        self.at_high = Lanes::select(slack, below, rate);
        (self.low, self.at_low) = (low, at_low);
        self.kept = Lanes::select(one, below, -one);
    }
}
