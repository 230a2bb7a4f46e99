//! The time that new tiles wait to be drawn. Where the processor draws, frames take time from
//! computing.

use std::time::{Duration, Instant};

use flipmap_render::tiles::explorer::ViewProgress;

/// Least time that new tiles alone wait for a frame.
const MIN_WAIT: Duration = Duration::from_millis(120);
/// Time that new tiles wait, in durations of the last frame, so that a processor that draws still
/// computes most of the time. The wait grows by one duration per second without an event, as the
/// picture changes less and less.
const IN_FRAMES: f64 = 6.0;
/// Longest time that new tiles wait, so that the map grows visibly.
const MAX_WAIT: Duration = Duration::from_secs(1);

/// The last frame, and what it showed.
#[derive(Debug)]
pub(super) struct NewsPace {
    /// Time that the frame took.
    took: Duration,
    /// True if its map was known coarsely everywhere, and if nothing was left to compute.
    milestones: [bool; 2],
    /// Moment of the last event that changed the window.
    touched: Instant,
}

impl NewsPace {
    /// Creates the pace of a window that has drawn nothing yet.
    pub(super) fn new(now: Instant) -> Self {
        NewsPace { took: Duration::ZERO, milestones: [false; 2], touched: now }
    }

    /// Notes an event that changes the window.
    pub(super) fn touch(&mut self, now: Instant) {
        self.touched = now;
    }

    /// Notes a frame.
    pub(super) fn drew(&mut self, took: Duration, progress: &ViewProgress) {
        (self.took, self.milestones) = (took, milestones_of(progress));
    }

    /// Returns the time from the last frame to one that shows this progress; zero for the first
    /// frame of a whole view and for its last.
    pub(super) fn pause(&self, progress: &ViewProgress, now: Instant) -> Duration {
        if milestones_of(progress) != self.milestones {
            return Duration::ZERO;
        }
        let untouched = now.saturating_duration_since(self.touched);
        self.took.mul_f64(IN_FRAMES + untouched.as_secs_f64()).clamp(MIN_WAIT, MAX_WAIT)
    }
}

fn milestones_of(progress: &ViewProgress) -> [bool; 2] {
    [progress.covered, progress.idle]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_become_rarer_but_what_is_whole_or_complete_is_shown_at_once() {
        let begun = Instant::now();
        let after = |secs: u64| begun + Duration::from_secs(secs);
        let mut pace = NewsPace::new(begun);
        let coarse = ViewProgress { covered: true, ..ViewProgress::default() };
        let complete = ViewProgress { idle: true, ..coarse };
        assert_eq!(pace.pause(&ViewProgress::default(), begun), MIN_WAIT);
        assert_eq!(pace.pause(&coarse, begun), Duration::ZERO, "the first map");
        pace.drew(Duration::from_millis(50), &coarse);
        assert_eq!(pace.pause(&coarse, after(0)), Duration::from_millis(300));
        assert_eq!(pace.pause(&coarse, after(4)), Duration::from_millis(500));
        assert_eq!(pace.pause(&coarse, after(1000)), MAX_WAIT);
        assert_eq!(pace.pause(&complete, after(4)), Duration::ZERO, "the last map");
        pace.touch(after(1000));
        assert_eq!(pace.pause(&coarse, after(1000)), Duration::from_millis(300));
        pace.drew(Duration::from_millis(2), &coarse);
        assert_eq!(pace.pause(&coarse, after(1010)), MIN_WAIT, "a graphics card is hardly slowed");
    }
}
