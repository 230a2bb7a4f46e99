//! The time until a view is complete, estimated from its progress so far.

use std::time::{Duration, Instant};

use super::camera::Camera;
use crate::tiles::explorer::ViewProgress;

/// The progress of the newest view since it was first aimed at.
#[derive(Debug, Default)]
pub struct TimeLeft {
    began: Option<Began>,
    latest: Option<(Instant, usize)>,
}

/// A view, and how much of it was known when it was first aimed at.
#[derive(Debug)]
struct Began {
    camera: Camera,
    wanted: usize,
    done: usize,
    at: Instant,
}

/// Time that a view must have been computed before anything is said of its end.
const LEAST: Duration = Duration::from_secs(1);

impl TimeLeft {
    /// Reads the progress of a view.
    pub fn read(&mut self, camera: Camera, progress: &ViewProgress, now: Instant) {
        let ViewProgress { wanted, done, .. } = *progress;
        let goes_on =
            |began: &Began| began.camera == camera && began.wanted == wanted && began.done <= done;
        if !self.began.as_ref().is_some_and(goes_on) {
            self.began = Some(Began { camera, wanted, done, at: now });
        }
        self.latest = Some((now, done));
    }

    /// Returns the seconds until the view is complete; none while they cannot be estimated.
    pub fn secs(&self) -> Option<f64> {
        let (began, (now, done)) = (self.began.as_ref()?, self.latest?);
        let (gained, took) = (done - began.done, now.duration_since(began.at));
        let tells = gained > 0 && done < began.wanted && took >= LEAST;
        tells.then(|| took.as_secs_f64() * (began.wanted - done) as f64 / gained as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::reach::Reach;

    #[test]
    fn what_is_left_takes_as_long_as_what_was_done_and_another_view_begins_anew() {
        let (begun, home) = (Instant::now(), Camera::whole(Reach::TORUS));
        let mut left = TimeLeft::default();
        let mut read = |camera: Camera, ms: u64, done: usize| {
            let progress = ViewProgress { wanted: 100, done, ..ViewProgress::default() };
            left.read(camera, &progress, begun + Duration::from_millis(ms));
            left.secs()
        };
        assert_eq!(read(home, 0, 20), None, "nothing is known yet");
        assert_eq!(read(home, 500, 30), None, "too early to tell");
        assert_eq!(read(home, 2000, 40), Some(6.0));
        assert_eq!(read(home, 5000, 100), None, "complete");
        let deeper = Camera { width_rad: 1.0, ..home };
        assert_eq!(read(deeper, 5000, 50), None);
        assert_eq!(read(deeper, 7000, 75), Some(2.0));
        assert_eq!(read(deeper, 8000, 10), None, "a larger budget");
        assert_eq!(read(deeper, 10_000, 55), Some(2.0));
    }
}
