//! Packed outcomes: a third or half of what the kernels keep, which is all that a picture shows.
//!
//! When all pendulums of a job have ended, a last dispatch writes two or three words for each and
//! adds up the work, so that the host reads 8 or 12 bytes a pendulum instead of 24. Nothing is
//! rounded. The dispatch reads the outcomes, and overwrites the lists and the queue, which are no
//! longer needed.

use std::cell::OnceCell;

use super::device::Gpu;
use super::kernel::{Design, pack_text};
use super::pipeline::{bind, compute_pipeline, layout, workgroups};
use crate::Precision;
use crate::gpu::shared::{NO_MOMENT, RawOutcome};
use flipmap_pendulum::Status;

/// The words of a packed outcome: first the status or the first part of the moment, then these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Packing {
    /// The second part of the moment, for adaptive steps.
    Moment,
    /// The number of steps, for fixed steps whose moment has one part.
    Steps,
    /// The number of steps and the second part of the moment.
    StepsAndMoment,
}

impl Packing {
    /// Every packing.
    pub const ALL: [Packing; 3] = [Packing::Moment, Packing::Steps, Packing::StepsAndMoment];

    /// Returns the packing of the outcomes of a kernel.
    pub(crate) fn of(design: &Design) -> Self {
        match (design.is_adaptive(), design.precision) {
            (true, _) => Packing::Moment,
            (false, Precision::F32) => Packing::Steps,
            (false, _) => Packing::StepsAndMoment,
        }
    }

    /// Number of words for each outcome.
    pub fn words(self) -> usize {
        2 + usize::from(self == Packing::StepsAndMoment)
    }

    /// Returns true if the words include the number of steps.
    pub(super) fn is_stepped(self) -> bool {
        self != Packing::Moment
    }

    /// Returns true if the words include the second part of the moment.
    pub(super) fn has_rest(self) -> bool {
        self != Packing::Steps
    }

    /// Unpacks the outcome that `words` hold; parts that they leave out are 0.
    pub(super) fn unpacked(self, words: &[u32]) -> RawOutcome {
        let first = words[0];
        let steps = if self.is_stepped() { words[1] } else { 0 };
        if first >= NO_MOMENT {
            return RawOutcome { status: first & !NO_MOMENT, steps, ..RawOutcome::default() };
        }
        let rest = if self.has_rest() { words[self.words() - 1] } else { 0 };
        let moment = [first, rest].map(f32::from_bits);
        RawOutcome { status: Status::Answered as u32, steps, moment, ..RawOutcome::default() }
    }
}

/// The pipelines that pack outcomes on one device, each compiled when it is first needed.
#[derive(Default)]
pub(super) struct Packer {
    packings: [OnceCell<Pipeline>; Packing::ALL.len()],
}

/// A compiled packing.
struct Pipeline {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// Number of invocations in a workgroup.
const WORKGROUP: u32 = 64;

impl Packer {
    /// Records a dispatch that packs the outcomes of `count` pendulums. The buffers are the job's
    /// head, the outcomes, the words and the work, whose bytes are 0.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        packing: Packing,
        count: u32,
        buffers: &[&wgpu::Buffer; 4],
    ) {
        let Pipeline { pipeline, layout } =
            self.packings[packing as usize].get_or_init(|| Pipeline::new(gpu, packing));
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &bind(&gpu.device, layout, buffers), &[]);
        pass.dispatch_workgroups(workgroups(count, WORKGROUP), 1, 1);
    }
}

impl Pipeline {
    fn new(gpu: &Gpu, packing: Packing) -> Self {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("pack"),
            source: wgpu::ShaderSource::Wgsl(pack_text(packing).into()),
        });
        let layout = layout(&gpu.device, &[true, true, false, false]);
        let pipeline = compute_pipeline(&gpu.device, &module, "pack", &[Some(&layout)]);
        Pipeline { pipeline, layout }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::shared::RUNNING;

    #[test]
    fn words_hold_a_moment_or_a_status() {
        let moment = [1.5f32, -3e-9];
        let [first, rest] = moment.map(f32::to_bits);
        for (packing, words, steps, parts) in [
            (Packing::Moment, &[first, rest][..], 0, moment),
            (Packing::Steps, &[first, 77], 77, [1.5, 0.0]),
            (Packing::StepsAndMoment, &[first, 77, rest], 77, moment),
        ] {
            assert_eq!(words.len(), packing.words());
            let flipped = RawOutcome { status: 1, steps, moment: parts, ..RawOutcome::default() };
            assert_eq!(packing.unpacked(words), flipped);
            for status in [0, 3, RUNNING, 77] {
                let words: Vec<u32> = [&[NO_MOMENT | status], &words[1..]].concat();
                let ended = RawOutcome { status, steps, ..RawOutcome::default() };
                assert_eq!(packing.unpacked(&words), ended);
            }
        }
        // A flip without a time stays a flip, which the host refuses.
        let lost = Packing::Moment.unpacked(&[f32::NAN.to_bits(), 0]);
        assert!(lost.status == 1 && lost.moment[0].is_nan());
    }
}
