//! The state of a render, kept in a file for a later run with a larger budget.
//!
//! The format is [postcard](https://docs.rs/postcard): compact, and every f64 exact.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use crate::scene::Document;
use crate::tiles::SavedPixels;

/// Begins every state file; the number is the format's.
const MAGIC: &str = "flipmap state 1\n";

/// A render that can go on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RenderState {
    /// What ran: only the same can go on to the same answers.
    pub ran: RunRecord,
    /// The scene's file, its budget the one that was reached.
    pub document: String,
    /// The pixels.
    pub kept: SavedPixels,
}

/// What a render ran on and by.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunRecord {
    /// `gpu` or `cpu`.
    pub engine: String,
    /// The adapter; of the processor its instruction set. Threads change no answer.
    pub adapter: String,
    /// The method's word.
    pub method: String,
    /// Its step or tolerance.
    pub setting: String,
    /// The number type's word.
    pub precision: String,
}

impl std::fmt::Display for RunRecord {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let RunRecord { engine, adapter, method, setting, precision } = self;
        write!(f, "{method} {setting} in {precision} on the {engine} engine, {adapter}")
    }
}

/// Why a file gives no state to go on from.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// Not a state file of this format, or damaged.
    #[error("is not a state that this flipmap wrote, or it is damaged")]
    Foreign,
    /// Of something else.
    #[error("belongs to another {what}: it has {kept}, and now it is {now}")]
    Different {
        /// What differs.
        what: &'static str,
        /// There.
        kept: String,
        /// Here.
        now: String,
    },
    /// Gone further than asked.
    #[error("has gone to {kept} s already; --budget is {now} and must be at least that")]
    Further {
        /// There.
        kept: f64,
        /// Here.
        now: f64,
    },
}

impl RenderState {
    /// Reads a state from the bytes of its file.
    pub fn parse(bytes: &[u8]) -> Result<Self, StateError> {
        let body = bytes.strip_prefix(MAGIC.as_bytes()).ok_or(StateError::Foreign)?;
        postcard::from_bytes(body).map_err(|_| StateError::Foreign)
    }

    /// Writes the state.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(MAGIC.as_bytes())?;
        let body = postcard::to_stdvec(self).map_err(io::Error::other)?;
        out.write_all(&body)
    }

    /// Refuses to go on with another scene than the one it belongs to.
    pub fn check_scene(&self, now: &Document) -> Result<(), StateError> {
        let kept = Document::parse(&self.document).map_err(|_| StateError::Foreign)?;
        let differ = |what, kept: String, now: String| {
            if kept == now { Ok(()) } else { Err(StateError::Different { what, kept, now }) }
        };
        let line = |value: &dyn std::fmt::Debug| format!("{value:?}");
        differ("pendulum", line(&kept.pendulum), line(&now.pendulum))?;
        differ("rule", kept.question.rule.to_string(), now.question.rule.to_string())?;
        differ("view", line(&kept.view), line(&now.view))?;
        differ("size", line(&kept.run.size), line(&now.run.size))?;
        let (kept, now) = (kept.question.budget.secs, now.question.budget.secs);
        if now < kept { Err(StateError::Further { kept, now }) } else { Ok(()) }
    }

    /// Refuses to go on with another engine or config.
    pub fn check_ran(&self, now: &RunRecord) -> Result<(), StateError> {
        if self.ran == *now {
            return Ok(());
        }
        let [kept, now] = [&self.ran, now].map(RunRecord::to_string);
        Err(StateError::Different { what: "recipe or engine", kept, now })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Outcome;

    fn state() -> RenderState {
        let mut kept = SavedPixels::default();
        kept.finish(5, Outcome::flipped(1.0 / 3.0));
        let word = str::to_string;
        RenderState {
            ran: RunRecord {
                engine: word("cpu"),
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
        for damaged in [&bytes[..bytes.len() - 1], &bytes[1..], b"", b"flipmap state 1\n"] {
            assert!(matches!(RenderState::parse(damaged), Err(StateError::Foreign)));
        }
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
        let changes: [(&str, Change); 5] = [
            ("pendulum", |document| document.pendulum.gravity = 1.0.into()),
            ("rule", |document| document.question.rule = crate::physics::Rule::First),
            ("view", |document| document.view.width = "1".to_string()),
            ("size", |document| document.run.size = Some([1, 2])),
            ("30 s already", |document| document.question.budget.secs = 20.0),
        ];
        for (word, change) in changes {
            let mut other = home.clone();
            change(&mut other);
            let error = state.check_scene(&other).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }

    #[test]
    fn another_recipe_is_refused() {
        let state = state();
        state.check_ran(&state.ran).unwrap();
        let other = RunRecord { precision: "f64".to_string(), ..state.ran.clone() };
        let error = state.check_ran(&other).unwrap_err().to_string();
        assert!(error.contains("in f32") && error.contains("in f64"), "{error}");
    }
}
