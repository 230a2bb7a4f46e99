// A tile's pendulums and the extreme of a quantity along their motion (counterpart:
// crates/engine/src/cpu/extremum.rs); all run to the end of the budget, where the last step is cut.
// `advance` stops before a step in which the quantity has an extreme, and `look` finds it.

// Halvings in the search for an extreme: its time to a billionth of a step.
const HALVINGS = 30u;

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
    var suspect = false;
    while !suspect && steps < stop && rough(time) < job.budget {
        let step = length_within(h, time, zero);
{{ maths.step }}
{% if adaptive %}
        let excess = excess_of(rough(error_squared), rough(time));
        let accepted = excess < 0;
{% else %}
        let accepted = true;
{% endif %}
        let turns = rough(rate) < 0 && rough(rate_next) >= 0;
        suspect = accepted && rough(counts) > 0 && turns;
        let taken = accepted && !suspect;
        // The quantity turns towards its next extreme.
        let leaves = taken && rough(rate) > 0 && rough(rate_next) < 0;
        counts = select(counts, real(1.0), leaves);
{% for name in moving %}
        {{ name }} = select({{ name }}, {{ name }}_next, taken);
{% endfor %}
{% if adaptive %}
        h = select(real(next_length(rough(step), excess)), h, suspect);
{% endif %}
        steps += select(1u, 0u, suspect);
{% if not adaptive %}
        time = select(time, time_after_steps(begun, steps, h), taken && step == h);
{% endif %}
    }
{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ name }};
{% endfor %}
    outcomes[pixel].steps = steps;
    let over = rough(time) >= job.budget;
    let sound = finite(x1) && (over || steps < most_steps);
    if !sound || (over && !suspect) {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(SUSPECTS, pixel, sound && suspect);
    put_on(1u - queue.turn, pixel, sound && !suspect && !over);
}

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
{% include "suspect.wgsl" %}
    let zero = job.zero;
    let whole = length_within(h, time, zero);
    // The state at the end of the whole step.
{% for name in state %}
    var {{ name }}_after = {{ name }};
{% endfor %}
    var low = real(0.0);
    var high = whole;
    // First the whole step, then the halvings, and last the value of the extreme.
    for (var trial = 0u; trial < HALVINGS + 2u; trial++) {
        var length = select(scaled(sum_of(low, high, zero), 0.5), whole, trial == 0u);
        length = select(length, high, trial > HALVINGS);
        let step = length;
{{ maths.step }}
        if trial == 0u {
{% for name in moving %}
            {{ name }}_after = {{ name }}_next;
{% endfor %}
{% if adaptive %}
            h_after = real(next_length(rough(whole), excess_of(rough(error_squared), rough(time))));
{% endif %}
        } else if trial <= HALVINGS {
            low = select(low, step, rough(rate_next) < 0);
            high = select(step, high, rough(rate_next) < 0);
        } else {
            let value = root_of(square_next);
{% if greatest %}
            let is_beyond = is_less(best, value);
{% else %}
            let is_beyond = is_less(value, best);
{% endif %}
            best_time_after = select(best_time, sum_of(time, high, zero), is_beyond);
            best_after = select(best, value, is_beyond);
        }
    }
{% if not adaptive %}
    let steps = outcomes[pixel].steps;
    let begun = begun_before_steps(time, steps, h, zero);
    time_after = select(time_after, time_after_steps(begun, steps + 1u, h), whole == h);
{% endif %}
{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_after;
{% endfor %}
    outcomes[pixel].steps += 1u;
    outcomes[pixel].status += (HALVINGS + 2u) * LOOK;
    let over = !(rough(time_after) < job.budget);
    if over {
        end(pixel, UNFLIPPED);
    }
    put_on(1u - queue.turn, pixel, !over);
}
