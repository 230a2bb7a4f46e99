//! The states in which the pendulums of a job begin, written to the device.

use bytemuck::{bytes_of, cast_slice};
use rayon::prelude::*;

use super::Slot;
use super::axes::Axes;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::workgroups;
use crate::gpu::shared::{CountedOutcome, JobHead, JobScene, Queue, RUNNING, RawOutcome, to_parts};
use crate::{IntegratorState, Precision, Starts, start};
use flipmap_pendulum::crossing::FAR;

impl Slot {
    /// Writes the job's head and scene.
    pub(super) fn write_scene(&self, gpu: &Gpu) {
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
        gpu.write(&self.buffers.job, 0, bytes_of(&self.head));
        gpu.write(&self.buffers.job, size, bytes_of(&scene));
    }

    /// Puts every pendulum at its start; the first slice reads list 0.
    pub(super) fn begin(&self, gpu: &Gpu, axes: Option<Axes>) {
        let queue = Queue { turn: 1, lengths: [self.head.count, 0, 0] };
        gpu.write(&self.buffers.queue, 0, bytes_of(&queue));
        if let Some(axes) = axes {
            return self.begin_upright(gpu, &axes);
        }
        let list: Vec<u32> = (0..self.head.count).collect();
        gpu.write(&self.buffers.lists, 0, cast_slice(&list));
        match &self.job.starts {
            Starts::Resumed { states: paused, .. } => self.write_states(gpu, paused),
            // Starts that cannot be begun have been refused on submission.
            _ => self.write_states(gpu, &start::states(&self.job).unwrap_or_default()),
        }
    }

    /// Submits the dispatch that puts the pendulums of an upright picture at their starts.
    fn begin_upright(&self, gpu: &Gpu, axes: &Axes) {
        let (Starts::Upright(upright), Some([numbers, places]), Some(pipeline)) =
            (&self.job.starts, &self.buffers.starts, &self.kernel.begin)
        else {
            unreachable!("axes are those of an upright picture and a kernel that begins it");
        };
        let precision = self.job.config.precision;
        let all = axes.numbers().flat_map(|(states, places)| encoded(states, places, precision));
        gpu.write(numbers, 0, &all.collect::<Vec<u8>>());
        gpu.write(places, 0, cast_slice(&upright.places));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.groups[0], &[]);
        pass.set_bind_group(2, &self.kernel.bind(gpu, 2, &[numbers, places]), &[]);
        pass.dispatch_workgroups(workgroups(self.head.count, MIN_WORKGROUP), 1, 1);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
    }

    fn write_states(&self, gpu: &Gpu, paused: &[IntegratorState]) {
        let precision = self.job.config.precision;
        let numbers = self.places.par_iter().map(|places| encoded(paused, *places, precision));
        gpu.write(&self.buffers.states, 0, &numbers.collect::<Vec<_>>().concat());
        let begun = |p: &IntegratorState| {
            let [first, second] = p.counts().turns;
            let turns = (first as u32 & 0xffff) | ((second as u32) << 16);
            RawOutcome { steps: p.steps, turns, ..UNBEGUN }
        };
        if self.job.question.passes == 1 {
            let outcomes: Vec<RawOutcome> = paused.iter().map(begun).collect();
            gpu.write(&self.buffers.outcomes, 0, cast_slice(&outcomes));
        } else {
            let counted = |p| CountedOutcome { raw: begun(p), passes: p.counts().passes };
            let outcomes: Vec<CountedOutcome> = paused.iter().map(counted).collect();
            gpu.write(&self.buffers.outcomes, 0, cast_slice(&outcomes));
        }
    }
}

/// Smallest number of invocations in a workgroup.
const MIN_WORKGROUP: u32 = 32;

/// Encodes one number of each state for the device, from the places of the number and of its
/// remainder in the state.
fn encoded(
    states: &[IntegratorState],
    [high, low]: [Option<usize>; 2],
    precision: Precision,
) -> Vec<u8> {
    let part =
        |place: Option<usize>, p: &IntegratorState| place.map_or(0.0, |place| p.number(place));
    match precision {
        Precision::F32 => {
            states.iter().flat_map(|p| (part(high, p) as f32).to_le_bytes()).collect()
        }
        Precision::Df32 => {
            let parts = states.iter().flat_map(|p| two_floats(part(high, p), part(low, p)));
            parts.flat_map(f32::to_le_bytes).collect()
        }
        _ => states.iter().flat_map(|p| part(high, p).to_le_bytes()).collect(),
    }
}

/// Splits the sum of a number and its remainder into two f32.
fn two_floats(value: f64, remainder: f64) -> [f32; 2] {
    let high = value as f32;
    let below = if high.is_finite() { value - f64::from(high) } else { 0.0 };
    [high, (below + remainder) as f32]
}

/// The outcome of a pendulum that has not begun.
const UNBEGUN: RawOutcome =
    RawOutcome { status: RUNNING, steps: 0, moment: [0.0; 2], clearance: FAR as f32, turns: 0 };
