//! A pendulum that changes continuously, as under a slider, and the map that follows it.
//!
//! Each change is a new physics. If each replaced the last at once, no map would ever be complete
//! and none would be seen before the slider rests. So a pendulum whose first coarse map is being
//! computed keeps its place until that map is known everywhere; then the newest pendulum follows,
//! and those in between are skipped.

use std::time::Duration;

use super::{Explorer, Physics, ViewTarget};

/// Longest time for which a pendulum keeps its place: a map that takes longer is not worth the
/// wait.
const MAX_HOLD: Duration = Duration::from_millis(700);

impl Explorer {
    /// Returns true if another target has to wait for the coarse map of the current one, because
    /// they differ in nothing but the pendulum.
    pub(super) fn holds(&self, next: &ViewTarget) -> bool {
        let Some(target) = &self.target else { return false };
        let build = target.physics.build;
        let physics = Physics { build, ..next.physics.clone() };
        let differs_in_build = next.physics.build != build
            && physics == target.physics
            && next.region == target.region
            && next.level == target.level;
        differs_in_build
            && !self.progress().covered
            && self.key_since.is_some_and(|since| since.elapsed() < MAX_HOLD)
    }

    /// Replaces the target by the waiting one, unless that one has to wait longer.
    pub(super) fn follow(&mut self) {
        if let Some(next) = self.next.take() {
            self.target(&next);
        }
    }

    /// Returns true if a newer target waits, so all known cells show an earlier pendulum.
    pub fn is_behind(&self) -> bool {
        self.next.is_some()
    }
}
