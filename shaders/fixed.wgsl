// A tile's pendulums in fixed steps, a slice at a time. `advance` takes whole steps and stops
// before one in which the top may be reached; `look` decides those. They are separate because
// software Vulkan runs both sides of every branch, and real devices have registers to save.

// Condition under which a bob with these angles and speeds at both ends of a step may have been at
// the top (counterpart: `flip::may_pass`).
fn may_be_at_top(t: Real, w: Real, t_next: Real, w_next: Real, step: Real) -> bool {
    let far = max(abs(t), abs(t_next));
    let travel = step * max(abs(w), abs(w_next));
    return (abs(t_next) >= PI) || ((w * w_next < 0) && (far + travel >= PI));
}

fn may_pass(now: State, next: State, step: Real) -> bool {
    return false
{% for bob in watched %}
        || ({% if general %}(job.watched & {{ bob }}u) != 0u && {% endif %}may_be_at_top(
            now.t{{ bob }}, now.w{{ bob }}, next.t{{ bob }}, next.w{{ bob }}, step))
{% endfor %}
    ;
}

fn is_sound(now: State) -> bool {
    return finite(now.w1) && finite(now.w2);
}

{% for bob in watched %}
// The angle of bob {{ bob }} beyond the top on one side, over a step between two states (see
// `flip::fraction_of_step`).
fn beyond_top{{ bob }}(now: State, next: State, side: Real, step: Real) -> Quintic {
{% for name in state %}
    let {{ name }} = now.{{ name }};
    let {{ name }}_next = next.{{ name }};
{% endfor %}
{{ maths["bob" ~ bob] }}
    return Quintic(c0, c1, c2, c3, c4, c5);
}

{% endfor %}
// A bob's pass of the top in a step.
struct Pass {
    // The bob, or 0 if none passes.
    bob: u32,
    // The share of the step after which it passes.
    share: Real,
    // The side from which it comes: 1 or -1.
    side: Real,
}

fn first_pass(now: State, next: State, step: Real) -> Pass {
    var first = Pass(0u, Real(-1), Real(0));
{% for bob in watched %}
    let side{{ bob }} = select(Real(1), Real(-1), next.t{{ bob }} < 0);
    let found{{ bob }} = first_rise(beyond_top{{ bob }}(now, next, side{{ bob }}, step));
    if {% if general %}(job.watched & {{ bob }}u) != 0u && {% endif %}found{{ bob }} >= 0 && (first.share < 0 || found{{ bob }} < first.share) {
        first = Pass({{ bob }}u, found{{ bob }}, side{{ bob }});
    }
{% endfor %}
    return first;
}

@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_at(queue.turn, id.x);
    if pixel == NO_PIXEL {
        return;
    }
    let step = from_parts(job.step);
    var now = state_of(pixel);
    var steps = outcomes[pixel].steps;
    let stop = min(steps + job.slice_steps, job.most_steps);
    var suspect = false;
    // The step after a suspicious one or the last one is computed and discarded, so that no step
    // waits for the verdict on the one before it. The state before the last verdict is kept.
    var kept = now;
    var going = true;
    loop {
        kept = chosen(going, now, kept);
        going = going && steps < stop;
        if !going {
            break;
        }
        let next = step_from(now, step).next;
        suspect = may_pass(now, next, step);
        going = !suspect;
        steps += select(0u, 1u, going);
        now = next;
    }
    keep_state(pixel, kept);
    outcomes[pixel].steps = steps;
    let slowed = is_slowed(kept);
    end_slice(pixel, is_sound(kept), steps >= job.most_steps || slowed, suspect && !slowed);
}
