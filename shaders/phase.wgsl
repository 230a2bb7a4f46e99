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
// Ends a slice of a pendulum after so many steps; `is_suspect` if the next one may reach the top.
fn end_slice(pixel: u32, now: State, steps: u32, clearance: f32, is_suspect: bool) {
    keep_state(pixel, now);
    outcomes[pixel].steps = steps;
    outcomes[pixel].clearance = clearance;
    let sound = steps < job.most_steps;
    var suspect = is_suspect;
    var over = !(rough(now.time) < job.budget);
{% if least_energy %}
    let slowed = is_slowed(now);
    suspect = suspect && !slowed;
    over = over || slowed;
{% endif %}
    if !sound || (over && !suspect) {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(SUSPECTS, pixel, sound && suspect);
    put_on(1u - queue.turn, pixel, sound && !suspect && !over);
}

// Ends the step of a pendulum that was searched for passes of the top, in which it flipped or reached
// a time; `sound` is false if it can go on no further.
fn end_step(pixel: u32, flipped: bool, sound: bool, time: Real) {
    let over = !sound || !(rough(time) < job.budget);
    if flipped {
        end(pixel, ANSWERED);
    } else if over {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(1u - queue.turn, pixel, !flipped && !over);
}
