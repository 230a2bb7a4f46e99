// The number type of two f32: the sum of its parts, 48 bits (Joldes, Muller and Popescu 2017).
// Unless every rounding that matters is protected, each driver tested folds error terms to zero.

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

// `rounded` is a sum that no optimiser sees through; `plus` is a sum from which its error is
// computed.
{% if guards_results %}
fn guard(x: f32, zero: u32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ zero);
}

fn rounded(a: f32, b: f32, zero: u32) -> f32 {
    return guard(a + b, zero);
}

fn plus(a: f32, b: f32, zero: u32) -> f32 {
{% if guards_all %}
    return guard(a + b, zero);
{% else %}
    return a + b;
{% endif %}
}
{% else %}
// The number 1, which only the host knows to be 1.
fn one(zero: u32) -> f32 {
    return bitcast<f32>(zero | 0x3f800000u);
}

fn rounded(a: f32, b: f32, zero: u32) -> f32 {
    return fma(a, one(zero), b);
}

fn plus(a: f32, b: f32, zero: u32) -> f32 {
    return rounded(a, b, zero);
}
{% endif %}

// The sum and its error; |a| >= |b|.
fn fast_two_sum(a: f32, b: f32, zero: u32) -> Real {
    let sum = rounded(a, b, zero);
    return Real(sum, plus(b, -plus(sum, -a, zero), zero));
}

fn two_sum(a: f32, b: f32, zero: u32) -> Real {
    let sum = rounded(a, b, zero);
    let part = rounded(sum, -a, zero);
    return Real(sum, plus(a, -plus(sum, -part, zero), zero) + plus(b, -part, zero));
}

{% if fused %}
fn two_product(a: f32, b: f32, zero: u32) -> Real {
    let product = a * b;
    return Real(product, fma(a, b, -product));
}
{% else %}
// The product splits its factors by masking (Dekker 1971), for devices whose multiply-adds are not
// fused, or are folded. Products of halves are exact, so it does not matter whether they are fused.
fn upper(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

fn two_product(a: f32, b: f32, zero: u32) -> Real {
    let ah = upper(a);
    let bh = upper(b);
    let al = plus(a, -ah, zero);
    let bl = plus(b, -bh, zero);
{% if guards_results %}
    let product = guard(a * b, zero);
{% else %}
    let product = a * b;
{% endif %}
    let first = plus(ah * bh, -product, zero);
    let second = plus(ah * bl, first, zero);
    let third = plus(al * bh, second, zero);
    return Real(product, plus(al * bl, third, zero));
}
{% endif %}

fn add(a: Real, b: Real, zero: u32) -> Real {
    let sum = two_sum(a.x, b.x, zero);
    let low = two_sum(a.y, b.y, zero);
    let first = fast_two_sum(sum.x, sum.y + low.x, zero);
    return fast_two_sum(first.x, first.y + low.y, zero);
}

fn subtract(a: Real, b: Real, zero: u32) -> Real {
    return add(a, -b, zero);
}

fn multiply(a: Real, b: Real, zero: u32) -> Real {
    let product = two_product(a.x, b.x, zero);
    return fast_two_sum(product.x, product.y + (a.x * b.y + a.y * b.x), zero);
}

// a b + c. The second part may be larger than the rounding of the first and, if terms cancel,
// larger than the first itself. Sums of products are made of such values, and `normal` finishes
// them before any other use (Ogita, Rump and Oishi 2005).
fn multiply_add(a: Real, b: Real, c: Real, zero: u32) -> Real {
    let product = two_product(a.x, b.x, zero);
    let sum = two_sum(c.x, product.x, zero);
    return Real(sum.x, (sum.y + product.y) + (c.y + (a.x * b.y + a.y * b.x)));
}

// Renormalises a sum of products. If its second part is larger than the first, the rounding error
// is lost, which is as small as the errors that the sum already has.
fn normal(x: Real, zero: u32) -> Real {
    return fast_two_sum(x.x, x.y, zero);
}

fn divide(a: Real, b: Real, zero: u32) -> Real {
    let first = a.x / b.x;
    let back = two_product(first, b.x, zero);
    let rest = ((plus(a.x, -back.x, zero) - back.y) + a.y) - first * b.y;
    return fast_two_sum(first, rest / b.x, zero);
}
