//! One job in flight on a device: its buffers, its slices, its answer.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Instant;

use bytemuck::{Pod, bytes_of, cast_slice};
use wgpu::BufferUsages as Usage;

use super::device::Gpu;
use super::pipeline::Kernel;
use crate::engine::method::{Method, Steps};
use crate::engine::shared::{JobHead, JobScene, Queue, RawOutcome, from_parts, to_parts};
use crate::engine::{EngineError, Finished, Job, Paused, Precision, Starts};
use crate::physics::{Outcome, State, Status};

/// A job on the device. Slices are submitted one at a time; each leaves behind how many
/// pendulums still run, and the last one is followed by the outcomes.
pub struct Slot {
    /// The job, kept whole so that it can be done again on another device.
    pub job: Job,
    /// The kernel's place in the engine's list.
    pub kernel: usize,
    steps: Steps,
    state_len: usize,
    head: JobHead,
    /// Pendulums that still run.
    running: u32,
    buffers: Buffers,
    groups: [wgpu::BindGroup; 2],
    flight: Option<Flight>,
}

struct Buffers {
    job: wgpu::Buffer,
    states: wgpu::Buffer,
    outcomes: wgpu::Buffer,
    queue: wgpu::Buffer,
    dispatch_size: wgpu::Buffer,
    /// Read back after each slice: the queue.
    progress: wgpu::Buffer,
    /// Read back at the end: outcomes, then states if they are kept.
    answer: wgpu::Buffer,
}

/// A submission whose read-back has not come yet.
struct Flight {
    submission: wgpu::SubmissionIndex,
    since: Instant,
    mapped: Arc<AtomicU8>,
    answer: bool,
}

/// A slice that has run.
pub struct Ran {
    /// When it was submitted.
    pub since: Instant,
    /// Steps of all its pendulums together, at most.
    pub pendulum_steps: f64,
}

/// What a slot has come to.
pub enum Landed {
    /// Nothing new.
    InFlight,
    /// A slice is done; more are needed.
    Slice(Ran),
    /// All pendulums are done; the answer has been asked for.
    Complete(Ran),
    /// The answer.
    Answer(Finished),
    /// The read-back failed.
    Failed,
}

impl Slot {
    /// Buffers for `job`, filled; the pendulums at their start.
    pub fn new(gpu: &Gpu, kernel: &Kernel, index: usize, job: Job) -> Result<Self, EngineError> {
        let Method::Rk4 { step_secs } = job.recipe.method;
        let steps = Steps::new(&job.question, step_secs, job.recipe.precision)?;
        let state_len = kernel.design.state().len();
        let head = JobHead {
            count: job.starts.len() as u32,
            most_steps: steps.count,
            slice_steps: 0,
            zero: 0,
            step: to_parts(steps.length),
        };
        let (buffers, groups) = make_buffers(gpu, kernel, &job, state_len)?;
        let slot = Slot {
            job,
            kernel: index,
            steps,
            state_len,
            running: head.count,
            head,
            buffers,
            groups,
            flight: None,
        };
        slot.write_scene(gpu);
        slot.begin(gpu, kernel);
        Ok(slot)
    }

    fn write_scene(&self, gpu: &Gpu) {
        let (pendulum, _) = self.job.question.pendulum.reduced();
        let scene = JobScene {
            watched: self.job.question.rule.watched().iter().map(|bob| 1 << bob).sum(),
            padding: 0,
            a: to_parts(pendulum.a),
            b: to_parts(pendulum.b),
            p: to_parts(pendulum.p),
            least_det: to_parts(pendulum.least_det),
        };
        let size = size_of::<JobHead>() as u64;
        gpu.queue.write_buffer(&self.buffers.job, 0, bytes_of(&self.head));
        gpu.queue.write_buffer(&self.buffers.job, size, bytes_of(&scene));
    }

    /// Puts every pendulum at its start; the first slice reads list 0.
    fn begin(&self, gpu: &Gpu, kernel: &Kernel) {
        let queue = Queue { turn: 1, lengths: [self.head.count, 0, 0] };
        gpu.queue.write_buffer(&self.buffers.queue, 0, bytes_of(&queue));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&kernel.begin);
            pass.set_bind_group(0, &self.groups[0], &[]);
            pass.dispatch_workgroups(self.head.count.div_ceil(WORKGROUP), 1, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        if let Starts::Paused(paused) = &self.job.starts {
            self.write_paused(gpu, paused);
        }
    }

    /// Overwrites what `begin` made with states kept earlier.
    fn write_paused(&self, gpu: &Gpu, paused: &[Paused]) {
        let part = |k: usize, p: &Paused| [p.state.angle, p.state.speed, p.rest].as_flattened()[k];
        let values = (0..self.state_len).flat_map(|k| paused.iter().map(move |p| part(k, p)));
        let bytes: Vec<u8> = match self.job.recipe.precision {
            Precision::F32 => values.flat_map(|x| (x as f32).to_le_bytes()).collect(),
            Precision::F64 => values.flat_map(f64::to_le_bytes).collect(),
        };
        gpu.queue.write_buffer(&self.buffers.states, 0, &bytes);
        let outcomes: Vec<RawOutcome> =
            paused.iter().map(|p| RawOutcome { steps: p.steps, ..Default::default() }).collect();
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
        if self.job.keep_unfinished {
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
        self.flight = Some(Flight { submission, since: Instant::now(), mapped, answer });
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
    pub fn land(&mut self, gpu: &Gpu) -> Landed {
        let landed = |flight: &mut Flight| flight.mapped.load(Ordering::Acquire) != PENDING;
        let Some(flight) = self.flight.take_if(landed) else {
            return Landed::InFlight;
        };
        if flight.mapped.load(Ordering::Acquire) == REFUSED {
            return Landed::Failed;
        }
        if flight.answer {
            return Landed::Answer(self.read_answer());
        }
        let queue: Queue = read(&self.buffers.progress, 0, 1)[0];
        self.buffers.progress.unmap();
        let pendulum_steps = f64::from(self.running) * f64::from(self.head.slice_steps);
        let ran = Ran { since: flight.since, pendulum_steps };
        self.running = queue.lengths[1 - queue.turn as usize];
        if self.running > 0 {
            return Landed::Slice(ran);
        }
        self.submit_answer(gpu);
        Landed::Complete(ran)
    }

    fn read_answer(&self) -> Finished {
        let count = self.head.count as usize;
        let raw: Vec<RawOutcome> = read(&self.buffers.answer, 0, count);
        let outcomes: Vec<Outcome> = raw.iter().map(|raw| self.outcome(raw)).collect();
        let unfinished = if self.job.keep_unfinished {
            self.read_unfinished(&raw, &outcomes)
        } else {
            Vec::new()
        };
        let before: u64 = match &self.job.starts {
            Starts::Rest(_) => 0,
            Starts::Paused(paused) => paused.iter().map(|p| u64::from(p.steps)).sum(),
        };
        let steps: u64 = raw.iter().map(|raw| u64::from(raw.steps)).sum::<u64>() - before;
        let bobs = self.job.question.rule.watched().len() as u64;
        let looks: u64 = raw.iter().map(|raw| u64::from(raw.status >> 8)).sum();
        // A look repeats its step and takes both ends' accelerations for each bob.
        let rhs_evaluations = 4 * steps + looks * (4 + 2 * bobs);
        self.buffers.answer.unmap();
        Finished { id: self.job.id, outcomes, unfinished, rhs_evaluations }
    }

    fn outcome(&self, raw: &RawOutcome) -> Outcome {
        match raw.status & 255 {
            1 => self.steps.outcome_of_pass(raw.steps, from_parts(raw.fraction)),
            3 => Outcome::without_time(Status::Failed),
            _ => Outcome::without_time(Status::Unflipped),
        }
    }

    fn read_unfinished(&self, raw: &[RawOutcome], outcomes: &[Outcome]) -> Vec<(usize, Paused)> {
        let numbers = raw.len() * self.state_len;
        let offset = self.outcome_bytes();
        let states: Vec<f64> = match self.job.recipe.precision {
            Precision::F32 => read::<f32>(&self.buffers.answer, offset, numbers)
                .into_iter()
                .map(f64::from)
                .collect(),
            Precision::F64 => read(&self.buffers.answer, offset, numbers),
        };
        let paused = |i: usize| {
            let part = |k: usize| states.get(k * raw.len() + i).copied().unwrap_or(0.0);
            let state = State { angle: [part(0), part(1)], speed: [part(2), part(3)] };
            Paused { steps: raw[i].steps, state, rest: [part(4), part(5)] }
        };
        (0..raw.len())
            .filter(|&i| outcomes[i].status == Status::Unflipped)
            .map(|i| (i, paused(i)))
            .collect()
    }
}

// How far a read-back is.
const PENDING: u8 = 0;
const MAPPED: u8 = 1;
const REFUSED: u8 = 2;

/// Invocations in a workgroup; the shaders have the same number.
const WORKGROUP: u32 = 64;

fn read<T: Pod>(buffer: &wgpu::Buffer, offset: u64, count: usize) -> Vec<T> {
    let bytes = offset..offset + (count * size_of::<T>()) as u64;
    let view = buffer.slice(bytes).get_mapped_range().expect("mapped before it is read");
    bytemuck::pod_collect_to_vec(&view)
}

fn start_bytes(job: &Job) -> Vec<u8> {
    let Starts::Rest(angles) = &job.starts else {
        return Vec::new();
    };
    match job.recipe.precision {
        Precision::F32 => {
            let split = |theta: &crate::physics::Dd| {
                let high = theta.hi as f32;
                [high, ((theta.hi - f64::from(high)) + theta.lo) as f32]
            };
            angles.iter().flatten().flat_map(split).flat_map(f32::to_le_bytes).collect()
        }
        Precision::F64 => angles.iter().flatten().flat_map(|t| t.hi.to_le_bytes()).collect(),
    }
}

fn make_buffers(
    gpu: &Gpu,
    kernel: &Kernel,
    job: &Job,
    state_len: usize,
) -> Result<(Buffers, [wgpu::BindGroup; 2]), EngineError> {
    let count = job.starts.len() as u64;
    let (number, start) = match job.recipe.precision {
        Precision::F32 => (4, 16),
        Precision::F64 => (8, 16),
    };
    let state_bytes = count * number * state_len as u64;
    let outcome_bytes = count * size_of::<RawOutcome>() as u64;
    let storage = Usage::STORAGE | Usage::COPY_DST;
    let both = storage | Usage::COPY_SRC;
    let back = Usage::MAP_READ | Usage::COPY_DST;
    let kept = if job.keep_unfinished { state_bytes } else { 0 };
    let head = (size_of::<JobHead>() + size_of::<JobScene>()) as u64;
    let starts = gpu.buffer("a job's starts", count * start, storage)?;
    let lists = gpu.buffer("a job's lists", count * 12, storage)?;
    let buffers = Buffers {
        job: gpu.buffer("a job's head", head, storage)?,
        states: gpu.buffer("a job's states", state_bytes, both)?,
        outcomes: gpu.buffer("a job's outcomes", outcome_bytes, both)?,
        queue: gpu.buffer("a job's queue", size_of::<Queue>() as u64, both)?,
        dispatch_size: gpu.buffer("a job's dispatch", 16, Usage::STORAGE | Usage::INDIRECT)?,
        progress: gpu.buffer("a job's progress", size_of::<Queue>() as u64, back)?,
        answer: gpu.buffer("a job's answer", outcome_bytes + kept, back)?,
    };
    gpu.queue.write_buffer(&starts, 0, &start_bytes(job));
    let Buffers { job, states, outcomes, queue, .. } = &buffers;
    let groups = [
        kernel.bind(gpu, 0, &[job, &starts, states, outcomes, &lists, queue]),
        kernel.bind(gpu, 1, &[&buffers.dispatch_size]),
    ];
    Ok((buffers, groups))
}
