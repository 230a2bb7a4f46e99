//! Fixed steps: RK4 in angles, a register of pendulums at a time.

use std::f64::consts::TAU;

use super::lane_scheduler::{Chunk, ChunkResult, LaneScheduler, PATIENCE};
use super::lanes::{Lanes, MOST_LANES};
use super::slowed::slowed_lanes;
use crate::engine::pace::Steps;
use crate::engine::start::{angles_of, whole_turns};
use crate::engine::{End, NUMBERS, Precision, Question};
use crate::physics::flip::{fraction_of_step, may_pass};
use crate::physics::integrator::rk4;
use crate::physics::trig::Turning;
use crate::physics::{Accumulators, Outcome, Pendulum, State, Status};

/// Runs a chunk in lanes of `L`; `TERMS` terms turn a stage's direction (0: a fresh sine).
#[inline(always)]
pub(super) fn run<L: Lanes, const TERMS: usize>(
    set: L::Set,
    chunk: &Chunk,
    steps: Steps,
) -> Option<ChunkResult> {
    let turning = if TERMS == 0 { Turning::Fresh } else { Turning::Small(TERMS) };
    let compensated = chunk.config.precision == Precision::F32;
    let (reduced, _) = chunk.question.reduced();
    let pendulum = reduced.map(|number| L::splat(set, number));
    let step = L::splat(set, steps.length);
    let mut fixed = FixedStepLanes {
        scheduler: LaneScheduler::new(chunk, L::COUNT, [0.0; NUMBERS]),
        reduced,
        steps,
    };
    fixed.finish_those_over();
    while fixed.scheduler.is_busy() {
        if fixed.scheduler.is_cancelled() {
            return None;
        }
        let [mut state, mut rest] = fixed.load::<L>(set);
        let mut taken = 0;
        let most = fixed.steps_left().min(PATIENCE);
        while taken < most {
            let change = rk4(&pendulum, &state, step, turning);
            let (next, next_rest) = if compensated {
                state.plus_with_rest(rest.angle, &change)
            } else {
                (state.plus(&change), rest.angle)
            };
            if nearest_pass(chunk.question, &state, &next, step) >= PI_BELOW {
                fixed.store([&state, &rest], taken);
                fixed.look([&next, &State { angle: next_rest, ..rest }]);
                taken = u32::MAX;
                break;
            }
            (state, rest.angle) = (next, next_rest);
            taken += 1;
        }
        if taken != u32::MAX {
            fixed.store([&state, &rest], taken);
        }
        fixed.finish_slowed();
        fixed.finish_those_over();
    }
    Some(fixed.scheduler.answer)
}

/// The f32 just below π, with which lanes compare; the exact test follows in f64.
const PI_BELOW: f64 = 3.141_592_5;

/// Largest angle from hanging, in rad, that a watched bob of any lane may have reached in a step
/// (counterpart: `flip::may_pass`).
#[inline(always)]
fn nearest_pass<L: Lanes>(
    question: &Question,
    before: &State<L>,
    after: &State<L>,
    step: L,
) -> f64 {
    let mut nearest = before.angle[0].lit(0.0);
    for &bob in question.rule.watched() {
        let end = after.angle[bob].abs();
        let far = before.angle[bob].abs().max(end);
        let travel = step * before.speed[bob].abs().max(after.speed[bob].abs());
        // 1e-37 is below any product that matters, and makes 0 negative: at rest a bob may turn
        // round at once.
        let turned = before.speed[bob] * after.speed[bob] - nearest.lit(1e-37);
        nearest = nearest.max(end).max((far + travel).where_negative(turned));
    }
    nearest.largest()
}

/// A lane scheduler for fixed steps. Its rows are θ1, θ2, ω1, ω2 and the remainders of the angles.
struct FixedStepLanes<'a> {
    scheduler: LaneScheduler<'a>,
    reduced: Pendulum<f64>,
    steps: Steps,
}

impl FixedStepLanes<'_> {
    #[inline(always)]
    fn load<L: Lanes>(&self, set: L::Set) -> [State<L>; 2] {
        let rows = &self.scheduler.rows;
        let zero = L::splat(set, 0.0);
        let angle = [L::load(set, &rows[0]), L::load(set, &rows[1])];
        let speed = [L::load(set, &rows[2]), L::load(set, &rows[3])];
        let rest = [L::load(set, &rows[4]), L::load(set, &rows[5])];
        [State { angle, speed }, State { angle: rest, speed: [zero, zero] }]
    }

    /// Stores the lanes' state after `taken` steps.
    #[inline(always)]
    fn store<L: Lanes>(&mut self, [state, rest]: [&State<L>; 2], taken: u32) {
        let rows = [state.angle, state.speed, rest.angle];
        for (row, lanes) in self.scheduler.rows.iter_mut().zip(rows.as_flattened()) {
            lanes.store(row);
        }
        self.scheduler.count_steps(taken);
    }

    /// Decides for each lane whether the step to `next` is a flip; otherwise takes it.
    #[inline(always)]
    fn look<L: Lanes>(&mut self, [next, next_rest]: [&State<L>; 2]) {
        let mut after = [[0.0; MOST_LANES]; 6];
        let rows = [next.angle, next.speed, next_rest.angle];
        for (row, lanes) in after.iter_mut().zip(rows.as_flattened()) {
            lanes.store(row);
        }
        for lane in self.scheduler.running() {
            self.look_at(lane, after.map(|row| row[lane]));
        }
        self.scheduler.answer.effort.lane_steps += L::COUNT as u64;
    }

    fn look_at(&mut self, lane: usize, after: [f64; 6]) {
        let before = exact_state(&self.scheduler.numbers(lane));
        let exact_after = exact_state(&after);
        let effort = &mut self.scheduler.answer.effort;
        effort.steps += 1;
        effort.rhs_evaluations += 4;
        let steps = self.scheduler.taken[lane];
        let (mut from, mut to, mut begun) = (before, exact_after, 0.0);
        while let Some((bob, share)) = self.first_pass(&from, &to, 1.0 - begun) {
            let fraction = begun + (1.0 - begun) * share;
            let outcome = self.steps.outcome_of_pass(steps, fraction);
            let change = rk4(&self.reduced, &before, self.steps.length * fraction, Turning::Fresh);
            let top = before.plus(&change);
            let anticlockwise = to.angle[bob] > 0.0;
            let over = outcome.status == Status::Unflipped;
            if over || self.scheduler.pass(lane, bob, anticlockwise) {
                let end = self.end(lane, f64::from(steps) + fraction, &top);
                self.scheduler.finish(lane, outcome, end);
                return;
            }
            // The bob goes on from the other side of the top.
            let turn = if anticlockwise { -TAU } else { TAU };
            to.angle[bob] += turn;
            (from, begun) = (top, fraction);
            from.angle = [0, 1].map(|i| top.angle[i] + (to.angle[i] - exact_after.angle[i]));
            from.angle[bob] = 0.5 * turn;
        }
        self.take(lane, after, [0, 1].map(|bob| to.angle[bob] - exact_after.angle[bob]));
    }

    /// Moves a lane to the state after a step, with its angles turned by whole turns, rad.
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

    /// The bob that first passes the top between two states a share of a step apart, and the
    /// fraction of that time at which it does.
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

    /// Frees the lanes whose budget is used up, until every lane has work or none is left.
    fn finish_those_over(&mut self) {
        loop {
            self.scheduler.refill();
            let mut finished = false;
            for lane in self.scheduler.running() {
                let speeds = [self.scheduler.rows[2][lane], self.scheduler.rows[3][lane]];
                let sound = speeds.iter().all(|speed| speed.is_finite());
                if !sound || self.scheduler.taken[lane] >= self.steps.count {
                    let status = if sound { Status::Unflipped } else { Status::Failed };
                    let state = exact_state(&self.scheduler.numbers(lane));
                    let end = self.end(lane, f64::from(self.scheduler.taken[lane]), &state);
                    self.scheduler.finish(lane, Outcome::without_time(status), end);
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
            let state = exact_state(&self.scheduler.numbers(lane));
            let end = self.end(lane, f64::from(self.scheduler.taken[lane]), &state);
            self.scheduler.finish(lane, Outcome::without_time(Status::Unflipped), end);
        }
    }

    fn end(&self, lane: usize, steps: f64, state: &State<f64>) -> End {
        let phase = self.reduced.phase(state);
        let (turns, passes) = (state.angle.map(whole_turns), self.scheduler.passes[lane]);
        let gathered = Accumulators { turns, passes, ..Accumulators::NONE };
        End { time: steps * self.steps.length, phase, gathered, ..End::NOWHERE }
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
