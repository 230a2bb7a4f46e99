    // The suspected pendulum of this invocation, and its state.
    if id.x >= atomicLoad(&queue.lengths[SUSPECTS]) {
        return;
    }
    let pixel = lists[SUSPECTS * job.count + id.x];
{% for name in state %}
    let {{ name }} = states[{{ loop.index0 }}u * job.count + pixel];
{% endfor %}
