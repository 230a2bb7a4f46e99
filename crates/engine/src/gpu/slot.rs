//! A slot: one job in flight on a device, its buffers, its slices, its answer.
//!
//! A job has up to a million pendulums that finish at very different times, and no dispatch may run
//! long. So a job runs in *slices* of a limited number of steps, and every slice packs the indices
//! of the pendulums that still run into a dense list for the next one (stream compaction), so that
//! workgroups stay full to the end. States stay in place; only indices move.
//!
//! ```text
//!  begin     the starts of an upright picture, from their columns and rows
//!  turn      read list 0, clear list 1 and the suspects, size the dispatch by list 0
//!  advance   0 1 2 3 4 5 6 7     at most `slice_steps` steps each
//!            ├─ 1 3 6    still running ──────────────────▶ list 1
//!            ├─ 2 5      may reach the top in next step ─▶ suspects
//!            └─ 0 4 7    over
//!  look      2 5
//!            ├─ 5        no flip ────────────────────────▶ list 1
//!            └─ 2        flipped
//!  host      reads 16 bytes: list 1 has 4 pendulums left, so another slice follows
//!  pack      after the last slice: what a picture shows of each outcome, over the lists
//! ```
//!
//! * Where there are subgroups, each reserves its places in a list by a prefix sum and one atomic.
//!   The order of a list is not determined, but no answer depends on it.
//! * The rare, long search for a flip is a kernel of its own, as in wavefront path tracing (Laine,
//!   Karras and Aila, *Megakernels considered harmful*, 2013), so the step loop needs no registers
//!   for it.
//! * The dispatch size is written on the device (indirect dispatch), so several slices can be
//!   submitted at once, and the host only learns when to stop. Its reads are asynchronous;
//!   outcomes, and states if they are kept, are read once, at the end.
//! * The job is kept whole: if the device is lost, it starts again on a fresh one.

mod answer;
mod axes;
mod buffers;
mod upload;

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use bytemuck::bytes_of;

use self::axes::Axes;
pub(super) use self::buffers::BufferPool;
use self::buffers::{Buffers, TICK_BYTES, TICKS_AT};
use super::clock::Slices;
use super::device::Gpu;
use super::packing::{Packer, Packing};
use super::pipeline::Kernel;
use crate::clock::Instant;
use crate::gpu::shared::{CountedOutcome, JobHead, PackedWork, Queue, RawOutcome, to_parts};
use crate::pace::Pace;
use crate::start::places;
use crate::{EngineError, Job, JobResult, Keep, Starts};

/// A job on the device. One submission of slices is in flight at a time; after each the host reads
/// how many pendulums still run, and after the last one the outcomes.
pub(super) struct Slot {
    /// The job, kept whole so that it can be repeated on another device.
    pub job: Job,
    /// The kernel that computes the job to its end.
    pub kernel: Arc<Kernel>,
    /// The steps over the budget.
    pub pace: Pace,
    /// Indices in a [`crate::IntegratorState`] of each number of the device's state and of its
    /// remainder.
    places: Vec<[Option<usize>; 2]>,
    /// The packing of the outcomes, if the job needs no more of them.
    packing: Option<Packing>,
    lane_steps: u64,
    head: JobHead,
    /// Number of pendulums that still run.
    running: u32,
    buffers: Buffers,
    groups: [wgpu::BindGroup; 2],
    flight: Option<Submission>,
}

/// A submission whose read-back has not finished.
struct Submission {
    submission: wgpu::SubmissionIndex,
    since: Instant,
    mapped: Arc<AtomicU8>,
    /// Number of slices; 0 for the answer.
    slices: u32,
}

/// Slices of one submission that have run.
pub(super) struct FinishedSlices {
    /// Moment of their submission.
    pub since: Instant,
    /// Seconds that they took by the device's clock, if it measures them.
    pub device_secs: Option<f64>,
    /// Number of slices.
    pub count: u32,
    /// Number of pendulums that ran at the beginning.
    pub running: u32,
    /// Upper bound on the steps of all pendulums together.
    pub pendulum_steps: f64,
}

/// The state of a slot's read-back.
pub(super) enum SlotEvent {
    /// The read-back is still in flight.
    InFlight,
    /// A submission is done, and more are needed.
    Slices(FinishedSlices),
    /// All pendulums are done, and the answer has been requested.
    Complete(FinishedSlices),
    /// The answer has been read back; an error if pendulums are missing from it.
    Answer(Result<JobResult, EngineError>),
    /// The read-back failed.
    Failed,
}

impl Slot {
    /// Creates the buffers of `job` and fills them, with every pendulum at its start.
    pub(super) fn new(
        gpu: &Gpu,
        pool: &mut BufferPool,
        kernel: Arc<Kernel>,
        job: Job,
    ) -> Result<Self, EngineError> {
        let pace = job.pace()?;
        let places = places(&kernel.design.state(), job.config.precision, job.keep.ends);
        let head = head(&job, &pace);
        let axes = Axes::of(&job, &kernel, &places);
        let begun = axes.as_ref().map(Axes::len);
        let packing = packing(&job, &kernel);
        let answer_bytes = answer_bytes(&job, packing);
        let buffers = Buffers::new(gpu, pool, &job, (places.len(), begun), answer_bytes)?;
        let slot = Slot {
            job,
            pace,
            places,
            packing,
            lane_steps: 0,
            running: head.count,
            head,
            groups: buffers.groups(gpu, &kernel),
            kernel,
            buffers,
            flight: None,
        };
        slot.write_scene(gpu);
        slot.begin(gpu, axes);
        Ok(slot)
    }

    /// Submits slices, which run one after another. Each sizes its dispatches for the pendulums
    /// that are still running.
    pub(super) fn submit_slices(&mut self, gpu: &Gpu, slices: Slices) {
        self.head.slice_steps = slices.steps;
        gpu.write(&self.buffers.job, 0, bytes_of(&self.head));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for slice in 0..slices.count {
            self.record_slice(&mut encoder, slice, slice + 1 == slices.count);
        }
        if let Some(ticks) = &self.buffers.ticks {
            encoder.resolve_query_set(&ticks.set, 0..2, &ticks.buffer, 0);
            let progress = &self.buffers.progress;
            encoder.copy_buffer_to_buffer(&ticks.buffer, 0, progress, TICKS_AT, TICK_BYTES);
        }
        self.fly(gpu, encoder, slices.count, TICKS_AT + TICK_BYTES);
    }

    fn record_slice(&self, encoder: &mut wgpu::CommandEncoder, slice: u32, is_last: bool) {
        let kernel = &self.kernel;
        let ticks = |moment, wanted: bool| {
            let ticks = self.buffers.ticks.as_ref().filter(|_| wanted);
            let timestamp_writes = ticks.map(|ticks| ticks.writes(moment));
            wgpu::ComputePassDescriptor { label: None, timestamp_writes }
        };
        {
            let mut pass = encoder.begin_compute_pass(&ticks(0, slice == 0));
            pass.set_bind_group(0, &self.groups[0], &[]);
            pass.set_bind_group(1, &self.groups[1], &[]);
            pass.set_pipeline(&kernel.turn);
            pass.dispatch_workgroups(1, 1, 1);
        }
        let mut pass = encoder.begin_compute_pass(&ticks(1, is_last));
        pass.set_bind_group(0, &self.groups[0], &[]);
        for pipeline in [&kernel.advance, &kernel.look] {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups_indirect(&self.buffers.dispatch_size, 0);
        }
        drop(pass);
        let (Buffers { queue, progress, .. }, size) = (&self.buffers, size_of::<Queue>() as u64);
        encoder.copy_buffer_to_buffer(queue, 0, progress, u64::from(slice) * size, size);
    }

    /// Requests the outcomes.
    fn submit_answer(&mut self, gpu: &Gpu, packer: &Packer) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let bytes = answer_bytes(&self.job, self.packing);
        let Buffers { job, answer, outcomes, lists, queue, states, kept, .. } = &self.buffers;
        if let Some(packing) = self.packing {
            gpu.write(queue, 0, bytes_of(&PackedWork::default()));
            let buffers = [job, outcomes, lists, queue];
            packer.record(gpu, &mut encoder, packing, self.head.count, &buffers);
            encoder.copy_buffer_to_buffer(queue, 0, answer, 0, WORK_BYTES);
            encoder.copy_buffer_to_buffer(lists, 0, answer, WORK_BYTES, bytes - WORK_BYTES);
        } else {
            encoder.copy_buffer_to_buffer(outcomes, 0, answer, 0, bytes);
            if *kept > 0 {
                encoder.copy_buffer_to_buffer(states, 0, answer, bytes, *kept);
            }
        }
        let all = bytes + kept;
        self.fly(gpu, encoder, 0, all);
    }

    /// Submits slices or, if there are none, the request for the answer, and requests the first
    /// `bytes` of the result.
    fn fly(&mut self, gpu: &Gpu, encoder: wgpu::CommandEncoder, slices: u32, bytes: u64) {
        let submission = gpu.queue.submit([encoder.finish()]);
        let mapped = Arc::new(AtomicU8::new(PENDING));
        let Buffers { answer, progress, .. } = &self.buffers;
        let buffer = if slices == 0 { answer } else { progress };
        gpu.count_download(bytes);
        buffer.map_async(wgpu::MapMode::Read, ..bytes.max(MAP_UNIT), {
            let mapped = mapped.clone();
            move |result| {
                let state = if result.is_ok() { MAPPED } else { REFUSED };
                mapped.store(state, Ordering::Release);
            }
        });
        self.flight = Some(Submission { submission, since: Instant::now(), mapped, slices });
    }

    /// Number of pendulums that still run.
    pub(super) fn running(&self) -> u32 {
        self.running
    }

    /// The submission whose read-back is in flight, if any, and the moment it was made.
    pub(super) fn submission(&self) -> Option<(Instant, &wgpu::SubmissionIndex)> {
        self.flight.as_ref().map(|flight| (flight.since, &flight.submission))
    }

    /// Leaves the buffers of an answered job to the next one.
    pub(super) fn give_buffers(self, pool: &mut BufferPool) {
        pool.give(self.buffers);
    }

    /// Takes the read-back if it has finished, and submits the request for the answer after the
    /// last slice.
    pub(super) fn land(&mut self, gpu: &Gpu, packer: &Packer) -> SlotEvent {
        let landed = |flight: &mut Submission| flight.mapped.load(Ordering::Acquire) != PENDING;
        let Some(flight) = self.flight.take_if(landed) else {
            return SlotEvent::InFlight;
        };
        if flight.mapped.load(Ordering::Acquire) == REFUSED {
            return SlotEvent::Failed;
        }
        if flight.slices == 0 {
            return self.read_answer().map_or(SlotEvent::Failed, SlotEvent::Answer);
        }
        let Some(ran) = self.read_progress(gpu, &flight) else { return SlotEvent::Failed };
        if self.running > 0 {
            return SlotEvent::Slices(ran);
        }
        self.submit_answer(gpu, packer);
        SlotEvent::Complete(ran)
    }

    /// Reads how many pendulums each slice has left; returns `None` if the device has been lost.
    fn read_progress(&mut self, gpu: &Gpu, flight: &Submission) -> Option<FinishedSlices> {
        let progress = &self.buffers.progress;
        let queues = answer::read::<Queue>(progress, 0, flight.slices as usize)?;
        let ticks = answer::read::<u64>(progress, TICKS_AT, 2)?;
        progress.unmap();
        let tick_secs = gpu.tick_secs();
        let device_secs = tick_secs.map(|secs| ticks[1].saturating_sub(ticks[0]) as f64 * secs);
        let running = self.running;
        let mut pendulum_steps = 0.0;
        for queue in &queues {
            pendulum_steps += f64::from(self.running) * f64::from(self.head.slice_steps);
            self.running = queue.lengths[1 - queue.turn as usize];
        }
        self.lane_steps += pendulum_steps as u64;
        let Submission { since, slices: count, .. } = *flight;
        Some(FinishedSlices { since, device_secs, count, running, pendulum_steps })
    }
}

fn head(job: &Job, pace: &Pace) -> JobHead {
    let [columns, rows] = match &job.starts {
        Starts::Upright(upright) => [0, 1].map(|i| upright.angles[i].len() as u32),
        _ => [0; 2],
    };
    let head = JobHead {
        count: job.starts.len() as u32,
        most_steps: pace.most_steps(),
        columns,
        rows,
        ..Default::default()
    };
    match pace {
        Pace::Fixed(steps) => {
            JobHead { step: to_parts(steps.length), budget: steps.budget() as f32, ..head }
        }
        Pace::Adaptive(adaptive) => JobHead {
            budget: adaptive.budget as f32,
            start: adaptive.control.start as f32,
            rise: adaptive.control.rise as f32,
            ceiling: adaptive.control.ceiling as f32,
            ..head
        },
    }
}

/// Size of a pendulum's outcome in bytes.
fn outcome_size(job: &Job) -> u64 {
    let size = if job.question.passes == 1 {
        size_of::<RawOutcome>()
    } else {
        size_of::<CountedOutcome>()
    };
    size as u64
}

/// Returns the packing of a job's outcomes, or `None` if the job needs more of them.
fn packing(job: &Job, kernel: &Kernel) -> Option<Packing> {
    let is_plain = job.keep == Keep::NOTHING && job.question.passes == 1;
    is_plain.then(|| Packing::of(&kernel.design))
}

/// Size in bytes of a job's answer without states: of all outcomes, or of the work and the packed
/// outcomes.
fn answer_bytes(job: &Job, packing: Option<Packing>) -> u64 {
    let count = job.starts.len() as u64;
    match packing {
        Some(packing) => WORK_BYTES + count * packing.words() as u64 * 4,
        None => count * outcome_size(job),
    }
}

/// Size in bytes of the work that is added up on the device.
const WORK_BYTES: u64 = size_of::<PackedWork>() as u64;

// Stages of a read-back.
const PENDING: u8 = 0;
const MAPPED: u8 = 1;
const REFUSED: u8 = 2;
/// Least number of bytes that can be mapped.
const MAP_UNIT: u64 = 8;
