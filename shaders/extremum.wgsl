// The extreme of a quantity along a motion (counterpart: crates/engine/src/cpu/extremum.rs). `advance`
// stops before a step in which the quantity has one, and `look` finds it.

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

// Returns true if the quantity has an extreme in a step.
fn is_suspect(now: State, step: Step) -> bool {
    return rough(now.counts) > 0 && rough(step.rate) < 0 && rough(step.rate_next) >= 0;
}

// The state after a step: extremes count once the quantity has turned the other way.
fn gathered(after: State, step: Step, taken: bool) -> State {
    var now = after;
    let leaves = taken && rough(step.rate) > 0 && rough(step.rate_next) < 0;
    now.counts = select(now.counts, real(1.0), leaves);
    return now;
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
