// The data layout that host and kernels share. Counterpart: crates/engine/src/gpu/shared.rs; a
// test compares offsets.

struct Job {
    // Pendulums in the job.
    count: u32,
    // Steps after which a pendulum is stopped.
    most_steps: u32,
    // Steps that one dispatch may take with each pendulum.
    slice_steps: u32,
    // Always 0, but only the host knows: an expression that it enters cannot be optimised away.
    zero: u32,
    // The fixed step in reduced time units, in two parts.
    step: vec2<f32>,
    // Reduced time at which adaptive steps end.
    budget: f32,
    // log2 of the squared tolerance at the release, the amount that a unit of time adds to it, and
    // its largest value.
    start: f32,
    rise: f32,
    ceiling: f32,
    // Numbers of columns and rows of an upright picture's starts.
    columns: u32,
    rows: u32,
{% if general %}
    // 1: the first bob is watched, 2: the second, 3: both.
    watched: u32,
    // A, B, P and AB - C^2 in reduced units, each in two parts.
    a: vec2<f32>,
    b: vec2<f32>,
    p: vec2<f32>,
    least_det: vec2<f32>,
{% if adaptive %}
    // Reciprocal of the scale of each momentum.
    inverse_scale: vec2<f32>,
{% endif %}
{% endif %}
}

{% include "outcome.wgsl" %}

// Lengths of the lists of pendulums: two of those that still run, packed together, read and written
// in turn, and one of those that may flip in their next step.
struct Queue {
    // Index of the list that is read, 0 or 1.
    turn: u32,
    lengths: array<atomic<u32>, 3>,
}

const SUSPECTS = 2u;
{{ statuses }}const LOOK = 256u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<storage, read> job: Job;
@group(0) @binding(1) var<storage, read_write> states: array<Real>;
@group(0) @binding(2) var<storage, read_write> outcomes: array<Outcome>;
@group(0) @binding(3) var<storage, read_write> lists: array<u32>;
@group(0) @binding(4) var<storage, read_write> queue: Queue;

// The job's zero.
var<private> zero: u32;
{% if general %}
// The pendulum as data; a kernel made for one scene has it in its text instead.
struct Scene {
    a: Real,
    b: Real,
    p: Real,
    least_det: Real,
{% if adaptive %}
    inverse_scale1: Real,
    inverse_scale2: Real,
{% endif %}
}
var<private> scene: Scene;
{% endif %}

// Reads what steps need from the job.
fn read_job() {
    zero = job.zero;
{% if general %}
    scene.a = from_parts(job.a);
    scene.b = from_parts(job.b);
    scene.p = from_parts(job.p);
    scene.least_det = from_parts(job.least_det);
{% if adaptive %}
    scene.inverse_scale1 = real(job.inverse_scale.x);
    scene.inverse_scale2 = real(job.inverse_scale.y);
{% endif %}
{% endif %}
}

const NO_PIXEL = 0xffffffffu;

// The pendulum at a place of a list, for which the job is read; none beyond the list's end.
fn pixel_at(list: u32, place: u32) -> u32 {
    if place >= atomicLoad(&queue.lengths[list]) {
        return NO_PIXEL;
    }
    read_job();
    return lists[list * job.count + place];
}

{% if counts_passes %}
// Number of passes of the top after which a pendulum is done.
const PASSES = {{ passes }}u;
// Largest number of passes in one step.
const MAX_PASSES = 8u;

// Counts a pass of the top by a bob, and returns true if that was the last one that is wanted.
fn count_pass(pixel: u32, bob: u32, anticlockwise: bool) -> bool {
    outcomes[pixel].passes[2u * bob - select(1u, 2u, anticlockwise)] += 1u;
    let passes = outcomes[pixel].passes;
    return passes[0] + passes[1] + passes[2] + passes[3] >= PASSES;
}

{% endif %}
// Sets the status of a pendulum that has ended. A pendulum that has not ended keeps the status that
// the host set, and the host accepts no answer from it.
fn end(pixel: u32, status: u32) {
    outcomes[pixel].status = (outcomes[pixel].status & ~255u) | status;
}

// Puts a pendulum on a list if `wanted`.
{% if subgroups %}
// One atomic for a whole subgroup: one for each invocation costs as much as ten steps on software
// Vulkan.
fn put_on(list: u32, pixel: u32, wanted: bool) {
    let one = select(0u, 1u, wanted);
    let before = subgroupExclusiveAdd(one);
    let all = subgroupAdd(one);
    var first = 0u;
    if wanted && before == 0u {
        first = atomicAdd(&queue.lengths[list], all);
    }
    let place = subgroupAdd(first) + before;
    if wanted {
        lists[list * job.count + place] = pixel;
    }
}
{% else %}
fn put_on(list: u32, pixel: u32, wanted: bool) {
    if wanted {
        let place = atomicAdd(&queue.lengths[list], 1u);
        lists[list * job.count + place] = pixel;
    }
}
{% endif %}

// Ends a slice of a pendulum: it goes on, is searched for a pass in its next step if that is suspect,
// or is done, because it is over or not sound.
fn end_slice(pixel: u32, sound: bool, over: bool, suspect: bool) {
    if !sound || (over && !suspect) {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(SUSPECTS, pixel, sound && suspect);
    put_on(1u - queue.turn, pixel, sound && !suspect && !over);
}

// Ends the suspect step of a pendulum: it flipped, is over, is not sound, or goes on.
fn end_step(pixel: u32, flipped: bool, sound: bool, over: bool) {
    if flipped {
        end(pixel, ANSWERED);
    } else if !sound || over {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(1u - queue.turn, pixel, !flipped && sound && !over);
}
