//! How long a film is, and how many frames it has.

use super::Document;
use super::film::{Film, FilmError};
use super::keys::{Easing, Key};
use super::{Scene, View};

/// What is said of a film's length; `None` leaves a number to the program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmLength {
    /// Length, s.
    pub secs: Option<f64>,
    /// Number of frames.
    pub frames: Option<u32>,
    /// Frames per second.
    pub fps: Option<f64>,
}

/// Seconds of film per decade of zoom.
const SECS_A_DECADE: f64 = 1.5;
/// Minimum seconds of film between two scenes.
const MIN_SECS: f64 = 2.0;
/// Default frames per second.
const FPS: f64 = 30.0;

impl FilmLength {
    /// Returns the film along `keys` whose frames have a width and a height in pixels. It is as long
    /// as its keys unless `secs` says otherwise, and has as many frames as that needs.
    pub fn film(self, mut keys: Vec<Key>, size: [u32; 2]) -> Result<Film, FilmError> {
        let [first, .., last] = &keys[..] else { return Err(FilmError::Few(keys.len())) };
        let (first, of_keys) = (first.secs, last.secs - first.secs);
        let stretch = self.secs.map_or(1.0, |secs| secs / of_keys.max(1e-9));
        keys.iter_mut().for_each(|key| key.secs = (key.secs - first) * stretch);
        let secs = keys[keys.len() - 1].secs;
        let fps = self.rate(secs)?;
        let needed = (secs * fps).round().max(2.0);
        if self.frames.is_none() && needed > f64::from(Film::MAX_FRAMES) {
            return Err(FilmError::Long { secs, fps, needed });
        }
        Ok(Film { size, frames: self.frames.unwrap_or(needed as u32), fps, keys })
    }

    /// Returns the frames per second of a film of `secs`.
    fn rate(self, secs: f64) -> Result<f64, FilmError> {
        match (self.fps, self.frames, self.secs) {
            (Some(fps), Some(frames), Some(_)) => {
                let lasts = f64::from(frames) / fps;
                let is_same = (lasts - secs).abs() <= 1.0 / fps;
                if is_same { Ok(fps) } else { Err(FilmError::Length { frames, fps, lasts, secs }) }
            }
            (Some(fps), ..) => Ok(fps),
            (None, Some(frames), Some(_)) => {
                Ok((f64::from(frames) / secs).clamp(*Film::FPS.start(), *Film::FPS.end()))
            }
            (None, ..) => Ok(FPS),
        }
    }
}

/// Returns keys of a zoom through scenes in their order, at a constant visible speed.
pub fn zoom_through(scenes: Vec<Document>) -> Vec<Key> {
    let mut secs = 0.0;
    let mut before: Option<f64> = None;
    let key = |scene: Document| {
        let width = scene.scene().view.width_rad().hi;
        if let Some(before) = before {
            let decades = (width / before).log10().abs();
            secs += (SECS_A_DECADE * decades).max(MIN_SECS);
        }
        before = Some(width);
        Key { secs, easing: Easing::Linear, clock: None, scene }
    };
    scenes.into_iter().map(key).collect()
}

/// Returns the whole map with the question, pendulum and colours of a scene: where a zoom to it
/// begins.
#[must_use]
pub fn home_before(scene: &Document) -> Document {
    scene.clone().with_scene(Scene { view: View::home_of(&scene.plane), ..scene.scene() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys() -> Vec<Key> {
        let mut deep = Document::default();
        deep.view.width = "1e-4".to_string();
        zoom_through(vec![home_before(&deep), deep])
    }

    fn film(length: FilmLength) -> Result<Film, FilmError> {
        length.film(keys(), [64, 48])
    }

    #[test]
    fn a_zoom_lasts_as_long_as_its_decades() {
        let decades = (keys()[0].scene.scene().view.width_rad().hi / 1e-4).log10();
        let made = film(FilmLength::default()).unwrap();
        assert!((made.keys[1].secs - 1.5 * decades).abs() < 1e-9 && made.fps == 30.0);
        assert_eq!(made.frames, (45.0 * decades).round() as u32);
    }

    #[test]
    fn two_of_three_numbers_give_the_third() {
        let (secs, frames, fps) = (Some(5.0), Some(50), Some(10.0));
        for length in [
            FilmLength { secs, frames, fps: None },
            FilmLength { secs, frames: None, fps },
            FilmLength { secs, frames, fps },
        ] {
            let made = film(length).unwrap();
            assert_eq!((made.frames, made.fps, made.keys[1].secs), (50, 10.0, 5.0));
        }
        let refused = film(FilmLength { secs, frames: Some(90), fps }).unwrap_err().to_string();
        assert!(refused.starts_with("90 frames at 10 per second last 9.00 s"), "{refused}");
        let long = FilmLength { secs: Some(1e6), ..FilmLength::default() };
        assert!(film(long).unwrap_err().to_string().contains("needs 30000000 frames"));
    }
}
