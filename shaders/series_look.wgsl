// Decides the steps before which `advance` stopped, on the polynomials themselves.
@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
{% include "suspect.wgsl" %}
{% include "general.wgsl" %}
{{ maths.step }}
    var x = array<array<Real, TERMS>, 2>();
    var searches = array<Passes, 2>();
{% for bob in watched %}
    x[{{ loop.index0 }}] = array<Real, TERMS>({% for k in range(terms) %}x{{ bob }}_{{ k }}, {% endfor %});
    searches[{{ loop.index0 }}] = passes_from(control_points(
        array<Real, TERMS>({% for k in range(terms) %}y{{ bob }}_{{ k }}, {% endfor %}), length));
{% endfor %}
    var clearance = outcomes[pixel].clearance;
    // For each watched bob the place in the step at which it next passes the top.
    var places = array<Real, 2>(NOWHERE, NOWHERE);
    for (var bob = 0u; bob < {{ bobs }}u; bob++) {
        if {{ is_watched }}true {
            var search = searches[bob];
            places[bob] = next_pass(&search, x[bob], length, &clearance);
            searches[bob] = search;
        }
    }
    var place = select(places[1], places[0], places[0] < places[1]);
    var flipped = place <= 1;
{% if counts_passes %}
{% include "series_passes.wgsl" %}
{% endif %}
    outcomes[pixel].steps += 1u;
    outcomes[pixel].clearance = clearance;
    outcomes[pixel].status += LOOK;
    if flipped {
        outcomes[pixel].moment = to_parts(time + place * length);
    } else {
{% for name in state %}
{% if name in moving %}
        states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_next;
{% endif %}
{% endfor %}
    }
    let sound = outcomes[pixel].steps < job.most_steps && finite(x1_next + p1_next + p2_next);
    let over = !sound || !(rough(time_next) < job.budget);
    if flipped {
        end(pixel, ANSWERED);
    } else if over {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(1u - queue.turn, pixel, !flipped && !over);
}

