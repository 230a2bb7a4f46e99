// A tile's pendulums with the tangents of their motion (counterpart:
// crates/engine/src/cpu/tangents.rs): all run to the end of the budget, where the last step is cut.

// Largest slope before all are made smaller by a power of two, so that none overflows.
const LARGE = {{ large }};
const SMALLER = {{ smaller }};
const LOG_LARGE = {{ log_large }};

@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
{% include "running.wgsl" %}
    let zero = job.zero;
    var steps = outcomes[pixel].steps;
    // The last fixed step may be cut in two by rounding, and f32 rounds long times.
    let most_steps = job.most_steps + 2u + job.most_steps / 256u;
{% if not adaptive %}
    let begun = begun_before_steps(time, steps, h, zero);
{% endif %}
    let stop = min(steps + job.slice_steps, most_steps);
    while steps < stop && rough(time) < job.budget {
        let step = length_within(h, time, zero);
{{ maths.step }}
{% if adaptive %}
        let excess = excess_of(rough(error_squared), rough(time));
        let taken = excess < 0;
        h = real(next_length(rough(step), excess));
{% else %}
        let taken = true;
{% endif %}
{% for name in moving %}
        {{ name }} = select({{ name }}, {{ name }}_next, taken);
{% endfor %}
        var most = 0.0;
{% for name in slopes %}
        most = max(most, abs(rough({{ name }})));
{% endfor %}
        if most > LARGE {
{% for name in slopes %}
            {{ name }} = scaled({{ name }}, SMALLER);
{% endfor %}
            log_scale = sum_of(log_scale, real(LOG_LARGE), zero);
        }
        steps += 1u;
{% if not adaptive %}
        time = select(time, time_after_steps(begun, steps, h), step == h);
{% endif %}
    }
{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ name }};
{% endfor %}
    outcomes[pixel].steps = steps;
    let over = rough(time) >= job.budget;
    let sound = finite(x1) && (over || steps < most_steps);
    if !sound || over {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(1u - queue.turn, pixel, sound && !over);
}

// Does nothing, because no step has to be searched.
@compute @workgroup_size(WORKGROUP)
fn look() {
}
