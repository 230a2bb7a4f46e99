// A tile's pendulums in Taylor steps (counterpart: crates/engine/src/cpu/taylor.rs), on unit
// vectors and momenta. The expansion gives the length of its step and bounds on where the bobs go:
// `advance` stops before a step in which the top may be reached, and `look` decides it on the
// polynomials.

// Clearance of a bob that is below its pivot.
const FAR = {{ far }};

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

{% if counts_turns %}
{% include "turns.wgsl" %}
{% endif %}
@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
{% include "running.wgsl" %}
{% include "general.wgsl" %}
{% include "slice.wgsl" %}
    while !suspect && steps < stop && rough(time) < budget {
{{ maths.step }}
        var near = FAR;
{% for bob in watched %}
        {% if general %}if (job.watched & {{ bob }}u) != 0u {{ '{' }}{% endif %}

        near = min(near, clearance_of(
            lowest{{ bob }}, nearest{{ bob }}, steady{{ bob }}, y{{ bob }}, y{{ bob }}_next));
        {% if general %}{{ '}' }}{% endif %}

{% endfor %}
        suspect = near <= 0;
{% if counts_turns %}
        turns += vec2<i32>(
            turns_between(rough(x1), rough(y1), rough(x1_next), rough(y1_next)),
            turns_between(rough(x2), rough(y2), rough(x2_next), rough(y2_next)),
        );
{% endif %}
{% for name in moving %}
        {{ name }} = select({{ name }}_next, {{ name }}, suspect);
{% endfor %}
        clearance = select(min(clearance, near), clearance, suspect);
        steps += select(1u, 0u, suspect);
        if !finite(x1 + p1 + p2) {
            steps = job.most_steps;
        }
    }
{% include "stop.wgsl" %}
}

