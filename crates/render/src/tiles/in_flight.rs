//! The one loop from tiles to samples, shared by pictures, films and the window.
//!
//! A [`TileSource`] supplies tiles, with the pixels that are already known. The rest of a tile
//! becomes one job, whose answers come back as samples in the order of the pixels.
//!
//! ```text
//! next_tile ──► known in full ──────────────────────► take
//!      └──────► InFlightJobs ──► engine ──► collect ──► take
//! ```

use std::collections::HashMap;

use super::open_tile::OpenTile;
use super::reader::Reader;
use super::samples::{Counts, Samples};
use flipmap_engine::{
    Effort, Engine, EngineError, EventSpec, IntegratorConfig, IntegratorState, Job, JobResult,
    Keep, Starts, Wait,
};
use flipmap_scene::question::QuestionName;

/// A tile to compute, with the question and the integrator config of its job.
pub(super) struct NextTile<T> {
    pub tile: T,
    pub open: OpenTile,
    pub question: EventSpec,
    pub config: IntegratorConfig,
    /// True if states are returned, so that pendulums can be resumed.
    pub keeps_states: bool,
    pub ask: QuestionName,
}

/// A supplier of tiles that takes back their samples.
pub(super) trait TileSource {
    type Tile;

    /// Removes the next tile from the queue; its job should have about `job_size` starts.
    fn next_tile(&mut self, job_size: usize) -> Option<NextTile<Self::Tile>>;

    /// Takes a finished tile.
    fn take(&mut self, batch: FinishedBatch<Self::Tile>);

    fn in_flight(&mut self) -> &mut InFlightJobs<Self::Tile>;

    /// Fills the engine's slots, or stops once `enough` returns true. Tiles without open pixels are
    /// finished at once; returns true if there were any.
    fn submit(
        &mut self,
        engine: &mut dyn Engine,
        enough: impl Fn(&Self) -> bool,
    ) -> Result<bool, EngineError> {
        let mut news = false;
        while self.in_flight().len() < engine.slots() {
            let Some(mut next) = self.next_tile(engine.job_size()) else { break };
            if engine.distrusts() {
                next.open.samples.distrust();
            }
            if next.open.is_settled() {
                self.take(FinishedBatch::settled(next.tile, next.open.samples));
                news = true;
            } else {
                self.in_flight().submit(engine, next)?;
            }
            if enough(self) {
                break;
            }
        }
        Ok(news)
    }

    /// Advances the engine and takes the tiles that have come back. Returns true if there were any.
    fn collect(&mut self, engine: &mut dyn Engine, wait: Wait) -> Result<bool, EngineError> {
        let batches = self.in_flight().poll(engine, wait)?;
        let news = !batches.is_empty();
        batches.into_iter().for_each(|batch| self.take(batch));
        Ok(news)
    }
}

/// A tile with all its samples.
#[derive(Debug)]
pub(super) struct FinishedBatch<T> {
    pub tile: T,
    pub samples: Samples,
    /// Places of the samples that the job computed.
    pub computed: Vec<u32>,
    /// Places and states of the computed pixels that have not flipped, if they were to be kept.
    pub unfinished: Vec<(u32, IntegratorState)>,
    pub effort: Effort,
}

impl<T> FinishedBatch<T> {
    /// Creates the batch of a tile that was known in full.
    fn settled(tile: T, samples: Samples) -> Self {
        let (computed, unfinished, effort) = (Vec::new(), Vec::new(), Effort::default());
        FinishedBatch { tile, samples, computed, unfinished, effort }
    }

    /// Adds the work of the batch to `counts`; its samples are counted by the source that takes
    /// them.
    pub(super) fn count_work(&self, counts: &mut Counts) {
        counts.simulated += self.computed.len() as u64;
        counts.effort += self.effort;
    }
}

/// A tile that an engine is computing.
#[derive(Debug)]
struct JobInFlight<T> {
    tile: T,
    /// Samples, of which those known beforehand are filled in.
    samples: Samples,
    /// Places of the samples that are computed.
    places: Vec<u32>,
    reader: Reader,
}

/// The tiles that an engine is computing, by the ids of their jobs.
#[derive(Debug)]
pub(super) struct InFlightJobs<T> {
    jobs: HashMap<u64, JobInFlight<T>>,
    next_id: u64,
}

impl<T> Default for InFlightJobs<T> {
    fn default() -> Self {
        InFlightJobs { jobs: HashMap::new(), next_id: 0 }
    }
}

impl<T> InFlightJobs<T> {
    /// Number of jobs in flight.
    pub(super) fn len(&self) -> usize {
        self.jobs.len()
    }

    /// Returns true if no job is in flight.
    pub(super) fn is_empty(&self) -> bool {
        self.jobs.is_empty()
    }

    /// Iterates over the tiles of all jobs, in no particular order.
    pub(super) fn tiles(&self) -> impl Iterator<Item = &T> {
        self.jobs.values().map(|job| &job.tile)
    }

    /// Submits a tile's open pixels to the engine as one job.
    fn submit(&mut self, engine: &mut dyn Engine, next: NextTile<T>) -> Result<(), EngineError> {
        let NextTile { tile, open, question, config, keeps_states, ask } = next;
        let OpenTile { samples, places, starts } = open;
        // A pendulum that begins where its cell's flow patch ends has no state to resume.
        let states = keeps_states && !matches!(starts, Starts::Deep(_));
        let reader = Reader::new(ask, &question);
        let keep = Keep { ends: reader.ends(), states };
        let id = self.next_id;
        self.next_id += 1;
        engine.submit(Job { id, question, config, starts, keep })?;
        self.jobs.insert(id, JobInFlight { tile, samples, places, reader });
        Ok(())
    }

    /// Advances the engine and returns the tiles that have come back.
    fn poll(
        &mut self,
        engine: &mut dyn Engine,
        wait: Wait,
    ) -> Result<Vec<FinishedBatch<T>>, EngineError> {
        if self.is_empty() {
            return Ok(Vec::new());
        }
        Ok(engine.poll(wait)?.into_iter().filter_map(|answer| self.finish(answer)).collect())
    }

    /// Cancels and forgets all jobs.
    pub(super) fn cancel(&mut self, engine: &mut dyn Engine) {
        engine.cancel();
        self.forget();
    }

    /// Forgets all jobs. Results that still arrive are ignored, because no job id is used twice.
    pub(super) fn forget(&mut self) {
        self.jobs.clear();
    }

    fn finish(&mut self, answer: JobResult) -> Option<FinishedBatch<T>> {
        let JobInFlight { tile, mut samples, places, reader } = self.jobs.remove(&answer.id)?;
        reader.fill(&answer, &places, &mut samples);
        for (&place, &assurance) in places.iter().zip(&answer.assurances) {
            samples.assure(place as usize, assurance);
        }
        let unfinished = answer.unfinished.into_iter();
        let unfinished = unfinished.map(|(k, state)| (places[k], state)).collect();
        Some(FinishedBatch { tile, samples, computed: places, unfinished, effort: answer.effort })
    }
}
