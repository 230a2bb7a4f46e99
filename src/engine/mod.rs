//! What computes: a job of pendulum starts goes in, their outcomes come out.
//!
//! An [`Engine`] knows no picture. It is given starts and a [`Question`] and answers with one
//! outcome a start, in the same order, whatever it did to be fast. Four lifetimes nest here:
//! `Gpu` (a device, as long as the process), `Kernel` (a compiled [`Recipe`]), `Slot` (the
//! buffers of one job in flight) and the job itself, which is plain data.
//!
//! * [`gpu`] runs kernels on any adapter that wgpu finds;
//! * [`cpu`] runs the same physics over threads and SIMD lanes;
//! * [`depth`] follows the starts of a deep zoom to where another engine can take over;
//! * [`background`] is any of them on a thread of its own;
//! * [`mock`] answers at once, for tests of everything above;
//! * [`trust`] checks the answers of another engine until two methods agree;
//! * [`selfcheck`] decides which arithmetic of an adapter is believed, [`profile`] what its
//!   configs cost, [`choice`] which engine runs which of them, [`words`] what a person asked for.

pub mod background;
pub mod choice;
pub mod cpu;
pub mod depth;
pub mod gpu;
pub mod level;
pub mod method;
pub mod mock;
pub mod profile;
pub mod run_settings;
pub mod selfcheck;
pub mod shared;
pub mod start;
pub mod symbol;
pub mod trust;

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::physics::crossing;
use crate::physics::phase::Phase;
use crate::physics::{Dd, Outcome, Pendulum, Rule, Scalar, Status};
use crate::scene::lattice::Cell;
use crate::scene::{Build, Scene};
pub use depth::DepthStats;
pub use level::Accuracy;
use method::Pace;
pub use method::{Method, Precision};
pub use trust::Trust;

/// What is asked about every start of a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question {
    /// The pendulum; gravity must pull.
    pub build: Build,
    /// Which bob is watched.
    pub rule: Rule,
    /// Simulated seconds a start may use.
    pub budget_secs: f64,
}

impl From<&Scene> for Question {
    /// What a checked scene asks.
    fn from(scene: &Scene) -> Self {
        Question {
            build: scene.build,
            rule: scene.question.rule,
            budget_secs: scene.question.budget.secs,
        }
    }
}

impl Question {
    /// The pendulum in units that make C = Q = 1, to the precision of the number type, and the
    /// unit of time, s.
    pub fn reduced_in<T: Scalar>(&self) -> (Pendulum<T>, T) {
        self.build.reduced_in()
    }

    /// The same, to the precision of f64.
    pub fn reduced(&self) -> (Pendulum<f64>, f64) {
        let (pendulum, unit_secs) = self.reduced_in::<Dd>();
        (pendulum.to_f64(), unit_secs.to_f64())
    }

    /// The outcome of a pendulum that flips after `secs`: unflipped if that is too late.
    pub fn flipped_at(&self, secs: f64) -> Outcome {
        if secs <= self.budget_secs {
            Outcome::flipped(secs)
        } else {
            Outcome::without_time(Status::Unflipped)
        }
    }
}

/// How it is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorConfig {
    /// The method with its step.
    pub method: Method,
    /// The number type.
    pub precision: Precision,
}

/// Where the pendulums of a job begin.
#[derive(Clone, Debug, PartialEq)]
pub enum Starts {
    /// Let go at rest at these angles (rad), each within (−π, π].
    Rest(Vec<[Dd; 2]>),
    /// Continued from where an earlier job of the same question and config paused them.
    Resumed(Vec<IntegratorState>),
    /// On their way already: what became of those of [`Starts::Deep`] in the meantime.
    Moving(Vec<Moving>),
    /// Let go at rest at places too close together for any number type of an engine's; only
    /// [`depth::DepthEngine`] takes them.
    Deep(Deep),
}

/// Starts by the leaves of the lattice in which they lie.
#[derive(Clone, Debug, PartialEq)]
pub struct Deep {
    /// All of one level.
    pub leaves: Vec<Leaf>,
    /// Whether they are followed with other cuts than usual and smaller errors, to check.
    pub strict: bool,
}

/// Starts in one cell of the lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Which.
    pub cell: Cell,
    /// Where in it, in [−1, 1]²: θ1 to the right, θ2 up.
    pub points: Vec<[f64; 2]>,
}

/// A pendulum on its way, in reduced units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Since the release, and what rounding took from it.
    pub time: [f64; 2],
    /// Unit vectors and momenta.
    pub phase: Phase<f64>,
    /// A step that is not too long.
    pub step: f64,
    /// See [`End::clearance`].
    pub clearance: f64,
    /// See [`End::grown`].
    pub grown: f64,
}

impl Starts {
    /// How many pendulums.
    pub fn len(&self) -> usize {
        match self {
            Starts::Rest(angles) => angles.len(),
            Starts::Resumed(states) => states.len(),
            Starts::Moving(states) => states.len(),
            Starts::Deep(deep) => deep.leaves.iter().map(|leaf| leaf.points.len()).sum(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Numbers that a pendulum's state takes at most, see [`start`].
pub const NUMBERS: usize = 15;

/// An unfinished pendulum between two jobs, exactly as the kernel left it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct IntegratorState {
    /// Steps done; of adaptive methods those tried.
    pub steps: u32,
    /// The state in the kernel's units and in the order that [`start`] gives; exact for every
    /// precision.
    pub numbers: [f64; NUMBERS],
}

/// One piece of work.
#[derive(Clone, Debug)]
pub struct Job {
    /// The submitter's own name for it.
    pub id: u64,
    /// What is asked.
    pub question: Question,
    /// How it is computed.
    pub config: IntegratorConfig,
    /// The pendulums.
    pub starts: Starts,
    /// What to hand back beside the outcomes.
    pub keep: Keep,
}

/// What a job hands back of its pendulums' states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// Nothing.
    #[default]
    Nothing,
    /// Those of pendulums unflipped at the end of the budget, so that they can be continued.
    Unfinished,
    /// Where each of them ended, so that answers can be compared.
    Ends,
}

/// Where a pendulum's integration ended: at its flip, or at the end of the budget; reduced units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Since the release.
    pub time: f64,
    /// Unit vectors and momenta.
    pub phase: Phase<f64>,
    /// How near a watched bob came to the top before, and turned round: at least this far from it
    /// (as a sine). Methods that cannot say have [`passage::FAR`].
    pub clearance: f64,
    /// How many times farther apart neighbours were when its own integration began than when they
    /// were let go: 1 where that was at rest, infinite where all was known without one.
    pub grown: f64,
}

impl End {
    /// Of a pendulum that has not been anywhere.
    pub const NOWHERE: End =
        End { time: 0.0, phase: [0.0; 6], clearance: crossing::FAR, grown: 1.0 };
}

impl Job {
    /// How long its steps are.
    pub fn pace(&self) -> Result<Pace, EngineError> {
        let pace = Pace::new(&self.question, &self.config)?;
        Ok(match (pace, self.config.method, &self.starts) {
            // These keep their one tolerance.
            (_, Method::Taylor { .. } | Method::Extrapolation { .. }, _) => pace,
            (Pace::Adaptive(adaptive), _, Starts::Moving(_)) => {
                // Measured on filaments 1e-3 to 1e-22 rad wide.
                let finer = if self.config.precision == Precision::F32 { 200.0 } else { 1000.0 };
                let control = adaptive.control.after_a_cell(finer);
                Pace::Adaptive(method::Adaptive { control, ..adaptive })
            }
            _ => pace,
        })
    }
}

/// The answer to a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobResult {
    /// The job's name.
    pub id: u64,
    /// One for each start, in the order of the starts.
    pub outcomes: Vec<Outcome>,
    /// For each start still unflipped, its index and state, if they were to be kept.
    pub unfinished: Vec<(usize, IntegratorState)>,
    /// Where each start ended, if that was to be kept.
    pub ends: Vec<End>,
    /// How sure each outcome is; empty where nobody looked.
    pub trusts: Vec<Trust>,
    /// What it took.
    pub effort: Effort,
}

/// Work done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// What following deep starts has shown.
    pub depth: Option<DepthStats>,
    /// Right-hand sides evaluated, those for locating flips included; an expansion to order N
    /// counts as N.
    pub rhs_evaluations: u64,
    /// Steps tried, of all pendulums.
    pub steps: u64,
    /// Steps that the lanes had room for while these were done.
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

/// How long [`Engine::poll`] may wait for something to finish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wait {
    /// As long as anything is in flight.
    UntilFinished,
    /// Not past this moment.
    Until(Instant),
}

/// What goes wrong inside an engine.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// A buffer could not be had.
    #[error("the device has no room for {mib} MiB more; use a smaller --size, or --engine cpu")]
    OutOfMemory {
        /// What was asked for.
        mib: u64,
    },
    /// More than the adapter's limits allow.
    #[error("{what} needs {needed}, but this adapter allows at most {allowed}")]
    LimitExceeded {
        /// What was too large.
        what: &'static str,
        /// How much of it.
        needed: u64,
        /// The adapter's limit.
        allowed: u64,
    },
    /// The config is not for this engine or adapter.
    #[error("{0}")]
    Unsupported(String),
    /// The device is gone and could not be had again.
    #[error("the graphics device was lost and could not be recreated: {0}")]
    DeviceLost(String),
    /// The driver refused something it should not have.
    #[error("the graphics driver reported: {0}")]
    Driver(String),
}

/// Something that computes jobs. Nothing here blocks but [`Engine::poll`] when told to wait.
pub trait Engine {
    /// Takes a job. The caller keeps at most [`Engine::slots`] of them in flight.
    fn submit(&mut self, job: Job) -> Result<(), EngineError>;
    /// Moves the work on and returns what has finished, in any order.
    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError>;
    /// Forgets all jobs in flight; their answers will not come.
    fn cancel(&mut self);
    /// How many jobs in flight keep the engine busy.
    fn slots(&self) -> usize;
    /// How many starts make a good job.
    fn job_size(&self) -> usize;
    /// `gpu`, `cpu` or `mock`.
    fn name(&self) -> &'static str;
    /// The adapter's name, or the processor's SIMD width and threads.
    fn adapter(&self) -> String;
    /// Whether it has the config and can be trusted with it.
    fn offers(&self, config: &IntegratorConfig) -> bool;
}

/// An engine lent out.
impl<E: Engine + ?Sized> Engine for &mut E {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        (**self).submit(job)
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        (**self).poll(wait)
    }

    fn cancel(&mut self) {
        (**self).cancel();
    }

    fn slots(&self) -> usize {
        (**self).slots()
    }

    fn job_size(&self) -> usize {
        (**self).job_size()
    }

    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn adapter(&self) -> String {
        (**self).adapter()
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        (**self).offers(config)
    }
}
