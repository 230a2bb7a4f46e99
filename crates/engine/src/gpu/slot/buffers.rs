//! The buffers of a job, and the pool in which they wait for the next job.
//!
//! A job of a million pendulums has some 80 MB of buffers. Allocating and clearing them anew for
//! each job would take as long as the job on a fast card.

use wgpu::BufferUsages as Usage;

use super::{WORK_BYTES, outcome_size};
use crate::adapters::MAX_SLICES;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::Kernel;
use crate::gpu::shared::{JobHead, JobScene, Queue};
use crate::{EngineError, Job, Keep, Precision};

/// The buffers of a job. Each may be larger than the job needs.
pub(super) struct Buffers {
    pub job: wgpu::Buffer,
    pub states: wgpu::Buffer,
    pub outcomes: wgpu::Buffer,
    /// The lists of pendulums, and at the end the packed outcomes.
    pub lists: wgpu::Buffer,
    /// The lengths of the lists, and at the end the work.
    pub queue: wgpu::Buffer,
    pub dispatch_size: wgpu::Buffer,
    /// The queue after each slice of a submission, then the ticks of its beginning and end.
    pub progress: wgpu::Buffer,
    /// The outcomes, then the states if they are kept; or the work, then the packed outcomes. Read
    /// back at the end.
    pub answer: wgpu::Buffer,
    /// Size in bytes of the states that are kept.
    pub kept: u64,
    /// Readings of the device's clock, if it has one.
    pub ticks: Option<Ticks>,
    /// The numbers of columns and rows, and the places of the starts, where the device begins them.
    pub starts: Option<[wgpu::Buffer; 2]>,
}

/// The moments at which a submission begins and ends on the device.
pub(super) struct Ticks {
    pub set: wgpu::QuerySet,
    /// The two moments, before they are copied to the host.
    pub buffer: wgpu::Buffer,
}

/// Size in bytes of the two moments of a submission.
pub(super) const TICK_BYTES: u64 = 16;
/// Offset of these moments in the progress buffer.
pub(super) const TICKS_AT: u64 = MAX_SLICES as u64 * size_of::<Queue>() as u64;

/// Buffers of finished jobs, by their labels.
#[derive(Default)]
pub(in crate::gpu) struct BufferPool {
    free: Vec<(&'static str, wgpu::Buffer)>,
}

/// Largest number of free buffers that are kept: those of two jobs. The ones that have been free
/// longest are dropped first.
const MAX_FREE_BUFFERS: usize = 22;

/// Returns the size to allocate for a buffer: at most a quarter more than needed, so that jobs of
/// nearly equal size can reuse each other's buffers.
fn size_class(bytes: u64) -> u64 {
    let step = (bytes.max(256).next_power_of_two() / 8).max(64);
    bytes.next_multiple_of(step)
}

impl BufferPool {
    /// Returns a free buffer with the label and about the size, or a new one. Its contents are
    /// undefined.
    fn take(
        &mut self,
        gpu: &Gpu,
        label: &'static str,
        bytes: u64,
        usage: Usage,
    ) -> Result<wgpu::Buffer, EngineError> {
        let size = size_class(bytes);
        let fits = |(name, buffer): &(&str, wgpu::Buffer)| *name == label && buffer.size() == size;
        if let Some(place) = self.free.iter().position(fits) {
            return Ok(self.free.remove(place).1);
        }
        gpu.buffer(label, size, usage).or_else(|_| {
            // The free buffers may take up the memory that is missing.
            self.free.clear();
            gpu.buffer(label, bytes, usage)
        })
    }

    /// Takes the buffers of a job that has been answered.
    pub(super) fn give(&mut self, buffers: Buffers) {
        let Buffers {
            job, states, outcomes, lists, queue, dispatch_size, progress, answer, ..
        } = buffers;
        self.free.extend([
            (JOB, job),
            (STATES, states),
            (OUTCOMES, outcomes),
            (LISTS, lists),
            (QUEUE, queue),
            (DISPATCH, dispatch_size),
            (PROGRESS, progress),
            (ANSWER, answer),
        ]);
        self.free.extend(buffers.ticks.map(|ticks| (TICKS, ticks.buffer)));
        self.free.extend(
            buffers.starts.into_iter().flat_map(|starts| [AXES, PLACES].into_iter().zip(starts)),
        );
        let extra = self.free.len().saturating_sub(MAX_FREE_BUFFERS);
        self.free.drain(..extra);
    }
}

// Labels of buffers.
const JOB: &str = "a job's head";
const STATES: &str = "a job's states";
const OUTCOMES: &str = "a job's outcomes";
const LISTS: &str = "a job's lists";
const QUEUE: &str = "a job's queue";
const DISPATCH: &str = "a job's dispatch";
const PROGRESS: &str = "a job's progress";
const ANSWER: &str = "a job's answer";
const TICKS: &str = "a job's clock";
const AXES: &str = "a job's columns and rows";
const PLACES: &str = "a job's places";

impl Buffers {
    /// Creates the buffers of a job whose states have `state_len` numbers each. The device begins
    /// it from `begun` numbers of columns and rows, if any. The answer without states has
    /// `answer_bytes`.
    pub(super) fn new(
        gpu: &Gpu,
        pool: &mut BufferPool,
        job: &Job,
        (state_len, begun): (usize, Option<usize>),
        answer_bytes: u64,
    ) -> Result<Self, EngineError> {
        let count = job.starts.len() as u64;
        let number = if job.config.precision == Precision::F32 { 4 } else { 8 };
        let state_bytes = count * number * state_len as u64;
        let storage = Usage::STORAGE | Usage::COPY_DST;
        let both = storage | Usage::COPY_SRC;
        let back = Usage::MAP_READ | Usage::COPY_DST;
        let kept = if job.keep == Keep::NOTHING { 0 } else { state_bytes };
        let head = (size_of::<JobHead>() + size_of::<JobScene>()) as u64;
        let sizes = Usage::STORAGE | Usage::INDIRECT;
        let queue = (size_of::<Queue>() as u64).max(WORK_BYTES);
        let mut take = |label, bytes, usage| pool.take(gpu, label, bytes, usage);
        Ok(Buffers {
            job: take(JOB, head, storage)?,
            states: take(STATES, state_bytes, both)?,
            outcomes: take(OUTCOMES, count * outcome_size(job), both)?,
            lists: take(LISTS, count * 12, both)?,
            queue: take(QUEUE, queue, both)?,
            dispatch_size: take(DISPATCH, 16, sizes)?,
            progress: take(PROGRESS, TICKS_AT + TICK_BYTES, back)?,
            answer: take(ANSWER, answer_bytes + kept, back)?,
            kept,
            ticks: Ticks::new(gpu, &mut take)?,
            starts: match begun {
                None => None,
                Some(axes) => Some([
                    take(AXES, axes as u64 * number, storage)?,
                    take(PLACES, count * 4, storage)?,
                ]),
            },
        })
    }

    /// The bind groups of a kernel on these buffers.
    pub(super) fn groups(&self, gpu: &Gpu, kernel: &Kernel) -> [wgpu::BindGroup; 2] {
        let Buffers { job, states, outcomes, lists, queue, .. } = self;
        [
            kernel.bind(gpu, 0, &[job, states, outcomes, lists, queue]),
            kernel.bind(gpu, 1, &[&self.dispatch_size]),
        ]
    }
}

impl Ticks {
    fn new(
        gpu: &Gpu,
        take: &mut dyn FnMut(&'static str, u64, Usage) -> Result<wgpu::Buffer, EngineError>,
    ) -> Result<Option<Self>, EngineError> {
        if gpu.tick_secs().is_none() {
            return Ok(None);
        }
        let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some(TICKS),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let usage = Usage::QUERY_RESOLVE | Usage::COPY_SRC;
        Ok(Some(Ticks { set, buffer: take(TICKS, TICK_BYTES, usage)? }))
    }

    /// Writes one of the two moments, at the beginning (0) or the end (1) of a pass.
    pub(super) fn writes(&self, moment: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: (moment == 0).then_some(0),
            end_of_pass_write_index: (moment == 1).then_some(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_rounded_up_by_a_quarter_at_most() {
        for bytes in [1, 16, 250, 256, 257, 4097, 84_000_000, 1 << 30] {
            let size = size_class(bytes);
            assert!(size >= bytes && size.is_multiple_of(64), "{bytes}: {size}");
            assert!(bytes < 256 || size * 4 <= bytes * 5, "{bytes}: {size}");
        }
        assert_eq!(size_class(84_000_000), size_class(84_100_000));
    }
}
