//! The engine behind the window, its scheduler, and what happens when one of them fails.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::engine::background::{self, Background, Opening};
use crate::engine::choice::{self, Chosen, Demand, Kind, Wish};
use crate::engine::trust::TrustEngine;
use crate::engine::{Engine, Recipe};
use crate::tiles::aim::Aim;
use crate::tiles::explorer::Explorer;

/// Wakes the window from any thread.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// How long a slice may run on a graphics card while a window is open.
const PACE: Duration = Duration::from_millis(15);
/// How much less urgent than drawing computing is; 19 is the most.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;
/// An engine that fails so often, each time within [`SOON`] of the last, is not opened again
/// until the person says so.
const MOST_FAILURES: u32 = 3;
const SOON: Duration = Duration::from_secs(60);

/// Where the engine is in its life.
enum Stage {
    Opening(Opening),
    Ready(Box<Background>),
    Failed,
}

/// The engine and the cells it computes.
pub struct EngineRoom {
    /// What is known and wanted.
    pub explorer: Explorer,
    wish: Wish,
    verify: bool,
    stage: Stage,
    failures: u32,
    failed_at: Option<Instant>,
    /// What takes so long while an engine is being opened.
    said: Arc<Mutex<String>>,
    wake: Wake,
}

/// What came of a turn.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Turn {
    /// Something new can be drawn.
    pub news: bool,
    /// What went wrong, in a sentence with what to do.
    pub failure: Option<String>,
}

impl EngineRoom {
    /// Begins to open an engine.
    pub fn new(wish: Wish, verify: bool, cache_bytes: usize, wake: Wake) -> Self {
        let stage = Stage::Failed;
        let explorer = Explorer::new(cache_bytes);
        let mut room = EngineRoom {
            explorer,
            wish,
            verify,
            stage,
            failures: 0,
            failed_at: None,
            said: Arc::default(),
            wake,
        };
        room.open();
        room
    }

    /// Opens another engine, or the same anew. What was computed stays.
    pub fn reopen(&mut self, kind: Kind, demand: Demand, verify: bool) {
        self.wish = Wish { kind, demand, ..self.wish.clone() };
        self.verify = verify;
        self.failures = 0;
        self.open();
    }

    fn open(&mut self) {
        self.explorer.ground();
        let (wish, verify) = (self.wish.clone(), self.verify);
        let (said, waker) = (Arc::new(Mutex::new(String::new())), Arc::clone(&self.wake));
        self.said = Arc::clone(&said);
        let tell = move |text: &str| {
            // Whoever panicked left a whole sentence.
            text.clone_into(&mut said.lock().unwrap_or_else(PoisonError::into_inner));
            waker();
        };
        let wake = Arc::clone(&self.wake);
        let opening = background::open(move || open(&wish, verify, &tell), move || wake());
        self.stage = opening.map_or_else(
            |error| {
                log::error!("no thread for the engine: {error}");
                Stage::Failed
            },
            Stage::Opening,
        );
    }

    /// The recipe of the engine, once it is open.
    pub fn recipe(&self) -> Option<Recipe> {
        match &self.stage {
            Stage::Ready(engine) => Some(engine.recipe),
            _ => None,
        }
    }

    /// The engine, for people: its name, adapter, and why it was chosen.
    pub fn engine(&self) -> Option<(&'static str, String, &str)> {
        match &self.stage {
            Stage::Ready(engine) => Some((engine.name(), engine.adapter(), &engine.why)),
            _ => None,
        }
    }

    /// What it is doing that takes so long before a deep view's first pixels are known.
    pub fn following(&self) -> Option<String> {
        match &self.stage {
            Stage::Ready(engine) => engine.following.words(),
            _ => None,
        }
    }

    /// While an engine is being opened, what it is doing that takes so long, if it says so.
    pub fn opening(&self) -> Option<String> {
        let said = || self.said.lock().unwrap_or_else(PoisonError::into_inner).clone();
        matches!(self.stage, Stage::Opening(_)).then(said)
    }

    /// Whether there is none, and none is coming.
    pub fn has_failed(&self) -> bool {
        matches!(self.stage, Stage::Failed)
    }

    /// Drops what is being computed: nobody looks at the map for a while.
    pub fn rest(&mut self) {
        if let Stage::Ready(engine) = &mut self.stage {
            engine.cancel();
            self.explorer.ground();
        }
    }

    /// Aims at what is looked at and moves the work on, without waiting.
    pub fn turn(&mut self, aim: impl FnOnce(Recipe) -> Aim, deadline: Instant) -> Turn {
        self.take_opened().unwrap_or_else(|| {
            let Stage::Ready(engine) = &mut self.stage else { return Turn::default() };
            self.explorer.aim(aim(engine.recipe));
            match self.explorer.work(engine.as_mut(), Some(deadline)) {
                Ok(news) => Turn { news, failure: None },
                Err(error) => self.fail(&error.to_string()),
            }
        })
    }

    /// Takes an engine that has been opened, or the news that it could not be.
    fn take_opened(&mut self) -> Option<Turn> {
        let Stage::Opening(opening) = &self.stage else { return None };
        match opening.poll()? {
            Ok(engine) => {
                self.stage = Stage::Ready(Box::new(engine));
                None
            }
            Err(error) => Some(self.fail(&error.to_string())),
        }
    }

    /// Opens the engine anew a few times, then the processor, then gives up.
    fn fail(&mut self, why: &str) -> Turn {
        let again = self.failed_at.is_some_and(|at| at.elapsed() < SOON);
        self.failures = if again { self.failures + 1 } else { 1 };
        self.failed_at = Some(Instant::now());
        self.stage = Stage::Failed;
        self.explorer.ground();
        let then = if self.failures < MOST_FAILURES {
            self.open();
            "The engine is being opened again."
        } else if self.wish.kind != Kind::Cpu {
            self.wish = Wish { kind: Kind::Cpu, adapter: None, ..self.wish.clone() };
            self.failures = 0;
            self.open();
            "The processor goes on; choose another engine under Accuracy."
        } else {
            "Choose another engine or accuracy, or press Try again."
        };
        Turn { news: true, failure: Some(format!("The engine failed: {why}. {then}")) }
    }
}

/// Opens an engine as it is used behind a window: with short slices, and less urgent than the
/// window's own threads.
fn open(wish: &Wish, verify: bool, tell: &dyn Fn(&str)) -> Result<Chosen, choice::ChoiceError> {
    step_back();
    let wish = Wish { pace: PACE, ..wish.clone() };
    let Chosen { engine, recipe, why, following } = choice::choose(&wish, tell)?;
    let engine: Box<dyn Engine> =
        if verify { Box::new(TrustEngine::new(engine, wish.threads)?) } else { engine };
    Ok(Chosen { engine, recipe, why, following })
}

/// Makes this thread, and those it will start, yield to the ones that draw. On Linux each thread
/// has a niceness of its own, and hands it on.
pub(super) fn step_back() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::setpriority_process(None, NICENESS) {
        log::info!("the engine runs as urgently as the window: {error}");
    }
}
