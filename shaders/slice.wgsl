    var steps = outcomes[pixel].steps;
    let stop = min(steps + job.slice_steps, job.most_steps);
    let budget = job.budget;
    var clearance = outcomes[pixel].clearance;
    var suspect = false;
{% if counts_turns %}
    var turns = vec2<i32>(
        extractBits(bitcast<i32>(outcomes[pixel].turns), 0u, 16u),
        extractBits(bitcast<i32>(outcomes[pixel].turns), 16u, 16u),
    );
{% endif %}
