//! A register's worth of pendulums stepped together; a lane whose pendulum is done takes the
//! next one, so that no lane idles while there is work.

use std::sync::atomic::{AtomicBool, Ordering};

use super::lanes::{Lanes, MOST_LANES};
use crate::engine::method::Steps;
use crate::engine::{Paused, Question};
use crate::physics::flip::{fraction_of_step, may_pass};
use crate::physics::integrator::rk4;
use crate::physics::trig::Turning;
use crate::physics::{Outcome, Pendulum, State, Status};

/// What one chunk of a job needs.
pub struct Chunk<'a> {
    /// What is asked.
    pub question: &'a Question,
    /// The fixed step over the budget.
    pub steps: Steps,
    /// Where each pendulum begins, in reduced units.
    pub starts: &'a [Paused],
    /// Whether angles keep what rounding takes from them.
    pub compensated: bool,
    /// Set when nobody wants the answer any more.
    pub cancelled: &'a AtomicBool,
}

/// What became of a chunk: per start its outcome and last state, and the work done.
pub struct Answer {
    /// In the order of the starts.
    pub outcomes: Vec<Outcome>,
    /// Likewise; of flipped ones the state at the beginning of the step in which they did.
    pub states: Vec<Paused>,
    /// Right-hand sides evaluated.
    pub rhs_evaluations: u64,
}

/// Steps between two looks at whether the work is still wanted.
const PATIENCE: u32 = 512;

/// Runs a chunk in lanes of `L`; `TERMS` terms turn a stage's direction (0: a fresh sine).
#[inline(always)]
pub fn run<L: Lanes, const TERMS: usize>(set: L::Set, chunk: &Chunk) -> Option<Answer> {
    let turning = if TERMS == 0 { Turning::Fresh } else { Turning::Small(TERMS) };
    let (reduced, _) = chunk.question.pendulum.reduced();
    let pendulum = reduced.map(|number| L::splat(set, number));
    let step = L::splat(set, chunk.steps.length);
    let mut flock = Flock::new(chunk, reduced, L::COUNT);
    while flock.busy > 0 {
        if chunk.cancelled.load(Ordering::Relaxed) {
            return None;
        }
        let [mut state, mut rest] = flock.load::<L>(set);
        let mut taken = 0;
        let most = flock.steps_left().min(PATIENCE);
        while taken < most {
            let change = rk4(&pendulum, &state, step, turning);
            let (next, next_rest) = if chunk.compensated {
                state.plus_with_rest(rest.angle, &change)
            } else {
                (state.plus(&change), rest.angle)
            };
            if nearest_pass(chunk.question, &state, &next, step) >= PI_BELOW {
                flock.store([&state, &rest], taken);
                flock.look([&next, &State { angle: next_rest, ..rest }]);
                taken = u32::MAX;
                break;
            }
            (state, rest.angle) = (next, next_rest);
            taken += 1;
        }
        if taken != u32::MAX {
            flock.store([&state, &rest], taken);
        }
        flock.refill();
    }
    Some(flock.answer)
}

/// The f32 next below π: lanes compare with it, the exact test follows in f64.
const PI_BELOW: f64 = 3.141_592_5;

/// How near any lane may have come to the top in a step (twin: `flip::may_pass`).
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
        let turned = before.speed[bob] * after.speed[bob];
        nearest = nearest.max(end).max((far + travel).where_negative(turned));
    }
    nearest.largest()
}

/// The lanes' bookkeeping between stretches of steps.
struct Flock<'a> {
    chunk: &'a Chunk<'a>,
    reduced: Pendulum<f64>,
    lanes: usize,
    /// Which start each lane runs.
    start: [usize; MOST_LANES],
    /// θ1, θ2, ω1, ω2 and the rests of the angles, lane by lane.
    values: [[f64; MOST_LANES]; 6],
    taken: [u32; MOST_LANES],
    next_start: usize,
    busy: usize,
    answer: Answer,
}

const IDLE: usize = usize::MAX;

impl<'a> Flock<'a> {
    fn new(chunk: &'a Chunk<'a>, reduced: Pendulum<f64>, lanes: usize) -> Self {
        let answer = Answer {
            outcomes: vec![Outcome::without_time(Status::Unflipped); chunk.starts.len()],
            states: chunk.starts.to_vec(),
            rhs_evaluations: 0,
        };
        let mut flock = Flock {
            chunk,
            reduced,
            lanes,
            start: [IDLE; MOST_LANES],
            values: [[0.0; MOST_LANES]; 6],
            taken: [0; MOST_LANES],
            next_start: 0,
            busy: 0,
            answer,
        };
        flock.refill();
        flock
    }

    /// Gives every idle lane the next start, if there is one.
    fn refill(&mut self) {
        for lane in 0..self.lanes {
            while self.start[lane] == IDLE && self.next_start < self.chunk.starts.len() {
                let start = self.chunk.starts[self.next_start];
                let [angle, speed] = [start.state.angle, start.state.speed];
                self.put(
                    lane,
                    [angle[0], angle[1], speed[0], speed[1], start.rest[0], start.rest[1]],
                );
                (self.start[lane], self.taken[lane]) = (self.next_start, start.steps);
                self.next_start += 1;
                self.busy += 1;
                self.finish_if_over(lane);
            }
        }
    }

    fn put(&mut self, lane: usize, values: [f64; 6]) {
        for (row, value) in self.values.iter_mut().zip(values) {
            row[lane] = value;
        }
    }

    #[inline(always)]
    fn load<L: Lanes>(&self, set: L::Set) -> [State<L>; 2] {
        let rows = &self.values;
        let zero = L::splat(set, 0.0);
        let angle = [L::load(set, &rows[0]), L::load(set, &rows[1])];
        let speed = [L::load(set, &rows[2]), L::load(set, &rows[3])];
        let rest = [L::load(set, &rows[4]), L::load(set, &rows[5])];
        [State { angle, speed }, State { angle: rest, speed: [zero, zero] }]
    }

    /// Takes the lanes' state after `taken` steps, and frees those whose budget is used.
    #[inline(always)]
    fn store<L: Lanes>(&mut self, [state, rest]: [&State<L>; 2], taken: u32) {
        let rows = [state.angle, state.speed, rest.angle];
        for (row, lanes) in self.values.iter_mut().zip(rows.as_flattened()) {
            lanes.store(row);
        }
        for lane in 0..self.lanes {
            if self.start[lane] != IDLE {
                self.taken[lane] += taken;
                self.answer.rhs_evaluations += 4 * u64::from(taken);
                self.finish_if_over(lane);
            }
        }
    }

    /// Decides for each lane whether the step to `next` is a flip; otherwise takes it.
    #[inline(always)]
    fn look<L: Lanes>(&mut self, [next, next_rest]: [&State<L>; 2]) {
        let mut after = [[0.0; MOST_LANES]; 6];
        let rows = [next.angle, next.speed, next_rest.angle];
        for (row, lanes) in after.iter_mut().zip(rows.as_flattened()) {
            lanes.store(row);
        }
        for lane in 0..self.lanes {
            if self.start[lane] != IDLE {
                self.look_at(lane, after.map(|row| row[lane]));
            }
        }
    }

    fn look_at(&mut self, lane: usize, after: [f64; 6]) {
        let before = exact_state(self.values.map(|row| row[lane]));
        let exact_after = exact_state(after);
        self.answer.rhs_evaluations += 4;
        let step = self.chunk.steps.length;
        let mut fraction: Option<f64> = None;
        for &bob in self.chunk.question.rule.watched() {
            if may_pass(&before, &exact_after, bob, step) {
                self.answer.rhs_evaluations += 2;
                let found = fraction_of_step(&self.reduced, bob, &before, &exact_after, step);
                fraction = [fraction, found].into_iter().flatten().reduce(f64::min);
            }
        }
        let Some(fraction) = fraction else {
            self.put(lane, after);
            self.taken[lane] += 1;
            self.finish_if_over(lane);
            return;
        };
        self.finish(lane, self.chunk.steps.outcome_of_pass(self.taken[lane], fraction));
    }

    fn finish_if_over(&mut self, lane: usize) {
        let sound = self.values[2][lane].is_finite() && self.values[3][lane].is_finite();
        if !sound {
            self.finish(lane, Outcome::without_time(Status::Failed));
        } else if self.taken[lane] >= self.chunk.steps.count {
            self.finish(lane, Outcome::without_time(Status::Unflipped));
        }
    }

    /// Keeps a lane's outcome and state, and hangs a pendulum at rest in it.
    fn finish(&mut self, lane: usize, outcome: Outcome) {
        let start = std::mem::replace(&mut self.start[lane], IDLE);
        let [t1, t2, w1, w2, rest1, rest2] = self.values.map(|row| row[lane]);
        self.answer.outcomes[start] = outcome;
        self.answer.states[start] = Paused {
            steps: self.taken[lane],
            state: State { angle: [t1, t2], speed: [w1, w2] },
            rest: [rest1, rest2],
        };
        self.put(lane, [0.0; 6]);
        self.busy -= 1;
    }

    /// Steps until the first lane's budget is used.
    fn steps_left(&self) -> u32 {
        (0..self.lanes)
            .filter(|&lane| self.start[lane] != IDLE)
            .map(|lane| self.chunk.steps.count - self.taken[lane])
            .min()
            .unwrap_or(0)
    }
}

fn exact_state([t1, t2, w1, w2, rest1, rest2]: [f64; 6]) -> State<f64> {
    State { angle: [t1 + rest1, t2 + rest2], speed: [w1, w2] }
}
