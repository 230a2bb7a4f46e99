// Decides the steps before which `advance` stopped (counterpart: crates/engine/src/cpu/pair.rs):
// the first trial is the whole step, and those after it end where a bob may be at the top. Every
// value that decides anything comes from a step of the method itself.

// What a trial is for: the whole step,
const WHOLE = 0u;
// the end of an interval in which the bob may cross the top,
const PART = 1u;
// the place at which the bob crosses the top,
const CROSS = 2u;
// or the state at the first pass.
const TOP = 3u;
// Largest number of trials for one step; a graze takes some sixty.
const MAX_TRIALS = 400u;

// The search for the first pass of the top in a step.
struct Search {
    goal: u32,
    // The watched bob that is examined, from 0.
    bob: u32,
    // True once it is decided where that bob passes.
    bob_done: bool,
    // False if the whole step shows that it does not pass, and the clearance that it then keeps.
    may_pass: bool,
    spared: f32,
    // Number of trials.
    trials: u32,
    // Length of the step, and of the next trial.
    whole: f32,
    length: f32,
    // Length into the step at which the rule is first met, in two parts; more than the whole step
    // until it is.
    flip: f32,
    flip_rest: f32,
    // The bob that passes there.
    passing: u32,
    // Distance from the top that the watched bobs have kept.
    clearance: f32,
    // The bobs at the end of the whole step.
    ends: array<Bob, 2>,
    // The interval that is decided: its beginning, the bob's state there, and its end.
    low: f32,
    low_bob: Bob,
    high: f32,
{% if quartic %}
    // The quartics of both bobs, and the trial after which a crossing is precise enough.
    courses: array<array<f32, 5>, 2>,
    most_trials_here: u32,
{% endif %}
}

fn search_in(pixel: u32, whole: f32) -> Search {
    var search = Search();
    search.whole = whole;
    search.length = whole;
    search.flip = 2.0 * whole;
    search.clearance = outcomes[pixel].clearance;
    return search;
}

// Takes a pass of the bob that is examined, at `moment`, which is `rest` after the trial, if it is
// the first one so far.
fn with_pass(before: Search, now: Bob, moment: f32, rest: f32) -> Search {
    var search = before;
    if now.x < 0 && moment < search.flip + search.flip_rest {
        search.flip = search.length;
        search.flip_rest = rest;
        search.passing = search.bob;
    }
    search.bob_done = true;
    return search;
}

// The search with the next bob that may pass the top.
fn at_next_bob(before: Search, begins: array<Bob, 2>) -> Search {
    var search = before;
    search.bob += select(1u, 0u, search.goal == WHOLE);
    search.bob_done = false;
    while search.bob < {{ bobs }}u {
        let bob = search.bob;
        search = examined(search, begins[bob]);
        if {{ is_watched }}search.may_pass {
            break;
        }
        let clearance = min(search.clearance, search.spared);
        search.clearance = select(search.clearance, clearance, {{ is_watched }}true);
        search.bob += 1u;
    }
{% if counts_passes %}
    if search.bob == {{ bobs }}u && search.flip + search.flip_rest <= search.whole {
        search.goal = TOP;
        search.bob = search.passing;
    }
{% endif %}
    return search;
}

// Length of the next trial as a number.
fn length_of_trial(search: Search) -> Real {
{% if counts_passes %}
    let flip = search.flip;
    let flip_rest = search.flip_rest;
    return select(real(search.length), {{ flip_length }}, search.goal == TOP);
{% else %}
    return real(search.length);
{% endif %}
}

// The moment of the first pass in a step from `now`, in two parts.
fn moment_of(search: Search, now: State) -> vec2<f32> {
    let flip = search.flip;
    let flip_rest = search.flip_rest;
    let time = now.time;
{% if compensated %}
    let time_low = now.time_low;
{% endif %}
    return {{ moment }};
}

{% if counts_passes %}
// Sine of the angle beyond the top at which a bob that has passed it is put.
const BARELY = 1e-30;

// The pendulum at a pass that does not end its motion, barely beyond the top (counterpart: `look` in
// crates/engine/src/cpu/lane_loop.rs).
fn beyond_top(state: State, search: Search, anticlockwise: bool) -> State {
    var now = state;
    let beyond = real(select(BARELY, -BARELY, anticlockwise));
{% for bob in watched %}
    if search.passing == {{ loop.index0 }}u {
        now.y{{ bob }} = beyond;
{% if compensated %}
        now.y{{ bob }}_low = real(0.0);
{% endif %}
    }
{% endfor %}
    return now;
}

// Height to which a bob at the top would rise beyond it if its acceleration turned it round.
fn height_beyond(search: Search, begin: Bob, top: Bob) -> f32 {
    let pull = abs(search.ends[search.passing].w - begin.w) / search.whole;
    return top.w * top.w / (2.0 * max(pull, 1e-30));
}

{% endif %}
@compute @workgroup_size(WORKGROUP)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_at(SUSPECTS, id.x);
    if pixel == NO_PIXEL {
        return;
    }
    let now = state_of(pixel);
    var search = search_in(pixel, rough(now.h));
    // The state at the end of the whole step, or at a pass.
    var after = now;
    var begins = array<Bob, 2>();
    var nows = array<Bob, 2>();
    while search.bob < {{ bobs }}u && search.trials < MAX_TRIALS {
        search.trials += 1u;
        let step = step_from(now, length_of_trial(search));
        begins = bobs_before(now, step);
        nows = bobs_after(step);
        if search.goal == TOP {
            after = step.next;
            break;
        }
        if search.goal == WHOLE {
            after = step.next;
            after.h = real(next_length(
                search.whole, excess_of(rough(step.error_squared), rough(now.time))));
            search.ends = nows;
{% if quartic %}
            search.courses = courses_of(begins, nows, array<f32, 2>({{ bows | join(", ") }}), search.whole);
{% endif %}
        } else {
            search = decided(search, nows[search.bob]);
        }
        if search.goal == WHOLE || search.bob_done {
            search = at_next_bob(search, begins);
        }
    }
    outcomes[pixel].steps += 1u;
{% if counts_passes %}
    var flipped = search.goal == TOP && rough(after.time) > job.budget;
    if search.goal == TOP && !flipped {
        let top = nows[search.passing];
        let begin = begins[search.passing];
        let anticlockwise = select(begin.y > 0, top.w > 0, begin.y == 0);
        let bobs = array<u32, 2>({{ numbers | join(", ") }});
        flipped = count_pass(pixel, bobs[search.passing], anticlockwise);
        after = beyond_top(after, search, anticlockwise);
        search.clearance = min(search.clearance, height_beyond(search, begin, top));
    }
{% else %}
    let flipped = search.flip + search.flip_rest <= search.whole;
{% endif %}
    outcomes[pixel].clearance = search.clearance;
    outcomes[pixel].status += search.trials * LOOK;
    if flipped {
        outcomes[pixel].moment = moment_of(search, now);
    } else {
        keep_state(pixel, after);
    }
    let sound = outcomes[pixel].steps < job.most_steps;
    end_step(pixel, flipped, sound, is_over(after.time));
}
