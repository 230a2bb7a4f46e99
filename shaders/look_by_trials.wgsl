// The search for a pass by shorter and shorter steps, for pairs that provide nothing between the ends
// of a step (counterpart: `crossing::within`).

// The search for a pass of a bob, as it begins.
fn examined(before: Search, begin: Bob) -> Search {
    var search = before;
    search.low = 0.0;
    search.low_bob = begin;
    search.high = search.whole;
    let end = search.ends[search.bob];
    let part = approach(search.low_bob, end, search.whole);
    search.goal = select(PART, CROSS, part.crosses);
    let guess = search.whole * search.low_bob.y / (search.low_bob.y - end.y);
    search.length = select(0.5 * search.whole, guess, part.crosses);
    search.may_pass = part.clearance <= 0;
    search.spared = part.clearance;
    return search;
}

// The search after a trial.
fn decided(before: Search, now: Bob) -> Search {
    if before.goal == PART {
        return decided_part(before, now);
    }
    return decided_crossing(before, now);
}

// The search after a trial at the end of an interval in which the bob may cross the top.
fn decided_part(before: Search, now: Bob) -> Search {
    var search = before;
    let span = search.length - search.low;
    let part = approach(search.low_bob, now, span);
    let plain = part.crosses || part.clearance > 0;
    if !plain && span > 1e-6 * search.whole {
        search.length = search.low + 0.5 * span;
    } else if part.crosses || (!plain && crosses(search.low_bob, now)) {
        search.goal = CROSS;
        search.high = search.length;
        search.length = search.low + span * search.low_bob.y / (search.low_bob.y - now.y);
    } else {
        search.clearance = min(search.clearance, select(abs(now.y), part.clearance, plain));
        search.bob_done = search.length >= search.whole;
        search.low = search.length;
        search.low_bob = now;
        search.length = min(search.low + 2.0 * span, search.whole);
    }
    return search;
}

// The search after a trial near the place at which the bob crosses the top: Newton's method in a
// shrinking interval.
fn decided_crossing(before: Search, now: Bob) -> Search {
    var search = before;
    let length = search.length;
    let newton = -now.y / (now.w * now.x);
    if crosses(search.low_bob, now) {
        search.high = length;
    } else {
        search.low = length;
    }
    let inside = length + newton >= search.low && length + newton <= search.high;
    let narrow = search.high - search.low < 1e-6 * search.whole;
    if (inside && abs(newton) < 1e-5 * search.whole) || narrow {
        let rest = select(0.0, newton, inside);
        search = with_pass(search, now, length + rest, rest);
    }
    search.length = select(0.5 * (search.low + search.high), length + newton, inside);
    return search;
}
