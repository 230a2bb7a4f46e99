//! The computation of a film's patches.

use std::collections::VecDeque;

use super::in_flight::{FinishedBatch, InFlightJobs, NextTile, TileSource};
use super::open_tile::{OpenTile, Spacing};
use super::patches::{PATCH_SAMPLES, PATCH_SIDE};
use super::samples::{Counts, Samples};
use super::stride::Stride;
use flipmap_engine::clock::Instant;
use flipmap_engine::{Engine, EngineError, EventSpec, IntegratorConfig, Wait};
use flipmap_scene::Scene;
use flipmap_scene::lattice::Cell;
use flipmap_scene::question::QuestionName;

/// Maximum number of patches in a job.
const MAX_PATCHES_IN_JOB: usize = 1024;

/// The computation of patches of one pendulum.
pub(crate) struct PatchWork {
    scene: Scene,
    question: EventSpec,
    config: IntegratorConfig,
    waiting: VecDeque<Cell>,
    in_flight: InFlightJobs<Vec<Cell>>,
    finished: Vec<(Cell, Samples)>,
    counts: Counts,
}

impl PatchWork {
    /// Creates the work for patches of a checked scene, whose view does not matter.
    pub(crate) fn new(
        scene: &Scene,
        config: IntegratorConfig,
        cells: impl Iterator<Item = Cell>,
    ) -> Self {
        PatchWork {
            scene: scene.clone(),
            question: EventSpec::from(scene),
            config,
            waiting: cells.collect(),
            in_flight: InFlightJobs::default(),
            finished: Vec::new(),
            counts: Counts::default(),
        }
    }

    /// Works until patches have finished or `deadline` has come, and returns the finished patches.
    pub(crate) fn work(
        &mut self,
        engine: &mut dyn Engine,
        deadline: Instant,
    ) -> Result<Vec<(Cell, Samples)>, EngineError> {
        while self.finished.is_empty() && !self.is_done() {
            self.submit(engine, |work| !work.finished.is_empty())?;
            self.collect(engine, Wait::Until(deadline))?;
            if Instant::now() >= deadline {
                break;
            }
        }
        Ok(std::mem::take(&mut self.finished))
    }

    /// Returns true if no patch is waiting or in flight.
    pub(crate) fn is_done(&self) -> bool {
        self.waiting.is_empty() && self.in_flight.is_empty()
    }

    /// Returns the counts of all that has been done so far.
    pub(crate) fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes the next patches of one level, which can share a job, from the queue.
    fn next_cells(&mut self, most: usize) -> Vec<Cell> {
        let level = self.waiting.front().map(|cell| cell.level);
        let alike = self.waiting.iter().take(most).take_while(|cell| Some(cell.level) == level);
        let count = alike.count();
        self.waiting.drain(..count).collect()
    }
}

impl TileSource for PatchWork {
    type Tile = Vec<Cell>;

    fn in_flight(&mut self) -> &mut InFlightJobs<Vec<Cell>> {
        &mut self.in_flight
    }

    fn next_tile(&mut self, job_size: usize) -> Option<NextTile<Vec<Cell>>> {
        let cells = self.next_cells((job_size / PATCH_SAMPLES).clamp(1, MAX_PATCHES_IN_JOB));
        if cells.is_empty() {
            return None;
        }
        let leaf_pixels = self.config.leaf_pixels();
        let spacing = Spacing { side: PATCH_SIDE, stride: Stride::ONE, leaf_pixels };
        let open = OpenTile::of_cells(&self.scene, self.config, &cells, spacing, |_, _| None);
        let (question, config) = (self.question, self.config);
        Some(NextTile {
            tile: cells,
            open,
            question,
            config,
            keeps_states: false,
            ask: QuestionName::Flip,
        })
    }

    fn take(&mut self, batch: FinishedBatch<Vec<Cell>>) {
        batch.count_work(&mut self.counts);
        self.counts.add(&batch.samples);
        for (k, cell) in batch.tile.into_iter().enumerate() {
            let samples = batch.samples.part(k * PATCH_SAMPLES..(k + 1) * PATCH_SAMPLES);
            self.finished.push((cell, samples));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::mock::MockEngine;
    use flipmap_engine::{Method, Precision};
    use flipmap_scene::Fate;

    const CONFIG: IntegratorConfig =
        IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };

    #[test]
    fn every_patch_comes_back_once_with_its_own_samples() {
        let scene = Scene::default();
        let cells = Cell::WHOLE.children().into_iter().flat_map(|cell| cell.children());
        let cells: Vec<Cell> = cells.collect();
        for backwards in [false, true] {
            let mut engine =
                MockEngine { backwards, job_size: 3 * PATCH_SAMPLES, ..Default::default() };
            let mut work = PatchWork::new(&scene, CONFIG, cells.iter().copied());
            let mut seen = Vec::new();
            while !work.is_done() {
                for (cell, samples) in work.work(&mut engine, Instant::now()).unwrap() {
                    let grid = cell.grid(&scene, PATCH_SIDE);
                    for place in 0..PATCH_SAMPLES as u32 {
                        let expected = match grid.fate(place % PATCH_SIDE, place / PATCH_SIDE) {
                            Fate::Open(angle) => {
                                MockEngine::answer(&EventSpec::from(&scene), angle)
                            }
                            Fate::Known(outcome) => outcome,
                            Fate::Thrown(_) | Fate::BesideTop(_) => unreachable!("at rest"),
                        };
                        assert_eq!(samples.get(place as usize), expected);
                    }
                    seen.push(cell);
                }
            }
            seen.sort();
            let mut all = cells.clone();
            all.sort();
            assert_eq!(seen, all);
            assert_eq!(work.counts().pixels as usize, cells.len() * PATCH_SAMPLES);
        }
    }
}
