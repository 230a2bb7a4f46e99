// The number type f32. The operators are the language's own.

alias Real = f32;

const PI = 3.14159274f;
// The remainder of π beyond PI.
const PI_REST = -8.74227766e-8f;

fn real(x: f32) -> Real {
    return x;
}

fn rough(x: Real) -> f32 {
    return x;
}

fn from_parts(parts: vec2<f32>) -> Real {
    return parts.x + parts.y;
}

fn to_parts(x: Real) -> vec2<f32> {
    return vec2<f32>(x, 0.0);
}

fn finite(x: Real) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// A rounded value that no optimiser sees through. Without it, every driver tested folds the error
// terms of two-sums to zero; a constant in place of the zero from a buffer is folded too.
fn guard(x: Real, zero: u32) -> Real {
    return bitcast<f32>(bitcast<u32>(x) ^ zero);
}
