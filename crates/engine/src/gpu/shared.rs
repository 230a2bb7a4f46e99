//! The data layout that host and kernels share. Counterpart: `shaders/shared.wgsl`; a test compares
//! the offsets that naga computes for the assembled shader with the ones here.

use bytemuck::{Pod, Zeroable};

use flipmap_pendulum::Status;

/// The status codes as WGSL constants: `ANSWERED` and so on.
pub fn status_constants() -> String {
    let line = |status: Status| {
        let name = format!("{status:?}").to_uppercase();
        format!("const {name}: u32 = {}u;\n", status as u8)
    };
    let all = [Status::Unflipped, Status::Answered, Status::Forbidden, Status::Failed];
    all.map(line).concat() + &format!("const RUNNING: u32 = {RUNNING}u;\n")
}

/// The status in the device's memory of a pendulum that has not ended. No [`Status`] has this code,
/// so a pendulum that a device lost on the way is not taken for one that did not flip.
pub(crate) const RUNNING: u32 = 255;

/// The status in the low byte of an outcome's word; none for a pendulum that has not ended.
pub(crate) fn status_of(word: u32) -> Option<Status> {
    [Status::Unflipped, Status::Answered, Status::Failed]
        .into_iter()
        .find(|status| *status as u32 == word & 255)
}

/// The head of a job, which is all that a kernel compiled for its scene reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct JobHead {
    /// Number of pendulums in the job.
    pub count: u32,
    /// Number of steps after which a pendulum is stopped.
    pub most_steps: u32,
    /// Number of steps that one dispatch may take with each pendulum.
    pub slice_steps: u32,
    /// Always 0, which the shader compiler cannot know.
    pub zero: u32,
    /// The fixed step in reduced time units, in two parts.
    pub step: [f32; 2],
    /// Reduced time at which adaptive steps end.
    pub budget: f32,
    /// log₂ of the squared tolerance at the release (see `flipmap_pendulum::control`).
    pub start: f32,
    /// Amount that a unit of time adds to `start`.
    pub rise: f32,
    /// Value beyond which `start` does not rise.
    pub ceiling: f32,
    /// Numbers of columns and rows of an upright picture's starts; else 0.
    pub columns: u32,
    /// See [`JobHead::columns`].
    pub rows: u32,
}

/// The scene, which a general kernel reads in addition to the head.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct JobScene {
    /// Bit mask of the watched bobs, 1: the first, 2: the second, 3: both.
    pub watched: u32,
    /// Padding, because WGSL aligns what follows to 8 bytes.
    pub padding: u32,
    /// A in reduced units, in two parts.
    pub a: [f32; 2],
    /// B in reduced units, in two parts.
    pub b: [f32; 2],
    /// P in reduced units, in two parts.
    pub p: [f32; 2],
    /// AB − C² in reduced units, in two parts.
    pub least_det: [f32; 2],
    /// Reciprocal of the scale of each momentum; only adaptive kernels read it.
    pub inverse_scale: [f32; 2],
}

/// The outcome of a pendulum, as a kernel writes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RawOutcome {
    /// Status in the low byte; above it, the number of steps taken to look for a flip.
    pub status: u32,
    /// Number of steps taken; for adaptive methods, of steps tried.
    pub steps: u32,
    /// Moment of the flip, in two parts: for fixed steps the fraction of the next one, for adaptive
    /// steps the reduced time.
    pub moment: [f32; 2],
    /// Distance from the top that the watched bobs have kept so far, as a sine.
    pub clearance: f32,
    /// Whole turns of the first bob in the low 16 bits and of the second in the high ones, signed;
    /// only adaptive kernels that watch no bob count them.
    pub turns: u32,
}

/// The outcome of a pendulum whose passes of the top are counted.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CountedOutcome {
    /// The outcome that every kernel writes.
    pub raw: RawOutcome,
    /// Number of passes by each bob anticlockwise and clockwise, the first bob first.
    pub passes: [u32; 4],
}

/// The upper bits of a packed outcome's first word if it holds a status instead of a moment; as an
/// f32, the word is NaN.
pub const NO_MOMENT: u32 = !255;

/// The work for all pendulums of a job, added up on the device.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct PackedWork {
    /// Number of steps and number of looks for a flip, each in two words with the low one first.
    pub sums: [u32; 4],
    /// Number of pendulums whose outcomes have been packed.
    pub packed: u32,
    /// Padding, so that packed outcomes can follow.
    pub padding: [u32; 3],
}

impl PackedWork {
    /// Number of steps and number of looks.
    pub(crate) fn steps_and_looks(&self) -> [u64; 2] {
        let [steps_low, steps_high, looks_low, looks_high] = self.sums.map(u64::from);
        [steps_low | steps_high << 32, looks_low | looks_high << 32]
    }
}

/// Lengths of the lists of pendulums, and the list in use.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct Queue {
    /// Index of the list that is read, 0 or 1.
    pub turn: u32,
    /// Lengths of the two lists of pendulums that still run, and of the list of those that may flip
    /// in their next step.
    pub lengths: [u32; 3],
}

/// `value` as the sum of two f32.
pub(crate) fn to_parts(value: f64) -> [f32; 2] {
    let high = value as f32;
    [high, (value - f64::from(high)) as f32]
}

/// The sum of two f32.
pub(crate) fn from_parts(parts: [f32; 2]) -> f64 {
    f64::from(parts[0]) + f64::from(parts[1])
}
