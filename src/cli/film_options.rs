//! The options that describe a film, and their conversion into its keys.

use std::ops::RangeInclusive;
use std::path::Path;
use std::str::FromStr;

use clap::Args;
use flipmap_engine::run_settings::RunSpec;
use flipmap_numbers::Decimal;
use flipmap_render::output::{holds_keys, read_text};
use flipmap_scene::film::Film;
use flipmap_scene::film_length::{FilmLength, home_before, zoom_through};
use flipmap_scene::keys::{Easing, Key, Keys};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{
    Budget, Document, DocumentError, Setting, between, decimal_hint, named, number, plain_numbers,
};

use super::exit::Exit;
use super::options::{SceneWords, check_run, load};
use super::picture_options::PictureOptions;
use super::run_options::RunOptions;
use super::same_file::Named;

#[derive(Args, Debug, Default)]
pub(super) struct FilmOptions {
    /// A .toml file of keys, or two or more scenes (.toml, .png written by flipmap, or built-in)
    #[arg(value_name = "KEYS.toml|SCENE")]
    scenes: Vec<String>,
    /// Zoom to this scene, starting from home or from the one scene given
    #[arg(long, value_name = "SCENE")]
    zoom_to: Option<String>,
    /// Keep one view and vary time, at, budget, energy, gravity, friction, masses or lengths, as in
    /// time=0..30 or masses=1,1..1,5
    #[arg(long, value_name = "WHAT=FROM..TO", allow_hyphen_values = true)]
    vary: Option<String>,
    /// Length of the film (default: that of the keys, else 1.5 s per decade of zoom, 10 s for one
    /// view)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    secs: Option<String>,
    /// Number of frames (default: as many as the length needs)
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    frames: Option<String>,
    /// Frames per second, also as 30000/1001 (default: 30)
    #[arg(long, value_name = "R", allow_hyphen_values = true)]
    fps: Option<String>,
    #[command(flatten)]
    pub words: SceneWords,
    #[command(flatten)]
    pub run: RunOptions,
    #[command(flatten)]
    pub picture: PictureOptions,
}

/// Seconds of film for a view that does not move.
const SECS_IN_PLACE: f64 = 10.0;

impl FilmOptions {
    /// Returns true if the options describe a film and not a still.
    pub(super) fn says_film(&self) -> bool {
        let one_scene =
            self.scenes.len() < 2 && !self.scenes.iter().any(|name| holds_keys(Path::new(name)));
        let said = [&self.vary, &self.zoom_to, &self.secs, &self.frames, &self.fps];
        !one_scene || said.into_iter().any(Option::is_some)
    }

    /// The files that the film is made from.
    pub(super) fn files(&self) -> Vec<Named<'_>> {
        let scenes = self.scenes.iter().map(|name| ("the scene", Path::new(name)));
        let target = self.zoom_to.iter().map(|name| ("--zoom-to", Path::new(name)));
        let files = scenes.chain(target).filter(|(_, path)| path.exists());
        files.chain(self.picture.palette_file()).collect()
    }

    /// Name of the scene of a still, if one was given.
    pub(super) fn scene(&self) -> Option<&str> {
        self.scenes.first().map(String::as_str)
    }

    /// Returns the checked film and its run settings; all keys get the picture and run tables of
    /// the first.
    pub(super) fn film(&self) -> anyhow::Result<(Film, RunSpec)> {
        let mut keys = self.keys()?;
        same_sizes(&keys, &self.run)?;
        let Some(first) = keys.first_mut() else {
            let message = "the file has no keys; each begins with a line [[key]]";
            return Err(Exit::Usage(message.to_string()).into());
        };
        self.picture.check_film()?;
        // The times of one view do not suit the others.
        first.scene.picture.forget_view_times();
        self.picture.apply(&mut first.scene)?;
        if self.picture.samples.is_none() && first.scene.picture.samples.along() == 1 {
            first.scene.picture.samples = Film::SAMPLES;
        }
        first.scene.picture.check()?;
        let spec = self.run.settle(&mut first.scene)?;
        first.scene.picture.check_size(spec.size())?;
        let film = self.length()?.film(keys, spec.size()).and_then(Film::settled);
        Ok((film.map_err(|why| Exit::usage(&why))?, spec))
    }

    /// Returns the keys with the scene options applied to each, or to the one scene of `--vary`.
    fn keys(&self) -> anyhow::Result<Vec<Key>> {
        let usage = |message: &str| Err(Exit::Usage(message.to_string()).into());
        let mut keys = match (&self.scenes[..], &self.zoom_to, &self.vary) {
            (_, Some(_), Some(_)) => {
                return usage("--zoom-to and --vary exclude each other; give one");
            }
            ([_, _, ..], Some(_), _) | ([_, _, ..], _, Some(_)) => {
                return usage(
                    "--zoom-to and --vary begin with one scene, and more are named: name one, or \
                     leave the option out",
                );
            }
            ([keys], _, Some(_)) if holds_keys(Path::new(keys)) => {
                return usage(
                    "a file of keys says itself what changes: give --vary one scene, or leave it out",
                );
            }
            ([] | [_], None, Some(vary)) => {
                let scene = self.words.apply(self.words.base(self.scene())?)?.settled();
                return varied(scene, vary, &self.words);
            }
            ([] | [_], Some(to), None) => return self.zoom(to),
            ([keys], None, None) if is_toml(keys) => read_keys(keys)?,
            ([_, _, ..], None, None) => {
                let scenes: anyhow::Result<Vec<Document>> =
                    self.scenes.iter().map(|name| load(name)).collect();
                zoom_through(scenes?)
            }
            ([] | [_], None, None) => {
                return usage(
                    "a film needs a file of keys, two or more scenes, --zoom-to SCENE, or --vary \
                     WHAT=FROM..TO",
                );
            }
        };
        if self.words.says_view() {
            return usage(
                "--center, --width, --rotate and --stretch would give all keys the same view: name \
                 the scene at the end with --zoom-to, or write the views into the scenes",
            );
        }
        for key in &mut keys {
            key.scene = self.words.apply(std::mem::take(&mut key.scene))?;
        }
        Ok(keys)
    }

    /// Returns keys of a zoom to a scene, from the named one or from home with the target's
    /// question. Options of the view say where the zoom ends.
    fn zoom(&self, to: &str) -> anyhow::Result<Vec<Key>> {
        let mut to = self.words.apply(load(to)?)?;
        // These times suit the view at the end, not the zoom towards it.
        to.picture.times.clear();
        let from = match self.scenes.first() {
            Some(name) => self.words.without_view().apply(load(name)?)?,
            None => home_before(&to),
        };
        Ok(zoom_through(vec![from, to]))
    }

    /// Returns what the options say of the film's length.
    fn length(&self) -> Result<FilmLength, Exit> {
        let said = |option: &str, text: &Option<String>, range| {
            text.as_ref().map(|text| number_or_ratio(option, text, range)).transpose()
        };
        let secs = said("--secs", &self.secs, 0.01..=1e6)?;
        let frames = said("--frames", &self.frames, 1.0..=f64::from(Film::MAX_FRAMES))?;
        if frames.is_some_and(|frames| frames.fract() != 0.0) {
            return Err(Exit::Usage("--frames must be a whole number".to_string()));
        }
        let fps = said("--fps", &self.fps, Film::FPS)?;
        Ok(FilmLength { secs, frames: frames.map(|frames| frames as u32), fps })
    }
}

/// Reads an option that is a number, or a ratio of two such as 30000/1001, within a range.
pub(super) fn number_or_ratio(
    option: &str,
    text: &str,
    range: RangeInclusive<f64>,
) -> Result<f64, Exit> {
    let number = match text.split_once('/') {
        Some((above, below)) => {
            number(above).zip(number(below)).map(|(above, below)| above / below)
        }
        None => number(text),
    };
    number.filter(|number| range.contains(number)).ok_or_else(|| {
        let (range, hint) = (between(&range), decimal_hint(text, 1));
        Exit::Usage(format!("{option} is '{text}'; it must lie {range}{hint}"))
    })
}

fn is_toml(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

fn read_keys(name: &str) -> Result<Vec<Key>, Exit> {
    let refuse = |why: &dyn std::fmt::Display| Exit::Usage(format!("{name}: {why}"));
    let text =
        read_text(Path::new(name)).map_err(|error| refuse(&format!("cannot be read: {error}")))?;
    if !text.contains("[[key]]") {
        return Err(refuse(
            &"there are no keys in it (each begins with a line [[key]]); a film of one scene \
              needs --zoom-to or --vary, and a plan is for flipmap run and merge",
        ));
    }
    let keys = Keys::parse(&text).map_err(|why| refuse(&why))?.keys;
    for (key, number) in keys.iter().zip(1..) {
        check_run(&key.scene.run, &format!("{name}: key {number}"))?;
    }
    Ok(keys)
}

/// The quantities that `--vary` changes, and how many numbers each has.
const VARIED: [(&str, usize); 8] = [
    ("time", 1),
    ("at", 1),
    ("budget", 1),
    ("energy", 1),
    ("gravity", 1),
    ("friction", 2),
    ("masses", 2),
    ("lengths", 2),
];

/// Returns the usage error for a `--vary` that cannot be read.
fn unreadable(vary: &str) -> Exit {
    let (word, values) = vary.split_once('=').unwrap_or((vary, ""));
    let why = match named("quantities", &VARIED, word) {
        Err(known) => known,
        Ok(count) => {
            let number = if count == 1 { "one number" } else { "two numbers with a comma" };
            let hints = values.split("..").map(|value| decimal_hint(value, count));
            let hint = hints.max_by_key(String::len).unwrap_or_default();
            format!(
                "{word} takes two values of {number} each, as in time=0..30 or masses=1,1..1,5{hint}"
            )
        }
    };
    Exit::Usage(format!("--vary is '{vary}'; {why}"))
}

/// Returns keys of one view in which one quantity changes. A question or budget in `words` is kept.
fn varied(scene: Document, vary: &str, words: &SceneWords) -> anyhow::Result<Vec<Key>> {
    let wrong = || unreadable(vary);
    let (word, values) = vary.split_once('=').ok_or_else(wrong)?;
    let (from, to) = values.split_once("..").ok_or_else(wrong)?;
    let key = |secs: f64, text: &str| -> anyhow::Result<Key> {
        let mut key = Key { secs, easing: Easing::Linear, clock: None, scene: scene.clone() };
        let one = || number(text).ok_or_else(wrong);
        let latest = [from, to].into_iter().filter_map(number).fold(0.0, f64::max);
        let latest = if words.says(Setting::Budget) { 0.0 } else { latest };
        let exact = |text: &str| Decimal::from_str(&plain_numbers(text)).map_err(|()| wrong());
        let two = || {
            let (first, second) = text.split_once(',').ok_or_else(wrong)?;
            Ok::<_, Exit>([exact(first)?, exact(second)?])
        };
        match word {
            "time" => {
                key.clock = Some(one()?);
                // The budget reaches the latest time, so that flips can be seen until then.
                let budget = &mut key.scene.question.budget;
                budget.secs = budget.secs.max(latest);
                budget.auto &= budget.secs > latest;
            }
            "at" => {
                if !words.says(Setting::Ask) && !key.scene.question.ask.kind().at_a_time {
                    key.scene = asking_state(key.scene, words);
                }
                let question = &mut key.scene.question;
                question.at = Some(one()?);
                question.budget.secs = question.budget.secs.max(latest);
            }
            "budget" => key.scene.question.budget = Budget::secs(one()?),
            "energy" => key.scene.plane.energy = one()?,
            "friction" => key.scene.pendulum.friction = two()?,
            "gravity" => key.scene.pendulum.gravity = exact(text)?,
            "masses" => key.scene.pendulum.masses = two()?,
            "lengths" => key.scene.pendulum.lengths = two()?,
            _ => return Err(wrong().into()),
        }
        key.scene.check().map_err(|why| refused(vary, why))?;
        Ok(key)
    };
    Ok(vec![key(0.0, from)?, key(SECS_IN_PLACE, to)?])
}

/// Returns the scene with the question `state`. A rule or a count in `words` stays, and is refused
/// by a later check; others are dropped.
fn asking_state(mut scene: Document, words: &SceneWords) -> Document {
    scene.question.ask = QuestionName::State;
    if words.says(Setting::Rule) || words.says(Setting::Count) {
        return scene;
    }
    let without_unused = scene.scene().without_unused();
    scene.with_scene(without_unused)
}

/// Converts the error of an invalid scene into a usage error that names `--vary`.
fn refused(vary: &str, why: DocumentError) -> Exit {
    Exit::Usage(match why {
        DocumentError::Scene(error) => {
            format!("--vary is '{vary}': {}", error.called(&error.setting))
        }
        other => format!("--vary is '{vary}': {other}"),
    })
}

/// Rejects keys that were made at different sizes, unless `--size` gives one.
fn same_sizes(keys: &[Key], run: &RunOptions) -> Result<(), Exit> {
    let sizes: Vec<[u32; 2]> = keys.iter().filter_map(|key| key.scene.run.size).collect();
    let other = sizes.iter().position(|size| *size != sizes[0]);
    match (other, &run.size) {
        (Some(other), None) => {
            let ([a, b], [c, d]) = (sizes[0], sizes[other]);
            Err(Exit::Usage(format!(
                "the keys have different sizes, {a}x{b} and {c}x{d}; say which with --size"
            )))
        }
        _ => Ok(()),
    }
}
