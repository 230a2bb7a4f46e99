// The number type of two f32: the sum of its parts, 48 bits (Joldes, Muller and Popescu 2017).
// Every rounding goes through `guard`: without it every driver seen folds error terms to zero.
// The exact product splits its factors by masking (Dekker 1971), because fused multiply-adds
// are folded as well.

alias Real = vec2<f32>;

fn real(x: f32) -> Real {
    return Real(x, 0.0);
}

fn rough(x: Real) -> f32 {
    return x.x;
}

fn from_parts(parts: vec2<f32>) -> Real {
    return parts;
}

fn to_parts(x: Real) -> vec2<f32> {
    return x;
}

fn guard(x: f32, zero: u32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ zero);
}

// The sum and its error; |a| >= |b|.
fn fast_two_sum(a: f32, b: f32, zero: u32) -> Real {
    let sum = guard(a + b, zero);
    return Real(sum, b - guard(sum - a, zero));
}

fn two_sum(a: f32, b: f32, zero: u32) -> Real {
    let sum = guard(a + b, zero);
    let part = guard(sum - a, zero);
    return Real(sum, guard(a - guard(sum - part, zero), zero) + guard(b - part, zero));
}

fn upper(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

fn two_product(a: f32, b: f32, zero: u32) -> Real {
    let ah = upper(a);
    let bh = upper(b);
    let al = guard(a - ah, zero);
    let bl = guard(b - bh, zero);
    let product = guard(a * b, zero);
    let first = guard(guard(ah * bh, zero) - product, zero);
    let second = guard(first + guard(ah * bl, zero), zero);
    let third = guard(second + guard(al * bh, zero), zero);
    return Real(product, guard(third + guard(al * bl, zero), zero));
}

fn add(a: Real, b: Real, zero: u32) -> Real {
    let sum = two_sum(a.x, b.x, zero);
    let low = two_sum(a.y, b.y, zero);
    let first = fast_two_sum(sum.x, guard(sum.y + low.x, zero), zero);
    return fast_two_sum(first.x, guard(first.y + low.y, zero), zero);
}

fn subtract(a: Real, b: Real, zero: u32) -> Real {
    return add(a, -b, zero);
}

fn multiply(a: Real, b: Real, zero: u32) -> Real {
    let product = two_product(a.x, b.x, zero);
    let cross = guard(guard(a.x * b.y, zero) + guard(a.y * b.x, zero), zero);
    return fast_two_sum(product.x, guard(product.y + cross, zero), zero);
}

fn divide(a: Real, b: Real, zero: u32) -> Real {
    let first = guard(a.x / b.x, zero);
    let rest = subtract(a, multiply(b, real(first), zero), zero);
    let second = guard(rest.x / b.x, zero);
    let last = subtract(rest, multiply(b, real(second), zero), zero);
    let third = guard(last.x / b.x, zero);
    return add(fast_two_sum(first, second, zero), real(third), zero);
}
