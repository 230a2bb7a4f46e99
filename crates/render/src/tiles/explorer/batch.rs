//! Adds the samples of a job's cells to those of earlier passes.

use super::{Cell, Explorer, FinishedBatch, SampleSet, Stride};
use crate::tiles::cache::{CachedCell, CellSamples};
use crate::tiles::samples::Samples;
use flipmap_pendulum::Status;
use flipmap_scene::lattice::SIDE;

/// Cells of one job in flight, with their sample set, budget and stride.
#[derive(Debug)]
pub(in crate::tiles) struct Batch {
    pub set: SampleSet,
    pub budget_secs: f64,
    pub stride: Stride,
    pub cells: Vec<BatchCell>,
}

/// A cell of a job, and the samples of an earlier pass that are not computed again.
#[derive(Clone, Copy, Debug)]
pub(in crate::tiles) struct BatchCell {
    pub cell: Cell,
    /// Serial number of the samples of an earlier pass to the same budget.
    pub before: Option<u64>,
}

impl Batch {
    pub(super) fn keys(&self) -> impl Iterator<Item = (SampleSet, Cell)> {
        self.cells.iter().map(|batched| (self.set, batched.cell))
    }
}

impl BatchCell {
    /// Creates a cell for a pass at a stride, given what is known of the cell.
    pub(super) fn new(cell: Cell, known: Option<&CachedCell>, stride: Stride) -> Self {
        let earlier = known.filter(|known| known.stride > stride);
        BatchCell { cell, before: earlier.map(|known| known.serial) }
    }
}

impl Explorer {
    /// Stores a batch's samples in the cache, cell by cell, and counts those of complete cells.
    /// Returns false if the samples of an earlier pass are no longer known, so that a cell has to
    /// be computed again.
    pub(super) fn keep(&mut self, finished: FinishedBatch<Batch>) -> bool {
        let FinishedBatch { tile: batch, samples, unfinished, .. } = finished;
        if batch.stride == Stride::ONE {
            self.counts.add(&samples);
        }
        let count = batch.stride.count(SIDE) as usize;
        let mut all_kept = true;
        for (k, &BatchCell { cell, before }) in batch.cells.iter().enumerate() {
            let places = k * count..(k + 1) * count;
            let first = places.start as u32;
            let unfinished = unfinished
                .iter()
                .filter(|(place, _)| places.contains(&(*place as usize)))
                .map(|(place, state)| (place - first, state.clone()))
                .collect();
            let (stride, budget_secs) = (batch.stride, batch.budget_secs);
            let samples = samples.part(places.clone());
            let mut cell_samples = CellSamples { samples, stride, budget_secs, unfinished };
            if let Some(serial) = before {
                let known = self.cache.peek(batch.set, cell);
                let Some(known) = known.filter(|known| known.serial == serial) else {
                    all_kept = false;
                    continue;
                };
                add_earlier(&mut cell_samples, known);
            }
            self.cache.insert(batch.set, cell, cell_samples);
        }
        all_kept
    }
}

/// Adds the samples and the states of an earlier pass. If its states were dropped, drops the cell's
/// own too: either all unflipped samples of a cell can be continued, or none.
fn add_earlier(cell: &mut CellSamples, earlier: &CachedCell) {
    let CellSamples { samples, stride, unfinished, .. } = cell;
    let known: &Samples = &earlier.samples;
    let moved = |index: u32| stride.index(earlier.stride.place(index, SIDE), SIDE);
    let mut is_unflipped = false;
    for from in 0..known.len() {
        let status = known.get(from).status;
        is_unflipped |= status == Status::Unflipped;
        let Some(to) = moved(from as u32) else { continue };
        samples.set_values(to as usize, status, known.values(from));
        samples.assure(to as usize, known.assurance(from));
    }
    if is_unflipped && earlier.unfinished.is_empty() {
        unfinished.clear();
        return;
    }
    let states = earlier.unfinished.iter();
    unfinished.extend(states.filter_map(|(index, state)| Some((moved(*index)?, state.clone()))));
    unfinished.sort_unstable_by_key(|(index, _)| *index);
}
