// A tile's pendulums in adaptive steps (counterpart: crates/engine/src/cpu/lane_loop.rs), on unit
// vectors and momenta. `advance` tries steps and stops before one in which the top may be reached;
// `look` decides those. The quantities that a step is judged by are f32, whatever the number type.

// A bob at one moment: its unit vector and speed.
struct Bob {
    x: f32,
    y: f32,
    w: f32,
}

fn inward(y: f32, begin: f32) -> f32 {
    return select(y, -y, begin < 0);
}

{% if quartic %}
// The control points of the quartic of DOPRI5 (counterpart: `embedded::quartic`).
fn control_points(before: Bob, after: Bob, bow: f32, h: f32) -> array<f32, 5> {
    let rise0 = before.w * before.x * h;
    let rise1 = after.w * after.x * h;
    let whole = after.y - before.y;
    let early = rise0 - whole;
    let late = whole - rise1 - early;
    return array<f32, 5>(
        before.y,
        before.y + 0.25 * (whole + early),
        before.y + 0.5 * whole + early / 3.0 + (late + bow) / 6.0,
        after.y - 0.25 * (whole - early - late),
        after.y,
    );
}

// Distance from the top that a bob keeps over a step; not positive if it may cross the top.
fn clearance_of(before: Bob, after: Bob, bow: f32, h: f32) -> f32 {
    if before.x >= 0 && after.x >= 0 {
        return FAR;
    }
    let points = control_points(before, after, bow, h);
    var least = FAR;
    for (var k = 1; k < 5; k++) {
        least = min(least, inward(points[k], points[0]));
    }
    return least;
}
{% else %}
// The path of a bob over an interval, relative to the top (counterpart: `crossing::approach`).
struct Approach {
    clearance: f32,
    crosses: bool,
}

fn approach(before: Bob, after: Bob, h: f32) -> Approach {
    if before.x >= 0 && after.x >= 0 {
        return Approach(FAR, false);
    }
    let rise0 = before.w * before.x * h;
    let rise1 = after.w * after.x * h;
    let first = before.y + rise0 / 3.0;
    let second = after.y - rise1 / 3.0;
    let chord = (after.y - before.y) / 3.0;
    let bend = max(abs(first - before.y - chord), abs(after.y - second - chord));
    // A start exactly at the top has not crossed it.
    let released = before.y == 0 && first == 0;
    let begin = select(before.y, second, before.y == 0);
    var least = min(inward(second, begin), inward(after.y, begin));
    least = select(min(least, inward(first, begin)), least, released);
    let falls = inward(rise0, begin) < 0 && inward(second - first, begin) < 0
        && inward(rise1, begin) < 0;
    let crosses = falls && inward(after.y, begin) <= 0 && before.y != 0;
    return Approach(least - {{ slack }} * bend, crosses);
}

fn clearance_of(before: Bob, after: Bob, bow: f32, h: f32) -> f32 {
    return approach(before, after, h).clearance;
}
{% endif %}

fn crosses(before: Bob, after: Bob) -> bool {
    return (before.y > 0 && after.y <= 0) || (before.y < 0 && after.y >= 0);
}

// The watched bobs at the beginning of a step and at its end.
fn bobs_before(now: State, step: Step) -> array<Bob, 2> {
    return array<Bob, 2>({{ befores }});
}

fn bobs_after(step: Step) -> array<Bob, 2> {
    return array<Bob, 2>({{ nows }});
}

// Distance from the top that the watched bobs keep over a step.
fn clearance_in_step(now: State, step: Step, h: f32) -> f32 {
    let befores = bobs_before(now, step);
    let nows = bobs_after(step);
    var near = FAR;
{% for bob in watched %}
    {% if general %}if (job.watched & {{ bob }}u) != 0u {{ '{' }}{% endif %}

    near = min(near, clearance_of(befores[{{ loop.index0 }}], nows[{{ loop.index0 }}], {{ bows[loop.index0] }}, h));
    {% if general %}{{ '}' }}{% endif %}

{% endfor %}
    return near;
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
        let h = rough(now.h);
        let step = step_from(now, now.h);
        let excess = excess_of(rough(step.error_squared), rough(now.time));
        let accepted = excess < 0;
        let near = clearance_in_step(now, step, h);
        suspect = accepted && near <= 0;
        let taken = accepted && !suspect;
{% if counts_turns %}
        turns += select(vec2<i32>(0), turns_in_step(now, step.next), taken);
{% endif %}
        now = chosen(taken, step.next, now);
        now.h = real(select(next_length(h, excess), h, suspect));
        clearance = select(clearance, min(clearance, near), taken);
        steps += select(1u, 0u, suspect);
    }
{% if counts_turns %}
    keep_turns(pixel, turns);
{% endif %}
    keep_slice(pixel, now, steps, clearance, suspect);
}
