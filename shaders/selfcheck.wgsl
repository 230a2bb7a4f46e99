// Operations with known results, by which the host judges a device.

struct Zero {
    zero: u32,
}

// The operands, in pairs.
@group(0) @binding(0) var<storage, read> operands: array<Real>;
// For each pair: sum, error (of number types other than f32: difference), product, quotient, sine
// and cosine of the first, the first rounded. Pairs of f32 have in place of the last three the
// exact sum and product of their first parts, and the product plus the first.
@group(0) @binding(1) var<storage, read_write> answers: array<Real>;
@group(0) @binding(2) var<storage, read> job: Zero;

@compute @workgroup_size(64)
fn check(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&operands) / 2u {
        return;
    }
    let a = operands[2u * id.x];
    let b = operands[2u * id.x + 1u];
    let zero = job.zero;
{{ maths }}
    let place = 7u * id.x;
    answers[place] = sum;
    answers[place + 1u] = error;
    answers[place + 2u] = product;
    answers[place + 3u] = quotient;
{% if pairs %}
    answers[place + 4u] = two_sum(a.x, b.x, zero);
    answers[place + 5u] = two_product(a.x, b.x, zero);
    answers[place + 6u] = both;
{% else %}
    answers[place + 4u] = sin;
    answers[place + 5u] = cos;
    answers[place + 6u] = round(a);
{% endif %}
}
