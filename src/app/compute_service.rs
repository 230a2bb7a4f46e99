//! The compute service: the engine behind the window, its scheduler, and recovery from failures.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::engine::background::{self, Background, PendingEngine};
use crate::engine::choice::{self, Chosen, EngineRequest, IntegrationSetting};
use crate::engine::{Engine, EngineKind, GpuTuning, IntegratorConfig};
use crate::tiles::Renderer;
use crate::tiles::explorer::Explorer;
use crate::tiles::view_target::ViewTarget;

/// Wakes the window from any thread.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Returns a waker and what it sends at each call.
#[cfg(test)]
pub(super) fn woken() -> (Wake, std::sync::mpsc::Receiver<()>) {
    let (sender, woken) = std::sync::mpsc::channel();
    let wake: Wake = Arc::new(move || {
        let _ = sender.send(());
    });
    (wake, woken)
}

/// Longest time that a slice may run on a graphics card while a window is open.
const PACE: Duration = Duration::from_millis(15);
/// Niceness of the computing threads, less urgent than drawing; 19 is the most.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;
/// Number of failures, each within [`SOON`] of the last, after which an engine is not opened again
/// until the user asks for it.
const MOST_FAILURES: u32 = 3;
const SOON: Duration = Duration::from_secs(60);

/// The state of the engine: being opened, ready, or failed.
enum ServiceState {
    Opening(PendingEngine),
    Ready(Box<Background>),
    Failed,
}

/// The engine and the cells it computes.
pub struct ComputeService {
    /// Scheduler of the cells, with all that is known and wanted.
    pub explorer: Explorer,
    request: EngineRequest,
    verify: bool,
    stage: ServiceState,
    /// Integrator config of the latest engine; none before the first has opened.
    config: Option<IntegratorConfig>,
    failures: u32,
    failed_at: Option<Instant>,
    /// Message on the slow part of opening the engine; empty if there is none.
    said: Arc<Mutex<String>>,
    wake: Wake,
}

/// The result of one [`ComputeService::turn`].
#[derive(Debug, Default, PartialEq, Eq)]
pub struct ServiceUpdate {
    /// True if something new can be drawn.
    pub news: bool,
    /// Sentence that says what went wrong and what to do; none without a failure.
    pub failure: Option<String>,
}

impl ComputeService {
    /// Creates the service and begins to open its engine.
    pub fn new(request: EngineRequest, verify: bool, cache_bytes: usize, wake: Wake) -> Self {
        let stage = ServiceState::Failed;
        let explorer = Explorer::new(cache_bytes);
        let mut service = ComputeService {
            explorer,
            request,
            verify,
            stage,
            config: None,
            failures: 0,
            failed_at: None,
            said: Arc::default(),
            wake,
        };
        service.open();
        service
    }

    /// Opens another engine, or reopens the same one. Samples already computed stay.
    pub fn reopen(&mut self, kind: Option<EngineKind>, setting: IntegrationSetting, verify: bool) {
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
            // A thread that panicked while it held the lock left a whole sentence.
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

    /// Returns the integrator config of the engine, once it is open.
    pub fn config(&self) -> Option<IntegratorConfig> {
        match &self.stage {
            ServiceState::Ready(engine) => Some(engine.config),
            _ => None,
        }
    }

    /// Returns the name of the engine, its adapter, and why it was chosen, for display.
    pub fn engine(&self) -> Option<(EngineKind, String, &str)> {
        match &self.stage {
            ServiceState::Ready(engine) => Some((engine.kind(), engine.adapter(), &engine.why)),
            _ => None,
        }
    }

    /// Describes the slow work that precedes a deep view's first pixels, while it lasts.
    pub fn following(&self) -> Option<String> {
        match &self.stage {
            ServiceState::Ready(engine) => engine.following.words(),
            _ => None,
        }
    }

    /// Returns the message on the slow part of opening an engine, while one is being opened.
    pub fn opening(&self) -> Option<String> {
        let said = || self.said.lock().unwrap_or_else(PoisonError::into_inner).clone();
        matches!(self.stage, ServiceState::Opening(_)).then(said)
    }

    /// Returns true if work waits that a turn would begin.
    pub fn is_waiting(&self) -> bool {
        matches!(self.stage, ServiceState::Ready(_)) && self.explorer.is_waiting()
    }

    /// Returns true if there is no engine and none is being opened.
    pub fn has_failed(&self) -> bool {
        matches!(self.stage, ServiceState::Failed)
    }

    /// Cancels the work in flight, because the map will be hidden for a while.
    pub fn rest(&mut self) {
        if let ServiceState::Ready(engine) = &mut self.stage {
            engine.cancel();
            self.explorer.ground();
        }
    }

    /// Sets the view target. While an engine is being opened, the target has the config of the one
    /// before, so that nothing is shown, or told, that answers another question than the view's.
    pub fn aim(&mut self, target: impl FnOnce(IntegratorConfig) -> ViewTarget) {
        if let Some(config) = self.config {
            self.explorer.target(&target(config));
        }
    }

    /// Sets the view target and advances the work, without waiting for the engine.
    pub fn turn(
        &mut self,
        target: impl FnOnce(IntegratorConfig) -> ViewTarget,
        deadline: Instant,
    ) -> ServiceUpdate {
        let opened = self.take_opened();
        self.aim(target);
        opened.unwrap_or_else(|| {
            let ServiceState::Ready(engine) = &mut self.stage else {
                return ServiceUpdate::default();
            };
            match self.explorer.work(engine.as_mut(), Some(deadline)) {
                Ok(news) => ServiceUpdate { news, failure: None },
                Err(error) => self.fail(&error.to_string()),
            }
        })
    }

    /// Takes an engine that has been opened, or reports that opening it failed.
    fn take_opened(&mut self) -> Option<ServiceUpdate> {
        let ServiceState::Opening(opening) = &self.stage else { return None };
        match opening.poll()? {
            Ok(engine) => {
                self.config = Some(engine.config);
                self.stage = ServiceState::Ready(Box::new(engine));
                None
            }
            Err(error) => Some(self.fail(&error.to_string())),
        }
    }

    /// Reopens the engine a few times, then falls back to the processor, then gives up.
    fn fail(&mut self, why: &str) -> ServiceUpdate {
        let again = self.failed_at.is_some_and(|at| at.elapsed() < SOON);
        self.failures = if again { self.failures + 1 } else { 1 };
        self.failed_at = Some(Instant::now());
        self.stage = ServiceState::Failed;
        self.explorer.ground();
        let then = if self.failures < MOST_FAILURES {
            self.open();
            "The engine is being opened again."
        } else if self.request.kind != Some(EngineKind::Cpu) {
            self.request = EngineRequest {
                kind: Some(EngineKind::Cpu),
                adapter: None,
                ..self.request.clone()
            };
            self.failures = 0;
            self.open();
            "The processor goes on; choose another engine under Accuracy."
        } else {
            "Choose another engine or accuracy, or press Try again."
        };
        ServiceUpdate { news: true, failure: Some(format!("The engine failed: {why}. {then}")) }
    }
}

/// Opens an engine for use behind a window: with short slices, and less urgent than the window's
/// own threads.
fn open(
    request: &EngineRequest,
    verify: bool,
    tell: &dyn Fn(&str),
) -> Result<Chosen, choice::ChoiceError> {
    step_back();
    let tuning = GpuTuning { pace: PACE, ..request.tuning };
    // The whole engine gets a thread of its own here.
    let request = EngineRequest { tuning, own_thread: false, ..request.clone() };
    let Chosen { engine, config, why, following } = choice::choose(&request, tell)?;
    let engine = Renderer::of(engine, config, verify, request.threads)?.into_engine();
    Ok(Chosen { engine, config, why, following })
}

/// Makes this thread, and those it will start, yield to the threads that draw. On Linux each thread
/// has a niceness of its own and passes it on to the threads it starts.
pub(super) fn step_back() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::setpriority_process(None, NICENESS) {
        log::info!("the engine runs as urgently as the window: {error}");
    }
}
