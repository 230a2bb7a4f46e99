//! The loop from a film's patches to their samples.

use std::collections::VecDeque;
use std::time::Instant;

use super::in_flight::{InFlightJobs, OpenTile};
use super::patches::{SAMPLES, SIDE, pitch_rad};
use super::samples::{Counts, Samples};
use crate::engine::{Engine, EngineError, IntegratorConfig, Keep, Question, Trust, Wait};
use crate::scene::lattice::Cell;
use crate::scene::{Grid, Grouped, Scene};

/// Patches in a job at most.
const MOST_IN_JOB: usize = 256;

/// Patches of one pendulum being computed.
pub struct PatchWork {
    scene: Scene,
    question: Question,
    config: IntegratorConfig,
    waiting: VecDeque<Cell>,
    in_flight: InFlightJobs<Vec<Cell>>,
    counts: Counts,
}

impl PatchWork {
    /// Of a checked scene, whose view does not matter.
    pub fn new(scene: &Scene, config: IntegratorConfig, cells: impl Iterator<Item = Cell>) -> Self {
        PatchWork {
            scene: scene.clone(),
            question: Question::from(scene),
            config,
            waiting: cells.collect(),
            in_flight: InFlightJobs::default(),
            counts: Counts::default(),
        }
    }

    /// Moves the work on until patches have finished or `deadline` has come, and returns them.
    pub fn work(
        &mut self,
        engine: &mut dyn Engine,
        deadline: Instant,
    ) -> Result<Vec<(Cell, Samples)>, EngineError> {
        let mut finished = Vec::new();
        while finished.is_empty() && !self.is_done() {
            self.submit(engine, &mut finished)?;
            for batch in self.in_flight.poll(engine, Wait::Until(deadline))? {
                self.counts.simulated += batch.computed.len() as u64;
                self.counts.effort += batch.effort;
                self.finish(batch.tile, &batch.samples, &mut finished);
            }
            if Instant::now() >= deadline {
                break;
            }
        }
        Ok(finished)
    }

    /// Whether every patch has been handed back.
    pub fn is_done(&self) -> bool {
        self.waiting.is_empty() && self.in_flight.is_empty()
    }

    /// What has been done so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Fills the engine's slots; patches without open samples are finished at once.
    fn submit(
        &mut self,
        engine: &mut dyn Engine,
        finished: &mut Vec<(Cell, Samples)>,
    ) -> Result<(), EngineError> {
        let most = (engine.job_size() / SAMPLES).clamp(1, MOST_IN_JOB);
        while self.in_flight.len() < engine.slots() {
            let cells = self.next_cells(most);
            let Some(first) = cells.first() else { return Ok(()) };
            let open = if self.is_deep_at(first.level) {
                deep(&self.scene, &cells)
            } else {
                self.open(&cells)
            };
            if open.is_settled() {
                self.finish(cells, &open.into_samples(), finished);
                return Ok(());
            }
            self.in_flight.submit(
                engine,
                cells,
                open,
                (self.question, self.config),
                Keep::Nothing,
            )?;
        }
        Ok(())
    }

    /// The next patches that can share a job: of one level.
    fn next_cells(&mut self, most: usize) -> Vec<Cell> {
        let level = self.waiting.front().map(|cell| cell.level);
        let alike = self.waiting.iter().take(most).take_while(|cell| Some(cell.level) == level);
        let count = alike.count();
        self.waiting.drain(..count).collect()
    }

    /// Whether a level's samples lie closer than the recipe's number type can tell apart.
    fn is_deep_at(&self, level: u32) -> bool {
        2.0 * pitch_rad(level) < self.config.deep_below()
    }

    fn open(&self, cells: &[Cell]) -> OpenTile {
        OpenTile::new(cells.iter().flat_map(|cell| {
            let grid = cell.grid(&self.scene, SIDE);
            (0..SIDE * SIDE).map(move |place| (grid.fate(place % SIDE, place / SIDE), None))
        }))
    }

    fn finish(&mut self, cells: Vec<Cell>, samples: &Samples, finished: &mut Vec<(Cell, Samples)>) {
        self.counts.add(samples);
        for (k, cell) in cells.into_iter().enumerate() {
            finished.push((cell, samples.part(k * SAMPLES..(k + 1) * SAMPLES)));
        }
    }
}

/// Patches whose samples no number type of an engine's tells apart.
fn deep(scene: &Scene, cells: &[Cell]) -> OpenTile {
    let grids: Vec<Grid> = cells.iter().map(|cell| cell.grid(scene, SIDE)).collect();
    let mut groups = Grouped::new();
    for (k, cell) in (0..).zip(cells) {
        let moved = |(place, point)| (k * SAMPLES as u32 + place, point);
        let leaves = cell.leaves(SIDE).into_iter();
        groups.extend(
            leaves.map(|(leaf, points)| (leaf, points.into_iter().map(moved).collect::<Vec<_>>())),
        );
    }
    OpenTile::deep(cells.len() * SAMPLES, groups, |place| {
        let (grid, place) = (&grids[place as usize / SAMPLES], place % SAMPLES as u32);
        grid.opening(place % SIDE, place / SIDE).map(|outcome| (outcome, Trust::Agreed))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::mock::MockEngine;
    use crate::engine::{Method, Precision};
    use crate::scene::Fate;

    const RECIPE: IntegratorConfig =
        IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };

    #[test]
    fn every_patch_comes_back_once_with_its_own_samples() {
        let scene = Scene::default();
        let cells = Cell::WHOLE.children().into_iter().flat_map(|cell| cell.children());
        let cells: Vec<Cell> = cells.collect();
        for backwards in [false, true] {
            let mut engine = MockEngine { backwards, job_size: 3 * SAMPLES, ..Default::default() };
            let mut work = PatchWork::new(&scene, RECIPE, cells.iter().copied());
            let mut seen = Vec::new();
            while !work.is_done() {
                for (cell, samples) in work.work(&mut engine, Instant::now()).unwrap() {
                    let grid = cell.grid(&scene, SIDE);
                    for place in 0..SAMPLES as u32 {
                        let expected = match grid.fate(place % SIDE, place / SIDE) {
                            Fate::Open(angle) => MockEngine::answer(&Question::from(&scene), angle),
                            Fate::Known(outcome) => outcome,
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
            assert_eq!(work.counts().pixels as usize, cells.len() * SAMPLES);
        }
    }
}
