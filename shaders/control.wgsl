// Step size control (counterpart: crates/engine/src/cpu/step_control.rs).

// Excess of an error over what is allowed at a time, in log2 of squares; negative if the step can
// be taken.
fn excess_of(error_squared: f32, time: f32) -> f32 {
    return log2(max(error_squared, 1e-37)) - min(job.start + job.rise * time, job.ceiling);
}

fn next_length(h: f32, excess: f32) -> f32 {
    let factor = exp2(clamp({{ exponent }} * excess + {{ safety }}, -8.0, 8.0));
    return min(h * clamp(factor, {{ shrink }}, {{ grow }}), {{ longest }});
}
