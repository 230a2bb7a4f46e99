//! The engine that runs on an adapter of wgpu.
//!
//! A few jobs are on the device, each with at most one submission in flight: with two, one runs
//! while the other waits behind it, so the device never idles and never has more than one
//! submission queued. A submission has one slice or a few; after each the host reads how many
//! pendulums are left, asynchronously, and makes the next submission longer or shorter so that none
//! runs longer than the pace. Results do not depend on the pace.

mod adapter;
mod clock;
pub mod device;
mod judged;
pub mod kernel;
mod kernels;
mod maths;
pub mod packing;
mod pipeline;
pub mod selfcheck;
pub mod shared;
mod slot;
mod symbol;
mod waiting;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

pub use self::adapter::{Adapter, judged, open_checked};
use self::clock::StepClock;
use self::device::Gpu;
use self::kernel::Design;
pub use self::kernels::MAX_KERNELS;
use self::kernels::{CompileWhen, Kernels};
use self::packing::Packer;
use self::pipeline::Kernel;
use self::slot::{BufferPool, FinishedSlices, Slot, SlotEvent};
pub use self::waiting::Waiting;
use crate::adapters::{GpuStats, GpuTuning, Verdict};
use crate::clock::Instant;
use crate::{
    Engine, EngineError, EngineKind, IntegratorConfig, Job, JobResult, Precision, Starts, Wait,
    start,
};

/// Largest number of losses after which the device is opened again.
const MAX_LOSSES: u32 = 3;

/// The engine that computes jobs on a graphics device.
pub struct GpuEngine {
    gpu: Gpu,
    verdict: Verdict,
    /// Methods and precisions whose orbits have been checked.
    checked: Vec<(&'static str, Precision)>,
    /// Methods and precisions whose general kernels have been checked, and whether they passed.
    generals: Vec<(&'static str, Precision, bool)>,
    tuning: GpuTuning,
    kernels: Kernels,
    slots: VecDeque<Slot>,
    pool: BufferPool,
    packer: Packer,
    clock: StepClock,
    last_landing: Option<Instant>,
    losses: u32,
    stats: GpuStats,
}

impl GpuEngine {
    /// An engine on an open device whose arithmetic has been judged.
    pub fn new(gpu: Gpu, verdict: Verdict) -> Self {
        GpuEngine {
            gpu,
            verdict,
            checked: Vec::new(),
            generals: Vec::new(),
            tuning: GpuTuning::default(),
            kernels: Kernels::default(),
            slots: VecDeque::new(),
            pool: BufferPool::default(),
            packer: Packer::default(),
            clock: StepClock::default(),
            last_landing: None,
            losses: 0,
            stats: GpuStats::default(),
        }
    }

    /// Changes settings that affect only speed. Kernels are compiled again if they have to be.
    pub fn tune(&mut self, tuning: GpuTuning) {
        if tuning.workgroup != self.tuning.workgroup && self.slots.is_empty() {
            self.kernels.clear();
        }
        self.tuning = tuning;
    }

    /// Sets the longest time that a submission may run.
    pub fn set_pace(&mut self, pace: Duration) {
        self.tuning.pace = pace;
    }

    /// Sets whether kernels are made for their scene (the default) or read it as data.
    pub fn set_specialised(&mut self, specialise: bool) {
        self.tuning.general = !specialise;
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Number of kernels in memory.
    pub fn kernel_count(&self) -> usize {
        self.kernels.len()
    }

    /// Returns true if the kernel made for a job's scene is compiled.
    pub fn has_own_kernel(&mut self, job: &Job) -> Result<bool, EngineError> {
        let own = self.general(&job.config)?.specialised(&job.question, &job.pace()?);
        Ok(self.kernels.has(&own))
    }

    /// Returns the design of the kernel that takes any scene in a configuration.
    fn general(&self, config: &IntegratorConfig) -> Result<Design, EngineError> {
        let subgroups = self.tuning.subgroups && self.gpu.has_subgroups();
        let general = Design::general(config, self.verdict.compensated, subgroups)?;
        Ok(general.with_pairs(self.verdict.pairs))
    }

    /// Compiles the kernel that takes any scene in a configuration and drops it, where the driver
    /// keeps what it has compiled.
    pub fn compile_general(&self, config: &IntegratorConfig) -> Result<(), EngineError> {
        Kernel::compile(&self.gpu.device, self.general(config)?, self.tuning.workgroup);
        self.gpu.check()
    }

    fn design(&mut self, job: &Job) -> Result<Design, EngineError> {
        self.require(&job.config)?;
        job.keep.check(&job.config)?;
        let general = self.general(&job.config)?.returning(job.keep.ends)?;
        // The general kernel counts nothing, carries nothing along and knows no friction.
        let (question, ends) = (&job.question, job.keep.ends);
        let is_special = question.counts() || ends.are_carried() || question.build.has_friction();
        if (self.tuning.general || general.serves_all()) && !is_special {
            return Ok(general);
        }
        let special = general.specialised(question, &job.pace()?);
        if ends.are_carried() {
            return Ok(special.computing(ends));
        }
        if self.tuning.at_once && !is_special {
            return self.design_at_once(special, general, &job.config);
        }
        Ok(special)
    }

    /// Returns the design with which the present picture began. A new picture takes the scene's own
    /// kernel if it is compiled, or if the general kernel is wrong. Otherwise it takes the general
    /// kernel, and the scene's own kernel is compiled in the background.
    fn design_at_once(
        &mut self,
        special: Design,
        general: Design,
        config: &IntegratorConfig,
    ) -> Result<Design, EngineError> {
        let design = match self.kernels.chosen(&special) {
            Some(chosen) => chosen,
            None if self.kernels.has(&special) || !self.is_general_trusted(config)? => special,
            None => general,
        };
        self.kernels.choose(special, design);
        if design == general {
            self.kernels.wish(&self.gpu, special, self.tuning.workgroup, CompileWhen::AfterRest);
        }
        Ok(design)
    }

    /// The job's kernel; compiles it if it is new.
    fn kernel_for(&mut self, job: &Job) -> Result<Arc<Kernel>, EngineError> {
        let design = self.design(job)?;
        self.kernels.get(&self.gpu, design, self.tuning.workgroup)
    }

    fn start(&mut self, job: Job) -> Result<(), EngineError> {
        let kernel = self.kernel_for(&job)?;
        let mut slot = Slot::new(&self.gpu, &mut self.pool, kernel, job)?;
        self.submit_slices(&mut slot);
        self.slots.push_back(slot);
        self.gpu.check()
    }

    /// Submits as many steps of a slot as the pace allows.
    fn submit_slices(&self, slot: &mut Slot) {
        let (design, typical) = (&slot.kernel.design, slot.pace.typical_steps());
        let slices = self.clock.slices(&self.tuning, design, slot.running(), typical);
        slot.submit_slices(&self.gpu, slices);
    }

    /// Takes everything that has been read back and submits what follows from it.
    fn land(&mut self) -> Result<Vec<JobResult>, EngineError> {
        let mut finished = Vec::new();
        for mut slot in std::mem::take(&mut self.slots) {
            match slot.land(&self.gpu, &self.packer) {
                SlotEvent::InFlight => {}
                SlotEvent::Slices(ran) => {
                    self.measure(&slot.kernel.design, &ran);
                    self.submit_slices(&mut slot);
                }
                SlotEvent::Complete(ran) => self.measure(&slot.kernel.design, &ran),
                // The device may not have reported its loss yet, but it is of no use either way.
                SlotEvent::Failed => self.gpu.give_up(),
                SlotEvent::Answer(answer) => {
                    finished.push(answer?);
                    slot.give_buffers(&mut self.pool);
                    continue;
                }
            }
            self.slots.push_back(slot);
        }
        Ok(finished)
    }

    /// Measures the time of a step from the time of a submission: by the device's clock or, if that
    /// fails, since the submission or the end of the one before it, whichever is later.
    fn measure(&mut self, design: &Design, ran: &FinishedSlices) {
        let now = Instant::now();
        let began = self.last_landing.map_or(ran.since, |last| last.max(ran.since));
        self.last_landing = Some(now);
        let elapsed = (now - began).as_secs_f64();
        // Ignores a clock that stands still or runs away.
        let whole = (now - ran.since).as_secs_f64();
        let is_sound = |secs: &f64| *secs > 0.0 && *secs <= whole;
        let secs = ran.device_secs.filter(is_sound).unwrap_or(elapsed).max(1e-6);
        let secs_per_step = secs * f64::from(ran.running) / ran.pendulum_steps.max(1.0);
        self.clock.note(design, ran.running, secs_per_step);
        self.stats.slices += u64::from(ran.count);
        self.stats.submissions += 1;
        self.stats.gpu_secs += secs;
    }

    /// Opens the device again and restarts all unfinished jobs.
    fn recover(&mut self) -> Result<(), EngineError> {
        self.losses += 1;
        if self.losses > MAX_LOSSES {
            return Err(EngineError::DeviceLost(format!("lost {} times", self.losses)));
        }
        let jobs: Vec<Job> = self.slots.drain(..).map(|slot| slot.job).collect();
        self.kernels.clear();
        self.pool = BufferPool::default();
        self.packer = Packer::default();
        self.gpu = self.gpu.reopen()?;
        jobs.into_iter().try_for_each(|job| self.start(job))
    }

    /// Waits for the oldest submission, or until a moment; returns false if it did not wait.
    fn wait(&mut self, wait: Wait) -> bool {
        let in_flight = self.slots.iter().filter_map(Slot::submission);
        let Some((_, submission)) = in_flight.min_by_key(|(since, _)| *since) else {
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
        let begun = Instant::now();
        let _ = self.gpu.device.poll(wgpu::PollType::Wait { submission_index, timeout });
        self.stats.host_wait_secs += begun.elapsed().as_secs_f64();
        true
    }
}

impl Engine for GpuEngine {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        if let Starts::Deep(_) = job.starts {
            start::states(&job)?;
        }
        start::check_carried(&job)?;
        self.require(&job.config)?;
        self.check_orbits(&job.config)?;
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

    fn begin_picture(&mut self) {
        self.kernels.begin_picture();
    }

    fn slots(&self) -> usize {
        self.tuning.slots
    }

    fn job_size(&self) -> usize {
        let own = if device::is_software(&self.gpu.adapter) { 1 << 16 } else { 1 << 20 };
        self.tuning.job_size.unwrap_or(own)
    }

    fn kind(&self) -> EngineKind {
        EngineKind::Gpu
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.require(config).is_ok()
    }

    fn checks_by(&self, config: &IntegratorConfig) -> bool {
        self.checks()(config)
    }

    fn adapter(&self) -> String {
        device::describe(&self.gpu.adapter)
    }

    fn gpu_stats(&self) -> Option<GpuStats> {
        let [upload_bytes, download_bytes] = self.gpu.traffic();
        let compile_secs = self.kernels.compile_secs();
        Some(GpuStats { upload_bytes, download_bytes, compile_secs, ..self.stats })
    }
}
