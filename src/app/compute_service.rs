//! The engine behind the window, its scheduler, and what happens when one of them fails.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::engine::background::{self, Background, PendingEngine};
use crate::engine::choice::{self, Chosen, EngineKind, EngineRequest, IntegrationSetting};
use crate::engine::trust::TrustEngine;
use crate::engine::{Engine, IntegratorConfig};
use crate::tiles::explorer::Explorer;
use crate::tiles::view_target::ViewTarget;

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
enum ServiceState {
    Opening(PendingEngine),
    Ready(Box<Background>),
    Failed,
}

/// The engine and the cells it computes.
pub struct ComputeService {
    /// What is known and wanted.
    pub explorer: Explorer,
    request: EngineRequest,
    verify: bool,
    stage: ServiceState,
    failures: u32,
    failed_at: Option<Instant>,
    /// What takes so long while an engine is being opened.
    said: Arc<Mutex<String>>,
    wake: Wake,
}

/// What came of a turn.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct ServiceUpdate {
    /// Something new can be drawn.
    pub news: bool,
    /// What went wrong, in a sentence with what to do.
    pub failure: Option<String>,
}

impl ComputeService {
    /// Begins to open an engine.
    pub fn new(request: EngineRequest, verify: bool, cache_bytes: usize, wake: Wake) -> Self {
        let stage = ServiceState::Failed;
        let explorer = Explorer::new(cache_bytes);
        let mut service = ComputeService {
            explorer,
            request,
            verify,
            stage,
            failures: 0,
            failed_at: None,
            said: Arc::default(),
            wake,
        };
        service.open();
        service
    }

    /// Opens another engine, or the same anew. What was computed stays.
    pub fn reopen(&mut self, kind: EngineKind, setting: IntegrationSetting, verify: bool) {
        self.request = EngineRequest { kind, setting, ..self.request.clone() };
        self.verify = verify;
        self.failures = 0;
        self.open();
    }

    fn open(&mut self) {
        self.explorer.ground();
        let (request, verify) = (self.request.clone(), self.verify);
        let (said, waker) = (Arc::new(Mutex::new(String::new())), Arc::clone(&self.wake));
        self.said = Arc::clone(&said);
        let tell = move |text: &str| {
            // Whoever panicked left a whole sentence.
            text.clone_into(&mut said.lock().unwrap_or_else(PoisonError::into_inner));
            waker();
        };
        let wake = Arc::clone(&self.wake);
        let opening = background::open(move || open(&request, verify, &tell), move || wake());
        self.stage = opening.map_or_else(
            |error| {
                log::error!("no thread for the engine: {error}");
                ServiceState::Failed
            },
            ServiceState::Opening,
        );
    }

    /// The config of the engine, once it is open.
    pub fn config(&self) -> Option<IntegratorConfig> {
        match &self.stage {
            ServiceState::Ready(engine) => Some(engine.config),
            _ => None,
        }
    }

    /// The engine, for people: its name, adapter, and why it was chosen.
    pub fn engine(&self) -> Option<(&'static str, String, &str)> {
        match &self.stage {
            ServiceState::Ready(engine) => Some((engine.name(), engine.adapter(), &engine.why)),
            _ => None,
        }
    }

    /// What it is doing that takes so long before a deep view's first pixels are known.
    pub fn following(&self) -> Option<String> {
        match &self.stage {
            ServiceState::Ready(engine) => engine.following.words(),
            _ => None,
        }
    }

    /// While an engine is being opened, what it is doing that takes so long, if it says so.
    pub fn opening(&self) -> Option<String> {
        let said = || self.said.lock().unwrap_or_else(PoisonError::into_inner).clone();
        matches!(self.stage, ServiceState::Opening(_)).then(said)
    }

    /// Whether there is none, and none is coming.
    pub fn has_failed(&self) -> bool {
        matches!(self.stage, ServiceState::Failed)
    }

    /// Drops what is being computed: nobody looks at the map for a while.
    pub fn rest(&mut self) {
        if let ServiceState::Ready(engine) = &mut self.stage {
            engine.cancel();
            self.explorer.ground();
        }
    }

    /// Aims at what is looked at and moves the work on, without waiting.
    pub fn turn(
        &mut self,
        target: impl FnOnce(IntegratorConfig) -> ViewTarget,
        deadline: Instant,
    ) -> ServiceUpdate {
        self.take_opened().unwrap_or_else(|| {
            let ServiceState::Ready(engine) = &mut self.stage else {
                return ServiceUpdate::default();
            };
            self.explorer.target(target(engine.config));
            match self.explorer.work(engine.as_mut(), Some(deadline)) {
                Ok(news) => ServiceUpdate { news, failure: None },
                Err(error) => self.fail(&error.to_string()),
            }
        })
    }

    /// Takes an engine that has been opened, or the news that it could not be.
    fn take_opened(&mut self) -> Option<ServiceUpdate> {
        let ServiceState::Opening(opening) = &self.stage else { return None };
        match opening.poll()? {
            Ok(engine) => {
                self.stage = ServiceState::Ready(Box::new(engine));
                None
            }
            Err(error) => Some(self.fail(&error.to_string())),
        }
    }

    /// Opens the engine anew a few times, then the processor, then gives up.
    fn fail(&mut self, why: &str) -> ServiceUpdate {
        let again = self.failed_at.is_some_and(|at| at.elapsed() < SOON);
        self.failures = if again { self.failures + 1 } else { 1 };
        self.failed_at = Some(Instant::now());
        self.stage = ServiceState::Failed;
        self.explorer.ground();
        let then = if self.failures < MOST_FAILURES {
            self.open();
            "The engine is being opened again."
        } else if self.request.kind != EngineKind::Cpu {
            self.request =
                EngineRequest { kind: EngineKind::Cpu, adapter: None, ..self.request.clone() };
            self.failures = 0;
            self.open();
            "The processor goes on; choose another engine under Accuracy."
        } else {
            "Choose another engine or accuracy, or press Try again."
        };
        ServiceUpdate { news: true, failure: Some(format!("The engine failed: {why}. {then}")) }
    }
}

/// Opens an engine as it is used behind a window: with short slices, and less urgent than the
/// window's own threads.
fn open(
    request: &EngineRequest,
    verify: bool,
    tell: &dyn Fn(&str),
) -> Result<Chosen, choice::ChoiceError> {
    step_back();
    let request = EngineRequest { pace: PACE, ..request.clone() };
    let Chosen { engine, config, why, following } = choice::choose(&request, tell)?;
    let engine: Box<dyn Engine> =
        if verify { Box::new(TrustEngine::new(engine, request.threads)?) } else { engine };
    Ok(Chosen { engine, config, why, following })
}

/// Makes this thread, and those it will start, yield to the ones that draw. On Linux each thread
/// has a niceness of its own, and hands it on.
pub(super) fn step_back() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::setpriority_process(None, NICENESS) {
        log::info!("the engine runs as urgently as the window: {error}");
    }
}
