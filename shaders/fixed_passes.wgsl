// Decides the fixed steps before which `advance` stopped, pass by pass (counterpart: `look_at` in
// crates/engine/src/cpu/fixed.rs): a bob that passes the top goes on from the other side of it.

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
{% include "suspect.wgsl" %}
    let whole = from_parts(job.step);
{% if compensated %}
    let zero = job.zero;
{% endif %}
    let steps = outcomes[pixel].steps + 1u;
    // The interval that is examined: a share of the step, from the last pass to the step's end.
{% for name in state %}
    var {{ name }}_from = {{ name }};
    var {{ name }}_to = {{ name }};
{% endfor %}
    var begun = Real(0);
    var passed = 0u;
    // The side from which each bob last came to the top, and the turns that end in this step.
    var sides = array<Real, 3>();
    var turned = array<Real, 3>();
    var done = false;
    var broken = false;
    for (var examined = 0u; !done; examined++) {
        {
            let step = whole * select(begun, Real(1), examined == 0u);
{{ maths.step }}
            broken = broken || !finite(w1_next) || !finite(w2_next);
{% for name in state %}
            {{ name }}_to = select({{ name }}_to, {{ name }}_next, examined == 0u);
            {{ name }}_from = select({{ name }}_next, {{ name }}, examined == 0u);
{% endfor %}
        }
{% for bob in watched %}
        t{{ bob }}_from = select(t{{ bob }}_from - 2 * turned[{{ bob }}] * PI, -sides[{{ bob }}] * PI, passed == {{ bob }}u);
{% if compensated %}
        t{{ bob }}_low_from = select(t{{ bob }}_low_from - 2 * turned[{{ bob }}] * PI_REST, -sides[{{ bob }}] * PI_REST, passed == {{ bob }}u);
{% endif %}
{% endfor %}
        var share = Real(-1);
        passed = 0u;
{% for name in state %}
        let {{ name }} = {{ name }}_from;
        let {{ name }}_next = {{ name }}_to;
{% endfor %}
        let step = whole * (Real(1) - begun);
{% for bob in watched %}
        {
            let side = select(Real(1), Real(-1), t{{ bob }}_next < 0);
{{ maths["bob" ~ bob] }}
            let found = first_rise(Quintic(c0, c1, c2, c3, c4, c5));
            if found >= 0 && (share < 0 || found < share) {
                share = found;
                passed = {{ bob }}u;
                sides[{{ bob }}] = side;
            }
        }
{% endfor %}
        if passed == 0u || broken || examined == MAX_PASSES {
            broken = broken || passed != 0u;
            break;
        }
        begun += (Real(1) - begun) * share;
        // The step may end beyond the budget.
        if (f32(steps - 1u) + rough(begun)) * job.step.x > job.budget {
            done = true;
            break;
        }
        let anticlockwise = sides[passed] > 0;
        outcomes[pixel].passes[2u * passed - select(1u, 2u, anticlockwise)] += 1u;
        done = passes_of(pixel) >= PASSES;
{% for bob in watched %}
        // The bob goes on from the other side of the top.
        if passed == {{ bob }}u {
            turned[{{ bob }}] += sides[{{ bob }}];
            t{{ bob }}_to -= 2 * sides[{{ bob }}] * PI;
{% if compensated %}
            t{{ bob }}_low_to -= 2 * sides[{{ bob }}] * PI_REST;
{% endif %}
        }
{% endfor %}
    }
    outcomes[pixel].status += LOOK;
    let over = steps >= job.most_steps;
    if broken {
        end(pixel, FAILED);
    } else if done {
        end(pixel, ANSWERED);
        outcomes[pixel].moment = to_parts(begun);
    } else {
{% for name in state %}
        states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_to;
{% endfor %}
        outcomes[pixel].steps = steps;
        if over {
            end(pixel, UNFLIPPED);
        }
    }
    put_on(1u - queue.turn, pixel, !done && !broken && !over);
}
