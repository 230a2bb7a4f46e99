// Before each slice: the list written last is read next, and the dispatch is made to fit it.
// A group of its own, because a buffer of dispatch sizes cannot be bound while it is used.

@group(1) @binding(0) var<storage, read_write> dispatch_size: array<u32, 3>;

@compute @workgroup_size(1)
fn turn() {
    let written = 1u - queue.turn;
    queue.turn = written;
    atomicStore(&queue.lengths[1u - written], 0u);
    atomicStore(&queue.lengths[SUSPECTS], 0u);
    // Enough for `look`, which takes one pendulum an invocation; `advance` may leave some idle.
    let groups = (atomicLoad(&queue.lengths[written]) + WORKGROUP - 1u) / WORKGROUP;
    dispatch_size = array<u32, 3>(groups, 1u, 1u);
}
