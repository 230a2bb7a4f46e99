//! Deep zoom: an engine for starts too close together for the number types of engines.
//!
//! It wraps another engine. The leaf of the lattice in which deep starts lie has an ancestor 6 to
//! 11 levels up, the *anchor*. Its middle is followed in as many digits as the depth needs, its
//! whole area as one [`FlowPatch`](crate::physics::flow_patch::FlowPatch): Taylor polynomials of
//! the flow map in the position of the start. Their coefficients are differences from the middle,
//! for which f64 has digits enough at any depth, as with the reference orbit of a deep Mandelbrot
//! zoom.
//!
//! ```text
//!  level        time ──▶
//!  L−11 … L−6   anchor ├────────────┤ polynomials no longer hold: quarters
//!   …           quarter             ├──────┤ quarters
//!  L            leaf                       ├─────────┤ start map
//!               samples of its line                   ├── integrated, tell most starts
//!               other starts                          ├── integrated one by one
//! ```
//!
//! Where the polynomials leave out too much, or cannot tell what happens at the top, the cell is
//! cut into quarters that continue on their own (automatic domain splitting; Wittig et al., Celest.
//! Mech. Dyn. Astr. 122, 2015; polynomial arithmetic on flows is Berz's differential algebra). The
//! finished patch gives each of its leaves a *start map*: which starts are forbidden, flip at a
//! known time or stay unflipped, and in which states the others are, far enough apart by then that
//! any number type can integrate them. By then most leaves have one direction alone; a few samples
//! along it tell most of its starts ([`lines`]). Samples, and the starts that these do not tell, go to
//! the wrapped engine as pendulums in motion, and all other jobs are passed on to it.
//!
//! * An answer depends on its leaf's place in the lattice alone, not on jobs or other requests.
//! * Anchors and splittings are cached, and cells are followed on threads of this engine's own, eight
//!   at a time in SIMD lanes ([`split_lanes`]).
//! * Strict jobs use other cuts and smaller errors: [`super::trust`] checks one map by another.

mod deep;
mod domain_splitting;
mod following;
mod line_interval;
mod lines;
mod split_lanes;
mod start_map;
mod stats;

use std::collections::{HashMap, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use self::domain_splitting::{DomainSplitting, SplitRequest};
pub use self::following::Following;
use self::lines::Lines;
use self::start_map::{MappedStart, StartMap};
pub use self::stats::DepthStats;
use super::{
    Effort, End, Engine, EngineError, EngineKind, IntegratorConfig, Job, JobResult, Keep, Leaf,
    Method, Moving, Precision, Question, Starts, Wait,
};
use crate::physics::{Outcome, Status};
use crate::scene::lattice::Cell;

/// An engine that follows deep starts for the engine that it wraps.
pub struct DepthEngine<'a> {
    inner: Box<dyn Engine + 'a>,
    pool: rayon::ThreadPool,
    splittings: Splittings,
    /// Deep jobs by identifier: some are being followed, others are with the wrapped engine.
    deep: HashMap<u64, Awaited>,
    /// Jobs for which the wrapped engine has no free slot yet.
    waiting: VecDeque<Job>,
    flying: usize,
    following: usize,
    cancelled: Arc<AtomicBool>,
    told: Following,
    sender: Sender<Followed>,
    receiver: Receiver<Followed>,
}

/// The domain splittings of the pendulums and rules met so far, the latest last.
type Splittings = Arc<Mutex<Vec<Arc<DomainSplitting>>>>;

/// Largest number of splittings that are kept.
const MOST_SPLITTINGS: usize = 4;

/// The known part of a deep job, to be merged with the wrapped engine's answer.
#[derive(Default)]
struct Awaited {
    outcomes: Vec<Outcome>,
    ends: Vec<End>,
    /// Indices of the starts that the wrapped engine integrates, and the states they begin in.
    moving: Vec<(usize, Moving)>,
    /// The job and its lines, while samples of these are integrated.
    lines: Option<(Job, Lines)>,
    effort: Effort,
}

/// A deep job whose cells have been followed, with its lines if it may use any.
struct Followed {
    job: Job,
    awaited: Awaited,
    lines: Option<Lines>,
}

/// Longest wait for one source of answers before the other is looked at.
const TURN: Duration = Duration::from_millis(2);

impl<'a> DepthEngine<'a> {
    /// Follows deep starts for `inner` on `threads` threads, or on one for every core.
    pub fn new(inner: Box<dyn Engine + 'a>, threads: Option<usize>) -> Result<Self, EngineError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or(0))
            .thread_name(|index| format!("depth-{index}"))
            .build()
            .map_err(|error| EngineError::Unsupported(format!("cannot start threads: {error}")))?;
        let (sender, receiver) = channel();
        Ok(DepthEngine {
            inner,
            pool,
            splittings: Splittings::default(),
            deep: HashMap::new(),
            waiting: VecDeque::new(),
            flying: 0,
            following: 0,
            cancelled: Arc::default(),
            told: Following::default(),
            sender,
            receiver,
        })
    }

    /// Makes the engine report its progress in following a middle to `following`.
    pub fn telling(mut self, following: Following) -> Self {
        self.told = following;
        self
    }

    fn follow(&mut self, job: Job) {
        let Starts::Deep(deep) = &job.starts else { return };
        let splitting = splitting_of(&self.splittings, &job.question, deep.strict);
        let (sender, cancelled) = (self.sender.clone(), self.cancelled.clone());
        let told = self.told.clone();
        self.deep.insert(job.id, Awaited::default());
        self.following += 1;
        self.pool.spawn_fifo(move || {
            if let Some(followed) = followed(job, &splitting, &cancelled, &told) {
                // The receiver is gone once the job is cancelled.
                let _ = sender.send(followed);
            }
        });
    }

    /// Takes a deep job whose cells have been followed; returns its result if all of it is known.
    fn take_followed(&mut self, followed: Followed) -> Option<JobResult> {
        self.following -= 1;
        let Followed { job, awaited, lines } = followed;
        match lines {
            Some(lines) => self.sample(job, awaited, lines),
            None => self.integrate(job, awaited),
        }
    }

    /// Queues the next samples of a job's lines; once these tell all they can, the starts that are
    /// left.
    fn sample(&mut self, job: Job, mut awaited: Awaited, mut lines: Lines) -> Option<JobResult> {
        let wanted = lines.ask();
        if wanted.is_empty() {
            awaited.effort.depth = awaited.effort.depth.map(|depth| lines.counted(depth));
            let Lines { known, mut alone, .. } = lines;
            for (place, outcome) in known {
                awaited.outcomes[place] = outcome;
            }
            alone.sort_unstable();
            awaited.moving.retain(|(place, _)| alone.binary_search(place).is_ok());
            return self.integrate(job, awaited);
        }
        let samples = Job { starts: Starts::Moving(wanted), keep: Keep::Ends, ..job.clone() };
        self.waiting.push_back(samples);
        let id = job.id;
        awaited.lines = Some((job, lines));
        self.deep.insert(id, awaited);
        None
    }

    /// Queues the starts that have to be integrated one by one; returns the result if there are none.
    fn integrate(&mut self, job: Job, awaited: Awaited) -> Option<JobResult> {
        if awaited.moving.is_empty() {
            self.deep.remove(&job.id);
            let Awaited { outcomes, ends, effort, .. } = awaited;
            let ends = if job.keep == Keep::Ends { ends } else { Vec::new() };
            return Some(JobResult { id: job.id, outcomes, ends, effort, ..JobResult::default() });
        }
        let states = awaited.moving.iter().map(|(_, state)| *state).collect();
        self.deep.insert(job.id, awaited);
        self.waiting.push_back(Job { starts: Starts::Moving(states), ..job });
        None
    }

    /// Takes a result of the wrapped engine, and returns what it completes: its deep job, or, if it
    /// belongs to none, the result itself.
    fn take_finished(&mut self, finished: JobResult) -> Option<JobResult> {
        self.flying -= 1;
        let Some(mut awaited) = self.deep.remove(&finished.id) else { return Some(finished) };
        if let Some((job, mut lines)) = awaited.lines.take() {
            lines.answer(&finished);
            awaited.effort += finished.effort;
            return self.sample(job, awaited, lines);
        }
        let Awaited { mut outcomes, mut ends, moving, mut effort, .. } = awaited;
        for (&(place, _), outcome) in moving.iter().zip(&finished.outcomes) {
            outcomes[place] = *outcome;
        }
        for ((place, begun), end) in moving.iter().zip(&finished.ends) {
            let clearance = end.clearance.min(begun.clearance);
            ends[*place] = End { clearance, grown: begun.grown, ..*end };
        }
        if finished.ends.is_empty() {
            ends.clear();
        }
        let unfinished = finished.unfinished.into_iter().map(|(k, state)| (moving[k].0, state));
        effort += finished.effort;
        let unfinished = unfinished.collect();
        Some(JobResult { outcomes, ends, unfinished, effort, ..finished })
    }

    /// Keeps the wrapped engine's slots full.
    fn feed(&mut self) -> Result<(), EngineError> {
        while self.flying < self.inner.slots() {
            let Some(job) = self.waiting.pop_front() else { break };
            self.inner.submit(job)?;
            self.flying += 1;
        }
        Ok(())
    }
}

/// Returns the domain splitting of a question, made if there is none yet.
fn splitting_of(
    splittings: &Splittings,
    question: &Question,
    strict: bool,
) -> Arc<DomainSplitting> {
    let mut splittings = splittings.lock().unwrap_or_else(|broken| broken.into_inner());
    if let Some(splitting) = splittings.iter().find(|splitting| splitting.is_of(question, strict)) {
        return splitting.clone();
    }
    if splittings.len() == MOST_SPLITTINGS {
        splittings.remove(0);
    }
    splittings.push(Arc::new(DomainSplitting::new(question, strict)));
    splittings[splittings.len() - 1].clone()
}

/// Follows the cells of a job and maps its starts through them; returns none if cancelled.
fn followed(
    mut job: Job,
    splitting: &DomainSplitting,
    cancelled: &AtomicBool,
    told: &Following,
) -> Option<Followed> {
    let Starts::Deep(deep) = std::mem::replace(&mut job.starts, Starts::Moving(Vec::new())) else {
        return None;
    };
    let question = job.question;
    let (_, unit_secs) = question.reduced();
    let level = deep.leaves.first().map_or(0, |leaf| leaf.cell.level);
    let wanted = SplitRequest { level, budget: question.budget_secs / unit_secs, cancelled, told };
    let cells: Vec<Cell> = deep.leaves.iter().map(|leaf| leaf.cell).collect();
    let start_maps = splitting.start_maps(&cells, wanted)?;
    let (mut outcomes, mut ends, mut moving) = (Vec::new(), Vec::new(), Vec::new());
    let mut lines = may_use_lines(&job).then(|| Lines::new(splitting.dynamics, unit_secs));
    let mut depth = DepthStats::NOTHING;
    for Leaf { cell, points } in &deep.leaves {
        let before = moving.len();
        for &at in points {
            match start_maps[cell].start(&splitting.dynamics, &question, unit_secs, at) {
                MappedStart::Known(outcome, end) => {
                    outcomes.push(outcome);
                    ends.push(end);
                }
                MappedStart::Moving(state) => {
                    moving.push((outcomes.len(), state));
                    outcomes.push(Outcome::without_time(Status::Unflipped));
                    ends.push(End::NOWHERE);
                }
            }
        }
        if let StartMap::Part { ended, .. } = &start_maps[cell] {
            if let Some(lines) = lines.as_mut().filter(|_| moving.len() > before) {
                lines.add(ended, &moving[before..]);
            }
            let secs = ended.patch.time.0 * unit_secs;
            depth = depth.and(DepthStats {
                digits: splitting.digits(level),
                integrated: (moving.len() - before) as u64,
                told_by_lines: 0,
                begins_secs: if moving.len() > before {
                    [secs; 2]
                } else {
                    DepthStats::NOTHING.begins_secs
                },
                decades_a_second: ended.decades_a_second(&splitting.dynamics, secs),
            });
        }
    }
    let effort = Effort { depth: Some(depth), ..Effort::default() };
    Some(Followed { job, awaited: Awaited { outcomes, ends, moving, lines: None, effort }, lines })
}

/// Returns true if a job's starts may be told from those beside them on a line: it wants outcomes
/// alone, of a method whose errors are far below what neighbours differ by.
fn may_use_lines(job: &Job) -> bool {
    let adaptive = !matches!(job.config.method, Method::Rk4 { .. });
    adaptive && job.config.precision != Precision::F32 && job.keep != Keep::Ends
}

impl Engine for DepthEngine<'_> {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        match job.starts {
            Starts::Deep(_) => self.follow(job),
            _ => self.waiting.push_back(job),
        }
        self.feed()
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        let mut finished = Vec::new();
        loop {
            while let Ok(followed) = self.receiver.try_recv() {
                finished.extend(self.take_followed(followed));
            }
            self.feed()?;
            let idle = self.flying == 0 && self.following == 0;
            let late = matches!(wait, Wait::Until(moment) if Instant::now() >= moment);
            if !finished.is_empty() || idle || late {
                return Ok(finished);
            }
            let until = match wait {
                Wait::Until(moment) => moment,
                Wait::UntilFinished => Instant::now() + Duration::from_secs(1),
            };
            if self.flying == 0 {
                let left = until.saturating_duration_since(Instant::now());
                if let Ok(followed) = self.receiver.recv_timeout(left) {
                    finished.extend(self.take_followed(followed));
                }
                continue;
            }
            let turn = if self.following > 0 { until.min(Instant::now() + TURN) } else { until };
            for answer in self.inner.poll(Wait::Until(turn))? {
                finished.extend(self.take_finished(answer));
            }
        }
    }

    fn cancel(&mut self) {
        self.cancelled.store(true, Ordering::Relaxed);
        self.cancelled = Arc::default();
        (self.sender, self.receiver) = channel();
        self.inner.cancel();
        self.deep.clear();
        self.waiting.clear();
        (self.flying, self.following) = (0, 0);
    }

    /// One more than the wrapped engine's: one job is followed while others are integrated.
    fn slots(&self) -> usize {
        self.inner.slots() + 1
    }

    fn job_size(&self) -> usize {
        self.inner.job_size()
    }

    fn kind(&self) -> EngineKind {
        self.inner.kind()
    }

    fn adapter(&self) -> String {
        self.inner.adapter()
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.inner.offers(config)
    }
}

impl Drop for DepthEngine<'_> {
    fn drop(&mut self) {
        self.cancel();
    }
}
