// A tile's pendulums in steps that choose their length (twin: src/engine/cpu/adaptive.rs), on unit
// vectors and momenta. `advance` tries steps and stops before one in which the top may be
// reached; `look` decides those. What a step is judged by is f32, whatever the number type.

// How far an error may be from what is allowed at a time, in log2 of squares: negative is good.
fn excess_of(error_squared: f32, time: f32) -> f32 {
    return log2(max(error_squared, 1e-37)) - min(job.start + job.rise * time, job.ceiling);
}

fn next_length(h: f32, excess: f32) -> f32 {
    let factor = exp2(clamp({{ exponent }} * excess + {{ safety }}, -8.0, 8.0));
    return min(h * clamp(factor, {{ shrink }}, {{ grow }}), {{ longest }});
}

// A bob at one moment: its unit vector and speed.
struct Bob {
    x: f32,
    y: f32,
    w: f32,
}

fn crosses(before: Bob, after: Bob) -> bool {
    return (before.y > 0 && after.y <= 0) || (before.y < 0 && after.y >= 0);
}

fn may_graze(before: Bob, after: Bob, h: f32) -> bool {
    let travel = {{ reach }} * h * max(abs(before.w), abs(after.w));
    return before.w * after.w < 0 && min(abs(before.y), abs(after.y)) <= travel;
}

fn may_pass(before: Bob, after: Bob, h: f32) -> bool {
    return min(before.x, after.x) < 0 && (crosses(before, after) || may_graze(before, after, h));
}

@compute @workgroup_size(WORKGROUP)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= atomicLoad(&queue.lengths[queue.turn]) {
        return;
    }
    let pixel = lists[queue.turn * job.count + id.x];
{% for name in state %}
    var {{ name }} = states[{{ loop.index0 }}u * job.count + pixel];
{% endfor %}
    let zero = job.zero;
{% include "general.wgsl" %}
    var steps = outcomes[pixel].steps;
    let stop = min(steps + job.slice_steps, job.most_steps);
    let budget = job.budget;
    var suspect = false;
    while !suspect && steps < stop && rough(time) < budget {
        let step = h;
{{ maths.step }}
        let excess = excess_of(rough(error_squared), rough(time));
        let accepted = excess < 0;
        suspect = accepted && (
{%- for bob in watched -%}
            {% if not loop.first %} || {% endif %}
            {% if general %}((job.watched & {{ bob }}u) != 0u) && {% endif -%}
            may_pass(Bob(rough(x{{ bob }}), rough(y{{ bob }}), rough(w{{ bob }})),
                Bob(rough(x{{ bob }}_next), rough(y{{ bob }}_next), rough(w{{ bob }}_next)), rough(h))
{%- endfor -%}
        );
        let taken = accepted && !suspect;
{% for name in moving %}
        {{ name }} = select({{ name }}, {{ name }}_next, taken);
{% endfor %}
        h = real(select(next_length(rough(h), excess), rough(h), suspect));
        steps += select(1u, 0u, suspect);
    }
{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = {{ name }};
{% endfor %}
    outcomes[pixel].steps = steps;
    let sound = steps < job.most_steps;
    if !sound {
        outcomes[pixel].status = FAILED;
    }
    put_on(SUSPECTS, pixel, sound && suspect);
    put_on(1u - queue.turn, pixel, sound && !suspect && rough(time) < budget);
}

// What `look` does with the next step it tries: the whole one, one that ends where a bob may turn
// round, or one that ends where it may be at the top.
const WHOLE = 0u;
const TURN = 1u;
const CROSS = 2u;
// Enough for any bracket to shrink to nothing.
const MOST_TRIALS = 64u;

@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= atomicLoad(&queue.lengths[SUSPECTS]) {
        return;
    }
    let pixel = lists[SUSPECTS * job.count + id.x];
{% for name in state %}
    let {{ name }} = states[{{ loop.index0 }}u * job.count + pixel];
{% endfor %}
    let zero = job.zero;
{% include "general.wgsl" %}
    let whole = rough(h);
    var length = whole;
    var goal = WHOLE;
    // The whole step's end.
{% for name in state %}
    var {{ name }}_after = {{ name }};
{% endfor %}
    var ends = array<Bob, 2>();
    // Which bob is looked at; where its pass or its turn lies, and the speeds there.
    var bob = 0u;
    var low = 0.0;
    var high = whole;
    var w_low = 0.0;
    var w_high = 0.0;
    // How far into the step the rule is first met, in two parts; at most its length.
    var flip = 2.0 * whole;
    var flip_rest = 0.0;
    var trials = 0u;
    while bob < {{ bobs }}u && trials < MOST_TRIALS {
        trials += 1u;
        let step = real(length);
{{ maths.step }}
        let befores = array<Bob, 2>({{ befores }});
        let nows = array<Bob, 2>({{ nows }});
        var bob_done = false;
        let before = befores[bob];
        let now = nows[bob];
        if goal == WHOLE {
{% for name in moving %}
            {{ name }}_after = {{ name }}_next;
{% endfor %}
            h_after = real(next_length(whole, excess_of(rough(error_squared), rough(time))));
            ends = nows;
        } else if goal == TURN {
            let moved = abs(select(high, low, (now.w < 0) == (before.w < 0)) - length);
            if crosses(before, now) {
                // Beyond the top where it turns, or on the way there.
                goal = CROSS;
                low = 0.0;
                high = length;
                length = 0.5 * length;
            } else if now.w == 0 || moved < 1e-5 * whole {
                bob_done = true;
            } else {
                // The false position, with Illinois' halving of the end that stays.
                if (now.w < 0) == (before.w < 0) {
                    low = length;
                    w_low = now.w;
                    w_high *= 0.5;
                } else {
                    high = length;
                    w_high = now.w;
                    w_low *= 0.5;
                }
                length = (low * w_high - high * w_low) / (w_high - w_low);
            }
        } else {
            let newton = -now.y / (now.w * now.x);
            if crosses(before, now) {
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
                }
                bob_done = true;
            }
            length = select(0.5 * (low + high), length + newton, inside);
        }
        // The next bob, or the first one after the whole step: what is there to find?
        if goal == WHOLE || bob_done {
            bob += select(1u, 0u, goal == WHOLE);
            while bob < {{ bobs }}u {
                let begun = befores[bob];
                let end = ends[bob];
                low = 0.0;
                high = whole;
                if {{ is_watched }}may_pass(begun, end, whole) {
                    if crosses(begun, end) {
                        goal = CROSS;
                        length = whole * begun.y / (begun.y - end.y);
                    } else {
                        goal = TURN;
                        w_low = begun.w;
                        w_high = end.w;
                        length = whole * w_low / (w_low - w_high);
                    }
                    break;
                }
                bob += 1u;
            }
        }
    }
    outcomes[pixel].steps += 1u;
    let flipped = flip + flip_rest <= whole;
    let looks = (outcomes[pixel].status & ~255u) + trials * LOOK;
    outcomes[pixel].status = looks | select(UNFLIPPED, FLIPPED, flipped);
    if flipped {
        outcomes[pixel].moment = {{ moment }};
    } else {
{% for name in state %}
        states[{{ loop.index0 }}u * job.count + pixel] = {{ name }}_after;
{% endfor %}
    }
    let over = rough(time_after) >= job.budget || outcomes[pixel].steps >= job.most_steps;
    put_on(1u - queue.turn, pixel, !flipped && !over);
}
