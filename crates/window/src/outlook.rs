//! The outlook on an unchecked view: how much of it is expected to be right, estimated in the
//! background once the view is computed.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, mpsc::TryRecvError};

use super::auto_budget::AutoBudget;
use super::compute_service::Wake;
use super::state::AppState;
use super::time_left::TimeLeft;
use flipmap_engine::choice::IntegrationSetting;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::trust::AccuracyEstimate;
use flipmap_engine::{Accuracy, Cells, EngineError, IntegratorConfig};
use flipmap_render::tiles::outlook;
use flipmap_render::tiles::view_target::ViewTarget;
use flipmap_scene::Scene;

/// Width and height in pixels of the picture that represents the view.
const SIZE: [u32; 2] = [64, 64];

/// Estimates about the newest view, made in the background.
#[derive(Default)]
pub(super) struct Estimates {
    pub(super) forecast: Forecast,
    pub(super) auto_budget: AutoBudget,
    pub(super) time_left: TimeLeft,
}

/// The outlook on the newest view.
#[derive(Default)]
pub(super) struct Forecast {
    asked: Option<ViewTarget>,
    flying: Option<OutlookThread>,
    known: Option<AccuracyEstimate>,
}

/// A thread that estimates the outlook from a sample of starts.
struct OutlookThread {
    answer: Receiver<AccuracyEstimate>,
    stopped: Arc<AtomicBool>,
}

impl Forecast {
    /// Asks for the outlook on a view that `balanced` has computed. `config` is what computed it;
    /// none while the view is not complete. Returns true if there is news.
    pub(super) fn follow(
        &mut self,
        state: &AppState,
        config: Option<IntegratorConfig>,
        wake: &Wake,
    ) -> bool {
        let spec = &state.integration.spec;
        let is_balanced = spec.setting == IntegrationSetting::Accuracy(Accuracy::Balanced);
        if !is_balanced || spec.verify || !state.scene().is_flip_from_rest() {
            // Views that are checked or computed otherwise need no outlook.
            *self = Forecast::default();
            return false;
        }
        if let Some(config) = config.filter(|_| state.moving.is_none()) {
            self.ask(state.view_target(config), || state.document().scene(), wake);
        }
        self.listen()
    }

    /// Asks for the outlook on a view, unless it is the one last asked for; `scene` returns its
    /// scene.
    fn ask(&mut self, target: ViewTarget, scene: impl FnOnce() -> Scene, wake: &Wake) {
        let target = ViewTarget { pointer: None, refinements: 0, ..target };
        if self.asked.as_ref() == Some(&target) {
            return;
        }
        let config = target.physics.config;
        (self.asked, self.known) = (Some(target), None);
        let (sender, answer) = channel();
        let (stopped, wake) = (Arc::new(AtomicBool::new(false)), Arc::clone(wake));
        self.flying = Some(OutlookThread { answer, stopped: Arc::clone(&stopped) });
        let scene = scene();
        std::thread::spawn(move || match look(&scene, config, &stopped) {
            Ok(Some(outlook)) => {
                // The receiver is gone once the outlook on another view is asked for.
                let _ = sender.send(outlook);
                wake();
            }
            Ok(None) => {}
            Err(error) => log::warn!("no outlook on this view: {error}"),
        });
    }

    /// Takes an outlook that has been found; returns true if there is news.
    fn listen(&mut self) -> bool {
        if let Some(flying) = &self.flying {
            match flying.answer.try_recv() {
                Ok(outlook) => (self.known, self.flying) = (Some(outlook), None),
                Err(TryRecvError::Disconnected) => self.flying = None,
                Err(TryRecvError::Empty) => return false,
            }
            return true;
        }
        false
    }

    /// Returns a warning about the newest view, if it needs one: a short form and the full text.
    pub(super) fn warning(&self) -> Option<(String, String)> {
        let outlook = self.known?;
        let percent = 100.0 * (1.0 - outlook.expected_right());
        Some((format!("{percent:.0} % beyond the horizon"), outlook.warning()?))
    }
}

impl Drop for OutlookThread {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}

fn look(
    scene: &Scene,
    config: IntegratorConfig,
    stop: &AtomicBool,
) -> Result<Option<AccuracyEstimate>, EngineError> {
    let mut engine = DepthEngine::new(Box::new(CpuEngine::new(Some(1))?), Some(1))?;
    let how = (config, Cells::Auto);
    outlook(scene, SIZE, how, &mut engine, &|| !stop.load(Ordering::Relaxed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute_service::woken;
    use flipmap_engine::level::BALANCED;
    use flipmap_numbers::Exact;
    use flipmap_render::tiles::view_target::Physics;
    use flipmap_scene::lattice::Region;
    use flipmap_scene::{Budget, QuestionSettings};
    use std::time::Duration;

    #[test]
    fn a_view_beyond_the_horizon_is_warned_of() {
        let (wake, woken) = woken();
        let mut forecast = Forecast::default();
        let mut warning_after = |secs: f64| {
            let question =
                QuestionSettings { budget: Budget::secs(secs), ..QuestionSettings::default() };
            let scene = Scene { question, ..Scene::default() }.checked().unwrap();
            let physics = Physics::of(&scene, BALANCED, false);
            let region = Region { center: [Exact::ZERO; 2], half_rad: [3.0; 2], repeats: true };
            let pointer = None;
            let target = ViewTarget {
                physics,
                budget_secs: secs,
                region,
                level: 4,
                pointer,
                refinements: 0,
            };
            forecast.ask(target.clone(), || scene, &wake);
            woken.recv_timeout(Duration::from_secs(60)).unwrap();
            assert!(forecast.listen());
            let warning = forecast.warning();
            forecast.ask(target, || unreachable!("it is known"), &wake);
            assert_eq!(forecast.warning(), warning, "asked twice, known once");
            warning
        };
        assert_eq!(warning_after(10.0), None);
        assert!(warning_after(200.0).unwrap().1.contains("beyond the horizon"));
    }
}
