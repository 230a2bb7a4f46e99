//! The only path from a document to the files of a picture. The command line and the window's
//! exports both use it; they differ only in how they choose an engine and display progress.

use super::render::{pass_samples, pass_work, render_pass};
use super::{OutputError, Paths, RenderClock, RenderError, SinkPass, Sinks};
use crate::Watch;
use crate::tiles::{Counts, Renderer, SavedPixels, check_feasible};
use flipmap_engine::Cells;
use flipmap_engine::clock::Instant;
use flipmap_engine::trust::Opinion;
use flipmap_scene::{Document, SceneError};

/// A picture to be made.
pub struct PictureRecipe<'a> {
    /// Scene and colours, checked and settled, with a view fitted to the size.
    pub document: &'a Document,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The choice of starts that are followed as cells first.
    pub cells: Cells,
    /// Files to write.
    pub paths: &'a Paths,
}

/// A picture that was made.
#[derive(Default)]
pub struct RenderedPicture {
    /// Counts of all passes.
    pub counts: Counts,
    /// The result of integrating some pixels directly; `None` if none were.
    pub opinion: Option<Opinion>,
    /// Time spent on it.
    pub clock: RenderClock,
}

impl PictureRecipe<'_> {
    /// Refuses invalid colours and sizes and files that cannot be written, before an engine is
    /// started.
    pub fn check(&self) -> Result<(), RenderError> {
        let check = |checked: Result<(), SceneError>| checked.map_err(OutputError::from);
        check(self.document.picture.check())?;
        check(self.document.picture.check_size(self.size))?;
        Ok(self.paths.check(&self.document.picture)?)
    }

    /// Computes the samples, paints them and completes the files. `saved` holds the pixels of an
    /// earlier render, which are resumed; afterwards it holds those that a later one can resume, also
    /// if this one was stopped.
    pub fn render(
        &self,
        renderer: &mut Renderer,
        saved: &mut Option<SavedPixels>,
        watch: &dyn Watch,
    ) -> Result<RenderedPicture, RenderError> {
        let beginning = Instant::now();
        let scene = self.document.scene();
        check_feasible(&scene, self.size, &renderer.config(), self.cells)?;
        let mut sinks = Sinks::open(self.paths, self.document, self.size)?;
        let passes = sinks.passes(self.document.picture.samples);
        let samples = |pass: &SinkPass| pass_samples(self.document, self.size, pass);
        let total = passes.iter().flat_map(samples).sum();
        let keep_going = || watch.keep_going(0, total);
        let opinion = renderer.second_opinion(&scene, self.size, self.cells, &keep_going)?;
        let mut rendered = RenderedPicture { opinion, ..RenderedPicture::default() };
        rendered.clock.setup = beginning.elapsed();
        let mut done = 0;
        for pass in &passes {
            let at = |samples: u64| watch.keep_going(done + samples, total);
            self.run_pass(renderer, (&mut sinks, pass), saved, &mut rendered, &at)?;
            done += samples(pass).iter().sum::<u64>();
        }
        let finishing = Instant::now();
        sinks.finish()?;
        rendered.clock.output += finishing.elapsed();
        Ok(rendered)
    }

    /// Runs one pass; `keep_going` takes the number of its samples so far, and returns false to
    /// stop.
    fn run_pass(
        &self,
        renderer: &mut Renderer,
        (sinks, pass): (&mut Sinks, &SinkPass),
        saved: &mut Option<SavedPixels>,
        rendered: &mut RenderedPicture,
        keep_going: &dyn Fn(u64) -> bool,
    ) -> Result<(), RenderError> {
        let [middles, _] = pass_samples(self.document, self.size, pass);
        let clock = &mut rendered.clock;
        let what = (self.document, self.cells);
        let in_middles = |counts: &Counts| keep_going(counts.pixels);
        let mut work = pass_work(renderer, what, self.size, (sinks, pass), clock, &in_middles)?;
        if let Some(saved) = saved.take() {
            work = work.keeping(saved);
        }
        let mut keep_going = |counts: &Counts| keep_going(middles + counts.pixels);
        let done = render_pass(&mut work, renderer.engine(), sinks, pass, clock, &mut keep_going);
        rendered.counts += work.totals();
        *saved = work.into_kept();
        done
    }
}
