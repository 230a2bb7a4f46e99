// Decides the fixed steps before which `advance` stopped, pass by pass (counterpart: `look_at` in
// crates/engine/src/cpu/fixed.rs): a bob that passes the top goes on from the other side of it.

// The state from which the step goes on after a pass: its angles count from this side of the top.
fn after_passes(state: State, turned: array<Real, 3>, last: Pass) -> State {
    var now = state;
{% for bob in watched %}
    now.t{{ bob }} = select(now.t{{ bob }} - 2 * turned[{{ bob }}] * PI, -last.side * PI, last.bob == {{ bob }}u);
{% if compensated %}
    now.t{{ bob }}_low = select(now.t{{ bob }}_low - 2 * turned[{{ bob }}] * PI_REST, -last.side * PI_REST, last.bob == {{ bob }}u);
{% endif %}
{% endfor %}
    return now;
}

// The state at the end of a step, on the other side of the top for the bob that has passed it.
fn on_other_side(end: State, last: Pass) -> State {
    var to = end;
{% for bob in watched %}
    if last.bob == {{ bob }}u {
        to.t{{ bob }} -= 2 * last.side * PI;
{% if compensated %}
        to.t{{ bob }}_low -= 2 * last.side * PI_REST;
{% endif %}
    }
{% endfor %}
    return to;
}

// The passes of a step.
struct Passes {
    // The state after the step.
    end: State,
    // The share of the step up to the last pass.
    share: Real,
    // True if a pass was the last one that is wanted, or came after the budget.
    done: bool,
    // True if the step has no sound end.
    broken: bool,
}

// Counts the passes of a step one after another.
fn passes_in_step(pixel: u32, now: State) -> Passes {
    let whole = from_parts(job.step);
    var last = Pass(0u, Real(0), Real(0));
    // The turns of each bob that end in this step.
    var turned = array<Real, 3>();
    var all = Passes(now, Real(0), false, false);
    for (var examined = 0u; !all.done; examined++) {
        let first = examined == 0u;
        let next = step_from(now, whole * select(all.share, Real(1), first)).next;
        all.broken = all.broken || !is_sound(next);
        all.end = chosen(first, next, all.end);
        let start = after_passes(chosen(first, now, next), turned, last);
        last = first_pass(start, all.end, whole * (Real(1) - all.share));
        if last.bob == 0u || all.broken || examined == MAX_PASSES {
            all.broken = all.broken || last.bob != 0u;
            break;
        }
        all.share += (Real(1) - all.share) * last.share;
        // The step may end beyond the budget.
        if (f32(outcomes[pixel].steps) + rough(all.share)) * job.step.x > job.budget {
            all.done = true;
            break;
        }
        all.done = count_pass(pixel, last.bob, last.side > 0);
        turned[last.bob] += last.side;
        all.end = on_other_side(all.end, last);
    }
    return all;
}

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_at(SUSPECTS, id.x);
    if pixel == NO_PIXEL {
        return;
    }
    let all = passes_in_step(pixel, state_of(pixel));
    let steps = outcomes[pixel].steps + 1u;
    outcomes[pixel].status += LOOK;
    let flipped = all.done && !all.broken;
    if flipped {
        outcomes[pixel].moment = to_parts(all.share);
    } else {
        keep_state(pixel, all.end);
        outcomes[pixel].steps = steps;
    }
    end_step(pixel, flipped, !all.broken, steps >= job.most_steps);
}
