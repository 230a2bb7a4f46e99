//! The compute service: the engine behind the window, its scheduler, and recovery from failures.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use flipmap_engine::background::{self, Background, PendingEngine};
use flipmap_engine::choice::{self, Chosen, EngineRequest, IntegrationSetting};
use flipmap_engine::profile::Profile;
use flipmap_engine::{Engine, EngineKind, GpuTuning, IntegratorConfig};
use flipmap_render::tiles::Renderer;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_render::tiles::view_target::ViewTarget;

/// A function that wakes the window from any thread.
pub(crate) type Wake = Arc<dyn Fn() + Send + Sync>;

/// Returns a waker and the receiver of what it sends at each call.
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
const MAX_FAILURES: u32 = 3;
const SOON: Duration = Duration::from_secs(60);

/// The state of the engine: being opened, ready, or failed.
enum ServiceState {
    Opening(PendingEngine),
    Ready(Box<Background>),
    Failed,
}

/// The comparison of the engines of a machine that has not been measured yet. The processor
/// computes the first view before it.
enum Comparison {
    /// No comparison is needed.
    None,
    /// A comparison that begins once the first view is complete, because other work would distort
    /// it.
    Due,
    Running(PendingEngine),
}

/// The engine and the cells it computes.
pub struct ComputeService {
    /// Scheduler of the cells, with all that is known and wanted.
    pub explorer: Explorer,
    request: EngineRequest,
    stage: ServiceState,
    comparison: Comparison,
    /// True if the engine that is being opened only stands in for the fastest one.
    stands_in: Arc<AtomicBool>,
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
pub(crate) struct ServiceUpdate {
    /// True if something new can be drawn.
    pub news: bool,
    /// Sentence that says what went wrong and what to do; none without a failure.
    pub failure: Option<String>,
}

impl ComputeService {
    /// Creates the service and begins to open its engine.
    pub(crate) fn new(request: EngineRequest, cache_bytes: usize, wake: Wake) -> Self {
        let stage = ServiceState::Failed;
        let explorer = Explorer::new(cache_bytes);
        let mut service = ComputeService {
            explorer,
            request,
            stage,
            comparison: Comparison::None,
            stands_in: Arc::default(),
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
    pub fn reopen(&mut self, request: EngineRequest) {
        self.request = request;
        self.failures = 0;
        self.open();
    }

    fn open(&mut self) {
        self.explorer.ground();
        self.comparison = Comparison::None;
        self.stands_in = Arc::default();
        let stands_in = Arc::clone(&self.stands_in);
        // The engine's thread finds out whether the machine was measured, because that takes a
        // moment.
        let opening = self.begin(move |request| {
            let is_measured = || Profile::kept(request.threads).is_some();
            if waits_for_comparison(&request) && !is_measured() {
                stands_in.store(true, Ordering::Release);
                return EngineRequest { kind: Some(EngineKind::Cpu), ..request };
            }
            request
        });
        self.stage = opening.map_or(ServiceState::Failed, ServiceState::Opening);
    }

    /// Begins to open an engine for the request as changed by `choose`; none if no thread can be
    /// started.
    fn begin(
        &mut self,
        choose: impl FnOnce(EngineRequest) -> EngineRequest + Send + 'static,
    ) -> Option<PendingEngine> {
        let request = self.request.clone();
        let (said, waker) = (Arc::new(Mutex::new(String::new())), Arc::clone(&self.wake));
        self.said = Arc::clone(&said);
        let tell = move |text: &str| {
            // Even a thread that panicked while it held the lock left a whole sentence.
            text.clone_into(&mut said.lock().unwrap_or_else(PoisonError::into_inner));
            waker();
        };
        let wake = Arc::clone(&self.wake);
        let opening = background::open(move || open(&choose(request), &tell), move || wake());
        opening.inspect_err(|error| log::error!("no thread for the engine: {error}")).ok()
    }

    /// Compares the engines once the first view is complete, and switches from the processor to a
    /// faster one, if any. Returns true if the engine has changed.
    fn compare(&mut self) -> bool {
        match &self.comparison {
            Comparison::Due if self.explorer.is_done() && self.explorer.progress().covered => {
                let opening = self.begin(|request| request);
                self.comparison = opening.map_or(Comparison::None, Comparison::Running);
                false
            }
            Comparison::Running(opening) => {
                let Some(compared) = opening.poll() else { return false };
                self.comparison = Comparison::None;
                match compared {
                    Ok(engine) if engine.kind() != EngineKind::Cpu => {
                        self.explorer.ground();
                        self.config = Some(engine.config);
                        self.stage = ServiceState::Ready(Box::new(engine));
                        return true;
                    }
                    Ok(_) => {}
                    Err(error) => log::warn!("the engines could not be compared: {error}"),
                }
                false
            }
            _ => false,
        }
    }

    /// Returns the integrator config of the engine, once it is open.
    pub fn config(&self) -> Option<IntegratorConfig> {
        match &self.stage {
            ServiceState::Ready(engine) => Some(engine.config),
            _ => None,
        }
    }

    /// Returns the name of the engine, its adapter, and why it was chosen, for display.
    pub(crate) fn engine(&self) -> Option<(EngineKind, String, &str)> {
        match &self.stage {
            ServiceState::Ready(engine) => Some((engine.kind(), engine.adapter(), &engine.why)),
            _ => None,
        }
    }

    /// Describes the slow work that precedes a deep view's first pixels, while it lasts.
    pub(crate) fn following(&self) -> Option<String> {
        match &self.stage {
            ServiceState::Ready(engine) => engine.following.words(),
            _ => None,
        }
    }

    /// Returns the message on the slow part of opening an engine, while one is being opened.
    pub(crate) fn opening(&self) -> Option<String> {
        matches!(self.stage, ServiceState::Opening(_)).then(|| self.said())
    }

    /// Returns the message on the comparison of the engines, while it lasts.
    pub(crate) fn comparing(&self) -> Option<String> {
        let said = matches!(self.comparison, Comparison::Running(_)).then(|| self.said());
        said.filter(|said| !said.is_empty())
    }

    fn said(&self) -> String {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns true if a turn would begin work that is waiting.
    pub(crate) fn is_waiting(&self) -> bool {
        matches!(self.stage, ServiceState::Ready(_)) && self.explorer.is_waiting()
    }

    /// Returns true if there is no engine and none is being opened.
    pub(crate) fn has_failed(&self) -> bool {
        matches!(self.stage, ServiceState::Failed)
    }

    /// Cancels the work in flight, because the map will be hidden for a while.
    pub(crate) fn rest(&mut self) {
        if let ServiceState::Ready(engine) = &mut self.stage {
            engine.cancel();
            self.explorer.ground();
        }
    }

    /// Sets the view target. While an engine is being opened, the target has the config of the
    /// previous one, so that everything shown answers the view's question.
    pub(crate) fn aim(&mut self, target: impl FnOnce(IntegratorConfig) -> ViewTarget) {
        let Some(config) = self.config else { return };
        let target = target(config);
        // Engines that are compared must have the machine to themselves.
        let is_free = matches!(self.comparison, Comparison::None);
        let refinements = if is_free { target.refinements } else { 0 };
        self.explorer.target(&ViewTarget { refinements, ..target });
    }

    /// Sets the view target and advances the work, without waiting for the engine.
    pub(crate) fn turn(
        &mut self,
        target: impl FnOnce(IntegratorConfig) -> ViewTarget,
        deadline: Instant,
    ) -> ServiceUpdate {
        let opened = self.take_opened();
        let compared = self.compare();
        self.aim(target);
        opened.unwrap_or_else(|| {
            let ServiceState::Ready(engine) = &mut self.stage else {
                return ServiceUpdate::default();
            };
            match self.explorer.work(engine.as_mut(), Some(deadline)) {
                Ok(news) => ServiceUpdate { news: news || compared, failure: None },
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
                if self.stands_in.load(Ordering::Acquire) {
                    self.comparison = Comparison::Due;
                }
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
        let then = if self.failures < MAX_FAILURES {
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
            "The processor takes over; choose another engine under Accuracy."
        } else {
            "Choose another engine or accuracy, or press Try again."
        };
        ServiceUpdate { news: true, failure: Some(format!("The engine failed: {why}. {then}")) }
    }
}

/// Returns true if a request asks for the fastest engine at an accuracy level. The processor can
/// keep the level's promise until the engines have been measured.
fn waits_for_comparison(request: &EngineRequest) -> bool {
    let is_open = request.kind.is_none() && request.adapter.is_none();
    is_open && matches!(request.setting, IntegrationSetting::Accuracy(_))
}

/// Opens an engine for use behind a window: with short slices, and less urgent than the window's
/// own threads.
fn open(request: &EngineRequest, tell: &dyn Fn(&str)) -> Result<Chosen, choice::ChoiceError> {
    lower_priority();
    let tuning = GpuTuning { pace: PACE, at_once: true, ..request.tuning };
    // The whole engine gets a thread of its own here.
    let request = EngineRequest { tuning, own_thread: false, ..request.clone() };
    let chosen = choice::choose(&request, tell)?;
    let (config, why, following) = (chosen.config, chosen.why.clone(), chosen.following.clone());
    let engine = Renderer::try_from(chosen)?.into_engine();
    Ok(Chosen { engine, config, why, following, request })
}

/// Makes this thread, and those it will start, yield to the threads that draw. On Linux each thread
/// has a niceness of its own and passes it on to the threads it starts.
pub(super) fn lower_priority() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::setpriority_process(None, NICENESS) {
        log::info!("the engine runs as urgently as the window: {error}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::Accuracy;
    use flipmap_render::tiles::view_target::Physics;
    use flipmap_scene::Scene;
    use flipmap_scene::lattice::Region;

    #[test]
    fn only_the_choice_of_the_fastest_waits_for_a_comparison() {
        let open = EngineRequest::default();
        assert!(waits_for_comparison(&open));
        let asked = EngineRequest { kind: Some(EngineKind::Gpu), ..open.clone() };
        let named = EngineRequest { adapter: Some("llvm".to_string()), ..open };
        assert!(!waits_for_comparison(&asked) && !waits_for_comparison(&named));
    }

    /// Takes turns until a condition holds.
    fn until(service: &mut ComputeService, holds: impl Fn(&ComputeService) -> bool) {
        let scene = Scene::default();
        let region = Region { center: scene.view.center_rad(), half_rad: [1.0; 2], repeats: true };
        let begun = Instant::now();
        while !holds(service) {
            let target = |config| ViewTarget {
                physics: Physics::of(&scene, config, false),
                budget_secs: 2.0,
                region,
                level: 1,
                pointer: None,
                refinements: 0,
            };
            let update = service.turn(target, Instant::now() + Duration::from_millis(2));
            assert_eq!(update.failure, None);
            assert!(begun.elapsed() < Duration::from_secs(120), "nothing comes of it");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn engines_are_compared_once_the_first_view_is_complete_and_the_processor_goes_on() {
        let setting = IntegrationSetting::Accuracy(Accuracy::Fast);
        let kind = Some(EngineKind::Cpu);
        let request = EngineRequest { kind, setting, ..EngineRequest::default() };
        let (wake, _woken) = woken();
        let mut service = ComputeService::new(request, 64 << 20, wake);
        service.stands_in.store(true, Ordering::Release);
        until(&mut service, |service| matches!(service.comparison, Comparison::Due));
        until(&mut service, |service| matches!(service.comparison, Comparison::Running(_)));
        assert!(service.explorer.is_done() && service.explorer.progress().covered);
        let simulated = service.explorer.counts().simulated;
        until(&mut service, |service| matches!(service.comparison, Comparison::None));
        let engine = service.engine().map(|(kind, ..)| kind);
        assert_eq!(engine, Some(EngineKind::Cpu));
        assert_eq!(service.explorer.counts().simulated, simulated, "nothing is computed again");
    }
}
