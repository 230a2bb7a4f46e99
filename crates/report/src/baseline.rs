//! The baseline of every speed: the loop that one would write first.

use std::time::Instant;

use flipmap_engine::EventSpec;
use flipmap_numbers::Dd;
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::{Outcome, State, Status, flip, integrator};

/// Step of the loop in seconds.
pub(crate) const STEP_SECS: f64 = 1.0 / 120.0;

/// Integrates one pendulum by plain RK4 in f64 at 120 steps per second.
pub fn outcome(question: &EventSpec, angle: [Dd; 2]) -> Outcome {
    let pendulum = question.build.pendulum();
    let steps = (question.budget_secs / STEP_SECS).round() as u32;
    let mut state = State::rest(angle.map(|theta| theta.hi));
    for n in 0..steps {
        let change = integrator::rk4(&pendulum, &state, STEP_SECS, Turning::Fresh);
        let next = state.plus(&change);
        let passes =
            question.rule.watched().iter().filter_map(|&bob| {
                flip::fraction_of_step(&pendulum, bob, &state, &next, STEP_SECS)
            });
        if let Some(fraction) = passes.reduce(f64::min) {
            return Outcome::flipped((f64::from(n) + fraction) * STEP_SECS);
        }
        state = next;
    }
    Outcome::without_time(Status::Unflipped)
}

/// Microseconds per start that the loop takes on one core.
pub fn us_per_pixel(question: &EventSpec, starts: &[[Dd; 2]]) -> f64 {
    let begun = Instant::now();
    for &angle in starts {
        std::hint::black_box(outcome(question, angle));
    }
    begun.elapsed().as_secs_f64() * 1e6 / starts.len() as f64
}
