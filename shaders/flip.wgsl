// Where inside a step the top is reached. Twin: src/physics/polynomial.rs.

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

// The root in [0, upper] of f, negative at 0 and not at upper: Newton's steps kept inside a
// shrinking bracket, until they no longer move.
fn rise_before(f: Quintic, slope: Quintic, upper: Real) -> Real {
    var low = Real(0);
    var high = upper;
    var x = Real(0.5) * upper;
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

// The first x in (0, 1] at which f, negative at 0, rises to zero; -1 if nowhere.
fn first_rise(f: Quintic) -> Real {
    let slope = derivative(f);
    let end_slope = value(slope, Real(1));
    if value(f, Real(1)) >= 0 {
        if end_slope > 0 || f.c0 < 0 {
            return rise_before(f, slope, Real(1));
        }
        return Real(-1);
    }
    if f.c1 <= 0 || end_slope >= 0 {
        return Real(-1);
    }
    let peak = rise_before(negative(slope), negative(derivative(slope)), Real(1));
    if value(f, peak) >= 0 {
        return rise_before(f, slope, peak);
    }
    return Real(-1);
}
