//! The colours of a view that is narrower than the home map, spread over its own times.

use super::camera::{Camera, Screen};
use super::samples_in_view;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::palette::{ViewTimes, budget_range_secs};
use flipmap_scene::{PictureTable, Scene};

/// Time in s that passes between two changes of the colours while the view moves.
const PAUSE_SECS: f64 = 0.1;
/// Number of different times below which those of a view that is not complete are taken for
/// samples of a much wider one: spread over them, the colours would jump to the palette's ends.
const FEW_TIMES: usize = 64;
/// Distance, in widths of the view, and logarithm of a zoom that do not change the colours.
const NEAR: f64 = 0.02;

/// The view over whose times the colours were last spread, if they follow the view.
#[derive(Debug, Default)]
pub struct ColourSpread(Option<Spread>);

#[derive(Debug)]
struct Spread {
    /// The largest difference of the view's times in s, if it is flat.
    flat_secs: Option<f64>,
    camera: Camera,
    at_secs: f64,
    /// True if the view was complete.
    complete: bool,
    /// The times of the colours in s.
    times: Vec<f64>,
}

impl ColourSpread {
    /// Returns the largest difference of the view's times in s, if the view is complete and flat.
    pub fn flat_secs(&self) -> Option<f64> {
        self.0.as_ref().filter(|spread| spread.complete)?.flat_secs
    }

    /// Spreads the palette of a picture over the flip times of a screen's view as far as they are
    /// known, and again once the view has moved or is `complete`. `now_secs` is the moment of a
    /// clock. Times that the user chose are left alone. Returns true if the colours have changed.
    pub fn follow(
        &mut self,
        (screen, scene): (&Screen, &Scene),
        picture: &mut PictureTable,
        explorer: &mut Explorer,
        (now_secs, complete): (f64, bool),
    ) -> bool {
        let camera = screen.camera;
        if !picture.follows_view() || !picture.paints_times(scene.question.ask) {
            self.0 = None;
            return false;
        }
        if ViewTimes::weight(camera.width_rad) == 0.0 {
            self.0 = None;
            return paint(picture, Vec::new());
        }
        let holds = |spread: &&Spread| spread.holds(&camera, now_secs, complete);
        if let Some(spread) = self.0.as_ref().filter(holds) {
            // Another palette or a step of the history may have come without them.
            return paint(picture, spread.times.clone());
        }
        let times = samples_in_view::spread_times(screen, explorer);
        let times = ViewTimes::new(times.into_iter());
        let (unit_secs, budget_secs) = (scene.build.unit_secs(), scene.question.budget.secs);
        let budget_range_secs = budget_range_secs(unit_secs, budget_secs);
        let weight = ViewTimes::weight(camera.width_rad);
        let is_coarse = !complete && times.distinct() < FEW_TIMES;
        let mut spread =
            if is_coarse { Vec::new() } else { times.spread(weight, budget_range_secs) };
        if spread.is_empty() {
            // Where nothing flips yet, or a few samples fill the view, the colours wait for times.
            spread.clone_from(&picture.times);
        }
        self.0 = Some(Spread {
            flat_secs: times.flat_secs(),
            camera,
            at_secs: now_secs,
            complete,
            times: spread.clone(),
        });
        paint(picture, spread)
    }
}

impl Spread {
    /// Returns true if the colours of a view need no change: it is the same, or it moves and they
    /// have just changed.
    fn holds(&self, camera: &Camera, now_secs: f64, complete: bool) -> bool {
        let away = self.camera.offset_of(camera.center).length() / camera.width_rad;
        let zoom = (self.camera.width_rad / camera.width_rad).ln().abs();
        let is_near = away < NEAR && zoom < NEAR;
        (is_near && self.complete) || (!complete && now_secs < self.at_secs + PAUSE_SECS)
    }
}

/// Replaces the times of the colours by some of the view's own; returns true if they differ.
fn paint(picture: &mut PictureTable, times: Vec<f64>) -> bool {
    picture.of_view = !times.is_empty();
    let differ = picture.times != times;
    picture.times = times;
    differ
}
