// A tile's pendulums and the extreme of a quantity along their motion (counterpart:
// crates/engine/src/cpu/extremum.rs); all run to the end of the budget, where the last step is cut.
// `advance` stops before a step in which the quantity has an extreme, and `look` finds it.

// Halvings in the search for an extreme: its time to a billionth of a step.
const HALVINGS = 30u;

// Returns true if one value is more extreme than another.
fn is_beyond(value: Real, other: Real) -> bool {
{% if greatest %}
    return is_less(other, value);
{% else %}
    return is_less(value, other);
{% endif %}
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
    var suspect = false;
    while !suspect && steps < stop && rough(now.time) < job.budget {
        let length = length_within(now.h, now.time, zero);
        let step = step_from(now, length);
{% if adaptive %}
        let excess = excess_of(rough(step.error_squared), rough(now.time));
        let accepted = excess < 0;
{% else %}
        let accepted = true;
{% endif %}
        let turns = rough(step.rate) < 0 && rough(step.rate_next) >= 0;
        suspect = accepted && rough(now.counts) > 0 && turns;
        let taken = accepted && !suspect;
        // The quantity turns towards its next extreme.
        let leaves = taken && rough(step.rate) > 0 && rough(step.rate_next) < 0;
        now = chosen(taken, step.next, now);
        now.counts = select(now.counts, real(1.0), leaves);
{% if adaptive %}
        now.h = select(real(next_length(rough(length), excess)), now.h, suspect);
{% endif %}
        steps += select(1u, 0u, suspect);
{% if not adaptive %}
        let time = time_after_steps(begun, steps, now.h);
        now.time = select(now.time, time, taken && length == now.h);
{% endif %}
    }
    keep_state(pixel, now);
    outcomes[pixel].steps = steps;
    let over = rough(now.time) >= job.budget;
    let sound = finite(now.x1) && (over || steps < most_steps);
    end_slice(pixel, sound, over, suspect);
}

// The state after a step of length `whole` in which the quantity has an extreme, which it keeps.
fn after_extreme(now: State, whole: Real) -> State {
    var after = now;
    var low = real(0.0);
    var high = whole;
    // First the whole step, then the halvings, and last the value of the extreme.
    for (var trial = 0u; trial < HALVINGS + 2u; trial++) {
        var length = select(scaled(sum_of(low, high, zero), 0.5), whole, trial == 0u);
        length = select(length, high, trial > HALVINGS);
        let step = step_from(now, length);
        if trial == 0u {
            after = step.next;
{% if adaptive %}
            let excess = excess_of(rough(step.error_squared), rough(now.time));
            after.h = real(next_length(rough(whole), excess));
{% endif %}
        } else if trial <= HALVINGS {
            low = select(low, length, rough(step.rate_next) < 0);
            high = select(length, high, rough(step.rate_next) < 0);
        } else {
            let value = root_of(step.square_next);
            let beyond = is_beyond(value, now.best);
            after.best_time = select(now.best_time, sum_of(now.time, high, zero), beyond);
            after.best = select(now.best, value, beyond);
        }
    }
    return after;
}

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_at(SUSPECTS, id.x);
    if pixel == NO_PIXEL {
        return;
    }
    let now = state_of(pixel);
    let whole = length_within(now.h, now.time, zero);
    var after = after_extreme(now, whole);
{% if not adaptive %}
    let steps = outcomes[pixel].steps;
    let begun = begun_before_steps(now.time, steps, now.h, zero);
    after.time = select(after.time, time_after_steps(begun, steps + 1u, now.h), whole == now.h);
{% endif %}
    keep_state(pixel, after);
    outcomes[pixel].steps += 1u;
    outcomes[pixel].status += (HALVINGS + 2u) * LOOK;
    end_step(pixel, false, true, rough(after.time) >= job.budget);
}
