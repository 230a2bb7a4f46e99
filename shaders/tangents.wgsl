// A tile's pendulums with the tangents of their motion (counterpart:
// crates/engine/src/cpu/tangents.rs): all run to the end of the budget, where the last step is cut.

// Largest slope before all are made smaller by a power of two, so that none overflows.
const LARGE = {{ large }};
const SMALLER = {{ smaller }};
const LOG_LARGE = {{ log_large }};

// A pendulum whose slopes are small again, by a power of two that its logarithm remembers.
fn kept_small(state: State) -> State {
    var now = state;
    var most = 0.0;
{% for name in slopes %}
    most = max(most, abs(rough(now.{{ name }})));
{% endfor %}
    if most > LARGE {
{% for name in slopes %}
        now.{{ name }} = scaled(now.{{ name }}, SMALLER);
{% endfor %}
        now.log_scale = sum_of(now.log_scale, real(LOG_LARGE), zero);
    }
    return now;
}

@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_at(queue.turn, id.x);
    if pixel == NO_PIXEL {
        return;
    }
    var now = state_of(pixel);
    var steps = outcomes[pixel].steps;
    let most_steps = most_steps_to_end();
{% if not adaptive %}
    let begun = begun_before_steps(now.time, steps, now.h, zero);
{% endif %}
    let stop = min(steps + job.slice_steps, most_steps);
    while steps < stop && rough(now.time) < job.budget {
        let length = length_within(now.h, now.time, zero);
        let step = step_from(now, length);
{% if adaptive %}
        let excess = excess_of(rough(step.error_squared), rough(now.time));
        now = chosen(excess < 0, step.next, now);
        now.h = real(next_length(rough(length), excess));
{% else %}
        now = step.next;
{% endif %}
        now = kept_small(now);
        steps += 1u;
{% if not adaptive %}
        now.time = select(now.time, time_after_steps(begun, steps, now.h), length == now.h);
{% endif %}
    }
    keep_state(pixel, now);
    outcomes[pixel].steps = steps;
    let over = rough(now.time) >= job.budget;
    let sound = finite(now.x1) && (over || steps < most_steps);
    end_slice(pixel, sound, over, false);
}

// Does nothing, because no step has to be searched.
@compute @workgroup_size(WORKGROUP)
fn look() {
}
