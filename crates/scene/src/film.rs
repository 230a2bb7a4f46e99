//! A film: the camera's path through its keys, and the frames along it.
//!
//! Between two keys the width changes by equal ratios in equal times, and the centre moves so that
//! one point of the plane stays where it is on the screen: a zoom has the same visible speed at
//! every depth. The stretch also changes by equal ratios, and everything else linearly.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::allowed::between;
use super::exact_length::exactly;
use super::keys::Key;
use super::{
    Axis, Budget, PendulumSpec, Plane, QuestionSettings, Sampling, Scene, SceneError, View,
};
use flipmap_numbers::{Decimal, Exact, Scalar};

/// A film: frames of one size along a path of keys.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// Width and height in pixels.
    #[serde(deserialize_with = "exactly")]
    pub size: [u32; 2],
    /// Number of frames; the first shows the first key and the last shows the last one.
    pub frames: u32,
    /// Frames per second.
    pub fps: f64,
    /// The keys of the camera's path, ordered by time.
    #[serde(rename = "key")]
    pub keys: Vec<Key>,
}

/// The way in which the frames of a film are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmKind {
    /// Frames painted from samples of first flips from rest, which are computed once for all
    /// frames.
    Flips,
    /// Answers of one view at later and later times: every trajectory is computed once.
    Moments,
    /// Frames that are each computed as a still.
    Stills,
}

/// The content of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// The scene, with the budget at that moment.
    pub scene: Scene,
    /// Simulated seconds that have passed, if the film has a clock; later flips are still dark.
    pub clock_secs: Option<f64>,
}

/// Reasons why keys do not make a film.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilmError {
    /// Too few keys: the camera has nowhere to go.
    #[error("a film needs two keys or more, and this one has {0}")]
    Few(usize),
    /// A setting that films do not support, or a number out of range.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// A change of a property that cannot change gradually.
    #[error("key {number} has another {what} than the first; in a film it stays the same")]
    Jumps {
        /// Number of the key, from 1.
        number: usize,
        /// The property that differs.
        what: &'static str,
    },
    /// A clock in a film that does not show first flips from rest.
    #[error(
        "key {number} has a clock, which lights up first flips from rest; for other answers, vary \
         at, budget, energy, friction, gravity, masses or lengths"
    )]
    Timeless {
        /// Number of the key, from 1.
        number: usize,
    },
    /// Keys that are all the same.
    #[error(
        "nothing changes from the first key to the last, so all frames would be the same: change the \
         view, the clock or the pendulum, or make one frame"
    )]
    Still,
    /// A number of frames that does not last as long as the film.
    #[error(
        "{frames} frames at {fps} per second last {lasts:.2} s, and the film {secs} s: leave out one \
         of the three"
    )]
    Length {
        /// Number of frames.
        frames: u32,
        /// Frames per second.
        fps: f64,
        /// Seconds that they last.
        lasts: f64,
        /// Seconds that the film was to last.
        secs: f64,
    },
    /// A length that takes too many frames.
    #[error(
        "a film of {secs} s needs {needed} frames at {fps} per second, and a film has {} at most: give \
         fewer seconds, frames per second or frames",
        Film::MAX_FRAMES
    )]
    Long {
        /// Length of the film, s.
        secs: f64,
        /// Frames per second.
        fps: f64,
        /// Number of frames.
        needed: f64,
    },
    /// A clock that starts or stops partway through the film.
    #[error("key {number} {has} a clock and the first {first}: give it to all keys or to none")]
    Clock {
        /// Number of the key, from 1.
        number: usize,
        /// Verb for this key: `has` or `lacks`.
        has: &'static str,
        /// Verb for the first key: `has` or `lacks`.
        first: &'static str,
    },
}

/// Largest number of samples in a frame.
const MAX_SAMPLES: u64 = 500_000_000;

impl Film {
    /// Largest number of frames: nearly an hour at 30 frames per second. More take too long to
    /// plan.
    pub const MAX_FRAMES: u32 = 100_000;
    /// Range of the frames per second.
    pub const FPS: RangeInclusive<f64> = 0.1..=1000.0;

    /// Samples of each pixel unless they are chosen.
    pub const SAMPLES: Sampling = Sampling::Square(2);

    /// Gives all keys the picture and the run of the first and views that fill the frames, refuses
    /// keys that do not make a film, and settles what the others leave open. Each key must have been
    /// checked by itself before.
    pub fn settled(mut self) -> Result<Self, FilmError> {
        let size = self.size.map(f64::from);
        if let [first, others @ ..] = &mut self.keys[..] {
            for key in others {
                key.scene.picture.clone_from(&first.scene.picture);
                key.scene.run.clone_from(&first.scene.run);
            }
        }
        for key in &mut self.keys {
            key.scene.view = key.scene.view.fitted(size);
        }
        self.check()?;
        for key in &mut self.keys {
            key.scene = std::mem::take(&mut key.scene).settled();
        }
        Ok(self)
    }

    /// Refuses keys that do not make a film. Each key must have been checked by itself before.
    pub fn check(&self) -> Result<(), FilmError> {
        let within = |setting, value: f64, range: RangeInclusive<f64>| {
            let allowed = format!("it must lie {}", between(&range));
            let error = || SceneError::new(setting, value.to_string(), allowed);
            if range.contains(&value) { Ok(()) } else { Err(error()) }
        };
        within("frames", f64::from(self.frames), 1.0..=f64::from(Self::MAX_FRAMES))?;
        within("fps", self.fps, Self::FPS)?;
        let [first, _, ..] = &self.keys[..] else { return Err(FilmError::Few(self.keys.len())) };
        let (size, samples) = (self.size, first.scene.picture.samples.along());
        let [width, height] = size.map(|side| u64::from(side) * u64::from(samples));
        if width * height > MAX_SAMPLES {
            let value = format!("{}x{} with samples {samples}", size[0], size[1]);
            let allowed = format!(
                "that is too much for a film: at most {} million samples fit in a frame",
                MAX_SAMPLES / 1_000_000
            );
            return Err(SceneError::new("size", value, allowed).into());
        }
        let shows = |key: &Key| (key.scene.scene(), key.clock);
        if self.frames > 1 && self.keys.iter().all(|key| shows(key) == shows(first)) {
            return Err(FilmError::Still);
        }
        let is_of_flips = self.kind() == FilmKind::Flips;
        for (key, number) in self.keys.iter().zip(1..) {
            let jumps = |what| Err(FilmError::Jumps { number, what });
            let asked = |key: &Key| (key.scene.question.ask, key.scene.question.count);
            if asked(key) != asked(first) {
                return jumps("question");
            }
            let place = |key: &Key| (key.scene.plane.kind, key.scene.plane.origin.clone());
            if place(key) != place(first) {
                return jumps("plane");
            }
            if key.clock.is_some() && !is_of_flips {
                return Err(FilmError::Timeless { number });
            }
            if key.scene.question.rule != first.scene.question.rule {
                return jumps("rule");
            }
            if key.scene.pendulum.kind != first.scene.pendulum.kind {
                return jumps("kind of pendulum");
            }
            if key.clock.is_some() != first.clock.is_some() {
                let has = |key: &Key| if key.clock.is_some() { "has" } else { "lacks" };
                return Err(FilmError::Clock { number, has: has(key), first: has(first) });
            }
            within("clock", key.clock.unwrap_or(0.0), 0.0..=*Budget::SECS.end())?;
        }
        Ok(())
    }

    /// Returns the way in which the film's frames are made.
    pub fn kind(&self) -> FilmKind {
        let scenes: Vec<Scene> = self.keys.iter().map(|key| key.scene.scene()).collect();
        let goes_on = |pair: &[Scene]| {
            let [a, b] = pair else { return false };
            let same = (a.build, &a.view, &a.plane, a.question.ask)
                == (b.build, &b.view, &b.plane, b.question.ask);
            same && b.question.end_secs() >= a.question.end_secs()
        };
        if scenes.iter().all(Scene::is_flip_from_rest) {
            FilmKind::Flips
        } else if scenes.iter().all(|scene| scene.question.ask.kind().at_a_time)
            && scenes.windows(2).all(goes_on)
        {
            FilmKind::Moments
        } else {
            FilmKind::Stills
        }
    }

    /// Returns the largest budget of the film, in s.
    pub fn budget_secs(&self) -> f64 {
        self.keys.iter().map(|key| key.scene.question.budget.secs).fold(0.0, f64::max)
    }

    /// Returns the time in s until which a shot shows flips: its own budget if the camera stays,
    /// and otherwise the film's largest budget, so that a place looks the same in every frame.
    pub fn shown_secs(&self, shot: &Shot) -> f64 {
        if self.stays() { shot.scene.question.budget.secs } else { self.budget_secs() }
    }

    /// Returns true if all keys have the same view.
    fn stays(&self) -> bool {
        self.keys.iter().all(|key| key.scene.view == self.keys[0].scene.view)
    }

    /// Returns the content of frame `frame`, counted from 0.
    pub fn shot(&self, frame: u32) -> Shot {
        let [first, last] = [&self.keys[0], &self.keys[self.keys.len() - 1]];
        let share = f64::from(frame) / f64::from((self.frames - 1).max(1));
        self.shot_at(first.secs + (last.secs - first.secs) * share.min(1.0))
    }

    /// Returns the content of the film at `secs` in s, measured as in the keys.
    pub fn shot_at(&self, secs: f64) -> Shot {
        let next = self.keys.partition_point(|key| key.secs <= secs);
        let next = next.clamp(1, self.keys.len() - 1);
        let [from, to] = [&self.keys[next - 1], &self.keys[next]];
        let time = ((secs - from.secs) / (to.secs - from.secs)).clamp(0.0, 1.0);
        self.between(from, to, to.easing.share(time))
    }

    /// Returns the content after `share` of the way from one key to the next.
    fn between(&self, from: &Key, to: &Key, share: f64) -> Shot {
        let [a, b] = [from.scene.scene(), to.scene.scene()];
        let mix = |a: f64, b: f64| if a == b { a } else { a + (b - a) * share };
        let exact = |a: Decimal, b: Decimal| match a == b {
            true => a,
            false => mix(a.value(), b.value()).into(),
        };
        let pair = |a: [Decimal; 2], b: [Decimal; 2]| [exact(a[0], b[0]), exact(a[1], b[1])];
        let build = PendulumSpec {
            kind: a.build.kind,
            masses: pair(a.build.masses, b.build.masses),
            lengths: pair(a.build.lengths, b.build.lengths),
            gravity: exact(a.build.gravity, b.build.gravity),
            friction: pair(a.build.friction, b.build.friction),
        };
        let view = between_views(&a.view, &b.view, share, a.plane.axes().map(Axis::wraps));
        let ends = [&a, &b].map(|scene| (scene.question.budget, &scene.view));
        let evenly = mix(a.question.budget.secs, b.question.budget.secs);
        let budget = Budget::on_the_way(ends, &view).map_or(evenly, |secs| secs.min(evenly));
        let at = a.question.at.zip(b.question.at).map(|(a, b)| mix(a, b));
        let question = QuestionSettings { budget: Budget::secs(budget), at, ..a.question };
        let plane = Plane { energy: mix(a.plane.energy, b.plane.energy), ..a.plane };
        let clock_secs = from.clock.zip(to.clock).map(|(a, b)| mix(a, b));
        Shot { scene: Scene { build, question, view, plane }, clock_secs }
    }
}

/// Returns the view after `share` of the way from `a` to `b`; `wraps` tells which axes wrap around.
fn between_views(a: &View, b: &View, share: f64, wraps: [bool; 2]) -> View {
    if share == 0.0 || a == b {
        return a.clone();
    }
    if share == 1.0 {
        return b.clone();
    }
    let [wide, narrow] = [a, b].map(|view| view.width_rad().to_f64());
    let (width, left) = zoomed(wide, narrow, share);
    let [from, to] = [a.center_rad(), b.center_rad()];
    // Twelve digits below the width tell the pixels of any frame apart.
    let digits = (12.0 - width.log10()).ceil().max(12.0) as usize;
    let center = [0, 1].map(|i| {
        let near = |x: Exact| if wraps[i] { x.wrapped() } else { x };
        let way = near(from[i] - to[i]);
        near(to[i] + way * Exact::from_f64(left)).decimal(digits)
    });
    View {
        center,
        width: format!("{width:e}"),
        rotate: a.rotate + (b.rotate - a.rotate) * share,
        stretch: a.stretch * (b.stretch / a.stretch).powf(share),
        fit: false,
    }
}

/// Returns the width after `share` of a zoom, and the share of the way that the centre still has to
/// go. That share shrinks as the width does, which keeps one point of the plane in its place.
fn zoomed(from: f64, to: f64, share: f64) -> (f64, f64) {
    let ratio = (from / to).ln();
    let width = to * (ratio * (1.0 - share)).exp();
    let left = if ratio.abs() < 1e-9 {
        1.0 - share
    } else {
        (ratio * (1.0 - share)).exp_m1() / ratio.exp_m1()
    };
    (width, left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Document;
    use crate::keys::Easing;

    fn key(secs: f64, change: impl FnOnce(&mut Document)) -> Key {
        let mut scene = Document::default();
        change(&mut scene);
        Key { secs, easing: Easing::Linear, clock: None, scene }
    }

    fn film(keys: Vec<Key>) -> Film {
        Film { size: [64, 48], frames: 11, fps: 25.0, keys }
    }

    fn zoom(width: &str) -> Film {
        let deep = key(10.0, |scene| {
            scene.view.center = ["-1.66".into(), "0.1".into()];
            scene.view.width = width.into();
        });
        film(vec![key(0.0, |_| ()), deep])
    }

    #[test]
    fn a_zoom_has_one_speed_and_a_point_that_stays() {
        for deep in ["1e-3", "1e-60"] {
            let film = zoom(deep);
            let shots: Vec<Scene> = (0..11).map(|frame| film.shot(frame).scene).collect();
            assert_eq!(shots[0].view, film.keys[0].scene.view);
            assert_eq!(shots[10].view, film.keys[1].scene.view);
            let width = |k: usize| shots[k].view.width_rad().to_f64();
            let ratio = width(1) / width(0);
            // The fixed point of the whole zoom, measured from the middle in widths of the view.
            let [a, b] = [0, 10].map(|k: usize| shots[k].view.center_rad());
            let fixed = [0, 1].map(|i| {
                b[i] + (a[i] - b[i]) * Exact::from_f64(-width(10) / (width(0) - width(10)))
            });
            let place = |k: usize| {
                let center = shots[k].view.center_rad();
                [0, 1].map(|i| (fixed[i] - center[i]).to_f64() / width(k))
            };
            for k in 0..10 {
                assert!((width(k + 1) / width(k) / ratio - 1.0).abs() < 1e-9, "{k}");
                for i in 0..2 {
                    assert!((place(k)[i] - place(0)[i]).abs() < 1e-6, "{k}: {:?}", place(k));
                }
            }
        }
    }

    #[test]
    fn a_pan_takes_the_short_way_round_the_torus() {
        let at = |theta: &str| {
            let theta = theta.to_string();
            move |scene: &mut Document| scene.view.center[0] = theta
        };
        let film = film(vec![key(0.0, at("3.1")), key(1.0, at("-3.1"))]);
        let middle = film.shot(5).scene.view.center_rad()[0].to_f64();
        assert!((middle.abs() - std::f64::consts::PI).abs() < 1e-9, "{middle}");
    }

    #[test]
    fn what_changes_changes_evenly() {
        let film = film(vec![
            key(0.0, |_| ()),
            key(1.0, |scene| {
                scene.pendulum.masses[1] = Decimal::from(5.0);
                scene.question.budget = Budget::secs(10.0);
            }),
        ]);
        let shot = film.shot(5).scene;
        assert_eq!((shot.build.masses_kg(), shot.question.budget.secs), ([1.0, 3.0], 20.0));
        assert_eq!(film.budget_secs(), 30.0);
    }

    #[test]
    fn budgets_grow_with_the_depth() {
        let mut film = zoom("1e-3");
        film.keys[1].scene.question.budget = Budget::secs(60.0);
        let budgets = (0..11).map(|frame| film.shot(frame).scene.question.budget.secs);
        assert!(budgets.zip(0..).all(|(secs, frame)| secs == 30.0 + 3.0 * f64::from(frame)));
    }

    #[test]
    fn automatic_budgets_begin_and_end_as_their_keys_have_them() {
        for (wide, deep) in [(30.0, 60.0), (60.0, 30.0), (10.0, 60.0)] {
            let mut film = zoom("1e-9");
            for (key, secs) in film.keys.iter_mut().zip([wide, deep]) {
                key.scene.question.budget = Budget { secs, auto: true };
            }
            let budget = |frame| film.shot(frame).scene.question.budget.secs;
            assert_eq!((budget(0), budget(10)), (wide, deep));
            assert!(budget(5) <= 0.5 * (wide + deep), "{}", budget(5));
        }
        // The pendulum changes while the camera stays.
        let mut film = zoom("1e-9");
        film.keys[0].scene.view = film.keys[1].scene.view.clone();
        for (key, secs) in film.keys.iter_mut().zip([75.0, 35.0]) {
            key.scene.question.budget = Budget { secs, auto: true };
        }
        assert_eq!(film.shot(5).scene.question.budget.secs, 55.0);
    }

    #[test]
    fn the_clock_runs_from_key_to_key() {
        let clock = |secs, clock| Key { clock: Some(clock), ..key(secs, |_| ()) };
        let film = film(vec![clock(0.0, 0.0), clock(1.0, 30.0)]);
        film.check().unwrap();
        assert_eq!(film.shot(5).clock_secs, Some(15.0));
    }

    #[test]
    fn keys_that_are_no_film_are_refused_by_name() {
        let refused = |keys| film(keys).check().unwrap_err().to_string();
        assert!(refused(vec![key(0.0, |_| ())]).contains("two keys or more, and this one has 1"));
        let rods = |scene: &mut Document| scene.pendulum.kind = crate::Kind::Rods;
        assert!(refused(vec![key(0.0, |_| ()), key(1.0, rods)]).contains("key 2 has another kind"));
        let first = |scene: &mut Document| scene.question.rule = flipmap_pendulum::Rule::First;
        assert!(refused(vec![key(0.0, |_| ()), key(1.0, first)]).contains("another rule"));
        let clock = Key { clock: Some(1.0), ..key(1.0, |_| ()) };
        let error = refused(vec![key(0.0, |_| ()), clock]);
        assert!(error.contains("key 2 has a clock and the first lacks"), "{error}");
        let few = Film { frames: 0, ..zoom("1") };
        assert!(
            few.check().unwrap_err().to_string().contains("`frames` is 0; it must lie between 1")
        );
        let one = Film { frames: 1, ..zoom("1") };
        assert!(one.check().is_ok() && one.shot(0) == zoom("1").shot(0));
    }
}
