//! An engine without physics, so that everything above engines can be tested in milliseconds: the
//! answer to a start is a formula in its angles, and jobs finish only when polled.

use std::collections::VecDeque;
use std::sync::mpsc::Sender;

use super::{
    Effort, Engine, EngineError, EngineKind, FinalState, IntegratorState, Job, JobResult, Leaf,
    Moving, NUMBERS,
};
use super::{EventSpec, IntegratorConfig, Onset, Starts, Wait};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::lattice::side_rad;
use flipmap_scene::question::Needs;

/// An engine that answers jobs in the order of submission, or in reverse, one per poll.
pub struct MockEngine {
    /// True if the newest job is answered first.
    pub backwards: bool,
    /// Number of submissions before the job that is refused, if any.
    pub fail_at: Option<usize>,
    /// A suitable number of starts for a job.
    pub job_size: usize,
    /// Number of jobs taken so far.
    pub submitted: usize,
    /// Number of starts answered so far.
    pub answered: usize,
    /// Largest number of jobs that were in flight at once.
    pub max_in_flight: usize,
    /// Jobs in flight.
    pub queue: VecDeque<Job>,
    /// Channel to which each job taken and each picture begun is reported, in order.
    pub told: Option<Sender<String>>,
}

impl Default for MockEngine {
    fn default() -> Self {
        MockEngine {
            backwards: false,
            fail_at: None,
            job_size: 64,
            submitted: 0,
            answered: 0,
            max_in_flight: 0,
            queue: VecDeque::new(),
            told: None,
        }
    }
}

impl MockEngine {
    /// The answer to a start: an early flip where |θ2| ≤ 1, otherwise one after more than 40 s, at
    /// a time that identifies the start and its pendulum. As with a real pendulum, the mirror image
    /// has the same answer.
    pub fn answer(question: &EventSpec, angle: [Dd; 2]) -> Outcome {
        let [theta1, theta2] = angle.map(|theta| theta.hi);
        let along = (theta1 + 0.01 * theta2).abs();
        let home_secs = if theta2.abs() > 1.0 {
            30.0 + 10.0 * theta2.abs() + 0.1 * along
        } else {
            10.0 + along
        };
        // In the home scene, Q is 9.81 J.
        let secs = home_secs * 9.81 / question.build.gravity.value();
        if secs <= question.budget_secs {
            Outcome::flipped(secs)
        } else {
            Outcome::without_time(Status::Unflipped)
        }
    }

    fn tell(&self, what: String) {
        // A test may have stopped listening.
        let _ = self.told.as_ref().map(|told| told.send(what));
    }

    /// The state of a start that did not flip within the question's budget.
    fn pause(question: &EventSpec, angle: [Dd; 2]) -> IntegratorState {
        let mut numbers = [0.0; NUMBERS];
        let [theta1, theta2] = angle;
        let known = [question.budget_secs, question.build.gravity.value()];
        let angles = [theta1.hi, theta1.lo, theta2.hi, theta2.lo];
        for (number, value) in numbers.iter_mut().zip(known.into_iter().chain(angles)) {
            *number = value;
        }
        IntegratorState::new(1, numbers)
    }

    /// The present angles of a pendulum in motion.
    fn under_way(state: &Moving) -> [Dd; 2] {
        let [x1, y1, x2, y2, ..] = state.phase;
        [y1.atan2(x1), y2.atan2(x2)].map(Dd::new)
    }

    /// The angles of a leaf's starts, to double-double precision.
    fn angles_in(leaf: &Leaf) -> Vec<[Dd; 2]> {
        let (center, half) = (leaf.cell.center(), side_rad(leaf.cell.level + 1));
        let angle = |at: &[f64; 2]| [0, 1].map(|i| center[i].to_dd() + Dd::new(half * at[i]));
        leaf.points.iter().map(angle).collect()
    }

    /// Returns the start that a saved state belongs to, or an error if an engine could not continue
    /// it.
    fn resumed(question: &EventSpec, state: &IntegratorState) -> Result<[Dd; 2], EngineError> {
        let [budget_secs, q, hi1, lo1, hi2, lo2, ..] = state.numbers;
        if q != question.build.gravity.value() || budget_secs >= question.budget_secs {
            let text = format!("{q} J after {budget_secs} s is not continued by {question:?}");
            return Err(EngineError::Unsupported(text));
        }
        Ok([Dd { hi: hi1, lo: lo1 }, Dd { hi: hi2, lo: lo2 }])
    }
}

impl Engine for MockEngine {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        if self.fail_at == Some(self.submitted) {
            return Err(EngineError::OutOfMemory { mib: 1 });
        }
        self.submitted += 1;
        self.tell(format!("job {}", job.id));
        self.queue.push_back(job);
        self.max_in_flight = self.max_in_flight.max(self.queue.len());
        Ok(())
    }

    fn poll(&mut self, _: Wait) -> Result<Vec<JobResult>, EngineError> {
        let job = if self.backwards { self.queue.pop_back() } else { self.queue.pop_front() };
        let Some(Job { id, question, starts, keep, .. }) = job else {
            return Ok(Vec::new());
        };
        let angles = match starts.listed() {
            Starts::Rest(angles) => angles,
            Starts::Upright(_) => unreachable!("listed"),
            Starts::Thrown(launches) => launches.iter().map(|launch| launch.angle).collect(),
            Starts::Mixed { starts, .. } => starts.iter().map(Onset::angle).collect(),
            Starts::Resumed { states, .. } => states
                .iter()
                .map(|state| Self::resumed(&question, state))
                .collect::<Result<_, _>>()?,
            Starts::Moving(moving) => moving.states.iter().map(Self::under_way).collect(),
            Starts::Deep(deep) => deep.leaves.iter().flat_map(Self::angles_in).collect(),
        };
        self.answered += angles.len();
        let outcomes: Vec<_> = angles.iter().map(|a| Self::answer(&question, *a)).collect();
        let unfinished = (0..angles.len())
            .filter(|k| keep.states && outcomes[*k].status == Status::Unflipped)
            .map(|k| (k, Self::pause(&question, angles[k])))
            .collect();
        let effort = Effort { rhs_evaluations: angles.len() as u64, ..Effort::default() };
        let end = |outcome: &Outcome| FinalState { time: outcome.time, ..FinalState::NOWHERE };
        let ended = outcomes.iter().filter(|_| keep.ends == Needs::End);
        let ends: Vec<FinalState> = ended.map(end).collect();
        Ok(vec![JobResult { id, outcomes, unfinished, ends, effort, ..JobResult::default() }])
    }

    fn begin_picture(&mut self) {
        self.tell("picture".to_string());
    }

    fn cancel(&mut self) {
        self.queue.clear();
    }

    fn slots(&self) -> usize {
        3
    }

    fn job_size(&self) -> usize {
        self.job_size
    }

    fn offers(&self, _: &IntegratorConfig) -> bool {
        true
    }

    fn kind(&self) -> EngineKind {
        EngineKind::Gpu
    }

    fn adapter(&self) -> String {
        "none".to_string()
    }
}
