//! The library's main entry point: a scene goes in, samples come out.

use super::preview::preview;
use super::{Samples, Work, opinion};
use crate::engine::choice::{ChoiceError, Chosen, EngineRequest, IntegrationSetting, choose};
use crate::engine::trust::TrustEngine;
use crate::engine::{Accuracy, Engine, EngineError, IntegratorConfig};
use crate::scene::Scene;

/// Renders scenes to arrays of samples, with one engine for all of them.
///
/// ```
/// use flipmap::engine::choice::{EngineKind, EngineRequest};
/// use flipmap::scene::Scene;
/// use flipmap::tiles::Renderer;
///
/// let mut renderer = Renderer::new(&EngineRequest { kind: EngineKind::Cpu, ..EngineRequest::default() })?;
/// let samples = renderer.render(&Scene::default(), [16, 16])?;
/// assert_eq!(samples.len(), 256);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Renderer {
    engine: Maker,
    config: IntegratorConfig,
}

/// An engine with or without checks.
enum Maker {
    Unchecked(Box<dyn Engine>),
    Checked(Box<TrustEngine<'static>>),
}

impl Renderer {
    /// Chooses and starts the requested engine. Every pixel is checked if `exact` is requested.
    pub fn new(wish: &EngineRequest) -> Result<Self, ChoiceError> {
        Renderer::with_checks(wish, wish.setting == IntegrationSetting::Accuracy(Accuracy::Exact))
    }

    /// Does the same, but checks every pixel if `verify` is true, and none otherwise.
    pub fn with_checks(wish: &EngineRequest, verify: bool) -> Result<Self, ChoiceError> {
        let Chosen { engine, config, .. } = choose(wish, &|_| {})?;
        let engine = if verify {
            Maker::Checked(Box::new(TrustEngine::new(engine, wish.threads)?))
        } else {
            Maker::Unchecked(engine)
        };
        Ok(Renderer { engine, config })
    }

    /// Returns the integrator config of the pixels.
    pub fn config(&self) -> IntegratorConfig {
        self.config
    }

    /// Returns the samples of a checked scene in `size` pixels, row by row from the top.
    pub fn render(&mut self, scene: &Scene, size: [u32; 2]) -> Result<Samples, EngineError> {
        let samples = self.render_while(scene, size, &|| true)?;
        Ok(samples.expect("nobody says stop"))
    }

    /// Does the same, but returns `None` once `go_on` returns false.
    pub fn render_while(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Samples>, EngineError> {
        if let Maker::Checked(engine) = &mut self.engine {
            opinion(scene, size, self.config, engine.as_mut(), go_on)?;
        }
        let engine: &mut dyn Engine = match &mut self.engine {
            Maker::Unchecked(engine) => engine.as_mut(),
            Maker::Checked(engine) => engine.as_mut(),
        };
        let mut work = Work::new(scene, size, self.config, engine.job_size());
        preview(&mut work, size, engine, go_on)
    }
}
