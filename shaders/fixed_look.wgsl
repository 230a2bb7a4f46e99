// Decides the fixed steps before which `advance` stopped: where the top is reached, the pendulum is
// done.

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_at(SUSPECTS, id.x);
    if pixel == NO_PIXEL {
        return;
    }
    let step = from_parts(job.step);
    let now = state_of(pixel);
    let steps = outcomes[pixel].steps + 1u;
    let next = step_from(now, step).next;
    let first = first_pass(now, next, step);
    outcomes[pixel].status += LOOK;
    let flipped = first.bob != 0u;
    if flipped {
        outcomes[pixel].moment = to_parts(first.share);
    } else {
        keep_state(pixel, next);
        outcomes[pixel].steps = steps;
    }
    end_step(pixel, flipped, is_sound(next), steps >= job.most_steps);
}
