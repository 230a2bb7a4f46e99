//! A film that is being planned in the window: the keys of its camera's path, and how it is shot.

use std::path::Path;

use serde::{Deserialize, Serialize};

use flipmap_render::output::{Destination, SafeFile, read_text};
use flipmap_scene::film::{Film, FilmError};
use flipmap_scene::keys::{Easing, Key, Keys};
use flipmap_scene::{Budget, Document, QuestionSettings, Scene};
use flipmap_screen::flight::playback::Playback;

/// How a film is shot, as it is kept between runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FilmForm {
    /// Width and height of a frame in pixels.
    pub size: [u32; 2],
    /// Frames per second.
    pub fps: f64,
    /// Path of the film.
    pub path: String,
    /// Path of the file that keeps the keys.
    pub keys_path: String,
    /// True while the keys are those of a descent.
    pub of_descent: bool,
}

impl Default for FilmForm {
    fn default() -> Self {
        FilmForm::of(&FilmDraft::default())
    }
}

impl FilmForm {
    /// Returns how the film of a draft is shot.
    pub(crate) fn of(draft: &FilmDraft) -> Self {
        let FilmDraft { size, fps, path, keys_path, of_descent, .. } = draft.clone();
        FilmForm { size, fps, path, keys_path, of_descent }
    }

    /// Returns a draft that is shot in this way and has no keys yet.
    pub(crate) fn draft(&self) -> FilmDraft {
        let FilmForm { size, fps, path, keys_path, of_descent } = self.clone();
        FilmDraft { size, fps, path, keys_path, of_descent, ..FilmDraft::default() }
    }
}

/// A film that is being planned.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmDraft {
    /// Keys, ordered by time; the first is at 0 s.
    pub keys: Vec<Key>,
    /// Width and height of a frame in pixels.
    pub size: [u32; 2],
    /// Frames per second.
    pub fps: f64,
    /// Path of the film.
    pub path: String,
    /// Path of the file that keeps the keys.
    pub keys_path: String,
    /// Clock of the preview.
    pub clock: Playback,
    /// True while the keys are those of a descent, which the next descent may replace.
    pub of_descent: bool,
}

impl Default for FilmDraft {
    fn default() -> Self {
        FilmDraft {
            keys: Vec::new(),
            size: [1280, 720],
            fps: 30.0,
            path: "film.mp4".to_string(),
            keys_path: "keys.toml".to_string(),
            clock: Playback::at_rest(),
            of_descent: false,
        }
    }
}

impl FilmDraft {
    /// Appends a scene at which the camera stops.
    pub fn add(&mut self, document: Document) {
        self.edit(|keys| keys.append(document, Easing::Smooth));
    }

    /// Takes the views of a descent as keys, which the camera passes without stopping.
    pub(crate) fn take_descent(&mut self, documents: impl Iterator<Item = Document>) {
        self.edit(|keys| {
            keys.keys.clear();
            for document in documents {
                keys.append(document, Easing::Linear);
            }
        });
        self.of_descent = true;
    }

    /// Removes a key; the steps to the later keys keep their lengths.
    pub(crate) fn remove(&mut self, place: usize) {
        if place >= self.keys.len() {
            return;
        }
        let mut steps = self.steps_secs();
        steps.remove(place);
        self.keys.remove(place);
        self.set_steps(&steps);
        self.of_descent = false;
    }

    /// Sets the time in s from the previous key to this one; the later keys are shifted.
    pub(crate) fn set_step(&mut self, place: usize, secs: f64) {
        let mut steps = self.steps_secs();
        if let Some(step) = steps.get_mut(place) {
            *step = secs.max(MIN_STEP_SECS);
        }
        self.set_steps(&steps);
    }

    /// Returns the time in s to each key from the one before it; 0 for the first.
    pub(crate) fn steps_secs(&self) -> Vec<f64> {
        let mut before = self.keys.first().map_or(0.0, |first| first.secs);
        let mut step = |secs| secs - std::mem::replace(&mut before, secs);
        self.keys.iter().map(|key| step(key.secs)).collect()
    }

    fn set_steps(&mut self, steps: &[f64]) {
        let mut secs = 0.0;
        for (place, (key, step)) in self.keys.iter_mut().zip(steps).enumerate() {
            secs += if place == 0 { 0.0 } else { *step };
            key.secs = secs;
        }
    }

    /// Returns the length of the film in s.
    pub(crate) fn secs(&self) -> f64 {
        self.steps_secs().iter().sum()
    }

    /// Returns the checked film; its keys have the colours and the run settings of the first.
    pub(crate) fn film(&self) -> Result<Film, FilmError> {
        let mut keys = self.keys.clone();
        if let Some(first) = self.keys.first() {
            for key in &mut keys {
                (key.scene.picture, key.scene.run) =
                    (first.scene.picture.clone(), first.scene.run.clone());
            }
        }
        // Frames are counted as in `flipmap video`.
        let frames = (self.secs() * self.fps).round().clamp(2.0, f64::from(u32::MAX)) as u32;
        let film = Film { size: self.size, frames, fps: self.fps, keys };
        film.check()?;
        Ok(film)
    }

    /// Returns the reason why the film cannot be shot, as a sentence; none if it can.
    pub(crate) fn problem(&self) -> Option<String> {
        match self.film() {
            Err(error) => Some(format!("{error}.")),
            Ok(_) if self.path.trim().is_empty() => Some("Name the film.".to_string()),
            Ok(_) => None,
        }
    }

    /// Returns the scene that the preview shows now; none if the keys do not make a film.
    pub(crate) fn scene(&self) -> Option<Scene> {
        let film = self.film().ok()?;
        let shot = film.shot_at(self.keys[0].secs + self.clock.time_secs());
        // If the budget changed with each moment, the map of a moving camera would restart each
        // time.
        let budget = Budget::secs(film.shown_secs(&shot));
        Some(Scene { question: QuestionSettings { budget, ..shot.scene.question }, ..shot.scene })
    }

    /// Reads the keys from their file. On failure, the draft stays as it was and the error is a
    /// sentence.
    pub(crate) fn open_keys(&mut self) -> Result<(), String> {
        let path = Path::new(&self.keys_path);
        let refuse = |why: &dyn std::fmt::Display| {
            format!("The film was not changed: {} {why}.", path.display())
        };
        let text = read_text(path).map_err(|error| refuse(&format!("cannot be read: {error}")))?;
        let keys =
            Keys::parse(&text).map_err(|error| refuse(&format!("has no film keys: {error}")))?;
        self.edit(|old| *old = keys);
        Ok(())
    }

    /// Writes the keys to their file. On failure, the file stays as it was and the error is a
    /// sentence.
    pub(crate) fn save_keys(&self) -> Result<(), String> {
        let file = Destination::from(Path::new(&self.keys_path));
        SafeFile::write_whole(&file, self.text().as_bytes())
            .map_err(|error| format!("The keys were not saved: cannot write {file}: {error}."))
    }

    /// Returns the keys as the text of their file.
    pub(crate) fn text(&self) -> String {
        Keys { keys: self.keys.clone(), ..Keys::default() }.text()
    }

    /// Changes the keys and restarts the preview.
    fn edit(&mut self, change: impl FnOnce(&mut Keys)) {
        let mut keys = Keys { keys: std::mem::take(&mut self.keys), ..Keys::default() };
        change(&mut keys);
        self.keys = keys.keys;
        (self.clock, self.of_descent) = (Playback::at_rest(), false);
    }
}

/// Shortest time in s between two keys.
const MIN_STEP_SECS: f64 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::Scalar;

    fn wide(width: &str) -> Document {
        let mut document = Document::default();
        document.view.width = width.to_string();
        document
    }

    fn draft(widths: &[&str]) -> FilmDraft {
        let mut draft = FilmDraft::default();
        widths.iter().for_each(|width| draft.add(wide(width)));
        draft
    }

    fn times(draft: &FilmDraft) -> Vec<f64> {
        draft.keys.iter().map(|key| key.secs).collect()
    }

    #[test]
    fn keys_keep_their_distances_when_others_change() {
        let mut draft = draft(&["6", "1", "0.1"]);
        assert_eq!(times(&draft), [0.0, 5.0, 10.0]);
        draft.set_step(1, 2.0);
        assert_eq!(times(&draft), [0.0, 2.0, 7.0]);
        draft.set_step(2, -3.0);
        assert_eq!(times(&draft), [0.0, 2.0, 2.1]);
        draft.remove(0);
        assert_eq!((times(&draft), draft.secs()), (vec![0.0, 2.1 - 2.0], 2.1 - 2.0));
        draft.remove(9);
        assert_eq!(draft.keys.len(), 2);
    }

    #[test]
    fn a_film_needs_two_keys_and_a_name() {
        assert!(draft(&["6"]).problem().unwrap().contains("two keys"));
        let mut two = draft(&["6", "1"]);
        assert_eq!(two.problem(), None);
        two.path = " ".to_string();
        assert_eq!(two.problem().as_deref(), Some("Name the film."));
        two.fps = 0.0;
        assert!(two.problem().unwrap().contains("`fps`"));
    }

    #[test]
    fn the_preview_shows_the_path_from_its_first_key_to_its_last() {
        let mut draft = draft(&["4", "1"]);
        let width = |draft: &FilmDraft| draft.scene().unwrap().view.width_rad().to_f64();
        assert_eq!(width(&draft), 4.0);
        draft.keys[1].scene.question.budget = Budget::secs(50.0);
        let budget = |draft: &FilmDraft| draft.scene().unwrap().question.budget.secs;
        assert_eq!(budget(&draft), 50.0);
        draft.clock.scrub(2.5);
        assert_eq!(budget(&draft), 50.0, "one map for all of the way");
        assert!((width(&draft) - 2.0).abs() < 1e-9, "half of a smooth zoom by 4");
        draft.clock.scrub(99.0);
        assert_eq!(width(&draft), 1.0);
        draft.add(wide("0.5"));
        assert_eq!(draft.clock, Playback::at_rest(), "another film begins at its beginning");
    }

    #[test]
    fn a_descent_becomes_a_film_that_does_not_stop_on_its_way() {
        let mut draft = draft(&["6"]);
        draft.take_descent(["6", "2", "0.6"].into_iter().map(wide));
        assert_eq!(times(&draft), [0.0, 1.0, 2.0]);
        assert!(draft.of_descent && draft.keys.iter().all(|key| key.easing == Easing::Linear));
        draft.add(wide("0.2"));
        assert!(!draft.of_descent, "a descent leaves alone what a user has changed");
    }

    #[test]
    fn keys_come_back_from_their_file_and_a_wrong_file_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        let kept = FilmDraft { keys_path: path("keys.toml"), ..draft(&["6", "1"]) };
        kept.save_keys().unwrap();
        let mut opened = FilmDraft { keys_path: kept.keys_path.clone(), ..draft(&["3"]) };
        opened.open_keys().unwrap();
        assert_eq!(opened.keys, kept.keys);
        std::fs::write(path("diary.toml"), "dear = \"diary\"").unwrap();
        let mut other = FilmDraft { keys_path: path("diary.toml"), ..kept.clone() };
        let why = other.open_keys().unwrap_err();
        assert!(why.contains("diary.toml has no film keys: line 1"), "{why}");
        assert_eq!(other.keys, kept.keys);
        other.keys_path = path("none/keys.toml");
        assert!(other.save_keys().unwrap_err().contains("The keys were not saved"));
    }
}
