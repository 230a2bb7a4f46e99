// Slices of steps on unit vectors and momenta, whatever chooses the length of a step.

// Clearance of a bob that is below its pivot.
const FAR = {{ far }};

{% if counts_turns %}
// Number of turns (-1, 0 or 1) that a bob completes between two places. It passes the top where the
// change of sign of its y matches the sense in which it turns (counterpart: `cpu/turns.rs`).
fn turns_between(x0: f32, y0: f32, x1: f32, y1: f32) -> i32 {
    let falls = select(0, 1, y1 < 0) - select(0, 1, y0 < 0);
    return select(0, falls, f32(falls) * (x0 * y1 - y0 * x1) > 0);
}

fn turns_in_step(now: State, next: State) -> vec2<i32> {
    return vec2<i32>(
        turns_between(rough(now.x1), rough(now.y1), rough(next.x1), rough(next.y1)),
        turns_between(rough(now.x2), rough(now.y2), rough(next.x2), rough(next.y2)),
    );
}

// The whole turns of a pendulum so far.
fn turns_of(pixel: u32) -> vec2<i32> {
    let turns = bitcast<i32>(outcomes[pixel].turns);
    return vec2<i32>(extractBits(turns, 0u, 16u), extractBits(turns, 16u, 16u));
}

fn keep_turns(pixel: u32, turns: vec2<i32>) {
    outcomes[pixel].turns = bitcast<u32>(insertBits(turns.x, turns.y, 16u, 16u));
}

{% endif %}
// Returns true if the budget ends before a time.
fn is_over(time: Real) -> bool {
    return !(rough(time) < job.budget);
}

// Keeps a pendulum after a slice of steps; `suspect` if the next one may reach the top.
fn keep_slice(pixel: u32, now: State, steps: u32, clearance: f32, suspect: bool) {
    keep_state(pixel, now);
    outcomes[pixel].steps = steps;
    outcomes[pixel].clearance = clearance;
    let slowed = is_slowed(now);
    end_slice(pixel, steps < job.most_steps, is_over(now.time) || slowed, suspect && !slowed);
}
