//! A clock with fixed steps, so that results do not depend on the frame rate.

/// A clock that counts steps of one length and keeps the time left since the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    /// Length of a step in seconds.
    pub step_secs: f64,
    /// Number of steps taken since the start.
    pub taken: u64,
    left_secs: f64,
}

/// Most seconds caught up at once, so that a window does not race after being hidden.
const MAX_SECS: f64 = 0.25;

impl Clock {
    /// Creates a clock at 0.
    pub(crate) fn new(step_secs: f64) -> Self {
        Clock { step_secs, taken: 0, left_secs: 0.0 }
    }

    /// Adds `elapsed_secs` and returns the number of steps now due, which count as taken.
    pub(crate) fn due(&mut self, elapsed_secs: f64) -> usize {
        self.left_secs += elapsed_secs.clamp(0.0, MAX_SECS);
        let due = (self.left_secs / self.step_secs + 1e-9).floor();
        self.left_secs = (self.left_secs - due * self.step_secs).max(0.0);
        self.taken += due as u64;
        due as usize
    }

    /// Returns the seconds from the start to the last step.
    pub(crate) fn secs(&self) -> f64 {
        self.taken as f64 * self.step_secs
    }

    /// Returns the progress from the last step towards the next one, in [0, 1].
    pub(crate) fn share(&self) -> f64 {
        (self.left_secs / self.step_secs).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_do_not_depend_on_frames() {
        let (mut often, mut seldom) = (Clock::new(1.0 / 240.0), Clock::new(1.0 / 240.0));
        let many: usize = (0..600).map(|_| often.due(1.0 / 600.0)).sum();
        let few: usize = (0..10).map(|_| seldom.due(0.1)).sum();
        assert_eq!((many, few), (240, 240));
        assert!((often.secs() - 1.0).abs() < 1e-12);
        often.due(1.0 / 480.0);
        assert!((often.share() - 0.5).abs() < 1e-6);
        assert!(often.due(1e9) <= 61, "a window that was away does not race");
    }
}
