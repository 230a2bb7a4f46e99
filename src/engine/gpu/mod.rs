//! The engine that runs on an adapter of wgpu.
//!
//! Up to [`SLOTS`] jobs are on the device, each with at most one slice submitted: while one slice
//! runs the other waits behind it, so the device never idles and never has more than one slice
//! queued. After each slice the host reads 16 bytes, asynchronously, and makes the next slice
//! longer or shorter so that none runs longer than the pace. Results do not depend on the pace.

pub mod device;
pub mod kernel;
mod maths;
pub mod pairs;
pub mod pipeline;
mod slot;

use crate::engine::EngineKind;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

use self::device::Gpu;
use self::kernel::Design;
use self::pipeline::Kernel;
use self::slot::{FinishedSlice, Slot, SlotEvent};
use super::selfcheck::{self, Check, Verdict};
use super::{Engine, EngineError, IntegratorConfig, Job, JobResult, Starts, Wait, start};

/// Largest number of jobs on the device at a time.
const SLOTS: usize = 2;
/// Longest time that a slice may run when no window is open; drivers reset at 2 s.
pub const HEADLESS_PACE: Duration = Duration::from_millis(50);
/// Number of steps of the first slice, before anything has been measured.
const FIRST_SLICE_STEPS: u32 = 8;
/// Least number of slices that a full budget is cut into, so that running pendulums are packed
/// often enough.
const LEAST_SLICES: u32 = 24;
/// Largest number of losses after which the device is opened again.
const MOST_LOSSES: u32 = 3;

/// The engine that computes jobs on a graphics device.
pub struct GpuEngine {
    gpu: Gpu,
    verdict: Verdict,
    specialise: bool,
    kernels: Vec<Kernel>,
    slots: VecDeque<Slot>,
    pace: Duration,
    /// Seconds that a step of one pendulum takes, measured on the last slice.
    step_secs: Option<f64>,
    last_landing: Option<Instant>,
    losses: u32,
}

impl GpuEngine {
    /// An engine on an open device whose arithmetic has been judged.
    pub fn new(gpu: Gpu, verdict: Verdict) -> Self {
        GpuEngine {
            gpu,
            verdict,
            specialise: true,
            kernels: Vec::new(),
            slots: VecDeque::new(),
            pace: HEADLESS_PACE,
            step_secs: None,
            last_landing: None,
            losses: 0,
        }
    }

    /// Sets the longest time that a slice may run.
    pub fn set_pace(&mut self, pace: Duration) {
        self.pace = pace;
    }

    /// Sets whether kernels are made for their scene (the default) or read it as data.
    pub fn set_specialised(&mut self, specialise: bool) {
        self.specialise = specialise;
    }

    /// The arithmetic that the device is trusted with.
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Returns true if there are kernels for the method in the precision, on any adapter.
    pub fn has(config: &IntegratorConfig) -> bool {
        Design::general(config, false, false).is_ok()
    }

    /// Refuses a configuration that the kernels do not have or the device is not trusted with.
    pub fn require(&self, config: &IntegratorConfig) -> Result<(), EngineError> {
        Design::general(config, false, false)?;
        self.verdict.require(config.precision).map_err(EngineError::Unsupported)
    }

    /// Takes more checks into account.
    pub fn judge_by(&mut self, checks: Vec<Check>) {
        let Verdict { checks: mut all, pairs, .. } = std::mem::take(&mut self.verdict);
        all.extend(checks);
        self.verdict = Verdict { pairs, ..selfcheck::verdict(all) };
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    fn design(&self, job: &Job) -> Result<Design, EngineError> {
        self.require(&job.config)?;
        job.keep.check(&job.config)?;
        let general =
            Design::general(&job.config, self.verdict.compensated, self.gpu.has_subgroups())?
                .with_pairs(self.verdict.pairs);
        // The general kernel counts nothing, carries nothing along and knows no friction.
        let (question, ends) = (&job.question, job.keep.ends);
        let is_special = question.counts() || ends.are_carried() || question.build.has_friction();
        if !self.specialise && !is_special {
            return Ok(general);
        }
        let special = general.specialised(question, &job.pace()?);
        Ok(if ends.are_carried() { special.computing(ends) } else { special })
    }

    /// Index of the job's kernel in the list; compiles it if it is new.
    fn kernel_for(&mut self, job: &Job) -> Result<usize, EngineError> {
        let design = self.design(job)?;
        if let Some(index) = self.kernels.iter().position(|kernel| kernel.design == design) {
            return Ok(index);
        }
        self.kernels.push(Kernel::new(&self.gpu, design)?);
        Ok(self.kernels.len() - 1)
    }

    fn start(&mut self, job: Job) -> Result<(), EngineError> {
        let index = self.kernel_for(&job)?;
        let kernel = &self.kernels[index];
        let mut slot = Slot::new(&self.gpu, kernel, index, job)?;
        slot.submit_slice(&self.gpu, kernel, self.slice_steps(&slot));
        self.slots.push_back(slot);
        self.gpu.check()
    }

    /// Takes everything that has been read back and submits what follows from it.
    fn land(&mut self) -> Result<Vec<JobResult>, EngineError> {
        let mut finished = Vec::new();
        for mut slot in std::mem::take(&mut self.slots) {
            match slot.land(&self.gpu) {
                SlotEvent::InFlight => {}
                SlotEvent::Slice(ran) => {
                    self.measure(&ran);
                    let steps = self.slice_steps(&slot);
                    slot.submit_slice(&self.gpu, &self.kernels[slot.kernel], steps);
                }
                SlotEvent::Complete(ran) => self.measure(&ran),
                // The device may not have reported its loss yet; it is of no use either way.
                SlotEvent::Failed => self.gpu.give_up(),
                SlotEvent::Answer(answer) => {
                    finished.push(answer?);
                    continue;
                }
            }
            self.slots.push_back(slot);
        }
        Ok(finished)
    }

    /// Measures the time of a step by that of a slice: since its submission, or since the slice
    /// before it ended.
    fn measure(&mut self, ran: &FinishedSlice) {
        let now = Instant::now();
        let began = self.last_landing.map_or(ran.since, |last| last.max(ran.since));
        self.last_landing = Some(now);
        self.step_secs = Some((now - began).as_secs_f64().max(1e-6) / ran.pendulum_steps);
    }

    /// Number of steps that a slot's next slice may take to keep the pace.
    fn slice_steps(&self, slot: &Slot) -> u32 {
        let Some(step_secs) = self.step_secs else {
            return FIRST_SLICE_STEPS;
        };
        let most = (slot.pace.typical_steps() / f64::from(LEAST_SLICES)).max(1.0);
        let wanted = self.pace.as_secs_f64() / (step_secs * f64::from(slot.running()));
        wanted.clamp(1.0, most) as u32
    }

    /// Opens the device again and restarts all unfinished jobs.
    fn recover(&mut self) -> Result<(), EngineError> {
        self.losses += 1;
        if self.losses > MOST_LOSSES {
            return Err(EngineError::DeviceLost(format!("lost {} times", self.losses)));
        }
        let jobs: Vec<Job> = self.slots.drain(..).map(|slot| slot.job).collect();
        self.kernels.clear();
        self.gpu = self.gpu.reopen()?;
        jobs.into_iter().try_for_each(|job| self.start(job))
    }

    /// Waits for the oldest submission, or until a moment; returns false if it did not wait.
    fn wait(&self, wait: Wait) -> bool {
        let Some(submission) = self.slots.iter().find_map(Slot::submission) else {
            return false;
        };
        let timeout = match wait {
            Wait::UntilFinished => None,
            Wait::Until(moment) => match moment.checked_duration_since(Instant::now()) {
                Some(left) if !left.is_zero() => Some(left),
                _ => return false,
            },
        };
        // A time-out is no error, and the caller notices a lost device.
        let submission_index = Some(submission.clone());
        let _ = self.gpu.device.poll(wgpu::PollType::Wait { submission_index, timeout });
        true
    }
}

impl Engine for GpuEngine {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        if let Starts::Deep(_) = job.starts {
            start::states(&job)?;
        }
        start::check_carried(&job)?;
        self.start(job)
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        loop {
            let _ = self.gpu.device.poll(wgpu::PollType::Poll);
            let finished = self.land()?;
            if self.gpu.is_lost() {
                self.recover()?;
            }
            self.gpu.check()?;
            if !finished.is_empty() || !self.wait(wait) {
                return Ok(finished);
            }
        }
    }

    fn cancel(&mut self) {
        self.slots.clear();
    }

    fn slots(&self) -> usize {
        SLOTS
    }

    fn job_size(&self) -> usize {
        if device::is_software(&self.gpu.adapter) { 1 << 16 } else { 1 << 20 }
    }

    fn kind(&self) -> EngineKind {
        EngineKind::Gpu
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.require(config).is_ok()
    }

    fn adapter(&self) -> String {
        device::describe(&self.gpu.adapter)
    }
}
