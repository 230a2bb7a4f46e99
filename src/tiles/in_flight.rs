//! Jobs in the air: what pictures and the lattice of a window have in common.
//!
//! A tile's pixels are first asked what is known without computing; what stays open becomes a
//! job. The answers come back as samples in the order of the pixels.

use std::collections::HashMap;

use super::samples::Samples;
use super::saved_pixels::SavedPixel;
use crate::engine::{Deep, Keep, Leaf, Trust, Wait};
use crate::engine::{
    Effort, Engine, EngineError, IntegratorConfig, IntegratorState, Job, JobResult, Question,
    Starts,
};
use crate::physics::Outcome;
use crate::scene::{Fate, Grouped};

/// A tile before its job: what is known of it, and the starts of the rest.
#[derive(Debug)]
pub struct OpenTile {
    samples: Samples,
    /// For each start, its place among the samples.
    places: Vec<u32>,
    starts: Starts,
}

impl OpenTile {
    /// Sorts pixels, in order, by what becomes of them and what is known already.
    pub fn new(pixels: impl Iterator<Item = (Fate, Option<(SavedPixel, Trust)>)>) -> Self {
        let pixels: Vec<_> = pixels.collect();
        let mut samples = Samples::unflipped(pixels.len());
        let (mut places, mut angles, mut paused) = (Vec::new(), Vec::new(), Vec::new());
        for (place, (fate, known)) in (0..).zip(pixels) {
            let at = place as usize;
            match (fate, known) {
                (Fate::Known(outcome), _) => {
                    samples.set(at, outcome);
                    samples.set_trust(at, Trust::of_proved(&outcome));
                }
                (Fate::Open(_), Some((SavedPixel::Over(outcome), trust))) => {
                    samples.set(at, outcome);
                    samples.set_trust(at, trust);
                }
                (Fate::Open(_), Some((SavedPixel::Unfinished(state), _))) => {
                    places.push(place);
                    paused.push(state);
                }
                (Fate::Open(angle), None) => {
                    places.push(place);
                    angles.push(angle);
                }
            }
        }
        let starts = if paused.is_empty() { Starts::Rest(angles) } else { Starts::Resumed(paused) };
        OpenTile { samples, places, starts }
    }

    /// Sorts `count` pixels of a deep picture, given by their leaves, by what is known already.
    pub fn deep(
        count: usize,
        groups: Grouped,
        known: impl Fn(u32) -> Option<(Outcome, Trust)>,
    ) -> Self {
        let mut samples = Samples::unflipped(count);
        let (mut places, mut leaves) = (Vec::new(), Vec::new());
        for (cell, pixels) in groups {
            let mut points = Vec::with_capacity(pixels.len());
            for (place, point) in pixels {
                if let Some((outcome, trust)) = known(place) {
                    samples.set(place as usize, outcome);
                    samples.set_trust(place as usize, trust);
                } else {
                    places.push(place);
                    points.push(point);
                }
            }
            if !points.is_empty() {
                leaves.push(Leaf { cell, points });
            }
        }
        OpenTile { samples, places, starts: Starts::Deep(Deep { leaves, strict: false }) }
    }

    /// Whether there is nothing to compute.
    pub fn is_settled(&self) -> bool {
        self.places.is_empty()
    }

    /// What has to be computed.
    pub fn into_starts(self) -> Starts {
        self.starts
    }

    /// What is known without computing; the rest is unflipped.
    pub fn into_samples(self) -> Samples {
        self.samples
    }
}

/// A tile whose answers have come.
#[derive(Debug)]
pub struct FinishedBatch<T> {
    /// Which.
    pub tile: T,
    /// All its samples.
    pub samples: Samples,
    /// Places of the samples that were computed now.
    pub computed: Vec<u32>,
    /// Places and states of those among them that have not flipped, if they were to be kept.
    pub paused: Vec<(u32, IntegratorState)>,
    /// What it took.
    pub effort: Effort,
}

/// The tiles that an engine is computing.
#[derive(Debug)]
pub struct InFlightJobs<T> {
    jobs: HashMap<u64, (T, Samples, Vec<u32>)>,
    next_id: u64,
}

impl<T> Default for InFlightJobs<T> {
    fn default() -> Self {
        InFlightJobs { jobs: HashMap::new(), next_id: 0 }
    }
}

impl<T> InFlightJobs<T> {
    /// How many.
    pub fn len(&self) -> usize {
        self.jobs.len()
    }

    /// Whether the engine has nothing to do.
    pub fn is_empty(&self) -> bool {
        self.jobs.is_empty()
    }

    /// The tiles, in no order.
    pub fn tiles(&self) -> impl Iterator<Item = &T> {
        self.jobs.values().map(|(tile, ..)| tile)
    }

    /// Sends a tile's open pixels to the engine.
    pub fn submit(
        &mut self,
        engine: &mut dyn Engine,
        tile: T,
        open: OpenTile,
        (question, config): (Question, IntegratorConfig),
        keep: Keep,
    ) -> Result<(), EngineError> {
        let OpenTile { samples, places, starts } = open;
        // A pendulum that begins at the end of its cell's way is no state of its start's alone.
        let keep = if let Starts::Deep(_) = starts { Keep::Nothing } else { keep };
        let id = self.next_id;
        self.next_id += 1;
        engine.submit(Job { id, question, config, starts, keep })?;
        self.jobs.insert(id, (tile, samples, places));
        Ok(())
    }

    /// Moves the engine on and returns the tiles that have come back.
    pub fn poll(
        &mut self,
        engine: &mut dyn Engine,
        wait: Wait,
    ) -> Result<Vec<FinishedBatch<T>>, EngineError> {
        if self.is_empty() {
            return Ok(Vec::new());
        }
        Ok(engine.poll(wait)?.into_iter().filter_map(|answer| self.land(answer)).collect())
    }

    /// Forgets all of them; their answers will not come.
    pub fn cancel(&mut self, engine: &mut dyn Engine) {
        engine.cancel();
        self.forget();
    }

    /// Forgets all of them; answers that still come are nobody's, for no name is used twice.
    pub fn forget(&mut self) {
        self.jobs.clear();
    }

    fn land(&mut self, answer: JobResult) -> Option<FinishedBatch<T>> {
        let (tile, mut samples, places) = self.jobs.remove(&answer.id)?;
        for (k, &place) in places.iter().enumerate() {
            samples.set(place as usize, answer.outcomes[k]);
            if let Some(&trust) = answer.trusts.get(k) {
                samples.set_trust(place as usize, trust);
            }
        }
        let paused = answer.unfinished.into_iter().map(|(k, state)| (places[k], state)).collect();
        Some(FinishedBatch { tile, samples, computed: places, paused, effort: answer.effort })
    }
}
