// The moment inside a step at which the top is reached. Counterpart:
// crates/numbers/src/polynomial.rs.

// c0 + c1 x + ... + c5 x^5.
struct Quintic {
    c0: Real,
    c1: Real,
    c2: Real,
    c3: Real,
    c4: Real,
    c5: Real,
}

fn value(f: Quintic, x: Real) -> Real {
    return ((((f.c5 * x + f.c4) * x + f.c3) * x + f.c2) * x + f.c1) * x + f.c0;
}

fn derivative(f: Quintic) -> Quintic {
    return Quintic(f.c1, 2 * f.c2, 3 * f.c3, 4 * f.c4, 5 * f.c5, 0);
}

fn negative(f: Quintic) -> Quintic {
    return Quintic(-f.c0, -f.c1, -f.c2, -f.c3, -f.c4, -f.c5);
}

// f from `low` on, in units of `span`.
fn part_of(f: Quintic, low: Real, span: Real) -> Quintic {
    var c = array<Real, 6>(f.c0, f.c1, f.c2, f.c3, f.c4, f.c5);
    for (var first = 0; first < 5; first++) {
        for (var k = 4; k >= first; k--) {
            c[k] += c[k + 1] * low;
        }
    }
    var power = span;
    for (var k = 1; k < 6; k++) {
        c[k] *= power;
        power *= span;
    }
    return Quintic(c[0], c[1], c[2], c[3], c[4], c[5]);
}

// The greatest of f's control points over [0, 1] except the first: f is below it.
fn highest(f: Quintic) -> Real {
    let b1 = f.c0 + f.c1 / 5;
    let b2 = f.c0 + (2 * f.c1) / 5 + f.c2 / 10;
    let b3 = f.c0 + (3 * f.c1) / 5 + (3 * f.c2) / 10 + f.c3 / 10;
    let b4 = f.c0 + (4 * f.c1) / 5 + (3 * f.c2) / 5 + (2 * f.c3) / 5 + f.c4 / 5;
    return max(max(b1, b2), max(max(b3, b4), value(f, Real(1))));
}

// The zero of f, which is negative at 0 and not at 1: Newton steps, kept inside a shrinking bracket
// until they no longer move.
fn only_rise(f: Quintic) -> Real {
    let slope = derivative(f);
    var low = Real(0);
    var high = Real(1);
    var x = Real(0.5);
    for (var i = 0; i < 60; i++) {
        let y = value(f, x);
        if y < 0 {
            low = x;
        } else {
            high = x;
        }
        var next = x - y / value(slope, x);
        if !(next >= low && next <= high) {
            next = Real(0.5) * (low + high);
        }
        if next == x {
            break;
        }
        x = next;
    }
    return x;
}

// The first x in (0, 1] at which f, which begins below zero, rises to it; -1 if nowhere. Decided by
// the control points of ever smaller parts.
fn first_rise(whole: Quintic) -> Real {
    var f = whole;
    if f.c0 >= 0 {
        if f.c1 > 0 {
            return Real(0);
        }
        // Only a start at zero itself can lie above it, because of a rounding.
        f.c0 = Real(0);
    }
    var low = Real(0);
    var span = Real(1);
    for (var parts = 0; parts < 200; parts++) {
        let part = part_of(f, low, span);
        let below = highest(part) < 0;
        let end = value(part, Real(1));
        // The part rises throughout if its slope does not vanish.
        let rises = highest(negative(derivative(part))) < 0 && part.c1 > 0;
        if !below && !rises && span > Real(1e-6) {
            span *= Real(0.5);
            continue;
        }
        if !below && end >= 0 && part.c0 < 0 {
            return low + span * only_rise(part);
        }
        low += span;
        if low >= Real(1) {
            break;
        }
        span = min(Real(2) * span, Real(1) - low);
    }
    return Real(-1);
}
