//! Pendulums that friction has left too little energy ever to pass the top: they are done early, by
//! proof.

use super::lane_scheduler::LaneScheduler;
use crate::engine::NUMBERS;
use crate::engine::start::phase_of;
use crate::physics::phase::Phase;
use crate::physics::{Outcome, Pendulum, Rule, Status};

/// Share of the energy's range by which a pendulum must lie below the bound: more than any error of
/// its energy.
const MARGIN: f64 = 1e-3;

/// Lanes whose pendulums can no longer meet the rule, none without friction. `phase` reads the numbers
/// of a lane, and `reduced` is the pendulum.
pub(super) fn slowed_lanes(
    scheduler: &LaneScheduler,
    reduced: &Pendulum<f64>,
    phase: impl Fn(&[f64; NUMBERS]) -> Phase<f64>,
) -> Vec<usize> {
    let question = scheduler.chunk.question;
    // Counts of passes are read at the end of the budget.
    let is_open = question.rule == Rule::Neither || question.passes == u32::MAX;
    if reduced.friction.is_none() || is_open {
        return Vec::new();
    }
    let least = reduced.least_depth(question.rule) + MARGIN * (reduced.p + reduced.q);
    let is_slowed = |lane: &usize| -reduced.energy_of(&phase(&scheduler.numbers(*lane))) > least;
    scheduler.running().filter(is_slowed).collect()
}

/// Frees those lanes where states are unit vectors and momenta.
pub(super) fn finish_slowed(scheduler: &mut LaneScheduler, reduced: &Pendulum<f64>) {
    for lane in slowed_lanes(scheduler, reduced, phase_of) {
        let end = scheduler.end_of_phase(lane);
        scheduler.finish(lane, Outcome::without_time(Status::Unflipped), end);
    }
}
