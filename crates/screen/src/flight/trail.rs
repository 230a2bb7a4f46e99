//! The recent path of a pendulum, kept from frame to frame: a new frame adds only what is new.

use std::collections::VecDeque;

use super::motion::Motion;
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::separation::natural_secs;

/// Duration of the trail in natural units of time: 3.8 s for the home pendulum.
const UNITS: f64 = 12.0;
/// Number of steps of the trail.
const STEPS: usize = 384;

/// The angles of the last few seconds, at multiples of a fixed time step.
#[derive(Clone, Debug)]
pub struct Trail {
    step_secs: f64,
    /// Time of the first point, in steps since the release.
    first: usize,
    angles: VecDeque<[f64; 2]>,
}

impl Trail {
    /// Creates the empty trail of a pendulum.
    pub fn new(pendulum: &Pendulum<f64>) -> Self {
        let step_secs = UNITS * natural_secs(pendulum) / STEPS as f64;
        Trail { step_secs, first: 0, angles: VecDeque::new() }
    }

    /// Follows a motion up to a moment after the release, s.
    pub fn follow(&mut self, motion: &Motion, until_secs: f64) {
        let last = (until_secs / self.step_secs).floor() as usize;
        let first = last.saturating_sub(STEPS);
        let end = self.first + self.angles.len();
        if first < self.first || first > end {
            self.angles.clear();
            self.first = first;
        }
        self.angles.drain(..first - self.first);
        self.first = first;
        self.angles.truncate(last + 1 - first);
        for step in first + self.angles.len()..=last {
            let Some(state) = motion.state_at(step as f64 * self.step_secs) else { break };
            self.angles.push_back(state.angle);
        }
    }

    /// Returns θ1 and θ2 in rad from the oldest point to the newest, each with its youth: 0 where
    /// the trail ends, 1 at the pendulum.
    pub fn points(&self) -> impl Iterator<Item = ([f64; 2], f32)> {
        let last = self.first + self.angles.len();
        let youth = move |step: usize| 1.0 - (last - 1 - step) as f32 / STEPS as f32;
        self.angles.iter().zip(self.first..).map(move |(angle, step)| (*angle, youth(step)))
    }

    /// Returns the time in s since the release at a point of this youth.
    pub fn secs_at(&self, youth: f32) -> f64 {
        let newest = (self.first + self.angles.len()).saturating_sub(1) as f64;
        (newest - f64::from(1.0 - youth) * STEPS as f64) * self.step_secs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::Dd;
    use flipmap_pendulum::State;
    use flipmap_pendulum::taylor::Orbit;
    use flipmap_scene::PendulumSpec;

    #[test]
    fn a_trail_kept_from_frame_to_frame_is_the_one_made_at_once() {
        let build = PendulumSpec::default();
        let (mut orbit, mut motion) = (
            Orbit::new(build.pendulum_in::<Dd>(), State::rest([2.2, 1.4].map(Dd::new))),
            Motion::default(),
        );
        while orbit.time().hi < 12.0 {
            let step = orbit.step();
            motion.push(&step, 12.0);
        }
        let at_once = |secs: f64| {
            let mut trail = Trail::new(&build.pendulum());
            trail.follow(&motion, secs);
            trail.points().collect::<Vec<_>>()
        };
        let mut kept = Trail::new(&build.pendulum());
        // Forward, forward beyond all that is kept, and back.
        for secs in [0.0, 0.01, 0.5, 0.533, 3.0, 4.5, 4.6, 11.9, 11.0, 2.0, 12.0] {
            kept.follow(&motion, secs);
            let points: Vec<_> = kept.points().collect();
            assert_eq!(points, at_once(secs), "at {secs}");
            let (newest, youth) = points[points.len() - 1];
            assert!(youth == 1.0 && points.len() <= STEPS + 1);
            let newest_secs = kept.secs_at(youth);
            assert!((0.0..=kept.step_secs).contains(&(secs - newest_secs)), "{newest_secs}");
            let truth = motion.state_at(secs).unwrap().angle;
            assert!((newest[0] - truth[0]).abs() < 0.2, "{newest:?} near {truth:?}");
        }
        assert!(at_once(12.0)[0].1 < 0.01, "the oldest point is faint");
    }
}
