//! The colours of a deep view, spread over the times in it.

use super::camera::Camera;
use super::state::AppState;
use super::view_samples;
use flipmap_render::tiles::Stride;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::PictureTable;
use flipmap_scene::palette::equalised;

/// Number of levels coarser than the finest whose times are good enough for a deep view's colours.
const COARSER: u32 = 3;

/// The view over whose times the colours were last spread, and true if it was complete.
#[derive(Debug, Default)]
pub(super) struct ColourSpread(Option<(Camera, bool)>);

impl ColourSpread {
    /// Spreads the palette over the flip times of a deep view, once the view has some samples
    /// everywhere and again once it is complete: otherwise it would look flat, because its times
    /// lie close together. Colours that the user chose are left alone. Returns true if the colours
    /// have changed.
    pub(super) fn follow(&mut self, state: &mut AppState, explorer: &mut Explorer) -> bool {
        let camera = state.target();
        if camera.width_rad >= PictureTable::SPREAD_BELOW_RAD {
            let clear = state.spreads && !state.picture.times.is_empty();
            if clear {
                state.picture.times = Vec::new();
            }
            state.spreads = state.picture.times.is_empty();
            self.0 = None;
            return clear;
        }
        let is_time = state.question.ask.is_time();
        if !state.spreads || state.moving.is_some() || !is_time {
            return false;
        }
        let near = |then: &Camera| {
            let moved = then.offset_of(camera.center).length() < 0.25 * camera.width_rad;
            moved && (then.width_rad / camera.width_rad).ln().abs() < 0.3
        };
        // True if the last spread used the complete view.
        let spread = self.0.filter(|(then, _)| near(then)).map(|(_, fine)| fine);
        if spread == Some(true) {
            return false;
        }
        let screen = state.screen();
        let Some((level, stride)) = view_samples::whole_level(&screen, COARSER, explorer) else {
            return false;
        };
        let finest = level == screen.level() && stride == Stride::ONE;
        if spread.is_some() && !finest {
            return false;
        }
        self.0 = Some((camera, finest));
        let times = view_samples::times_at(&screen, level, explorer);
        let times = equalised(times.into_iter(), PictureTable::SPREAD_STEPS);
        let change = !times.is_empty();
        if change {
            state.picture.times = times;
        }
        change
    }
}
