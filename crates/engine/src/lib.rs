//! Engines: jobs of pendulum starts go in, their outcomes come out.
//!
//! An [`Engine`] knows nothing of pictures. It takes starts and an [`EventSpec`] and answers with
//! one outcome per start, in the same order, however it arranges the work to be fast. Four
//! lifetimes nest here: `Gpu` (a device, as long as the process), `Kernel` (a compiled `Design`),
//! `Slot` (the buffers of one job in flight) and the job itself, which is plain data.
//!
//! * [`adapters`] lists graphics adapters, and `gpu` runs kernels on them (feature `gpu`);
//! * [`cpu`] runs the same physics over threads and SIMD lanes;
//! * [`depth`] follows the starts of a deep zoom to the point where another engine can take over;
//! * [`background`] runs any of them on a thread of its own;
//! * [`mock`] answers at once, for tests of everything that uses engines;
//! * [`trust`] checks the answers of another engine until two methods agree;
//! * `gpu::selfcheck` decides which arithmetic of an adapter is trusted, [`profile`] measures what the
//!   configurations cost, [`choice`] selects an engine and a configuration, and [`run_settings`]
//!   turns the words of a request into settings.
//!
//! ```
//! use flipmap_engine::cpu::outcomes;
//! use flipmap_engine::EventSpec;
//! use flipmap_numbers::Dd;
//! use flipmap_pendulum::Rule;
//! use flipmap_pendulum::embedded::Dop853;
//! use flipmap_scene::PendulumSpec;
//!
//! let build = PendulumSpec::default();
//! let question = EventSpec { build, rule: Rule::Second, budget_secs: 5.0, passes: 1 };
//! let starts = [[3.0, 3.0], [0.1, 0.2]].map(|angles| angles.map(Dd::new));
//! let answers = outcomes::<Dop853>(&question, 1e-12, &starts)?;
//! assert!(answers[0].time < 5.0);
//! # Ok::<(), flipmap_engine::EngineError>(())
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]
// States, steps and verdicts have parts that only kernels read.
#![cfg_attr(not(feature = "gpu"), allow(dead_code))]

pub mod adapters;
pub mod background;
mod cells;
pub mod choice;
pub mod clock;
pub mod cpu;
pub mod depth;
mod end;
#[cfg(feature = "gpu")]
pub mod gpu;
mod integrator_state;
mod keep;
mod kind;
pub mod level;
mod method;
pub mod mock;
mod number_parts;
mod one_job;
pub mod pace;
pub mod plain_file;
pub mod profile;
pub mod run_settings;
mod slowed;
pub mod start;
mod starts;
pub mod threads;
pub mod trust;

use std::sync::mpsc::{Receiver, RecvTimeoutError};

use crate::clock::Instant;
use flipmap_numbers::{Dd, Exact, Scalar};
use flipmap_pendulum::opening::Opening;
use flipmap_pendulum::{Outcome, Pendulum, Rule, Status};
use flipmap_scene::question::Needs;
use flipmap_scene::{PendulumSpec, Scene, SceneError};
use pace::{Adaptive, Pace};

pub(crate) use adapters::GpuStats;
pub use adapters::GpuTuning;
pub use cells::Cells;
pub use depth::DepthStats;
pub use end::FinalState;
pub(crate) use integrator_state::Carried;
pub use integrator_state::{IntegratorState, NUMBERS};
pub use keep::Keep;
pub use kind::EngineKind;
pub use level::Accuracy;
pub use method::{Method, Precision};
pub use one_job::run_job;
pub use starts::{Deep, Leaf, Onset, Separable, StartList, Starts};
pub(crate) use starts::{Moving, MovingStarts};
pub use trust::{Assurance, Trust};

/// The event that a job looks for from each of its starts, and the budget of time for the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventSpec {
    /// The pendulum; gravity must pull.
    pub build: PendulumSpec,
    /// The rule that says which bob is watched.
    pub rule: Rule,
    /// Longest time in s that a start is simulated.
    pub budget_secs: f64,
    /// Number of passes of the top after which a pendulum is done; [`u32::MAX`] for no limit.
    pub passes: u32,
}

impl From<&Scene> for EventSpec {
    /// The question of a checked scene.
    fn from(scene: &Scene) -> Self {
        EventSpec {
            build: scene.build,
            rule: scene.question.watched(),
            budget_secs: scene.question.end_secs(),
            passes: scene.question.passes(),
        }
    }
}

impl EventSpec {
    /// The pendulum in reduced units, in which C = Q = 1, to the precision of the number type, and
    /// the unit of time in s.
    pub fn reduced_in<T: Scalar>(&self) -> (Pendulum<T>, T) {
        self.build.reduced_in()
    }

    /// The pendulum in reduced units and the unit of time in s, to the precision of f64.
    pub fn reduced(&self) -> (Pendulum<f64>, f64) {
        let (pendulum, unit_secs) = self.reduced_in::<Dd>();
        (pendulum.to_f64(), unit_secs.to_f64())
    }

    /// Returns the opening that finds the first moments of launches, for the passes that answers
    /// with `ends` report or count.
    pub(crate) fn opening(&self, ends: Needs) -> Opening {
        let (pendulum, unit_secs) = self.reduced_in::<Exact>();
        let bobs = match self.rule {
            Rule::Neither if ends == Needs::End => Rule::Either.watched(),
            rule => rule.watched(),
        };
        Opening::new(&pendulum, bobs, self.budget_secs / unit_secs.to_f64())
    }

    /// Returns true if turns or passes are counted along the motion.
    pub(crate) fn counts(&self) -> bool {
        self.passes != 1 || self.rule == Rule::Neither
    }

    /// The outcome of a pendulum that flips after `secs`: unflipped if that is beyond the budget.
    pub(crate) fn flipped_at(&self, secs: f64) -> Outcome {
        if secs <= self.budget_secs {
            Outcome::flipped(secs)
        } else {
            Outcome::without_time(Status::Unflipped)
        }
    }
}

/// A method with its step or tolerance, and a precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorConfig {
    /// The method with its step or tolerance.
    pub method: Method,
    /// The number type.
    pub precision: Precision,
}

/// One piece of work for an engine.
#[derive(Clone, Debug)]
pub struct Job {
    /// Identifier chosen by the submitter.
    pub id: u64,
    /// The question to answer for each start.
    pub question: EventSpec,
    /// The method and the precision.
    pub config: IntegratorConfig,
    /// The states in which the pendulums begin.
    pub starts: Starts,
    /// Selects the states to return along with the outcomes.
    pub keep: Keep,
}

impl Job {
    /// Returns the fixed steps or the step size control of the job.
    pub(crate) fn pace(&self) -> Result<Pace, EngineError> {
        let pace = Pace::new(&self.question, &self.config)?;
        let pace = match (starts::fastest(&self.question, &pace, &self.starts), pace) {
            (None, pace) => pace,
            (Some(_), Pace::Fixed(steps)) => Pace::Fixed(steps.for_launches()),
            (Some(fastest), Pace::Adaptive(adaptive)) => {
                Pace::Adaptive(adaptive.for_launches(&self.question, fastest))
            }
        };
        let (Pace::Adaptive(adaptive), Starts::Moving(moving)) = (pace, &self.starts) else {
            return Ok(pace);
        };
        if self.config.method.is_steady() {
            return Ok(pace);
        }
        // Measured on filaments 1e-3 to 1e-22 rad wide with leaves of 16 pixels (in a larger leaf,
        // neighbours differ by less), and doubled in f64 since the tolerance rises.
        let finer = if self.config.precision == Precision::F32 { 200.0 } else { 2000.0 };
        let finer = finer * f64::from(self.config.leaf_pixels()) / 16.0;
        let control = adaptive.control.after_a_cell(moving.since, moving.end, finer);
        Ok(Pace::Adaptive(Adaptive { control, ..adaptive }))
    }
}

/// The answer to a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobResult {
    /// Identifier of the job.
    pub id: u64,
    /// One outcome per start, in the order of the starts.
    pub outcomes: Vec<Outcome>,
    /// Index and state of each pendulum that has not flipped, if the job keeps states.
    pub unfinished: Vec<(usize, IntegratorState)>,
    /// The end of each pendulum, if the job keeps ends.
    pub ends: Vec<FinalState>,
    /// Assurance of each outcome; empty if nothing was checked.
    pub assurances: Vec<Assurance>,
    /// Work done for the job.
    pub effort: Effort,
}

/// Counts of work done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Statistics of following deep starts.
    pub depth: Option<DepthStats>,
    /// Right-hand sides evaluated, including those for locating flips; an expansion to order N
    /// counts as N.
    pub rhs_evaluations: u64,
    /// Steps tried, summed over all pendulums.
    pub steps: u64,
    /// Number of lane steps, counting those of idle lanes.
    pub lane_steps: u64,
}

impl std::ops::AddAssign for Effort {
    fn add_assign(&mut self, other: Effort) {
        self.rhs_evaluations += other.rhs_evaluations;
        self.steps += other.steps;
        self.lane_steps += other.lane_steps;
        self.depth = match (self.depth, other.depth) {
            (Some(a), Some(b)) => Some(a.and(b)),
            (a, b) => a.or(b),
        };
    }
}

/// Limit on the time that [`Engine::poll`] may wait for something to finish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wait {
    /// Waits until something finishes, as long as anything is in flight.
    UntilFinished,
    /// Waits until this moment at the latest.
    Until(Instant),
}

impl Wait {
    /// Returns the next message of a channel; fails once the time is up or the senders are gone.
    pub(crate) fn receive<T>(self, channel: &Receiver<T>) -> Result<T, RecvTimeoutError> {
        match self {
            Wait::UntilFinished => channel.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Wait::Until(moment) => {
                channel.recv_timeout(moment.saturating_duration_since(Instant::now()))
            }
        }
    }
}

/// Errors of an engine.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// A buffer could not be allocated.
    #[error("the device has no room for {mib} MiB more; use a smaller size or the cpu engine")]
    OutOfMemory {
        /// Size of the buffer in MiB.
        mib: u64,
    },
    /// A request exceeds the adapter's limits.
    #[error("{what} needs {needed}, but this adapter allows at most {allowed}")]
    LimitExceeded {
        /// Name of the quantity that is too large.
        what: &'static str,
        /// Size that is needed.
        needed: u64,
        /// The adapter's limit.
        allowed: u64,
    },
    /// A setting whose value cannot be used.
    #[error("{0}")]
    Setting(#[from] SceneError),
    /// The configuration is not available on this engine or adapter.
    #[error("{0}")]
    Unsupported(String),
    /// The device was lost and could not be opened again.
    #[error("the graphics device was lost and could not be recreated: {0}")]
    DeviceLost(String),
    /// A device finished a job without finishing all its pendulums.
    #[error(
        "the graphics device lost {lost} of {count} pendulums of a job; its answers cannot be \
         trusted; use the cpu engine"
    )]
    LostPendulums {
        /// Number of pendulums without an answer.
        lost: usize,
        /// Number of pendulums of the job.
        count: usize,
    },
    /// The driver refused something that it should have accepted.
    #[error("the graphics driver reported: {0}")]
    Driver(String),
}

/// An interface to anything that computes jobs. No method blocks except [`Engine::poll`] when asked
/// to wait. A mutable reference to an engine is an engine, too.
#[auto_impl::auto_impl(&mut)]
pub trait Engine {
    /// Takes a job. The caller keeps at most [`Engine::slots`] of them in flight.
    fn submit(&mut self, job: Job) -> Result<(), EngineError>;
    /// Advances the work and returns the jobs that have finished, in any order.
    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError>;
    /// Drops all jobs in flight; their answers will not arrive.
    fn cancel(&mut self);
    /// Begins another picture, which may be computed by a faster kernel that rounds differently.
    fn begin_picture(&mut self) {}
    /// Number of jobs in flight that keep the engine busy.
    fn slots(&self) -> usize;
    /// A suitable number of starts for a job.
    fn job_size(&self) -> usize;
    /// The hardware that it computes on.
    fn kind(&self) -> EngineKind;
    /// The adapter's name, or the processor's SIMD width and threads.
    fn adapter(&self) -> String;
    /// Returns true if the engine has the configuration and can be trusted with it.
    fn offers(&self, config: &IntegratorConfig) -> bool;
    /// Returns true if checks with the configuration run on this engine and not on the processor.
    fn checks_by(&self, config: &IntegratorConfig) -> bool {
        self.offers(config)
    }
    /// Returns the statistics of a graphics device, or `None` for other engines.
    fn gpu_stats(&self) -> Option<GpuStats> {
        None
    }
    /// Returns true if answers have been contradicted, so that all are to be marked, even those
    /// that are known without this engine.
    fn distrusts(&self) -> bool {
        false
    }
}
