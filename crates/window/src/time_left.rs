//! The time until a view is complete, estimated from its progress so far.

use std::time::{Duration, Instant};

use flipmap_render::tiles::explorer::ViewProgress;
use flipmap_screen::camera::Camera;

/// The progress of the newest view since it was first aimed at.
#[derive(Debug, Default)]
pub(crate) struct TimeLeft {
    began: Option<Began>,
    latest: Option<(Instant, f64)>,
}

/// A view, and how much of its way was done when it was first aimed at.
#[derive(Debug)]
struct Began {
    camera: Camera,
    wanted: usize,
    way: f64,
    at: Instant,
}

/// Time for which a view must be computed before its end is estimated.
const MIN_MEASURED: Duration = Duration::from_secs(1);

impl TimeLeft {
    /// Reads the progress of a view.
    pub(crate) fn read(&mut self, camera: Camera, progress: &ViewProgress, now: Instant) {
        let ViewProgress { wanted, way, .. } = *progress;
        let goes_on =
            |began: &Began| began.camera == camera && began.wanted == wanted && began.way <= way;
        if !self.began.as_ref().is_some_and(goes_on) {
            self.began = Some(Began { camera, wanted, way, at: now });
        }
        self.latest = Some((now, way));
    }

    /// Returns the seconds until the view is complete; none while they cannot be estimated.
    pub(crate) fn secs(&self) -> Option<f64> {
        let (began, (now, way)) = (self.began.as_ref()?, self.latest?);
        let (gained, took) = (way - began.way, now.duration_since(began.at));
        let tells = gained > 0.0 && way < 1.0 && took >= MIN_MEASURED;
        tells.then(|| took.as_secs_f64() * (1.0 - way) / gained)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_screen::reach::Reach;

    #[test]
    fn what_is_left_takes_as_long_as_what_was_done_and_another_view_begins_anew() {
        let (begun, home) = (Instant::now(), Camera::whole(Reach::TORUS));
        let mut left = TimeLeft::default();
        // Shares are 64ths, which add up exactly.
        let mut read = |camera: Camera, ms: u64, of_64: u32| {
            let way = f64::from(of_64) / 64.0;
            let progress = ViewProgress { wanted: 100, way, ..ViewProgress::default() };
            left.read(camera, &progress, begun + Duration::from_millis(ms));
            left.secs()
        };
        assert_eq!(read(home, 0, 16), None, "nothing is known yet");
        assert_eq!(read(home, 500, 20), None, "too early to tell");
        assert_eq!(read(home, 2000, 32), Some(4.0));
        assert_eq!(read(home, 5000, 64), None, "complete");
        let deeper = Camera { width_rad: 1.0, ..home };
        assert_eq!(read(deeper, 5000, 32), None);
        assert_eq!(read(deeper, 7000, 48), Some(2.0));
        assert_eq!(read(deeper, 8000, 8), None, "a larger budget");
        assert_eq!(read(deeper, 10_000, 36), Some(2.0));
    }
}
