// Before each slice, the list written last becomes the one to read, and the dispatch is made to fit
// it. The size has a bind group of its own, because a buffer of dispatch sizes cannot be bound
// while it is used.

@group(1) @binding(0) var<storage, read_write> dispatch_size: array<u32, 3>;

@compute @workgroup_size(1)
fn turn() {
    let written = 1u - queue.turn;
    queue.turn = written;
    atomicStore(&queue.lengths[1u - written], 0u);
    atomicStore(&queue.lengths[SUSPECTS], 0u);
    // Enough for `advance`, one pendulum per invocation; `look` has fewer and leaves some idle.
    let groups = (atomicLoad(&queue.lengths[written]) + WORKGROUP - 1u) / WORKGROUP;
    dispatch_size = array<u32, 3>(groups, 1u, 1u);
}
