// Decides the steps before which `advance` stopped (counterpart: crates/engine/src/cpu/pair.rs):
// the first trial is the whole step, and those after it end where a bob may be at the top. Every
// value that decides anything comes from a step of the method itself.
const WHOLE = 0u;
// An interval in which the bob may cross the top.
const PART = 1u;
// An interval in which the bob crosses the top.
const CROSS = 2u;
{% if counts_passes %}
// A step that ends where a bob passes the top.
const TOP = 3u;
{% endif %}
// Largest number of trials for one step; a graze takes some sixty.
const MAX_TRIALS = 400u;
{% if counts_passes %}
// Sine of the angle beyond the top at which a bob that has passed it is put.
const BARELY = 1e-30;
{% endif %}

{% if quartic %}
// The control points of a part of a quartic (de Casteljau).
fn part_of(control: array<f32, 5>, low: f32, high: f32) -> array<f32, 5> {
    var points = control;
    // Up to `high` …
    for (var k = 1; k < 5; k++) {
        for (var j = 4; j >= k; j--) {
            points[j] = mix(points[j - 1], points[j], high);
        }
    }
    // … and from `low` on.
    let share = low / high;
    for (var k = 1; k < 5; k++) {
        for (var j = 0; j < 5 - k; j++) {
            points[j] = mix(points[j], points[j + 1], share);
        }
    }
    return points;
}

// The first place in (0, 1] at which a quartic is no longer on the side of zero that it begins on;
// 2 if there is none (counterpart: `polynomial::course`).
fn first_change(control: array<f32, 5>) -> f32 {
    var begin = control[0];
    for (var k = 1; begin == 0 && k < 5; k++) {
        begin = control[k];
    }
    var low = 0.0;
    var span = 1.0;
    for (var parts = 0; parts < 200; parts++) {
        let points = part_of(control, low, low + span);
        var least = FAR;
        var falls = true;
        for (var k = 1; k < 5; k++) {
            least = min(least, inward(points[k], begin));
            falls = falls && inward(points[k] - points[k - 1], begin) < 0;
        }
        let stays = least > 0;
        let beyond = inward(points[4], begin) < 0;
        if !stays && span > 1e-6 && !(falls && span < 0.02) {
            span *= 0.5;
            continue;
        }
        if !stays && beyond {
            return low + span * points[0] / (points[0] - points[4]);
        }
        low += span;
        if low >= 1.0 {
            break;
        }
        span = min(2.0 * span, 1.0 - low);
    }
    return 2.0;
}
{% endif %}

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
{% include "suspect.wgsl" %}
    let zero = job.zero;
{% include "general.wgsl" %}
    let whole = rough(h);
    var length = whole;
    var goal = WHOLE;
    // The state at the end of the whole step.
{% for name in state %}
    var {{ name }}_after = {{ name }};
{% endfor %}
    var ends = array<Bob, 2>();
{% if counts_passes %}
    var begins = array<Bob, 2>();
    // The bob that passes the top first, and its state there.
    var passing = 0u;
    var top = Bob();
{% endif %}
{% if quartic %}
    var courses = array<array<f32, 5>, 2>();
    var most_trials_here = 0u;
{% endif %}
    // The bob that is examined, and the interval that is decided: its beginning, the bob's state
    // there, and its end.
    var bob = 0u;
    var low = 0.0;
    var low_bob = Bob();
    var high = whole;
    // Length into the step at which the rule is first met, in two parts; more than the whole step
    // until it is.
    var flip = 2.0 * whole;
    var flip_rest = 0.0;
    var clearance = outcomes[pixel].clearance;
    var trials = 0u;
    while bob < {{ bobs }}u && trials < MAX_TRIALS {
        trials += 1u;
{% if counts_passes %}
        let step = select(real(length), {{ flip_length }}, goal == TOP);
{% else %}
        let step = real(length);
{% endif %}
{{ maths.step }}
        let befores = array<Bob, 2>({{ befores }});
        let nows = array<Bob, 2>({{ nows }});
        let now = nows[bob];
        var bob_done = false;
{% if counts_passes %}
        if goal == TOP {
{% for name in moving %}
            {{ name }}_after = {{ name }}_next;
{% endfor %}
            h_after = h;
            top = now;
            break;
        }
{% endif %}
        if goal == WHOLE {
{% for name in moving %}
            {{ name }}_after = {{ name }}_next;
{% endfor %}
            h_after = real(next_length(whole, excess_of(rough(error_squared), rough(time))));
            ends = nows;
{% if counts_passes %}
            begins = befores;
{% endif %}
{% if quartic %}
            let bows = array<f32, 2>({{ bows | join(", ") }});
            for (var k = 0u; k < {{ bobs }}u; k++) {
                courses[k] = control_points(befores[k], nows[k], bows[k], whole);
            }
        } else {
            // Near the quartic's crossing, steps that end there give the exact moment.
            let newton = -now.y / (now.w * now.x);
            let near = abs(newton) < 0.1 * whole;
            let better = length + select(0.0, newton, near);
            if !near || abs(newton) < 1e-5 * whole || trials >= most_trials_here {
                if now.x < 0 && better < flip + flip_rest {
                    flip = length;
                    flip_rest = better - length;
{% if counts_passes %}
                    passing = bob;
{% endif %}
                }
                bob_done = true;
            }
            length = clamp(better, 0.0, whole);
        }
{% else %}
        } else if goal == PART {
            let span = length - low;
            let part = approach(low_bob, now, span);
            let plain = part.crosses || part.clearance > 0;
            if !plain && span > 1e-6 * whole {
                length = low + 0.5 * span;
            } else if part.crosses || (!plain && crosses(low_bob, now)) {
                goal = CROSS;
                high = length;
                length = low + span * low_bob.y / (low_bob.y - now.y);
            } else {
                clearance = min(clearance, select(abs(now.y), part.clearance, plain));
                bob_done = length >= whole;
                low = length;
                low_bob = now;
                length = min(low + 2.0 * span, whole);
            }
        } else {
            let newton = -now.y / (now.w * now.x);
            if crosses(low_bob, now) {
                high = length;
            } else {
                low = length;
            }
            let inside = length + newton >= low && length + newton <= high;
            if (inside && abs(newton) < 1e-5 * whole) || high - low < 1e-6 * whole {
                let rest = select(0.0, newton, inside);
                if now.x < 0 && length + rest < flip + flip_rest {
                    flip = length;
                    flip_rest = rest;
{% if counts_passes %}
                    passing = bob;
{% endif %}
                }
                bob_done = true;
            }
            length = select(0.5 * (low + high), length + newton, inside);
        }
{% endif %}
        // Moves to the next bob, or to the first one after the whole step, and finds out what has
        // to be decided.
        if goal == WHOLE || bob_done {
            bob += select(1u, 0u, goal == WHOLE);
            while bob < {{ bobs }}u {
{% if quartic %}
                goal = CROSS;
                let change = first_change(courses[bob]);
                let x = mix(befores[bob].x, ends[bob].x, change);
                length = whole * change;
                most_trials_here = trials + 4u;
                if {{ is_watched }}change <= 1.0 && x < 0 {
                    break;
                }
{% else %}
                let part = approach(befores[bob], ends[bob], whole);
                low = 0.0;
                low_bob = befores[bob];
                high = whole;
                goal = select(PART, CROSS, part.crosses);
                let guess = whole * low_bob.y / (low_bob.y - ends[bob].y);
                length = select(0.5 * whole, guess, part.crosses);
                if {{ is_watched }}part.clearance <= 0 {
                    break;
                }
                clearance = select(clearance, min(clearance, part.clearance), {{ is_watched }}true);
{% endif %}
                bob += 1u;
            }
{% if counts_passes %}
            if bob == {{ bobs }}u && flip + flip_rest <= whole {
                goal = TOP;
                bob = passing;
            }
{% endif %}
        }
    }
    outcomes[pixel].steps += 1u;
{% if counts_passes %}
{% include "passes.wgsl" %}
{% else %}
    let flipped = flip + flip_rest <= whole;
{% endif %}
    outcomes[pixel].clearance = clearance;
    outcomes[pixel].status += trials * LOOK;
    if flipped {
        outcomes[pixel].moment = {{ moment }};
    } else {
{% for name in state %}
        states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_after;
{% endfor %}
    }
    let sound = outcomes[pixel].steps < job.most_steps;
    let over = !sound || !(rough(time_after) < job.budget);
    if flipped {
        end(pixel, ANSWERED);
    } else if over {
        end(pixel, select(FAILED, UNFLIPPED, sound));
    }
    put_on(1u - queue.turn, pixel, !flipped && !over);
}
