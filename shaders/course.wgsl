// The zeros of a polynomial over a step (counterpart: crates/numbers/src/polynomial.rs). The
// polynomial is given by its control points over [0, 1]: it begins at the first, ends at the last,
// and lies between the least and the greatest.

const TERMS = {{ terms }};
// Smallest part of a step that is cut any further: a shorter pass cannot be told from none.
const MIN_PART = 1.5e-8;
// Largest number of parts that are examined for one change of sign.
const MAX_PARTS = 400;
// Stands for no place in a step; it lies beyond the step's end.
const NOWHERE = Real(2);

fn control_points(coefficients: array<Real, TERMS>, length: Real) -> array<Real, TERMS> {
    var scaled = coefficients;
    var power = length;
    for (var k = 1; k < TERMS; k++) {
        scaled[k] *= power;
        power *= length;
    }
    var points = scaled;
    for (var k = 1; k < TERMS; k++) {
        var share = Real(1);
        var sum = scaled[0];
        for (var j = 1; j <= k; j++) {
            share *= real(f32(k + 1 - j)) / real(f32(TERMS - j));
            sum += scaled[j] * share;
        }
        points[k] = sum;
    }
    return points;
}

// The control points of the part up to `x`.
fn part_before(control: array<Real, TERMS>, x: Real) -> array<Real, TERMS> {
    var points = control;
    for (var k = 1; k < TERMS; k++) {
        for (var j = TERMS - 1; j >= k; j--) {
            points[j] = points[j - 1] + (points[j] - points[j - 1]) * x;
        }
    }
    return points;
}

// The control points of the part from `x` on.
fn part_after(control: array<Real, TERMS>, x: Real) -> array<Real, TERMS> {
    var points = control;
    for (var k = 1; k < TERMS; k++) {
        for (var j = 0; j < TERMS - k; j++) {
            points[j] += (points[j + 1] - points[j]) * x;
        }
    }
    return points;
}

fn value_at(coefficients: array<Real, TERMS>, x: Real) -> Real {
    var sum = coefficients[TERMS - 1];
    for (var k = TERMS - 2; k >= 0; k--) {
        sum = sum * x + coefficients[k];
    }
    return sum;
}

fn slope_at(coefficients: array<Real, TERMS>, x: Real) -> Real {
    var slopes = array<Real, TERMS>();
    for (var k = 1; k < TERMS; k++) {
        slopes[k - 1] = real(f32(k)) * coefficients[k];
    }
    return value_at(slopes, x);
}

// The zero of a polynomial that falls from `side` to beyond zero: false position with the Illinois
// rule, which halves the value at an end that is kept twice in a row.
fn only_zero(control: array<Real, TERMS>, side: Real) -> Real {
    var low = Real(0);
    var high = Real(1);
    var at_low = side * control[0];
    var at_high = side * control[TERMS - 1];
    var x = high;
    // The end that the last iteration kept: -1 the low one, 1 the high one.
    var kept = 0;
    for (var i = 0; i < 120; i++) {
        let next = (low * at_high - high * at_low) / (at_high - at_low);
        let still = abs(next - x) <= Real(2e-16) * next;
        x = next;
        if still || !(next > low && next < high) {
            break;
        }
        let value = side * part_before(control, x)[TERMS - 1];
        if value > 0 {
            low = x;
            at_low = value;
            if kept == 1 {
                at_high *= Real(0.5);
            }
            kept = 1;
        } else {
            high = x;
            at_high = value;
            if kept == -1 {
                at_low *= Real(0.5);
            }
            kept = -1;
        }
    }
    return larger(x, low);
}

// The course over [0, 1] of a polynomial that begins on one side of zero.
struct Course {
    // The first place at which it is no longer on that side, or nowhere.
    change: Real,
    // Lower bound on the distance from zero that it keeps until its final fall.
    clearance: f32,
}

// The course of the polynomial with these control points, which begins on `side` of zero (1 or -1)
// or at zero. Decided by the control points of ever smaller parts: if all are on that side, nothing
// happens; if all fall, zero is crossed at most once.
fn course(control: array<Real, TERMS>, side: Real) -> Course {
    var clearance = FAR;
    var low = Real(0);
    var span = Real(1);
    for (var parts = 0; parts < MAX_PARTS; parts++) {
        let part = part_before(part_after(control, low), span / (Real(1) - low));
        var least = side * part[1];
        var falls = true;
        for (var k = 1; k < TERMS; k++) {
            least = -larger(-least, -side * part[k]);
            falls = falls && side * (part[k] - part[k - 1]) < 0;
        }
        let end = side * part[TERMS - 1];
        if least <= 0 && falls && end <= 0 {
            return Course(low + span * only_zero(part, side), clearance);
        }
        if least <= 0 && !falls {
            if span > Real(MIN_PART) {
                span *= Real(0.5);
                continue;
            }
            clearance = min(clearance, rough(abs(end)));
            if end < 0 {
                return Course(low + span, clearance);
            }
        }
        if least > 0 {
            clearance = min(clearance, rough(least));
        }
        low += span;
        if low >= 1 {
            break;
        }
        span = -larger(-Real(2) * span, low - Real(1));
    }
    return Course(NOWHERE, clearance);
}

// A search for a bob's passes of the top in a step.
struct Passes {
    // Control points of `y` from the last change of its sign on, and the place of that change.
    control: array<Real, TERMS>,
    begin: Real,
    // The side of zero on which `y` is from there on: 1 or -1, or 0 where it vanishes.
    side: Real,
}

fn passes_from(control: array<Real, TERMS>) -> Passes {
    var begin = control[0];
    for (var k = 1; begin == 0 && k < TERMS; k++) {
        begin = control[k];
    }
    let side = select(select(Real(0), Real(-1), begin < 0), Real(1), begin > 0);
    return Passes(control, Real(0), side);
}

// The place in the step at which the bob, whose `x` has these coefficients, next passes the top; or
// nowhere. Lowers `clearance` to the distance from the top that the bob keeps until then.
fn next_pass(
    passes: ptr<function, Passes>,
    x: array<Real, TERMS>,
    length: Real,
    clearance: ptr<function, f32>,
) -> Real {
    while (*passes).side != 0 && (*passes).begin < 1 {
        let found = course((*passes).control, (*passes).side);
        if value_at(x, (*passes).begin * length) < 0 {
            *clearance = min(*clearance, found.clearance);
        }
        if found.change > 1 {
            break;
        }
        let place = (*passes).begin + (Real(1) - (*passes).begin) * found.change;
        // Every crossing, at the top or at the bottom, changes the side.
        (*passes).control = part_after((*passes).control, found.change);
        (*passes).control[0] = Real(0);
        (*passes).begin = place;
        (*passes).side = -(*passes).side;
        if value_at(x, place * length) < 0 {
            return place;
        }
    }
    return NOWHERE;
}

