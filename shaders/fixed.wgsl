// A tile's pendulums in fixed steps, a slice at a time. `advance` takes whole steps and stops
// before one in which the top may be reached; `look` decides those. They are separate because
// software Vulkan runs both sides of every branch, and real devices have registers to save.

@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
{% include "running.wgsl" %}
    let step = from_parts(job.step);
{% if compensated %}
    let zero = job.zero;
{% endif %}
{% include "general.wgsl" %}
    var steps = outcomes[pixel].steps;
    let stop = min(steps + job.slice_steps, job.most_steps);
    var suspect = false;
    // The step after a suspicious one or the last one is computed and discarded, so that no step
    // waits for the verdict on the one before it. The state before the last verdict is kept.
{% for name in state %}
    var {{ name }}_kept = {{ name }};
{% endfor %}
    var going = true;
    loop {
{% for name in state %}
        {{ name }}_kept = select({{ name }}_kept, {{ name }}, going);
{% endfor %}
        going = going && steps < stop;
        if !going {
            break;
        }
{{ maths.step }}
        suspect = {{ may_pass }};
        going = !suspect;
        steps += select(0u, 1u, going);
{% for name in state %}
        {{ name }} = {{ name }}_next;
{% endfor %}
    }
{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_kept;
{% endfor %}
    outcomes[pixel].steps = steps;
    let sound = finite(w1_kept) && finite(w2_kept);
{% if least_energy %}
{{ maths.energy }}
    // Too little energy is left ever to pass the top (see crates/engine/src/slowed.rs).
    let slowed = rough(energy) < {{ least_energy }};
    suspect = suspect && !slowed;
{% endif %}
    let over = steps >= job.most_steps{% if least_energy %} || slowed{% endif %};
    if !sound || (over && !suspect) {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(SUSPECTS, pixel, sound && suspect);
    put_on(1u - queue.turn, pixel, sound && !suspect && !over);
}
