// The search for a pass on the quartics that a pair provides for its steps: steps that end near the
// quartic's crossing give the exact moment.

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

// The quartics of the watched bobs over the whole step.
fn courses_of(
    begins: array<Bob, 2>,
    ends: array<Bob, 2>,
    bows: array<f32, 2>,
    whole: f32,
) -> array<array<f32, 5>, 2> {
    var courses = array<array<f32, 5>, 2>();
    for (var k = 0u; k < {{ bobs }}u; k++) {
        courses[k] = control_points(begins[k], ends[k], bows[k], whole);
    }
    return courses;
}

// The search for a pass of a bob, as it begins.
fn examined(before: Search, begin: Bob) -> Search {
    var search = before;
    search.goal = CROSS;
    let change = first_change(search.courses[search.bob]);
    let x = mix(begin.x, search.ends[search.bob].x, change);
    search.length = search.whole * change;
    search.most_trials_here = search.trials + 4u;
    search.may_pass = change <= 1.0 && x < 0;
    // Quartics tell no clearance.
    search.spared = FAR;
    return search;
}

// The search after a trial.
fn decided(before: Search, now: Bob) -> Search {
    var search = before;
    let newton = -now.y / (now.w * now.x);
    let near = abs(newton) < 0.1 * search.whole;
    let better = search.length + select(0.0, newton, near);
    if !near || abs(newton) < 1e-5 * search.whole || search.trials >= search.most_trials_here {
        search = with_pass(search, now, better, better - search.length);
    }
    search.length = clamp(better, 0.0, search.whole);
    return search;
}
