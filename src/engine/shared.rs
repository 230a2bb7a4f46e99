//! What the host and the kernels both know. Twin: `shaders/shared.wgsl`; a test compares the
//! offsets that naga computes for the assembled shader with the ones here.

use bytemuck::{Pod, Zeroable};

/// The head of a job, for a kernel made for its scene.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct JobHead {
    /// Pendulums in the job.
    pub count: u32,
    /// Steps that begin before the end of the budget.
    pub most_steps: u32,
    /// Steps that one dispatch may take with each pendulum.
    pub slice_steps: u32,
    /// Always 0.
    pub zero: u32,
    /// The fixed step in reduced time units, in two parts.
    pub step: [f32; 2],
    /// Reduced time at which adaptive steps end.
    pub budget: f32,
    /// log₂ of the squared tolerance at the release, what a unit of time adds, and where that
    /// ends (see `physics::control`).
    pub start: f32,
    /// See there.
    pub rise: f32,
    /// See there.
    pub ceiling: f32,
}

/// What a general kernel reads besides: the scene.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct JobScene {
    /// 1: the first bob is watched, 2: the second, 3: both.
    pub watched: u32,
    /// WGSL aligns what follows to 8 bytes.
    pub padding: u32,
    /// A in reduced units, in two parts.
    pub a: [f32; 2],
    /// B.
    pub b: [f32; 2],
    /// P.
    pub p: [f32; 2],
    /// AB − C².
    pub least_det: [f32; 2],
    /// 1 over the scale of each momentum; only adaptive kernels read it.
    pub inverse_scale: [f32; 2],
}

/// What a kernel says of a pendulum.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RawOutcome {
    /// Low byte: the status. Above it: how many times a possible flip was looked at.
    pub status: u32,
    /// Steps done; of adaptive ones, tried.
    pub steps: u32,
    /// When the flip is, in two parts: of fixed steps the fraction of the next one, of adaptive
    /// ones the reduced time.
    pub moment: [f32; 2],
    /// How far from the top the watched bobs have stayed before, as a sine.
    pub clearance: f32,
    /// WGSL aligns the next one to 8 bytes.
    pub padding: f32,
}

/// Lengths of the lists of pendulums.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct Queue {
    /// Which of the first two is read.
    pub turn: u32,
    /// Two of those that still run, and one of those that may flip in their next step.
    pub lengths: [u32; 3],
}

/// `value` as the sum of two f32.
pub fn to_parts(value: f64) -> [f32; 2] {
    let high = value as f32;
    [high, (value - f64::from(high)) as f32]
}

/// The sum of two f32.
pub fn from_parts(parts: [f32; 2]) -> f64 {
    f64::from(parts[0]) + f64::from(parts[1])
}
