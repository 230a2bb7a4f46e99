// Number of turns (-1, 0 or 1) that a bob completes between two places. It passes the top where the
// change of sign of its y matches the sense in which it turns (counterpart: `cpu/turns.rs`).
fn turns_between(x0: f32, y0: f32, x1: f32, y1: f32) -> i32 {
    let falls = select(0, 1, y1 < 0) - select(0, 1, y0 < 0);
    return select(0, falls, f32(falls) * (x0 * y1 - y0 * x1) > 0);
}

