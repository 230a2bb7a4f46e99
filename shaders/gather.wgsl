// A tile's pendulums and what they gather along their way (counterpart:
// crates/engine/src/cpu/gather_loop.rs): all run to the end of the budget, where the last step is cut.
// What is gathered says which steps `look` has to search, and sees every other step.

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
        suspect = accepted && is_suspect(now, step);
        let taken = accepted && !suspect;
        now = gathered(chosen(taken, step.next, now), step, taken);
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
