//! The renderer: a scene goes in, samples come out.

use super::preview::preview;
use super::{Counts, Samples, Work, check_feasible, opinion};
use crate::Watch;
use flipmap_engine::choice::{ChoiceError, Chosen, EngineRequest, choose};
use flipmap_engine::threads::threads_beside;
use flipmap_engine::trust::{Opinion, TrustEngine};
use flipmap_engine::{Cells, Engine, EngineError, IntegratorConfig};
use flipmap_scene::{Sampling, Scene};

/// Renders scenes to arrays of samples, one engine for all of them.
///
/// ```
/// use flipmap_engine::choice::EngineRequest;
/// use flipmap_engine::EngineKind;
/// use flipmap_scene::Scene;
/// use flipmap_render::tiles::Renderer;
///
/// let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
/// let samples = Renderer::new(&request)?.render(&Scene::default(), [16, 16])?;
/// assert_eq!(samples.len(), 256);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Renderer {
    engine: MaybeChecked,
    config: IntegratorConfig,
    counts: Counts,
}

/// The engine, with checks or without.
enum MaybeChecked {
    Unchecked(Box<dyn Engine>),
    Checked(Box<TrustEngine<'static>>),
}

/// Creates a renderer with a chosen engine, with checks if its request asks for them.
impl TryFrom<Chosen> for Renderer {
    type Error = EngineError;

    fn try_from(chosen: Chosen) -> Result<Self, EngineError> {
        let Chosen { engine, config, request, .. } = chosen;
        Renderer::of(engine, config, request.verifies(), request.threads)
    }
}

impl Renderer {
    /// Chooses and starts the engine of a request. Pixels are checked if the request says so or
    /// asks for the level `exact`.
    pub fn new(request: &EngineRequest) -> Result<Self, ChoiceError> {
        Ok(Renderer::try_from(choose(request, &|_| {})?)?)
    }

    /// Creates a renderer with the given engine; with `verify`, every pixel is checked, on
    /// `threads` threads of the processor or on one for each core.
    pub fn of(
        engine: Box<dyn Engine>,
        config: IntegratorConfig,
        verify: bool,
        threads: Option<usize>,
    ) -> Result<Self, EngineError> {
        let engine = if verify {
            MaybeChecked::Checked(Box::new(TrustEngine::new(engine, threads_beside(threads))?))
        } else {
            MaybeChecked::Unchecked(engine)
        };
        Ok(Renderer { engine, config, counts: Counts::default() })
    }

    /// Returns the method, tolerance and number type of the pixels.
    pub fn config(&self) -> IntegratorConfig {
        self.config
    }

    /// Returns the counts of the last picture.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Returns the engine, with its checks if there are any.
    pub fn engine(&mut self) -> &mut dyn Engine {
        match &mut self.engine {
            MaybeChecked::Unchecked(engine) => engine.as_mut(),
            MaybeChecked::Checked(engine) => engine.as_mut(),
        }
    }

    /// Returns true if every pixel is checked.
    pub(crate) fn is_checked(&self) -> bool {
        matches!(self.engine, MaybeChecked::Checked(_))
    }

    /// Returns the engine alone, for a loop outside the renderer.
    pub fn into_engine(self) -> Box<dyn Engine> {
        match self.engine {
            MaybeChecked::Unchecked(engine) => engine,
            MaybeChecked::Checked(engine) => engine,
        }
    }

    /// Integrates some pixels of a picture directly if pixels are checked (see [`opinion()`]).
    pub fn second_opinion(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        cells: Cells,
        keep_going: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Opinion>, EngineError> {
        match &mut self.engine {
            MaybeChecked::Unchecked(_) => Ok(None),
            MaybeChecked::Checked(engine) => {
                opinion(scene, size, (self.config, cells), engine, keep_going)
            }
        }
    }

    /// Returns the work of a picture of `size` pixels, for a loop that takes tiles as they finish.
    pub fn work(&mut self, scene: &Scene, size: [u32; 2]) -> Work {
        self.sampled_work(scene, size, Sampling::SINGLE)
    }

    /// Returns the work of a picture whose pixels are sampled by `sampling`.
    pub(crate) fn sampled_work(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        sampling: Sampling,
    ) -> Work {
        let tile_pixels = self.engine().job_size();
        Work::sampled(&scene.clone().settled(), (size, sampling), self.config, tile_pixels)
    }

    /// Returns the samples of a checked scene in `size` pixels, row by row from the top; an error
    /// if the pixels lie too close together for the question or the plane.
    pub fn render(&mut self, scene: &Scene, size: [u32; 2]) -> Result<Samples, EngineError> {
        let samples = self.render_while(scene, size, &|_, _| true)?;
        Ok(samples.expect("it is never stopped"))
    }

    /// Returns the samples of a checked scene; `None` if `watch` stops it.
    pub fn render_while(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        watch: &dyn Watch,
    ) -> Result<Option<Samples>, EngineError> {
        let scene = &scene.clone().settled();
        check_feasible(scene, size, &self.config, Cells::Auto)?;
        let total = u64::from(size[0]) * u64::from(size[1]);
        self.second_opinion(scene, size, Cells::Auto, &|| watch.keep_going(0, total))?;
        let mut work = self.work(scene, size);
        let keep_going = |counts: &Counts| watch.keep_going(counts.pixels, total);
        let samples = preview(&mut work, size, self.engine(), &keep_going)?;
        self.counts = work.counts();
        Ok(samples)
    }
}
