// Decides the steps before which `advance` stopped, on the polynomials themselves.

{% for name in ["x", "y", "w"] %}
// The coefficients of `{{ name }}` of the watched bobs.
fn {{ name }}_of(step: Step) -> array<array<Real, TERMS>, 2> {
    var all = array<array<Real, TERMS>, 2>();
{% for bob in watched %}
    all[{{ loop.index0 }}] = array<Real, TERMS>({% for k in range(terms) %}step.{{ name }}{{ bob }}_{{ k }}, {% endfor %});
{% endfor %}
    return all;
}

{% endfor %}
// The search for the passes of the watched bobs in a step.
struct Search {
    x: array<array<Real, TERMS>, 2>,
    bobs: array<Passes, 2>,
    // For each bob the place in the step at which it next passes the top.
    places: array<Real, 2>,
    // Distance from the top that the bobs have kept.
    clearance: f32,
    // True once the motion ends at the next pass.
    flipped: bool,
}

// The search after the next pass of a bob has been found.
fn at_next_pass(before: Search, bob: u32, length: Real) -> Search {
    var search = before;
    var passes = search.bobs[bob];
    var clearance = search.clearance;
    search.places[bob] = next_pass(&passes, search.x[bob], length, &clearance);
    search.bobs[bob] = passes;
    search.clearance = clearance;
    return search;
}

fn search_in(pixel: u32, step: Step) -> Search {
    var search = Search();
    search.x = x_of(step);
    search.places = array<Real, 2>(NOWHERE, NOWHERE);
    search.clearance = outcomes[pixel].clearance;
    let y = y_of(step);
    for (var bob = 0u; bob < {{ bobs }}u; bob++) {
        search.bobs[bob] = passes_from(control_points(y[bob], step.length));
        if {{ is_watched }}true {
            search = at_next_pass(search, bob, step.length);
        }
    }
    search.flipped = first_place(search) <= 1;
    return search;
}

// The place at which a bob first passes the top.
fn first_place(search: Search) -> Real {
    return select(search.places[1], search.places[0], search.places[0] < search.places[1]);
}

{% if counts_passes %}
// Counts the passes of a step from `time` in their order, until the last one that is wanted
// (counterpart: `look` in crates/engine/src/cpu/lane_loop.rs).
fn counted(pixel: u32, time: Real, step: Step, before: Search) -> Search {
    var search = before;
    let speeds = w_of(step);
    let bobs = array<u32, 2>({{ numbers | join(", ") }});
    search.flipped = false;
    while first_place(search) <= 1 {
        let into_step = first_place(search) * step.length;
        let bob = select(1u, 0u, search.places[0] <= search.places[1]);
        // Beyond the pass, the side has changed.
        let anticlockwise = search.bobs[bob].side < 0;
        search.flipped = rough(time + into_step) > job.budget;
        if !search.flipped {
            search.flipped = count_pass(pixel, bobs[bob], anticlockwise);
        }
        if search.flipped {
            break;
        }
        // Height to which the bob would rise beyond the top if its acceleration turned it round.
        let speed = rough(value_at(speeds[bob], into_step));
        let pull = abs(rough(slope_at(speeds[bob], into_step)));
        search.clearance = min(search.clearance, speed * speed / (2.0 * max(pull, 1e-30)));
        search = at_next_pass(search, bob, step.length);
    }
    return search;
}

{% endif %}
@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_at(SUSPECTS, id.x);
    if pixel == NO_PIXEL {
        return;
    }
    let now = state_of(pixel);
    let step = step_from(now, now.h);
    var search = search_in(pixel, step);
{% if counts_passes %}
    search = counted(pixel, now.time, step, search);
{% endif %}
    outcomes[pixel].steps += 1u;
    outcomes[pixel].clearance = search.clearance;
    outcomes[pixel].status += LOOK;
    if search.flipped {
        outcomes[pixel].moment = to_parts(now.time + first_place(search) * step.length);
    } else {
        keep_state(pixel, step.next);
    }
    let sound = outcomes[pixel].steps < job.most_steps && is_sound(step.next);
    end_step(pixel, search.flipped, sound, is_over(step.next.time));
}
