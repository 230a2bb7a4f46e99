//! The state of a render, kept in a file for a later run with a larger budget.
//!
//! The format is [postcard](https://docs.rs/postcard): compact, and exact for every f64. Before it
//! stands its checksum.

use std::collections::BTreeMap;
use std::io::{self, Write};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::engine::{EngineKind, IntegratorState, NUMBERS};
use crate::scene::Document;
use crate::tiles::SavedPixels;

/// First bytes of every state file; the number is the format's.
const MAGIC: &str = "flipmap state 2\n";
/// First bytes of files of the first format, which knew first flips only and had no checksum.
const FIRST_MAGIC: &str = "flipmap state 1\n";
/// Size of the checksum in bytes.
const DIGEST: usize = 32;

/// A render that can be resumed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RenderState {
    /// Record of what ran: only the same engine and configuration lead to the same answers.
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
    /// Name of the adapter, or the processor's instruction set. Threads change no answer.
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
    /// A file that is not a state of this format, or is damaged.
    #[error("is not a state that this flipmap wrote, or it is damaged")]
    Foreign,
    /// A state of something else.
    #[error("belongs to another {what}: it has {kept}, and now it is {now}")]
    Different {
        /// The property that differs.
        what: &'static str,
        /// Value in the state.
        kept: String,
        /// Value of this run.
        now: String,
    },
    /// A state beyond the budget that is requested.
    #[error("has gone to {kept} s already; {option} is {now} and must be at least that")]
    Further {
        /// The option that is too small.
        option: &'static str,
        /// Budget that the state has reached, s.
        kept: f64,
        /// Budget of this run, s.
        now: f64,
    },
}

impl RenderState {
    /// Reads a state from the bytes of its file.
    pub fn parse(bytes: &[u8]) -> Result<Self, StateError> {
        if let Some(body) = bytes.strip_prefix(FIRST_MAGIC.as_bytes()) {
            let first = postcard::from_bytes::<FirstFormat>(body);
            return first.map(RenderState::from).map_err(|_| StateError::Foreign);
        }
        let rest = bytes.strip_prefix(MAGIC.as_bytes()).ok_or(StateError::Foreign)?;
        let (digest, body) = rest.split_at_checked(DIGEST).ok_or(StateError::Foreign)?;
        if Sha256::digest(body)[..] != *digest {
            return Err(StateError::Foreign);
        }
        postcard::from_bytes(body).map_err(|_| StateError::Foreign)
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
        let kept = Document::parse(&self.document).map_err(|_| StateError::Foreign)?.settled();
        let differ = |what, kept: String, now: String| {
            if kept == now { Ok(()) } else { Err(StateError::Different { what, kept, now }) }
        };
        let line = |value: &dyn std::fmt::Debug| format!("{value:?}");
        differ("pendulum", line(&kept.pendulum), line(&now.pendulum))?;
        differ("question", kept.question.ask.to_string(), now.question.ask.to_string())?;
        differ("number of flips", kept.question.count.to_string(), now.question.count.to_string())?;
        differ("plane", line(&kept.plane), line(&now.plane))?;
        differ("rule", kept.question.rule.to_string(), now.question.rule.to_string())?;
        differ("view", line(&kept.view), line(&now.view))?;
        differ("size", line(&kept.run.size), line(&now.run.size))?;
        let option = if now.question.at.is_some() { "--at" } else { "--budget" };
        let (kept, now) = (kept.question.end_secs(), now.question.end_secs());
        if now < kept { Err(StateError::Further { option, kept, now }) } else { Ok(()) }
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

/// A state as the first format has it.
#[derive(Serialize, Deserialize)]
struct FirstFormat {
    ran: RunRecord,
    document: String,
    flipped: BTreeMap<u64, f64>,
    failed: Vec<u64>,
    paused: BTreeMap<u64, (u32, [f64; NUMBERS])>,
}

impl From<FirstFormat> for RenderState {
    fn from(first: FirstFormat) -> Self {
        let FirstFormat { ran, document, flipped, failed, paused } = first;
        let state = |(index, (steps, numbers))| (index, IntegratorState::new(steps, numbers));
        let paused = paused.into_iter().map(state).collect();
        let kept = SavedPixels::of_first_flips(flipped, failed, paused);
        RenderState { ran, document, kept }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Status;

    fn state() -> RenderState {
        let mut kept = SavedPixels::default();
        kept.finish(5, Status::Flipped, &[1.0 / 3.0]);
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
            assert!(matches!(RenderState::parse(damaged), Err(StateError::Foreign)));
        }
        for bit in 0..8 * bytes.len() {
            let mut altered = bytes.clone();
            altered[bit / 8] ^= 1 << (bit % 8);
            assert!(RenderState::parse(&altered).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn states_of_the_first_format_are_read() {
        let state = state();
        let first = FirstFormat {
            ran: state.ran.clone(),
            document: state.document.clone(),
            flipped: BTreeMap::from([(5, 1.0 / 3.0)]),
            failed: Vec::new(),
            paused: BTreeMap::from([(7, (3, [0.5; NUMBERS]))]),
        };
        let mut bytes = FIRST_MAGIC.as_bytes().to_vec();
        bytes.extend(postcard::to_stdvec(&first).unwrap());
        let mut expected = state;
        expected.kept.pause(7, IntegratorState::new(3, [0.5; NUMBERS]));
        assert_eq!(RenderState::parse(&bytes).unwrap(), expected);
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
            ("question", |document| document.question.ask = crate::question::Ask::First),
            ("number of flips", |document| document.question.count = 2),
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
    fn another_configuration_is_refused() {
        let state = state();
        state.check_ran(&state.ran).unwrap();
        let other = RunRecord { precision: "f64".to_string(), ..state.ran.clone() };
        let error = state.check_ran(&other).unwrap_err().to_string();
        assert!(error.contains("in f32") && error.contains("in f64"), "{error}");
    }
}
