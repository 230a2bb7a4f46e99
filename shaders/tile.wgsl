// A tile's pendulums, a slice of steps at a time. `advance` takes whole steps and stops before
// one in which the top may be reached; `look` decides those. They are apart because software
// Vulkan runs both sides of every branch, and real devices have registers to save.

fn keep_running(pixel: u32) {
    let list = 1u - queue.turn;
    let place = atomicAdd(&queue.running[list], 1u);
    lists[list * job.count + place] = pixel;
}

@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= atomicLoad(&queue.running[queue.turn]) {
        return;
    }
    let pixel = lists[queue.turn * job.count + id.x];
{% for name in state %}
    var {{ name }} = states[{{ loop.index0 }}u * job.count + pixel];
{% endfor %}
    let step = from_parts(job.step);
{% include "general.wgsl" %}
    var steps = outcomes[pixel].steps;
    let stop = min(steps + job.slice_steps, job.most_steps);
    var suspect = false;
    while steps < stop {
{{ maths.step }}
        suspect = {{ may_pass }};
        if suspect {
            break;
        }
{% for name in state %}
        {{ name }} = {{ name }}_next;
{% endfor %}
        steps++;
    }
{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ name }};
{% endfor %}
    outcomes[pixel].steps = steps;
    if !finite(w1) || !finite(w2) {
        outcomes[pixel].status = FAILED;
    } else if suspect {
        lists[2u * job.count + atomicAdd(&queue.suspects, 1u)] = pixel;
    } else if steps < job.most_steps {
        keep_running(pixel);
    }
}

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= atomicLoad(&queue.suspects) {
        return;
    }
    let pixel = lists[2u * job.count + id.x];
{% for name in state %}
    let {{ name }} = states[{{ loop.index0 }}u * job.count + pixel];
{% endfor %}
    let step = from_parts(job.step);
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
    let looks = (outcomes[pixel].status & ~255u) + LOOK;
    if fraction >= 0 {
        outcomes[pixel] = Outcome(looks | FLIPPED, steps - 1u, to_parts(fraction));
        return;
    }
{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_next;
{% endfor %}
    let broken = !finite(w1_next) || !finite(w2_next);
    outcomes[pixel].status = looks | select(UNFLIPPED, FAILED, broken);
    outcomes[pixel].steps = steps;
    if !broken && steps < job.most_steps {
        keep_running(pixel);
    }
}
