    // Counts the passes of the step in their order, until the last one that is wanted (counterpart:
    // `flips_in_step` in crates/engine/src/cpu/taylor.rs).
    var speeds = array<array<Real, TERMS>, 2>();
{% for bob in watched %}
    speeds[{{ loop.index0 }}] = array<Real, TERMS>({% for k in range(terms) %}w{{ bob }}_{{ k }}, {% endfor %});
{% endfor %}
    let bobs = array<u32, 2>({{ numbers | join(", ") }});
    flipped = false;
    while place <= 1 {
        let bob = select(1u, 0u, places[0] <= places[1]);
        flipped = rough(time + place * length) > job.budget;
        if flipped {
            break;
        }
        var search = searches[bob];
        // Beyond the pass, the side has changed.
        let anticlockwise = search.side < 0;
        outcomes[pixel].passes[2u * bobs[bob] - select(1u, 2u, anticlockwise)] += 1u;
        flipped = passes_of(pixel) >= PASSES;
        if flipped {
            break;
        }
        // Height to which the bob would rise beyond the top if its acceleration turned it round.
        let speed = rough(value_at(speeds[bob], place * length));
        let pull = abs(rough(slope_at(speeds[bob], place * length)));
        clearance = min(clearance, speed * speed / (2.0 * max(pull, 1e-30)));
        places[bob] = next_pass(&search, x[bob], length, &clearance);
        searches[bob] = search;
        place = select(places[1], places[0], places[0] < places[1]);
    }

