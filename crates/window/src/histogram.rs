//! The flip times in view, for the histogram over a gradient.

use super::state::AppState;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::Scene;
use flipmap_scene::palette::Tones;
use flipmap_screen::camera::Camera;
use flipmap_screen::samples_in_view;

/// Time in s between two looks at a view that is not complete.
const PAUSE_SECS: f64 = 0.5;

/// The known flip times at evenly spaced places of the view.
#[derive(Default)]
pub(super) struct TimesInView {
    times_secs: Vec<f64>,
    /// The view, what is asked there, and if it was complete.
    of: Option<(Camera, Scene, bool)>,
    at_secs: f64,
}

impl TimesInView {
    /// Returns the times of the view in s as far as they are known. They are looked up again once
    /// the view has changed or more of it may be known.
    pub(super) fn follow(
        &mut self,
        state: &AppState,
        explorer: &mut Explorer,
        complete: bool,
    ) -> &[f64] {
        let of = Some((state.camera, state.scene(), complete));
        let waits = !complete && (0.0..PAUSE_SECS).contains(&(state.now_secs - self.at_secs));
        if self.of.is_some() && (waits || (complete && self.of == of)) {
            return &self.times_secs;
        }
        self.times_secs = samples_in_view::spread_times(&state.screen(), explorer);
        (self.of, self.at_secs) = (of, state.now_secs);
        &self.times_secs
    }
}

/// Returns how often each of `count` equal parts of the palette is used for these times: the square
/// root of its share of the most frequent one, so that rare parts are seen as well.
pub(crate) fn bars(times_secs: &[f64], tones: &Tones, count: usize) -> Vec<f32> {
    let mut bars = vec![0u32; count];
    for secs in times_secs {
        let place = (tones.position(*secs) * count as f64) as usize;
        bars[place.min(count - 1)] += 1;
    }
    let most = bars.iter().max().copied().unwrap_or(0).max(1);
    bars.into_iter().map(|bar| (bar as f32 / most as f32).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::PictureTable;

    #[test]
    fn bars_lie_where_the_palette_is_used() {
        let picture = PictureTable { times: vec![1.0, 100.0], ..PictureTable::default() };
        let tones = |reverse| Tones::new(&PictureTable { reverse, ..picture.clone() }, 0.3, 30.0);
        let times = [0.5, 1.0, 1.1, 1.2, 99.0];
        assert_eq!(bars(&times, &tones(false).unwrap(), 4), [1.0, 0.0, 0.0, 0.5]);
        assert_eq!(bars(&times, &tones(true).unwrap(), 4), [0.5, 0.0, 0.0, 1.0]);
        assert_eq!(bars(&[], &tones(true).unwrap(), 4), [0.0; 4]);
    }
}
