//! Answers of a view's pendulums at increasing times: each trajectory is computed once, and
//! continues from its state at the previous time.

use std::ops::Range;

use super::plan::plan;
use super::reader::Reader;
use super::samples::Samples;
use flipmap_engine::{
    Engine, EngineError, EventSpec, IntegratorConfig, Keep, StartList, Starts, run_job,
};
use flipmap_scene::film::{Film, FilmKind};
use flipmap_scene::{Fate, Grid, Scene};

/// The pendulums of a view in motion.
pub struct Moments {
    question: EventSpec,
    config: IntegratorConfig,
    reader: Reader,
    samples: Samples,
    batches: Vec<Batch>,
    /// Time that the pendulums have reached, s.
    reached_secs: f64,
}

/// Pendulums of one job.
struct Batch {
    /// Indices of their pixels, row by row from the first.
    places: Vec<u32>,
    /// Their starts, or the states in which the last job left them.
    starts: Starts,
}

impl Moments {
    /// Places the pendulums of a checked scene, whose question is about one moment, at their starts
    /// in a picture of `size` pixels.
    pub fn new(scene: &Scene, size: [u32; 2], config: IntegratorConfig, job_size: usize) -> Self {
        Moments::of_rows(scene, size, config, job_size, 0..size[1])
    }

    /// Works like [`Moments::new`] for some rows of the picture.
    pub(crate) fn of_rows(
        scene: &Scene,
        size: [u32; 2],
        config: IntegratorConfig,
        job_size: usize,
        rows: Range<u32>,
    ) -> Self {
        let grid = Grid::new(scene, size);
        let question = EventSpec::from(scene);
        let (ask, count) = (scene.question.ask, size[0] as usize * rows.len());
        let mut samples = Samples::unanswered(count, ask.kind().channels.len());
        let mut batches = Vec::new();
        for tile in plan(size[0], rows.clone(), job_size) {
            let (mut places, mut starts) = (Vec::new(), StartList::default());
            for [x, y] in tile.pixels() {
                let place = (y - rows.start) * size[0] + x;
                match grid.fate(x, y) {
                    Fate::Known(outcome) => {
                        samples.set_values(place as usize, outcome.status, &[]);
                        continue;
                    }
                    Fate::Open(angle) => starts.push_at_rest(angle),
                    Fate::Thrown(launch) => starts.push_thrown(launch),
                    Fate::BesideTop(moments) => starts.push_beside_top(moments),
                }
                places.push(place);
            }
            batches.push(Batch { places, starts: starts.into_starts() });
        }
        let reader = Reader::new(ask, &question);
        Moments { question, config, reader, samples, batches, reached_secs: 0.0 }
    }

    /// Returns the states and ends that jobs must return.
    fn keep(&self) -> Keep {
        Keep { ends: self.reader.ends(), states: true }
    }

    /// Returns true if the frames of a checked film can be computed as one motion. Otherwise, every
    /// frame starts again: with checks, or with an integrator that cannot resume all that is
    /// needed.
    pub fn can_make(film: &Film, verify: bool, config: &IntegratorConfig) -> bool {
        let first = &film.keys[0].scene.scene();
        film.kind() == FilmKind::Moments && !verify && Moments::are_possible(first, config)
    }

    /// Returns true if an integrator config can continue pendulums with all that a checked scene's
    /// question needs.
    fn are_possible(scene: &Scene, config: &IntegratorConfig) -> bool {
        let ends = scene.question.ask.kind().needs;
        Keep { ends, states: true }.check(config).is_ok()
    }

    /// Number of pendulums that still move.
    pub(crate) fn moving(&self) -> usize {
        self.batches.iter().map(|batch| batch.places.len()).sum()
    }

    /// Continues all pendulums until `at_secs`, which must not lie before the time they have
    /// reached, and returns the answers there; `None` once `keep_going` returns false.
    pub fn at(
        &mut self,
        engine: &mut dyn Engine,
        at_secs: f64,
        keep_going: &dyn Fn() -> bool,
    ) -> Result<Option<&Samples>, EngineError> {
        assert!(at_secs >= self.reached_secs, "time goes on");
        self.reached_secs = at_secs;
        self.question.budget_secs = at_secs;
        self.reader = self.reader.at(&self.question);
        let keep = self.keep();
        for batch in &mut self.batches {
            let starts = std::mem::replace(&mut batch.starts, Starts::Rest(Vec::new()));
            let (question, config, thrown) = (self.question, self.config, starts.are_thrown());
            let Some(result) = run_job(engine, question, config, starts, keep, keep_going)? else {
                return Ok(None);
            };
            self.reader.fill(&result, &batch.places, &mut self.samples);
            // Pendulums that are not among the unfinished ones have failed.
            let place = |(k, state): (usize, _)| (batch.places[k], state);
            let (places, states): (Vec<u32>, Vec<_>) =
                result.unfinished.into_iter().map(place).unzip();
            (batch.places, batch.starts) = (places, Starts::Resumed { states, thrown });
        }
        Ok(Some(&self.samples))
    }
}
