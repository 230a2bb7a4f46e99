    // Counts a pass; a pendulum that is not done goes on from there, barely beyond the top
    // (counterpart: `look` in crates/engine/src/cpu/adaptive.rs).
    var flipped = false;
    if goal == TOP && rough(time_after) > job.budget {
        flipped = true;
    } else if goal == TOP {
        let side = begins[passing].y;
        let anticlockwise = select(side > 0, top.w > 0, side == 0);
        let bobs = array<u32, 2>({{ numbers | join(", ") }});
        outcomes[pixel].passes[2u * bobs[passing] - select(1u, 2u, anticlockwise)] += 1u;
        flipped = passes_of(pixel) >= PASSES;
        let beyond = real(select(BARELY, -BARELY, anticlockwise));
{% for bob in watched %}
        if passing == {{ loop.index0 }}u {
            y{{ bob }}_after = beyond;
{% if compensated %}
            y{{ bob }}_low_after = real(0.0);
{% endif %}
        }
{% endfor %}
        // Height to which the bob would rise beyond the top if its acceleration turned it round.
        let pull = abs(ends[passing].w - begins[passing].w) / whole;
        clearance = min(clearance, top.w * top.w / (2.0 * max(pull, 1e-30)));
    }
