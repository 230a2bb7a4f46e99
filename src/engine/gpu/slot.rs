//! One job in flight on a device: its buffers, its slices, its answer.

mod answer;

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Instant;

use bytemuck::{bytes_of, cast_slice};
use wgpu::BufferUsages as Usage;

use super::device::Gpu;
use super::pipeline::Kernel;
use crate::engine::method::Pace;
use crate::engine::shared::{JobHead, JobScene, Queue, RawOutcome, to_parts};
use crate::engine::start::{self, places};
use crate::engine::{EngineError, IntegratorState, Job, JobResult, Keep, Precision, Starts};
use crate::physics::crossing::FAR;

/// A job on the device. Slices are submitted one at a time; each leaves behind how many
/// pendulums still run, and the last one is followed by the outcomes.
pub struct Slot {
    /// The job, kept whole so that it can be done again on another device.
    pub job: Job,
    /// The kernel's place in the engine's list.
    pub kernel: usize,
    /// Its steps over the budget.
    pub pace: Pace,
    /// Where each number of the device's state is in a [`Paused`] one, and its rest.
    places: Vec<[Option<usize>; 2]>,
    lane_steps: u64,
    head: JobHead,
    /// Pendulums that still run.
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
    /// Read back after each slice: the queue.
    progress: wgpu::Buffer,
    /// Read back at the end: outcomes, then states if they are kept.
    answer: wgpu::Buffer,
}

/// A submission whose read-back has not come yet.
struct Submission {
    submission: wgpu::SubmissionIndex,
    since: Instant,
    mapped: Arc<AtomicU8>,
    answer: bool,
}

/// A slice that has run.
pub struct FinishedSlice {
    /// When it was submitted.
    pub since: Instant,
    /// Steps of all its pendulums together, at most.
    pub pendulum_steps: f64,
}

/// What a slot has come to.
pub enum SlotEvent {
    /// Nothing new.
    InFlight,
    /// A slice is done; more are needed.
    Slice(FinishedSlice),
    /// All pendulums are done; the answer has been asked for.
    Complete(FinishedSlice),
    /// The answer.
    Answer(JobResult),
    /// The read-back failed.
    Failed,
}

impl Slot {
    /// Buffers for `job`, filled; the pendulums at their start.
    pub fn new(gpu: &Gpu, kernel: &Kernel, index: usize, job: Job) -> Result<Self, EngineError> {
        let pace = job.pace()?;
        let places = places(&kernel.design.state(), job.config.precision);
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
            Starts::Resumed(paused) => self.write_states(gpu, paused),
            // Refused when submitted, if they cannot be begun.
            _ => self.write_states(gpu, &start::states(&self.job).unwrap_or_default()),
        }
    }

    fn write_states(&self, gpu: &Gpu, paused: &[IntegratorState]) {
        let part =
            |place: Option<usize>, p: &IntegratorState| place.map_or(0.0, |place| p.numbers[place]);
        let mut bytes: Vec<u8> = Vec::with_capacity(self.buffers.states.size() as usize);
        for &[high, low] in &self.places {
            for p in paused {
                match self.job.config.precision {
                    Precision::F32 => bytes.extend((part(high, p) as f32).to_le_bytes()),
                    Precision::Df32 => {
                        let parts = [high, low].map(|place| part(place, p) as f32);
                        bytes.extend(parts.into_iter().flat_map(f32::to_le_bytes));
                    }
                    _ => bytes.extend(part(high, p).to_le_bytes()),
                }
            }
        }
        gpu.queue.write_buffer(&self.buffers.states, 0, &bytes);
        let outcomes: Vec<RawOutcome> =
            paused.iter().map(|p| RawOutcome { steps: p.steps, ..UNBEGUN }).collect();
        gpu.queue.write_buffer(&self.buffers.outcomes, 0, cast_slice(&outcomes));
    }

    /// Submits a slice of at most `slice_steps` steps a pendulum.
    pub fn submit_slice(&mut self, gpu: &Gpu, kernel: &Kernel, slice_steps: u32) {
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

    /// Asks for the outcomes.
    pub fn submit_answer(&mut self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let outcomes = self.outcome_bytes();
        let Buffers { answer, states, .. } = &self.buffers;
        encoder.copy_buffer_to_buffer(&self.buffers.outcomes, 0, answer, 0, outcomes);
        let kept = answer.size() - outcomes;
        if self.job.keep != Keep::Nothing {
            encoder.copy_buffer_to_buffer(states, 0, answer, outcomes, kept);
        }
        self.fly(gpu, encoder, true);
    }

    fn outcome_bytes(&self) -> u64 {
        u64::from(self.head.count) * size_of::<RawOutcome>() as u64
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

    /// Pendulums that still run.
    pub fn running(&self) -> u32 {
        self.running
    }

    /// The submission that is waited for, if any.
    pub fn submission(&self) -> Option<&wgpu::SubmissionIndex> {
        self.flight.as_ref().map(|flight| &flight.submission)
    }

    /// Takes what has been read back.
    pub fn land(&mut self, gpu: &Gpu) -> SlotEvent {
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

fn head(job: &Job, pace: &Pace) -> JobHead {
    let head = JobHead {
        count: job.starts.len() as u32,
        most_steps: pace.most_steps(),
        ..Default::default()
    };
    match pace {
        Pace::Fixed(steps) => JobHead { step: to_parts(steps.length), ..head },
        Pace::Adaptive(adaptive) => JobHead {
            budget: adaptive.budget as f32,
            start: adaptive.control.start as f32,
            rise: adaptive.control.rise as f32,
            ceiling: adaptive.control.ceiling as f32,
            ..head
        },
    }
}

/// What is known of a pendulum that has not begun.
const UNBEGUN: RawOutcome =
    RawOutcome { status: 0, steps: 0, moment: [0.0; 2], clearance: FAR as f32, padding: 0.0 };

// How far a read-back is.
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
    let outcome_bytes = count * size_of::<RawOutcome>() as u64;
    let storage = Usage::STORAGE | Usage::COPY_DST;
    let both = storage | Usage::COPY_SRC;
    let back = Usage::MAP_READ | Usage::COPY_DST;
    let kept = if job.keep == Keep::Nothing { 0 } else { state_bytes };
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
