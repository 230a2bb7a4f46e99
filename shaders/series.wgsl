// A tile's pendulums in Taylor steps (counterpart: crates/engine/src/cpu/taylor.rs), on unit
// vectors and momenta. The expansion gives the length of its step and bounds on where the bobs go:
// `advance` stops before a step in which the top may be reached, and `look` decides it on the
// polynomials.

fn larger(a: Real, b: Real) -> Real {
    return select(b, a, a > b);
}

// The longest step in which no term of the last two orders, whose coefficients have these sizes,
// exceeds the tolerance.
fn length_of(last_but_one: Real, last: Real) -> Real {
    let tolerance = 0.5 * job.start;
    let longest = min(
        (tolerance - log2(max(rough(last_but_one), 1e-37))) / {{ terms - 2 }}.0,
        (tolerance - log2(max(rough(last), 1e-37))) / {{ terms - 1 }}.0,
    );
    return real(min(exp2(clamp(longest, -90.0, 8.0)), {{ longest }}));
}

// Distance from the top that a bob keeps over a step; not positive if it may cross the top, that
// is, if `y` can vanish, `x` can be negative, and the bob ends on the other side or can turn round.
fn clearance_of(lowest: Real, nearest: Real, steady: Real, before: Real, after: Real) -> f32 {
    if lowest >= 0 {
        return FAR;
    }
    let one_way = before * after > Real(1e-37) && steady > 0;
    let ends = rough(-larger(-abs(before), -abs(after)));
    return select(rough(nearest), max(rough(nearest), ends), one_way);
}

// Distance from the top that the watched bobs keep over a step.
fn clearance_in_step(now: State, step: Step) -> f32 {
    var near = FAR;
{% for bob in watched %}
    {% if general %}if (job.watched & {{ bob }}u) != 0u {{ '{' }}{% endif %}

    near = min(near, clearance_of(
        step.lowest{{ bob }}, step.nearest{{ bob }}, step.steady{{ bob }}, now.y{{ bob }}, step.next.y{{ bob }}));
    {% if general %}{{ '}' }}{% endif %}

{% endfor %}
    return near;
}

fn is_sound(now: State) -> bool {
    return finite(now.x1 + now.p1 + now.p2);
}

@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_at(queue.turn, id.x);
    if pixel == NO_PIXEL {
        return;
    }
    var now = state_of(pixel);
    var steps = outcomes[pixel].steps;
    let stop = min(steps + job.slice_steps, job.most_steps);
    let budget = job.budget;
    var clearance = outcomes[pixel].clearance;
    var suspect = false;
{% if counts_turns %}
    var turns = turns_of(pixel);
{% endif %}
    while !suspect && steps < stop && rough(now.time) < budget {
        let step = step_from(now, now.h);
        let near = clearance_in_step(now, step);
        suspect = near <= 0;
{% if counts_turns %}
        turns += turns_in_step(now, step.next);
{% endif %}
        now = chosen(suspect, now, step.next);
        clearance = select(min(clearance, near), clearance, suspect);
        steps += select(1u, 0u, suspect);
        if !is_sound(now) {
            steps = job.most_steps;
        }
    }
{% if counts_turns %}
    keep_turns(pixel, turns);
{% endif %}
    keep_slice(pixel, now, steps, clearance, suspect);
}
