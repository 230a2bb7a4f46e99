{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ name }};
{% endfor %}
    outcomes[pixel].steps = steps;
    outcomes[pixel].clearance = clearance;
{% if counts_turns %}
    outcomes[pixel].turns = bitcast<u32>(insertBits(turns.x, turns.y, 16u, 16u));
{% endif %}
    let sound = steps < job.most_steps;
{% if least_energy %}
{{ maths.energy }}
    // Too little energy is left ever to pass the top (see crates/engine/src/slowed.rs).
    let slowed = rough(energy) < {{ least_energy }};
    suspect = suspect && !slowed;
{% endif %}
    let over = !(rough(time) < budget){% if least_energy %} || slowed{% endif %};
    if !sound || (over && !suspect) {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(SUSPECTS, pixel, sound && suspect);
    put_on(1u - queue.turn, pixel, sound && !suspect && !over);

