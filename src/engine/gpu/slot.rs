//! A slot: one job in flight on a device, its buffers, its slices, its answer.
//!
//! A job has up to a million pendulums that finish at very different times, and no dispatch may run
//! long. So a job runs in *slices* of a limited number of steps, and every slice packs the indices
//! of the pendulums that still run into a dense list for the next one (stream compaction), so that
//! workgroups stay full to the end. States stay in place; only indices move.
//!
//! ```text
//!  turn      read list 0, clear list 1 and the suspects, size the dispatch by list 0
//!  advance   0 1 2 3 4 5 6 7     at most `slice_steps` steps each
//!            ├─ 1 3 6    still running ──────────────────▶ list 1
//!            ├─ 2 5      may reach the top in next step ─▶ suspects
//!            └─ 0 4 7    over
//!  look      2 5
//!            ├─ 5        no flip ────────────────────────▶ list 1
//!            └─ 2        flipped
//!  host      reads 16 bytes: list 1 has 4 pendulums left, so another slice follows
//! ```
//!
//! * Where there are subgroups, each reserves its places in a list by a prefix sum and one atomic.
//!   The order of a list is not determined, but no answer depends on it.
//! * The rare, long search for a flip is a kernel of its own, as in wavefront path tracing (Laine,
//!   Karras and Aila, *Megakernels considered harmful*, 2013), so the step loop needs no registers
//!   for it.
//! * The dispatch size is written on the device (indirect dispatch), so the host only learns when
//!   to stop. Its reads are asynchronous; outcomes, and states if they are kept, come once, at the
//!   end.
//! * The job is kept whole: if the device is lost, it starts again on a fresh one.

mod answer;

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Instant;

use bytemuck::{bytes_of, cast_slice};
use wgpu::BufferUsages as Usage;

use super::device::Gpu;
use super::pipeline::Kernel;
use crate::engine::method::Pace;
use crate::engine::shared::{
    CountedOutcome, JobHead, JobScene, Queue, RUNNING, RawOutcome, to_parts,
};
use crate::engine::start::{self, places};
use crate::engine::{EngineError, IntegratorState, Job, JobResult, Keep, Precision, Starts};
use crate::physics::crossing::FAR;

/// A job on the device. Slices are submitted one at a time; after each the host reads how many
/// pendulums still run, and after the last one the outcomes.
pub(super) struct Slot {
    /// The job, kept whole so that it can be repeated on another device.
    pub job: Job,
    /// Index of the kernel in the engine's list.
    pub kernel: usize,
    /// The steps over the budget.
    pub pace: Pace,
    /// Indices in an [`IntegratorState`] of each number of the device's state and of its remainder.
    places: Vec<[Option<usize>; 2]>,
    lane_steps: u64,
    head: JobHead,
    /// Number of pendulums that still run.
    running: u32,
    buffers: Buffers,
    groups: [wgpu::BindGroup; 2],
    flight: Option<Submission>,
}

struct Buffers {
    job: wgpu::Buffer,
    states: wgpu::Buffer,
    outcomes: wgpu::Buffer,
    lists: wgpu::Buffer,
    queue: wgpu::Buffer,
    dispatch_size: wgpu::Buffer,
    /// The queue, read back after each slice.
    progress: wgpu::Buffer,
    /// The outcomes, then the states if they are kept, read back at the end.
    answer: wgpu::Buffer,
}

/// A submission whose read-back has not finished.
struct Submission {
    submission: wgpu::SubmissionIndex,
    since: Instant,
    mapped: Arc<AtomicU8>,
    answer: bool,
}

/// A slice that has run.
pub(super) struct FinishedSlice {
    /// Moment of its submission.
    pub since: Instant,
    /// Upper bound on the steps of all its pendulums together.
    pub pendulum_steps: f64,
}

/// Result of looking for a slot's read-back.
pub(super) enum SlotEvent {
    /// The read-back is still in flight.
    InFlight,
    /// A slice is done, and more are needed.
    Slice(FinishedSlice),
    /// All pendulums are done, and the answer has been requested.
    Complete(FinishedSlice),
    /// The answer has been read back; an error if pendulums are missing from it.
    Answer(Result<JobResult, EngineError>),
    /// The read-back failed.
    Failed,
}

impl Slot {
    /// Creates the buffers of `job` and fills them, with every pendulum at its start.
    pub(super) fn new(
        gpu: &Gpu,
        kernel: &Kernel,
        index: usize,
        job: Job,
    ) -> Result<Self, EngineError> {
        let pace = job.pace()?;
        let places = places(&kernel.design.state(), job.config.precision, job.keep.ends);
        let head = head(&job, &pace);
        let (buffers, groups) = make_buffers(gpu, kernel, &job, places.len())?;
        let slot = Slot {
            job,
            kernel: index,
            pace,
            places,
            lane_steps: 0,
            running: head.count,
            head,
            buffers,
            groups,
            flight: None,
        };
        slot.write_scene(gpu);
        slot.begin(gpu);
        Ok(slot)
    }

    fn write_scene(&self, gpu: &Gpu) {
        let (pendulum, _) = self.job.question.reduced();
        let scene = JobScene {
            watched: self.job.question.rule.watched().iter().map(|bob| 1 << bob).sum(),
            padding: 0,
            a: to_parts(pendulum.a),
            b: to_parts(pendulum.b),
            p: to_parts(pendulum.p),
            least_det: to_parts(pendulum.least_det),
            inverse_scale: pendulum.momentum_scale().map(|scale| (1.0 / scale) as f32),
        };
        let size = size_of::<JobHead>() as u64;
        gpu.queue.write_buffer(&self.buffers.job, 0, bytes_of(&self.head));
        gpu.queue.write_buffer(&self.buffers.job, size, bytes_of(&scene));
    }

    /// Puts every pendulum at its start; the first slice reads list 0.
    fn begin(&self, gpu: &Gpu) {
        let queue = Queue { turn: 1, lengths: [self.head.count, 0, 0] };
        gpu.queue.write_buffer(&self.buffers.queue, 0, bytes_of(&queue));
        let list: Vec<u32> = (0..self.head.count).collect();
        gpu.queue.write_buffer(&self.buffers.lists, 0, cast_slice(&list));
        match &self.job.starts {
            Starts::Resumed { states: paused, .. } => self.write_states(gpu, paused),
            // Starts that cannot be begun have been refused on submission.
            _ => self.write_states(gpu, &start::states(&self.job).unwrap_or_default()),
        }
    }

    fn write_states(&self, gpu: &Gpu, paused: &[IntegratorState]) {
        let part =
            |place: Option<usize>, p: &IntegratorState| place.map_or(0.0, |place| p.number(place));
        let mut bytes: Vec<u8> = Vec::with_capacity(self.buffers.states.size() as usize);
        for &[high, low] in &self.places {
            for p in paused {
                match self.job.config.precision {
                    Precision::F32 => bytes.extend((part(high, p) as f32).to_le_bytes()),
                    Precision::Df32 => {
                        let parts = two_floats(part(high, p), part(low, p));
                        bytes.extend(parts.into_iter().flat_map(f32::to_le_bytes));
                    }
                    _ => bytes.extend(part(high, p).to_le_bytes()),
                }
            }
        }
        gpu.queue.write_buffer(&self.buffers.states, 0, &bytes);
        let begun = |p: &IntegratorState| {
            let [first, second] = p.counts().turns;
            let turns = (first as u32 & 0xffff) | ((second as u32) << 16);
            RawOutcome { steps: p.steps, turns, ..UNBEGUN }
        };
        if self.job.question.passes == 1 {
            let outcomes: Vec<RawOutcome> = paused.iter().map(begun).collect();
            gpu.queue.write_buffer(&self.buffers.outcomes, 0, cast_slice(&outcomes));
        } else {
            let counted = |p| CountedOutcome { raw: begun(p), passes: p.counts().passes };
            let outcomes: Vec<CountedOutcome> = paused.iter().map(counted).collect();
            gpu.queue.write_buffer(&self.buffers.outcomes, 0, cast_slice(&outcomes));
        }
    }

    /// Submits a slice of at most `slice_steps` steps per pendulum.
    pub(super) fn submit_slice(&mut self, gpu: &Gpu, kernel: &Kernel, slice_steps: u32) {
        self.head.slice_steps = slice_steps;
        gpu.queue.write_buffer(&self.buffers.job, 0, bytes_of(&self.head));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_bind_group(0, &self.groups[0], &[]);
            pass.set_bind_group(1, &self.groups[1], &[]);
            pass.set_pipeline(&kernel.turn);
            pass.dispatch_workgroups(1, 1, 1);
        }
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_bind_group(0, &self.groups[0], &[]);
        for pipeline in [&kernel.advance, &kernel.look] {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups_indirect(&self.buffers.dispatch_size, 0);
        }
        drop(pass);
        let size = size_of::<Queue>() as u64;
        encoder.copy_buffer_to_buffer(&self.buffers.queue, 0, &self.buffers.progress, 0, size);
        self.fly(gpu, encoder, false);
    }

    /// Requests the outcomes.
    pub(super) fn submit_answer(&mut self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let outcomes = self.outcome_bytes();
        let Buffers { answer, states, .. } = &self.buffers;
        encoder.copy_buffer_to_buffer(&self.buffers.outcomes, 0, answer, 0, outcomes);
        let kept = answer.size() - outcomes;
        if self.job.keep != Keep::NOTHING {
            encoder.copy_buffer_to_buffer(states, 0, answer, outcomes, kept);
        }
        self.fly(gpu, encoder, true);
    }

    fn outcome_bytes(&self) -> u64 {
        u64::from(self.head.count) * outcome_size(&self.job)
    }

    fn fly(&mut self, gpu: &Gpu, encoder: wgpu::CommandEncoder, answer: bool) {
        let submission = gpu.queue.submit([encoder.finish()]);
        let mapped = Arc::new(AtomicU8::new(PENDING));
        let buffer = if answer { &self.buffers.answer } else { &self.buffers.progress };
        buffer.map_async(wgpu::MapMode::Read, .., {
            let mapped = mapped.clone();
            move |result| {
                let state = if result.is_ok() { MAPPED } else { REFUSED };
                mapped.store(state, Ordering::Release);
            }
        });
        self.flight = Some(Submission { submission, since: Instant::now(), mapped, answer });
    }

    /// Number of pendulums that still run.
    pub(super) fn running(&self) -> u32 {
        self.running
    }

    /// The submission whose read-back is in flight, if any.
    pub(super) fn submission(&self) -> Option<&wgpu::SubmissionIndex> {
        self.flight.as_ref().map(|flight| &flight.submission)
    }

    /// Takes the read-back if it has finished, and submits the request for the answer after the
    /// last slice.
    pub(super) fn land(&mut self, gpu: &Gpu) -> SlotEvent {
        let landed = |flight: &mut Submission| flight.mapped.load(Ordering::Acquire) != PENDING;
        let Some(flight) = self.flight.take_if(landed) else {
            return SlotEvent::InFlight;
        };
        if flight.mapped.load(Ordering::Acquire) == REFUSED {
            return SlotEvent::Failed;
        }
        if flight.answer {
            return self.read_answer().map_or(SlotEvent::Failed, SlotEvent::Answer);
        }
        let Some(queue) = answer::read::<Queue>(&self.buffers.progress, 0, 1)
            .and_then(|read| read.first().copied())
        else {
            return SlotEvent::Failed;
        };
        self.buffers.progress.unmap();
        let pendulum_steps = f64::from(self.running) * f64::from(self.head.slice_steps);
        self.lane_steps += pendulum_steps as u64;
        let ran = FinishedSlice { since: flight.since, pendulum_steps };
        self.running = queue.lengths[1 - queue.turn as usize];
        if self.running > 0 {
            return SlotEvent::Slice(ran);
        }
        self.submit_answer(gpu);
        SlotEvent::Complete(ran)
    }
}

/// A number and its remainder, where it has one of its own, as two f32.
fn two_floats(value: f64, remainder: f64) -> [f32; 2] {
    let high = value as f32;
    let below = if high.is_finite() { value - f64::from(high) } else { 0.0 };
    [high, (below + remainder) as f32]
}

fn head(job: &Job, pace: &Pace) -> JobHead {
    let head = JobHead {
        count: job.starts.len() as u32,
        most_steps: pace.most_steps(),
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

/// The outcome of a pendulum that has not begun.
const UNBEGUN: RawOutcome =
    RawOutcome { status: RUNNING, steps: 0, moment: [0.0; 2], clearance: FAR as f32, turns: 0 };

// Stages of a read-back.
const PENDING: u8 = 0;
const MAPPED: u8 = 1;
const REFUSED: u8 = 2;

fn make_buffers(
    gpu: &Gpu,
    kernel: &Kernel,
    job: &Job,
    state_len: usize,
) -> Result<(Buffers, [wgpu::BindGroup; 2]), EngineError> {
    let count = job.starts.len() as u64;
    let number = if job.config.precision == Precision::F32 { 4 } else { 8 };
    let state_bytes = count * number * state_len as u64;
    let outcome_bytes = count * outcome_size(job);
    let storage = Usage::STORAGE | Usage::COPY_DST;
    let both = storage | Usage::COPY_SRC;
    let back = Usage::MAP_READ | Usage::COPY_DST;
    let kept = if job.keep == Keep::NOTHING { 0 } else { state_bytes };
    let head = (size_of::<JobHead>() + size_of::<JobScene>()) as u64;
    let buffers = Buffers {
        job: gpu.buffer("a job's head", head, storage)?,
        states: gpu.buffer("a job's states", state_bytes, both)?,
        outcomes: gpu.buffer("a job's outcomes", outcome_bytes, both)?,
        lists: gpu.buffer("a job's lists", count * 12, storage)?,
        queue: gpu.buffer("a job's queue", size_of::<Queue>() as u64, both)?,
        dispatch_size: gpu.buffer("a job's dispatch", 16, Usage::STORAGE | Usage::INDIRECT)?,
        progress: gpu.buffer("a job's progress", size_of::<Queue>() as u64, back)?,
        answer: gpu.buffer("a job's answer", outcome_bytes + kept, back)?,
    };
    let Buffers { job, states, outcomes, lists, queue, .. } = &buffers;
    let groups = [
        kernel.bind(gpu, 0, &[job, states, outcomes, lists, queue]),
        kernel.bind(gpu, 1, &[&buffers.dispatch_size]),
    ];
    Ok((buffers, groups))
}
