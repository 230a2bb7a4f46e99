// Decides the fixed steps before which `advance` stopped: where the top is reached, the pendulum is
// done.

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
{% include "suspect.wgsl" %}
    let step = from_parts(job.step);
{% if compensated %}
    let zero = job.zero;
{% endif %}
{% include "general.wgsl" %}
    let steps = outcomes[pixel].steps + 1u;
{{ maths.step }}
    var fraction = Real(-1);
{% for bob in watched %}
    {
        let side = select(Real(1), Real(-1), t{{ bob }}_next < 0);
{{ maths["bob" ~ bob] }}
        let found = first_rise(Quintic(c0, c1, c2, c3, c4, c5));
        if {% if general %}(job.watched & {{ bob }}u) != 0u && {% endif %}found >= 0 && (fraction < 0 || found < fraction) {
            fraction = found;
        }
    }
{% endfor %}
    outcomes[pixel].status += LOOK;
    let flipped = fraction >= 0;
    let broken = !finite(w1_next) || !finite(w2_next);
    let over = steps >= job.most_steps;
    if flipped {
        end(pixel, ANSWERED);
        outcomes[pixel].moment = to_parts(fraction);
    } else {
{% for name in state %}
        states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_next;
{% endfor %}
        outcomes[pixel].steps = steps;
        if broken || over {
            end(pixel, select(UNFLIPPED, FAILED, broken));
        }
    }
    put_on(1u - queue.turn, pixel, !flipped && !broken && !over);
}
