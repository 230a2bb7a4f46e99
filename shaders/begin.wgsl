// Puts pendulums that are released from rest at their starts, before the first slice. Each is in a
// column and a row of an upright picture: numbers of its first bob are those of the column, numbers
// of its second bob those of the row, and the others are the same for all.

// For each number of the state in turn: a value for every column, for every row, or for all.
@group(2) @binding(0) var<storage, read> axes: array<Real>;
// The column of each start, and its row times the number of columns.
@group(2) @binding(1) var<storage, read> places: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn begin(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    for (var pixel = id.x; pixel < job.count; pixel += groups.x * WORKGROUP) {
        let column = places[pixel] % job.columns;
        let row = places[pixel] / job.columns;
        var first = 0u;
{% for name in state %}
{% if "1" in name %}
        states[{{ loop.index0 }}u * job.count + pixel] = axes[first + column];
        first += job.columns;
{% elif "2" in name %}
        states[{{ loop.index0 }}u * job.count + pixel] = axes[first + row];
        first += job.rows;
{% else %}
        states[{{ loop.index0 }}u * job.count + pixel] = axes[first];
        first += 1u;
{% endif %}
{% endfor %}
        lists[pixel] = pixel;
        outcomes[pixel].status = RUNNING;
        outcomes[pixel].steps = 0u;
        outcomes[pixel].clearance = {{ far }};
{% if counts_turns %}
        outcomes[pixel].turns = 0u;
{% endif %}
{% if counts_passes %}
        outcomes[pixel].passes = array<u32, 4>();
{% endif %}
    }
}
