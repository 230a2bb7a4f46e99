// Packs what a picture shows of each outcome into {{ words }} words, and adds up the work, when all
// pendulums of a job have ended (counterpart: crates/engine/src/gpu/packing.rs).

{# Counted outcomes are not packed. #}
{% set counts_turns = false %}
{% set counts_passes = false %}
{% include "outcome.wgsl" %}

// The first member of a job's head.
struct Head {
    count: u32,
}

struct Work {
    // All steps, then all looks for a flip, each in two words with the low one first.
    sums: array<atomic<u32>, 4>,
    // Pendulums that have been packed.
    packed: atomic<u32>,
}

{{ statuses }}const WORDS = {{ words }}u;
const WORKGROUP = 64u;
// Upper bits of a word that holds a status instead of a moment; as an f32, such a word is NaN.
const NO_MOMENT = 0xffffff00u;

@group(0) @binding(0) var<storage, read> job: Head;
@group(0) @binding(1) var<storage, read> outcomes: array<Outcome>;
@group(0) @binding(2) var<storage, read_write> words: array<u32>;
@group(0) @binding(3) var<storage, read_write> work: Work;

// The work of this workgroup's pendulums.
var<workgroup> own: Work;

fn add_to_own(sum: u32, amount: u32) {
    let before = atomicAdd(&own.sums[sum], amount);
    if before + amount < before {
        atomicAdd(&own.sums[sum + 1u], 1u);
    }
}

@compute @workgroup_size(WORKGROUP)
fn pack(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) place: u32,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    for (var pixel = id.x; pixel < job.count; pixel += groups.x * WORKGROUP) {
        let outcome = outcomes[pixel];
        let status = outcome.status & 255u;
        let moment = bitcast<vec2<u32>>(outcome.moment);
        words[pixel * WORDS] = select(NO_MOMENT | status, moment.x, status == ANSWERED);
{% if stepped %}
        words[pixel * WORDS + 1u] = outcome.steps;
{% endif %}
{% if has_rest %}
        words[pixel * WORDS + WORDS - 1u] = moment.y;
{% endif %}
        add_to_own(0u, outcome.steps);
        add_to_own(2u, outcome.status >> 8u);
        atomicAdd(&own.packed, 1u);
    }
    workgroupBarrier();
    if place != 0u {
        return;
    }
    for (var sum = 0u; sum < 4u; sum += 2u) {
        let low = atomicLoad(&own.sums[sum]);
        let before = atomicAdd(&work.sums[sum], low);
        let carried = select(0u, 1u, before + low < before);
        atomicAdd(&work.sums[sum + 1u], atomicLoad(&own.sums[sum + 1u]) + carried);
    }
    atomicAdd(&work.packed, atomicLoad(&own.packed));
}
