//! The state of a render, kept in a file for a later run with a larger budget.
//!
//! The format is [postcard](https://docs.rs/postcard): compact, and exact for every f64. A checksum
//! precedes it.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::tiles::SavedPixels;
use flipmap_engine::EngineKind;
use flipmap_scene::{Document, Setting};

/// First bytes of every state file; the number is the format's.
const MAGIC: &str = "flipmap state 2\n";
/// First bytes of files of the first format, which has no checksum that would reveal damage.
const FIRST_MAGIC: &str = "flipmap state 1\n";
/// Size of the checksum in bytes.
const DIGEST: usize = 32;

/// A render that can be resumed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RenderState {
    /// Engine and configuration that ran: only the same ones lead to the same answers.
    pub ran: RunRecord,
    /// The scene's file, with the budget that was reached.
    pub document: String,
    /// The saved pixels.
    pub kept: SavedPixels,
}

/// The engine and the configuration of a render.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunRecord {
    /// The kind of engine.
    pub engine: EngineKind,
    /// Name of the adapter, or the processor's instruction set. The number of threads changes no
    /// answer.
    pub adapter: String,
    /// Name of the method.
    pub method: String,
    /// Step or tolerance of the method.
    pub setting: String,
    /// Name of the number type.
    pub precision: String,
}

impl std::fmt::Display for RunRecord {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let RunRecord { engine, adapter, method, setting, precision } = self;
        write!(f, "{method} {setting} in {precision} on the {engine} engine, {adapter}")
    }
}

/// Reasons why a file has no state to resume.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// A file that is not a state.
    #[error("is not a state that flipmap wrote")]
    Foreign,
    /// A state that was damaged after it was written.
    #[error("is cut short or altered ({0}): remove it, and render again from the beginning")]
    Damaged(&'static str),
    /// A state of the first format.
    #[error(
        "is of the first format, which has no checksum that would detect damage: remove it, \
         and render again from the beginning"
    )]
    Unchecked,
    /// A state of another scene, size, engine or configuration.
    #[error("belongs to another {what}: it has {kept}, and this run {now}")]
    Different {
        /// The property that differs.
        what: &'static str,
        /// Value in the state.
        kept: String,
        /// Value of this run.
        now: String,
    },
    /// A state beyond the budget that is requested.
    #[error("has gone to {kept} s already; the {end} must be at least that, and is {now} s")]
    Further {
        /// A word for the end of this run: its time or its budget.
        end: &'static str,
        /// Budget that the state has reached, s.
        kept: f64,
        /// Budget of this run, s.
        now: f64,
    },
}

/// Settings that must be equal for a render to be resumed, by the name of what they describe.
const MUST_BE_EQUAL: &[(&str, &[Setting])] = &[
    (
        "pendulum",
        &[Setting::Kind, Setting::Masses, Setting::Lengths, Setting::Gravity, Setting::Friction],
    ),
    ("question", &[Setting::Ask]),
    ("number of flips", &[Setting::Count]),
    ("plane", &[Setting::Plane, Setting::Origin, Setting::Energy]),
    ("rule", &[Setting::Rule]),
    ("view", &[Setting::Center, Setting::Width, Setting::Rotate, Setting::Stretch]),
];

impl RenderState {
    /// Reads a state from the bytes of its file.
    pub fn parse(bytes: &[u8]) -> Result<Self, StateError> {
        if bytes.starts_with(FIRST_MAGIC.as_bytes()) {
            return Err(StateError::Unchecked);
        }
        let rest = bytes.strip_prefix(MAGIC.as_bytes()).ok_or(StateError::Foreign)?;
        let cut = StateError::Damaged("it ends within its checksum, bytes 16 to 47");
        let (digest, body) = rest.split_at_checked(DIGEST).ok_or(cut)?;
        if Sha256::digest(body)[..] != *digest {
            let why = "the checksum in bytes 16 to 47 is not that of the bytes after it";
            return Err(StateError::Damaged(why));
        }
        let wrong = StateError::Damaged("the bytes from 48 on are not a state");
        postcard::from_bytes(body).map_err(|_| wrong)
    }

    /// Writes the state.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(MAGIC.as_bytes())?;
        let body = postcard::to_stdvec(self).map_err(io::Error::other)?;
        out.write_all(&Sha256::digest(&body))?;
        out.write_all(&body)
    }

    /// Refuses to resume with another scene than the state's own, or with a smaller budget.
    pub fn check_scene(&self, now: &Document) -> Result<(), StateError> {
        let kept = Document::parse(&self.document);
        let kept = kept.map_err(|_| StateError::Damaged("its scene is none"))?.settled();
        let differ = |what, setting: &str, [kept, now]: [String; 2]| {
            if kept == now {
                return Ok(());
            }
            let kept = format!("{setting} {kept}");
            Err(StateError::Different { what, kept, now })
        };
        let scenes = [kept.scene(), now.scene()];
        for (what, words) in MUST_BE_EQUAL {
            for word in *words {
                differ(what, word.name(), scenes.each_ref().map(|scene| word.text(scene)))?;
            }
        }
        let sizes = [kept.run.size, now.run.size].map(Option::unwrap_or_default);
        differ("size", "size", sizes.map(|[width, height]| format!("{width}x{height}")))?;
        let end = if now.question.at.is_some() { "time" } else { "budget" };
        let (kept, now) = (kept.question.end_secs(), now.question.end_secs());
        if now < kept { Err(StateError::Further { end, kept, now }) } else { Ok(()) }
    }

    /// Refuses to resume with another engine or integrator config.
    pub fn check_ran(&self, now: &RunRecord) -> Result<(), StateError> {
        if self.ran == *now {
            return Ok(());
        }
        let [kept, now] = [&self.ran, now].map(RunRecord::to_string);
        Err(StateError::Different { what: "configuration or engine", kept, now })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::Status;

    fn state() -> RenderState {
        let mut kept = SavedPixels::default();
        kept.finish(5, Status::Answered, &[1.0 / 3.0]);
        let word = str::to_string;
        RenderState {
            ran: RunRecord {
                engine: EngineKind::Cpu,
                adapter: word("AVX2"),
                method: word("rk4"),
                setting: word("step 1/120"),
                precision: word("f32"),
            },
            document: Document::default().text(),
            kept,
        }
    }

    #[test]
    fn a_state_comes_back_as_it_was() {
        let mut bytes = Vec::new();
        state().write(&mut bytes).unwrap();
        assert_eq!(RenderState::parse(&bytes).unwrap(), state());
        for damaged in [&bytes[..bytes.len() - 1], &bytes[1..], b"", b"flipmap state 2\n"] {
            let refused = RenderState::parse(damaged);
            assert!(matches!(refused, Err(StateError::Foreign | StateError::Damaged(_))));
        }
        for bit in 0..8 * bytes.len() {
            let mut altered = bytes.clone();
            altered[bit / 8] ^= 1 << (bit % 8);
            assert!(RenderState::parse(&altered).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn states_without_a_checksum_are_refused() {
        let error = RenderState::parse(&[FIRST_MAGIC.as_bytes(), &[0; 100]].concat()).unwrap_err();
        assert!(
            error.to_string().contains("first format") && matches!(error, StateError::Unchecked)
        );
    }

    #[test]
    fn another_scene_is_refused_by_what_differs() {
        let state = state();
        let home = Document::default();
        state.check_scene(&home).unwrap();
        let mut later = home.clone();
        later.question.budget.secs = 60.0;
        state.check_scene(&later).unwrap();
        type Change = fn(&mut Document);
        let changes: [(&str, Change); 7] = [
            ("question", |document| {
                document.question.ask = flipmap_scene::question::QuestionName::First
            }),
            ("number of flips", |document| document.question.count = 2),
            ("pendulum", |document| document.pendulum.gravity = 1.0.into()),
            ("rule", |document| document.question.rule = flipmap_pendulum::Rule::First),
            ("view", |document| document.view.width = "1".to_string()),
            ("size", |document| document.run.size = Some([1, 2])),
            ("30 s already", |document| document.question.budget.secs = 20.0),
        ];
        for (word, change) in changes {
            let mut other = home.clone();
            change(&mut other);
            let error = state.check_scene(&other).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
            assert!(!error.contains('{'), "in words: {error}");
        }
        let mut heavy = home.clone();
        heavy.pendulum.masses[1] = 2.0.into();
        assert_eq!(
            state.check_scene(&heavy).unwrap_err().to_string(),
            "belongs to another pendulum: it has masses 1,1, and this run 1,2"
        );
    }

    #[test]
    fn another_configuration_is_refused() {
        let state = state();
        state.check_ran(&state.ran).unwrap();
        let other = RunRecord { precision: "f64".to_string(), ..state.ran.clone() };
        let error = state.check_ran(&other).unwrap_err().to_string();
        assert!(error.contains("in f32") && error.contains("in f64"), "{error}");
    }
}
