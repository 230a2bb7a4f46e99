//! Speeds of kernels, from which the lengths of slices follow.

use super::GpuTuning;
use super::kernel::Design;

/// The slices of one submission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slices {
    /// Number of steps that each slice may take with each pendulum.
    pub steps: u32,
    /// Number of slices.
    pub count: u32,
}

/// Least number of slices that a full budget is cut into, so that running pendulums are packed
/// often enough.
const MIN_SLICES: u32 = 24;

/// Measured speeds. A step of few pendulums takes hardly less time than one of many, and kernels
/// differ a hundredfold, so each kind of kernel has a speed for each order of magnitude of
/// pendulums.
#[derive(Debug, Default)]
pub(super) struct StepClock {
    speeds: Vec<Speed>,
}

#[derive(Debug)]
struct Speed {
    kind: Design,
    running: u32,
    secs_per_step: f64,
}

/// Returns the part of a design that decides its speed, which hardly depends on the scene.
fn kind_of(design: &Design) -> Design {
    Design { scene: None, passes: design.passes.min(2), ..*design }
}

impl StepClock {
    /// Records the seconds that a step of `running` pendulums took.
    pub(super) fn note(&mut self, design: &Design, running: u32, secs_per_step: f64) {
        let (kind, running) = (kind_of(design), running.max(1));
        let same = |speed: &Speed| speed.kind == kind && speed.running.ilog2() == running.ilog2();
        self.speeds.retain(|speed| !same(speed));
        self.speeds.push(Speed { kind, running, secs_per_step });
    }

    /// Returns an upper bound on the seconds that a step of `running` pendulums takes, or `None`
    /// before anything has been measured.
    fn secs_per_step(&self, design: &Design, running: u32) -> Option<f64> {
        let (kind, running) = (kind_of(design), running.max(1));
        let known = || self.speeds.iter().filter(|speed| speed.kind == kind);
        let scaled = |speed: &Speed| {
            // Fewer pendulums may take as long as many.
            speed.secs_per_step * (f64::from(running) / f64::from(speed.running)).max(1.0)
        };
        let alike = known().find(|speed| speed.running.ilog2() == running.ilog2());
        alike.map(scaled).or_else(|| known().map(scaled).reduce(f64::min))
    }

    /// The slices of a slot's next submission that keep the pace, for `running` pendulums with
    /// `typical_steps` steps over the budget.
    pub(super) fn slices(
        &self,
        tuning: &GpuTuning,
        design: &Design,
        running: u32,
        typical_steps: f64,
    ) -> Slices {
        let Some(secs) = self.secs_per_step(design, running) else {
            return Slices { steps: tuning.first_slice, count: 1 };
        };
        let most = (typical_steps / f64::from(MIN_SLICES)).max(1.0);
        let wanted = tuning.pace.as_secs_f64() / secs;
        let steps = wanted.clamp(1.0, most) as u32;
        let count = (wanted / f64::from(steps)) as u32;
        Slices { steps, count: count.clamp(1, tuning.slices) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::level::{BALANCED, LESSON};

    #[test]
    fn submissions_keep_the_pace_of_their_own_kernel() {
        let tuning = GpuTuning::default();
        let [fast, slow] = [LESSON, BALANCED].map(|c| Design::general(&c, false, false).unwrap());
        let mut clock = StepClock::default();
        let slices = |clock: &StepClock, design, running| {
            let Slices { steps, count } = clock.slices(&tuning, design, running, 3600.0);
            [steps, count]
        };
        assert_eq!(slices(&clock, &fast, 1 << 20), [8, 1], "nothing is known yet");
        clock.note(&slow, 1 << 20, 0.01);
        assert_eq!(slices(&clock, &slow, 1 << 20), [5, 1]);
        assert_eq!(slices(&clock, &fast, 1 << 20), [8, 1], "the other kernel tells nothing");
        clock.note(&fast, 1 << 20, 1e-5);
        assert_eq!(slices(&clock, &fast, 1 << 20), [150, 8], "a full budget has 24 slices");
        clock.note(&fast, 1 << 20, 1e-4);
        assert_eq!(slices(&clock, &fast, 1 << 20), [150, 3], "the latest measurement counts");
        // The tail of a job says little about the beginning of the next one.
        clock.note(&fast, 100, 5e-5);
        assert_eq!(slices(&clock, &fast, 1 << 20), [150, 3]);
        assert_eq!(slices(&clock, &fast, 90), [150, 6]);
        assert_eq!(slices(&clock, &fast, 1 << 22), [125, 1], "as if it grew with the pendulums");
    }
}
