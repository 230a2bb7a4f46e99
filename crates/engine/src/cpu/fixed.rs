//! Fixed steps: RK4 in angles, a register of pendulums at a time.

use std::f64::consts::TAU;

use super::lane_scheduler::{Chunk, ChunkResult, LaneScheduler, PATIENCE, lane_of};
use super::lanes::{Lanes, MAX_LANES};
use super::slowed::slowed_lanes;
use super::stretch::{Stretch, StretchEnd, vectorized};
use crate::pace::Steps;
use crate::start::{angles_of, whole_turns};
use crate::{FinalState, NUMBERS, Precision};
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::flip::{fraction_of_step, may_pass};
use flipmap_pendulum::integrator::rk4;
use flipmap_pendulum::{Accumulators, Outcome, Pendulum, State, Status};

/// Runs a chunk in lanes of `L`. A stage's direction is turned by a series of `TERMS` terms, or
/// computed afresh if that is 0.
#[inline(never)]
pub(super) fn run<L: Lanes, const TERMS: usize>(
    set: L::Set,
    chunk: &Chunk,
    steps: Steps,
) -> Option<ChunkResult> {
    let (reduced, _) = chunk.question.reduced();
    let mut fixed = FixedStepLanes {
        scheduler: LaneScheduler::new(chunk, L::COUNT, [0.0; NUMBERS]),
        reduced,
        steps,
    };
    let mut suspect = SuspectStep { after: [[0.0; MAX_LANES]; 6], nearest: [0.0; MAX_LANES] };
    fixed.finish_those_over();
    while fixed.scheduler.is_busy() {
        if fixed.scheduler.is_cancelled() {
            return None;
        }
        let stretch = FixedStretch::<TERMS> {
            pendulum: &reduced,
            step: steps.length,
            watches: chunk.question.rule.watches(),
            compensated: chunk.config.precision == Precision::F32,
            most: fixed.steps_left().min(PATIENCE),
            rows: &mut fixed.scheduler.rows,
            suspect: &mut suspect,
        };
        let StretchEnd { taken, is_suspect } = vectorized::<L, _>(set, stretch);
        fixed.scheduler.count_steps(taken);
        if is_suspect {
            fixed.look(&suspect);
        }
        fixed.finish_slowed();
        fixed.finish_those_over();
    }
    Some(fixed.scheduler.answer)
}

/// A loop that steps all lanes until a watched bob may have been at the top. The suspect step is
/// not taken.
struct FixedStretch<'a, const TERMS: usize> {
    pendulum: &'a Pendulum<f64>,
    /// Length of a step in reduced units.
    step: f64,
    watches: [bool; 2],
    /// True if the rounding remainders of the angles are carried along.
    compensated: bool,
    most: u32,
    /// The lanes' numbers, before the stretch and then after the steps taken.
    rows: &'a mut [[f64; MAX_LANES]; NUMBERS],
    suspect: &'a mut SuspectStep,
}

/// A step in which a bob of some lane may have been at the top.
struct SuspectStep {
    /// The lanes' numbers after the step.
    after: [[f64; MAX_LANES]; 6],
    /// Largest angle from hanging, in rad, that each lane's watched bobs may have reached.
    nearest: [f64; MAX_LANES],
}

impl<L: Lanes, const TERMS: usize> Stretch<L> for FixedStretch<'_, TERMS> {
    type Output = StretchEnd;

    #[inline(always)]
    fn run(self, set: L::Set) -> StretchEnd {
        let turning = if TERMS == 0 { Turning::Fresh } else { Turning::Small(TERMS) };
        let pendulum = self.pendulum.map(|number| L::splat(set, number));
        let (step, top) = (L::splat(set, self.step), L::splat(set, PI_BELOW));
        let [mut state, mut rest] = load::<L>(set, self.rows);
        for taken in 0..self.most {
            let change = rk4(&pendulum, &state, step, turning);
            let (next, next_rest) = if self.compensated {
                state.plus_with_rest(rest.angle, &change)
            } else {
                (state.plus(&change), rest.angle)
            };
            let nearest = nearest_pass(self.watches, &state, &next, step);
            if top.any_at_most(nearest) {
                store([&state, &rest], self.rows);
                store([&next, &State { angle: next_rest, ..rest }], &mut self.suspect.after);
                nearest.store(&mut self.suspect.nearest);
                return StretchEnd { taken, is_suspect: true };
            }
            (state, rest.angle) = (next, next_rest);
        }
        store([&state, &rest], self.rows);
        StretchEnd { taken: self.most, is_suspect: false }
    }
}

/// Loads the lanes' states, and the rounding remainders of their angles, from rows.
#[inline(always)]
fn load<L: Lanes>(set: L::Set, rows: &[[f64; MAX_LANES]]) -> [State<L>; 2] {
    let zero = L::splat(set, 0.0);
    let angle = [L::load(set, &rows[0]), L::load(set, &rows[1])];
    let speed = [L::load(set, &rows[2]), L::load(set, &rows[3])];
    let rest = [L::load(set, &rows[4]), L::load(set, &rows[5])];
    [State { angle, speed }, State { angle: rest, speed: [zero, zero] }]
}

/// Stores the lanes' states, and the rounding remainders of their angles, to rows.
#[inline(always)]
fn store<L: Lanes>([state, rest]: [&State<L>; 2], rows: &mut [[f64; MAX_LANES]]) {
    let numbers = [state.angle, state.speed, rest.angle];
    for (row, lanes) in rows.iter_mut().zip(numbers.as_flattened()) {
        lanes.store(row);
    }
}

/// The f32 just below π, with which lanes compare; the exact test follows in f64.
const PI_BELOW: f64 = 3.141_592_5;

/// Largest angle from hanging, in rad, that the watched bobs of each lane may have reached in a
/// step (counterpart: `flip::may_pass`).
#[inline(always)]
fn nearest_pass<L: Lanes>(watches: [bool; 2], before: &State<L>, after: &State<L>, step: L) -> L {
    let mut nearest = step.lit(0.0);
    // Written out: the loop would keep the states in memory.
    if watches[0] {
        nearest = nearest_pass_of(0, nearest, before, after, step);
    }
    if watches[1] {
        nearest = nearest_pass_of(1, nearest, before, after, step);
    }
    nearest
}

#[inline(always)]
fn nearest_pass_of<L: Lanes>(
    bob: usize,
    nearest: L,
    before: &State<L>,
    after: &State<L>,
    step: L,
) -> L {
    let end = after.angle[bob].abs();
    let far = before.angle[bob].abs().max(end);
    let travel = step * before.speed[bob].abs().max(after.speed[bob].abs());
    // Subtracting 1e-37, which is below any product that matters, makes 0 negative, because a bob
    // at rest may turn round at once.
    let turned = before.speed[bob] * after.speed[bob] - nearest.lit(1e-37);
    nearest.max(end).max((far + travel).where_negative(turned))
}

/// A lane scheduler for fixed steps. Its rows are θ1, θ2, ω1, ω2 and the remainders of the angles.
struct FixedStepLanes<'a> {
    scheduler: LaneScheduler<'a>,
    reduced: Pendulum<f64>,
    steps: Steps,
}

impl FixedStepLanes<'_> {
    /// Decides a step in those lanes where a bob may have been at the top; takes it in the others.
    fn look(&mut self, step: &SuspectStep) {
        for lane in self.scheduler.running() {
            let effort = &mut self.scheduler.answer.effort;
            effort.steps += 1;
            effort.rhs_evaluations += 4;
            let after = lane_of(&step.after, lane);
            if step.nearest[lane] >= PI_BELOW {
                self.look_at(lane, after);
            } else {
                self.take(lane, after, [0.0; 2]);
            }
        }
        self.scheduler.count_lane_steps(1);
    }

    /// Looks for passes of the top, one after another, in the step of a lane; then finishes the
    /// lane or takes the step.
    fn look_at(&mut self, lane: usize, after: [f64; 6]) {
        let before = exact_state(&self.scheduler.numbers(lane));
        let exact_after = exact_state(&after);
        let steps = self.scheduler.taken[lane];
        let (mut from, mut to, mut begun) = (before, exact_after, 0.0);
        let mut last = None;
        while let Some((bob, share)) = self.first_pass(&from, &to, 1.0 - begun) {
            let fraction = begun + (1.0 - begun) * share;
            // At the top, rounding can put a bob on either side; it passes once.
            if last.replace((bob, fraction)) == Some((bob, fraction)) {
                break;
            }
            let outcome = self.steps.outcome_of_pass(steps, fraction);
            let (reduced, length) = (self.reduced, self.steps.length);
            let top = || before.plus(&rk4(&reduced, &before, length * fraction, Turning::Fresh));
            let anticlockwise = to.angle[bob] > 0.0;
            let over = outcome.status == Status::Unflipped;
            if over || self.scheduler.pass(lane, bob, anticlockwise) {
                self.finish(lane, outcome, f64::from(steps) + fraction, top);
                return;
            }
            let top = top();
            // The bob goes on from the other side of the top.
            let turn = if anticlockwise { -TAU } else { TAU };
            to.angle[bob] += turn;
            (from, begun) = (top, fraction);
            from.angle = [0, 1].map(|i| top.angle[i] + (to.angle[i] - exact_after.angle[i]));
            from.angle[bob] = 0.5 * turn;
        }
        self.take(lane, after, [0, 1].map(|bob| to.angle[bob] - exact_after.angle[bob]));
    }

    /// Moves a lane to the state after a step, with whole turns (rad) added to its angles.
    fn take(&mut self, lane: usize, mut after: [f64; 6], turned: [f64; 2]) {
        for bob in (0..2).filter(|&bob| turned[bob] != 0.0) {
            let angle = after[bob] + turned[bob] + after[4 + bob];
            let kept = match self.scheduler.chunk.config.precision {
                Precision::F32 => f64::from(angle as f32),
                _ => angle,
            };
            (after[bob], after[4 + bob]) = (kept, angle - kept);
        }
        for (row, value) in self.scheduler.rows.iter_mut().zip(after) {
            row[lane] = value;
        }
        self.scheduler.taken[lane] += 1;
    }

    /// Returns the bob that first passes the top between two states that are a `share` of a step
    /// apart, and the fraction of that time at which it passes.
    fn first_pass(
        &mut self,
        from: &State<f64>,
        to: &State<f64>,
        share: f64,
    ) -> Option<(usize, f64)> {
        let length = self.steps.length * share;
        let mut first: Option<(usize, f64)> = None;
        for &bob in self.scheduler.chunk.question.rule.watched() {
            if may_pass(from, to, bob, length) {
                self.scheduler.answer.effort.rhs_evaluations += 2;
                let found = fraction_of_step(&self.reduced, bob, from, to, length);
                let earlier = |share: &f64| first.is_none_or(|(_, before)| *share < before);
                if let Some(share) = found.filter(earlier) {
                    first = Some((bob, share));
                }
            }
        }
        first
    }

    /// Frees and refills the lanes whose budget is used up, until every lane has work or no start
    /// is left.
    fn finish_those_over(&mut self) {
        loop {
            self.scheduler.refill();
            let mut finished = false;
            for lane in self.scheduler.running() {
                let speeds = [self.scheduler.rows[2][lane], self.scheduler.rows[3][lane]];
                let sound = speeds.iter().all(|speed| speed.is_finite());
                if !sound || self.scheduler.taken[lane] >= self.steps.count {
                    let status = if sound { Status::Unflipped } else { Status::Failed };
                    self.finish_now(lane, Outcome::without_time(status));
                    finished = true;
                }
            }
            if !finished {
                return;
            }
        }
    }

    /// Frees the lanes whose pendulums friction has left too little energy ever to pass the top.
    fn finish_slowed(&mut self) {
        let phase = |numbers: &[f64; NUMBERS]| self.reduced.phase(&exact_state(numbers));
        for lane in slowed_lanes(&self.scheduler, &self.reduced, phase) {
            self.finish_now(lane, Outcome::without_time(Status::Unflipped));
        }
    }

    /// Finishes a lane after the steps it has taken.
    fn finish_now(&mut self, lane: usize, outcome: Outcome) {
        let (steps, numbers) = (self.scheduler.taken[lane], self.scheduler.numbers(lane));
        self.finish(lane, outcome, f64::from(steps), || exact_state(&numbers));
    }

    /// Finishes a lane after `steps` steps, in the state that `state` computes.
    fn finish(
        &mut self,
        lane: usize,
        outcome: Outcome,
        steps: f64,
        state: impl FnOnce() -> State<f64>,
    ) {
        let (reduced, length) = (self.reduced, self.steps.length);
        self.scheduler.finish(lane, outcome, |scheduler| {
            let state = state();
            let (turns, passes) = (state.angle.map(whole_turns), scheduler.passes[lane]);
            let gathered = Accumulators { turns, passes, ..Accumulators::NONE };
            let phase = reduced.phase(&state);
            FinalState { time: steps * length, phase, gathered, ..FinalState::NOWHERE }
        });
    }

    /// Number of steps until the first lane's budget is used up.
    fn steps_left(&self) -> u32 {
        let left = |lane: usize| self.steps.count - self.scheduler.taken[lane];
        self.scheduler.running().map(left).min().unwrap_or(0)
    }
}

fn exact_state(numbers: &[f64]) -> State<f64> {
    State { angle: angles_of(numbers), speed: [numbers[2], numbers[3]] }
}
