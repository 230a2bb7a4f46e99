//! Lanes of pendulums that friction has left too little energy ever to pass the top.

use super::lane_scheduler::LaneScheduler;
use crate::NUMBERS;
use crate::slowed::least_energy;
use crate::start::phase_of;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::{Outcome, Pendulum, Status};

/// Returns the lanes whose pendulums can no longer flip; none without friction. `phase` reads the
/// numbers of a lane, and `reduced` is the pendulum.
pub(super) fn slowed_lanes(
    scheduler: &LaneScheduler,
    reduced: &Pendulum<f64>,
    phase: impl Fn(&[f64; NUMBERS]) -> Phase<f64>,
) -> Vec<usize> {
    let question = scheduler.chunk.question;
    let Some(least) = least_energy(reduced, question.rule) else {
        return Vec::new();
    };
    let is_slowed = |lane: &usize| reduced.energy_of(&phase(&scheduler.numbers(*lane))) < least;
    scheduler.running().filter(is_slowed).collect()
}

/// Frees the lanes that [`slowed_lanes`] returns. States must be unit vectors and momenta.
pub(super) fn finish_slowed(scheduler: &mut LaneScheduler, reduced: &Pendulum<f64>) {
    for lane in slowed_lanes(scheduler, reduced, phase_of) {
        scheduler.finish(lane, Outcome::without_time(Status::Unflipped), |lanes| {
            lanes.end_of_phase(lane)
        });
    }
}
