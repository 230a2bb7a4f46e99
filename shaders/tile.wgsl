// A tile's pendulums, a slice of steps at a time. `advance` takes whole steps and stops before
// one in which the top may be reached; `look` decides those. They are apart because software
// Vulkan runs both sides of every branch, and real devices have registers to save.

{% if lanes | length == 2 %}
// Two pendulums an invocation: the arithmetic of one fills the waiting times of the other.
alias Lanes = vec2<Real>;
alias Counts = vec2<u32>;
alias Flags = vec2<bool>;
{% else %}
// One pendulum an invocation: a real device has others to run in the waiting times.
alias Lanes = Real;
alias Counts = u32;
alias Flags = bool;
{% endif %}

// Puts a pendulum on a list if it is wanted there.
{% if subgroups %}
// One atomic for all of a subgroup: one for each invocation costs as much as ten steps on
// software Vulkan.
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

// Keeps what became of a pendulum in this slice, and passes it on.
fn settle(pixel: u32, steps: u32, sound: bool, suspect: bool, valid: bool) {
    if valid {
        outcomes[pixel].steps = steps;
        if !sound {
            outcomes[pixel].status = FAILED;
        }
    }
    put_on(SUSPECTS, pixel, valid && sound && suspect);
    put_on(1u - queue.turn, pixel, valid && sound && !suspect && steps < job.most_steps);
}

@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let running = atomicLoad(&queue.lengths[queue.turn]);
    let first = id.x * {{ lanes | length }}u;
    if first >= running {
        return;
    }
{% for lane in lanes %}
    let place{{ lane }} = min(first + {{ loop.index0 }}u, running - 1u);
    let pixel{{ lane }} = lists[queue.turn * job.count + place{{ lane }}];
{% endfor %}
{% for name in state %}
{% set part = loop.index0 %}
    var {{ name }} = Lanes({% for lane in lanes %}states[{{ part }}u * job.count + pixel{{ lane }}]{{ ", " if not loop.last }}{% endfor %});
{% endfor %}
    let step = from_parts(job.step);
{% include "general.wgsl" %}
    var steps = Counts({% for lane in lanes %}outcomes[pixel{{ lane }}].steps{{ ", " if not loop.last }}{% endfor %});
    let stop = min(steps + job.slice_steps, Counts(job.most_steps));
    var suspect = Flags(false);
    loop {
        let going = (steps < stop) & !suspect;
        if !any(going) {
            break;
        }
{{ maths.step }}
        suspect = suspect | (going & ({{ may_pass }}));
        let taken = going & !suspect;
{% for name in state %}
        {{ name }} = select({{ name }}, {{ name }}_next, taken);
{% endfor %}
        steps += select(Counts(0u), Counts(1u), taken);
    }
{% for lane in lanes %}
{% set lane_of = "." ~ lane if lanes | length == 2 else "" %}
    let valid{{ lane }} = first + {{ loop.index0 }}u < running;
    if valid{{ lane }} {
{% for name in state %}
        states[{{ loop.index0 }}u * job.count + pixel{{ lane }}] = {{ name }}{{ lane_of }};
{% endfor %}
    }
    let sound{{ lane }} = finite(w1{{ lane_of }}) && finite(w2{{ lane_of }});
    settle(pixel{{ lane }}, steps{{ lane_of }}, sound{{ lane }}, suspect{{ lane_of }}, valid{{ lane }});
{% endfor %}
}

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= atomicLoad(&queue.lengths[SUSPECTS]) {
        return;
    }
    let pixel = lists[SUSPECTS * job.count + id.x];
{% for name in state %}
    let {{ name }} = states[{{ loop.index0 }}u * job.count + pixel];
{% endfor %}
    let step = from_parts(job.step);
{% include "general.wgsl" %}
    let steps = outcomes[pixel].steps + 1u;
{{ maths.one_step }}
    var fraction = Real(-1);
{% for bob in watched %}
    {
        let side = select(Real(1), Real(-1), t{{ bob }}_next < 0);
{{ maths["bob" ~ bob] }}
        let found = first_rise(Quintic(c0, c1, c2, c3, c4, c5));
        if {% if general %}(job.watched & {{ bob }}u) != 0u && {% endif %}found >= 0 && (fraction < 0 || found < fraction) {
            fraction = found;
        }
    }
{% endfor %}
    let looks = (outcomes[pixel].status & ~255u) + LOOK;
    let flipped = fraction >= 0;
    let broken = !finite(w1_next) || !finite(w2_next);
    if flipped {
        outcomes[pixel] = Outcome(looks | FLIPPED, steps - 1u, to_parts(fraction));
    } else {
{% for name in state %}
        states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_next;
{% endfor %}
        outcomes[pixel].status = looks | select(UNFLIPPED, FAILED, broken);
        outcomes[pixel].steps = steps;
    }
    put_on(1u - queue.turn, pixel, !flipped && !broken && steps < job.most_steps);
}
