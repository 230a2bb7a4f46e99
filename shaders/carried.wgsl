// Number of steps after which a pendulum is stopped. The last fixed step may be cut in two by
// rounding, and f32 rounds long times.
fn most_steps_to_end() -> u32 {
    return job.most_steps + 2u + job.most_steps / 256u;
}

// The few operations outside the printed maths on numbers that pendulums carry along, which may be
// pairs of f32.

{% if pairs %}
// The length `h`, or the time left in the budget if that is less.
fn length_within(h: Real, time: Real, zero: u32) -> Real {
    return real(min(h.x, rough(subtract(real(job.budget), time, zero))));
}

fn sum_of(a: Real, b: Real, zero: u32) -> Real {
    return add(a, b, zero);
}

// A number times a power of two.
fn scaled(x: Real, by: f32) -> Real {
    return x * by;
}

// The square root, to the precision of f32.
fn root_of(x: Real) -> Real {
    return real(sqrt(max(x.x, 0.0)));
}

fn finite(x: Real) -> bool {
    return (bitcast<u32>(x.x) & 0x7f800000u) != 0x7f800000u;
}

fn is_less(a: Real, b: Real) -> bool {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}
{% else %}
// The length `h`, or the time left in the budget if that is less.
fn length_within(h: Real, time: Real, zero: u32) -> Real {
    return min(h, real(job.budget) - time);
}

fn sum_of(a: Real, b: Real, zero: u32) -> Real {
    return a + b;
}

// A number times a power of two.
fn scaled(x: Real, by: f32) -> Real {
    return x * real(by);
}

fn root_of(x: Real) -> Real {
    return sqrt(x);
}

fn is_less(a: Real, b: Real) -> bool {
    return a < b;
}

{% if doubles %}
// A rounded value that no optimiser sees through.
fn guard(x: Real, zero: u32) -> Real {
    return x + f64(zero);
}

{% endif %}
{% if not adaptive %}
// The time after `steps` whole steps from `begun`: a product, because the sum of so many steps would
// drift.
fn time_after_steps(begun: Real, steps: u32, h: Real) -> Real {
    return begun + real(f32(steps)) * h;
}

// The time at which the steps began that `time_after_steps` counts, so that times do not depend on
// where a slice ends. The product is guarded, because drivers fuse it with the difference.
fn begun_before_steps(time: Real, steps: u32, h: Real, zero: u32) -> Real {
    return time - guard(real(f32(steps)) * h, zero);
}
{% endif %}
{% endif %}
