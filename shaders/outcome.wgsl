struct Outcome {
    // Status in the low byte; above it, the number of steps taken to look for a flip.
    status: u32,
    // Steps taken; for adaptive methods, steps tried.
    steps: u32,
    // Moment of the flip, in two parts: for fixed steps the fraction of the next one, for adaptive
    // steps the reduced time.
    moment: vec2<f32>,
    // Distance from the top that the watched bobs have kept so far, as a sine; only adaptive steps
    // set it.
    clearance: f32,
{% if counts_turns %}
    // Whole turns of the bobs, anticlockwise ones positive: two signed numbers of 16 bits.
    turns: u32,
{% endif %}
{% if counts_passes %}
    unused: u32,
    // Passes of the top by each bob anticlockwise and clockwise, the first bob first.
    passes: array<u32, 4>,
{% endif %}
}

