//! The gradual change of the colours from one range of times to another.

use flipmap_scene::palette::TimeScale;
use flipmap_scene::{PictureTable, Scale};

/// Duration of the change in s.
const GLIDE_SECS: f64 = 0.3;
/// Number of equal steps of the palette whose times glide.
const STEPS: usize = 64;

/// The range of times that is shown, while it changes to another.
#[derive(Debug, Default)]
pub struct Glide {
    to: Option<TimeScale>,
    /// Times in s at equal steps of the palette when the change began, and the beginning on the
    /// window's clock, in s.
    from: Option<(Vec<f64>, f64)>,
}

impl Glide {
    /// Returns the picture to show at a moment of the window's clock while its colours change to
    /// `scale`, the picture's own; none if the change is over or if `moves` is false.
    pub fn shown(
        &mut self,
        picture: &PictureTable,
        scale: &TimeScale,
        now_secs: f64,
        moves: bool,
    ) -> Option<PictureTable> {
        if self.to.as_ref() != Some(scale) {
            let from = self.to.as_ref().map(|to| (self.times(to, now_secs), now_secs));
            let glides = moves && picture.scale != Scale::Steps;
            self.from = from.filter(|(times, _)| glides && overlap(times, scale));
            self.to = Some(scale.clone());
        }
        let (_, began_secs) = self.from.as_ref()?;
        if now_secs >= began_secs + GLIDE_SECS || picture.scale == Scale::Steps {
            self.from = None;
            return None;
        }
        let times = self.times(scale, now_secs);
        Some(PictureTable { times, ..picture.clone() })
    }

    /// Returns true while the colours change.
    pub fn is_under_way(&self) -> bool {
        self.from.is_some()
    }

    /// Returns the times in s at equal steps of the palette, which change gradually to those of
    /// `to`.
    fn times(&self, to: &TimeScale, now_secs: f64) -> Vec<f64> {
        let own = (0..=STEPS).map(|k| to.secs_at(k as f64 / STEPS as f64));
        let Some((from, began_secs)) = &self.from else { return own.collect() };
        let share = ((now_secs - began_secs) / GLIDE_SECS).clamp(0.0, 1.0);
        let share = share * share * (3.0 - 2.0 * share);
        own.zip(from).map(|(to, from)| from.powf(1.0 - share) * to.powf(share)).collect()
    }
}

/// Returns true if times in s, ascending, and a scale have some in common. Otherwise all that is
/// shown would have the last or the first colour while the colours glide.
fn overlap(times: &[f64], scale: &TimeScale) -> bool {
    let [first, last] = scale.range_secs();
    times[0] <= last && first <= times[times.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::palette::Tones;

    #[test]
    fn times_move_gradually_and_from_where_they_are() {
        let picture = |times: &[f64]| PictureTable { times: times.to_vec(), ..Default::default() };
        let tones = |picture: &PictureTable| Tones::new(picture, 0.3, 30.0).unwrap();
        let [early, late] = [picture(&[1.0, 10.0]), picture(&[4.0, 5.0, 20.0])];
        let mut glide = Glide::default();
        let mut first = |picture: &PictureTable, now_secs| {
            let scale = tones(picture).scale().clone();
            let shown = glide.shown(picture, &scale, now_secs, true);
            shown.map(|shown| {
                shown.check().unwrap();
                shown.times[0]
            })
        };
        assert_eq!(first(&early, 0.0), None, "nothing to come from");
        let began = first(&late, 1.0).unwrap();
        let middle = first(&late, 1.15).unwrap();
        assert!((began - 1.0).abs() < 1e-9 && (middle - 2.0).abs() < 1e-9, "{began} {middle}");
        let back = first(&early, 1.15).unwrap();
        assert!((back - middle).abs() < 1e-9, "no jump when it turns round");
        assert_eq!(first(&early, 1.5), None);
        let much_later = picture(&[30.0, 40.0]);
        assert_eq!(first(&much_later, 1.6), None, "no time in common");
        assert_eq!(first(&early, 1.7), None);
        let scale = tones(&late).scale().clone();
        assert_eq!(glide.shown(&late, &scale, 2.0, false), None, "nothing moves");
    }
}
