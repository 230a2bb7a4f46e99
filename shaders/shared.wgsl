// What the host and the kernels both know. Twin: src/engine/shared.rs; a test compares offsets.

struct Job {
    // Pendulums in the job.
    count: u32,
    // Steps that begin before the end of the budget.
    most_steps: u32,
    // Steps that one dispatch may take with each pendulum.
    slice_steps: u32,
    // Always 0, but only the host knows: what is mixed with it cannot be optimised away.
    zero: u32,
    // The step in reduced time units, in two parts.
    step: vec2<f32>,
{% if general %}
    // 1: the first bob is watched, 2: the second, 3: both.
    watched: u32,
    // A, B, P and AB - C^2 in reduced units, each in two parts.
    a: vec2<f32>,
    b: vec2<f32>,
    p: vec2<f32>,
    least_det: vec2<f32>,
{% endif %}
}

struct Outcome {
    // Low byte: the status. Above it: how many times a possible flip was looked at.
    status: u32,
    // Whole steps done.
    steps: u32,
    // How far into the next step the flip is, in two parts.
    fraction: vec2<f32>,
}

// Lengths of the lists of pendulums: two of those that still run, packed together, read and
// written in turn, and one of those that may have flipped in their next step.
struct Queue {
    // Which of the first two is read.
    turn: u32,
    lengths: array<atomic<u32>, 3>,
}

const SUSPECTS = 2u;
const UNFLIPPED = 0u;
const FLIPPED = 1u;
const FAILED = 3u;
const LOOK = 256u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<storage, read> job: Job;
@group(0) @binding(1) var<storage, read> starts: array<Start>;
@group(0) @binding(2) var<storage, read_write> states: array<Real>;
@group(0) @binding(3) var<storage, read_write> outcomes: array<Outcome>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;
@group(0) @binding(5) var<storage, read_write> queue: Queue;
