    // The pendulum that runs in this invocation, and its state.
    if id.x >= atomicLoad(&queue.lengths[queue.turn]) {
        return;
    }
    let pixel = lists[queue.turn * job.count + id.x];
{% for name in state %}
    var {{ name }} = states[{{ loop.index0 }}u * job.count + pixel];
{% endfor %}
