// From a start to the state that a pendulum's integration begins with: at rest.

@compute @workgroup_size(WORKGROUP)
fn begin(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.x;
    if pixel >= job.count {
        return;
    }
    let start = starts[pixel];
{% for value in begin %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ value }};
{% endfor %}
    outcomes[pixel] = Outcome(UNFLIPPED, 0u, vec2<f32>(0.0, 0.0));
    lists[pixel] = pixel;
}
