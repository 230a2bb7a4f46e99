//! The colours of a deep view, spread over the times in it.

use super::camera::Camera;
use super::model::AppModel;
use super::view_samples;
use flipmap_render::tiles::Stride;
use flipmap_scene::PictureTable;
use flipmap_scene::palette::equalised;

/// Number of levels coarser than the finest whose times are good enough for a deep view's colours.
const COARSER: u32 = 3;

impl AppModel {
    /// Spreads the palette over the flip times of a deep view, once the view has some samples
    /// everywhere and again once it is complete: otherwise it would look flat, because its times
    /// lie close together. Colours that the user chose are left alone. Returns true if the colours
    /// have changed.
    pub(super) fn spread_colours(&mut self) -> bool {
        let camera = self.state.target();
        if camera.width_rad >= PictureTable::SPREAD_BELOW_RAD {
            let clear = self.state.spreads && !self.state.picture.times.is_empty();
            if clear {
                self.state.picture.times = Vec::new();
            }
            self.state.spreads = self.state.picture.times.is_empty();
            self.spread_for = None;
            return clear;
        }
        let is_time = self.state.question.ask.is_time();
        if !self.state.spreads || self.state.moving.is_some() || !is_time {
            return false;
        }
        let near = |then: &Camera| {
            let moved = then.offset_of(camera.center).length() < 0.25 * camera.width_rad;
            moved && (then.width_rad / camera.width_rad).ln().abs() < 0.3
        };
        // True if the last spread used the complete view.
        let spread = self.spread_for.filter(|(then, _)| near(then)).map(|(_, fine)| fine);
        if spread == Some(true) {
            return false;
        }
        let (screen, explorer) = (self.state.screen(), &mut self.compute.explorer);
        let Some((level, stride)) = view_samples::whole_level(&screen, COARSER, explorer) else {
            return false;
        };
        let finest = level == screen.level() && stride == Stride::ONE;
        if spread.is_some() && !finest {
            return false;
        }
        self.spread_for = Some((camera, finest));
        let times = view_samples::times_at(&screen, level, explorer);
        let times = equalised(times.into_iter(), PictureTable::SPREAD_STEPS);
        let change = !times.is_empty();
        if change {
            self.state.picture.times = times;
        }
        change
    }
}
