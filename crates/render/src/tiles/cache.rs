//! The cache of computed cells, which keeps them as long as their bytes fit.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, OnceLock};

use super::open_tile::Known;
use super::refinement::{self, Quarters};
use super::samples::Samples;
use super::saved_pixels::SavedPixel;
use super::stride::Stride;
use flipmap_engine::IntegratorState;
use flipmap_pendulum::Status;
use flipmap_scene::lattice::{Cell, SAMPLES, SIDE};

/// A computed cell.
#[derive(Clone, Debug)]
pub struct CachedCell {
    /// Samples of the cell at its stride, row by row from the top.
    pub samples: Arc<Samples>,
    /// Stride of the samples; stride 1 has all samples of the cell.
    pub stride: Stride,
    /// Simulated seconds that the unflipped samples have had.
    pub budget_secs: f64,
    /// Serial number, which changes whenever the samples do and is never used twice.
    pub serial: u64,
    /// Quarters that have edges, determined when they are first needed.
    edges: OnceLock<Quarters>,
    /// States of unflipped samples with their indices, in ascending order of index.
    pub(super) unfinished: Vec<(u32, IntegratorState)>,
    used: u64,
}

/// The samples that a cell may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SampleSet {
    /// Key of the physics.
    pub physics: usize,
    /// True if samples of times were computed only at edges, and interpolated elsewhere.
    pub refined: bool,
}

/// A set of samples, and a canonical cell.
type CacheKey = (SampleSet, Cell);

/// Samples of a cell that were computed in a pass.
#[derive(Clone, Debug)]
pub(crate) struct CellSamples {
    /// Samples at the stride, row by row from the top.
    pub samples: Samples,
    /// Stride of the samples.
    pub stride: Stride,
    /// Simulated seconds that the unflipped samples have had.
    pub budget_secs: f64,
    /// States of unflipped samples with their indices, in ascending order of index.
    pub unfinished: Vec<(u32, IntegratorState)>,
}

/// Computed cells by physics, within a budget of bytes.
#[derive(Debug)]
pub(crate) struct Cache {
    budget_bytes: usize,
    bytes: usize,
    known: HashMap<CacheKey, CachedCell>,
    /// Cells that must not be removed.
    wanted: HashSet<CacheKey>,
    /// Number of uses so far, so that the least recently used cells go first.
    clock: u64,
    serial: u64,
}

/// Size in bytes of a cell of flip times without unfinished pendulums.
pub const TILE_BYTES: usize = SAMPLES * Samples::bytes(1);

impl CachedCell {
    /// Returns true for the quarters that have edges, which finer samples would show.
    pub(super) fn edges(&self) -> Quarters {
        *self.edges.get_or_init(|| refinement::edges(&self.samples))
    }

    /// Returns the share of the cell's samples that are known to a budget, 0 to 1.
    pub(super) fn share(&self, budget_secs: f64) -> f64 {
        if self.budget_secs < budget_secs {
            return 0.0;
        }
        f64::from(self.stride.count(SIDE)) / SAMPLES as f64
    }

    /// Returns true if all samples are known to a budget.
    pub(crate) fn is_complete(&self, budget_secs: f64) -> bool {
        self.stride == Stride::ONE && self.budget_secs >= budget_secs
    }

    /// Returns the sample at a column and row as a pass to `budget_secs` needs it, or `None` if its
    /// pendulum has to start again.
    pub(super) fn known(&self, place: [u32; 2], budget_secs: f64) -> Option<Known> {
        let index = self.stride.index(place, SIDE)?;
        let outcome = self.samples.get(index as usize);
        let assurance = self.samples.assurance(index as usize);
        if outcome.status != Status::Unflipped || self.budget_secs >= budget_secs {
            return Some((SavedPixel::Over(outcome), assurance));
        }
        let state = self.unfinished.binary_search_by_key(&index, |(index, _)| *index).ok()?;
        Some((SavedPixel::Unfinished(self.unfinished[state].1.clone()), assurance))
    }

    fn bytes(&self) -> usize {
        let samples = self.samples.len() * Samples::bytes(self.samples.channels());
        samples + self.unfinished.capacity() * size_of::<(u32, IntegratorState)>()
    }
}

impl Cache {
    /// Creates an empty cache.
    pub(crate) fn new(budget_bytes: usize) -> Self {
        Cache {
            budget_bytes,
            bytes: 0,
            known: HashMap::new(),
            wanted: HashSet::new(),
            clock: 0,
            serial: 0,
        }
    }

    /// Number of bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }

    /// Number of cells with this many channels and without unfinished pendulums that fit at the
    /// same time.
    pub(crate) fn room(&self, channels: usize) -> usize {
        self.budget_bytes / (SAMPLES * Samples::bytes(channels))
    }

    /// Changes the budget. The cache may exceed a smaller one until fewer cells are wanted.
    pub(crate) fn set_budget(&mut self, budget_bytes: usize) {
        self.budget_bytes = budget_bytes;
        self.shrink();
    }

    /// Returns a cell, if it is known, and counts it as used.
    pub(crate) fn get(&mut self, set: SampleSet, cell: Cell) -> Option<&CachedCell> {
        self.clock += 1;
        let known = self.known.get_mut(&(set, cell))?;
        known.used = self.clock;
        Some(known)
    }

    /// Returns a cell, if it is known, without counting it as used.
    pub(crate) fn peek(&self, set: SampleSet, cell: Cell) -> Option<&CachedCell> {
        self.known.get(&(set, cell))
    }

    /// Replaces the wanted cells, which are not removed and count as used; all others may be
    /// removed. There must be at most [`Cache::room`] wanted cells.
    pub(crate) fn want(&mut self, cells: impl Iterator<Item = (SampleSet, Cell)>) {
        self.wanted = cells.collect();
        self.clock += 1;
        for key in &self.wanted {
            if let Some(known) = self.known.get_mut(key) {
                known.used = self.clock;
            }
        }
        self.shrink();
    }

    /// Stores a cell's samples in place of earlier ones.
    pub(crate) fn insert(
        &mut self,
        set: SampleSet,
        cell: Cell,
        CellSamples { samples, stride, budget_secs, mut unfinished }: CellSamples,
    ) {
        unfinished.shrink_to_fit();
        self.clock += 1;
        self.serial += 1;
        let (samples, edges) = (Arc::new(samples), OnceLock::new());
        let (serial, used) = (self.serial, self.clock);
        let known = CachedCell { samples, stride, budget_secs, serial, edges, unfinished, used };
        self.bytes += known.bytes();
        if let Some(old) = self.known.insert((set, cell), known) {
            self.bytes -= old.bytes();
        }
        self.shrink();
    }

    /// Frees bytes until the rest fits: first the states of unfinished pendulums in cells that are
    /// not wanted, which then start again if the budget grows; then those cells; last the states in
    /// wanted cells. The least recently used always go first.
    fn shrink(&mut self) {
        if self.bytes <= self.budget_bytes {
            return;
        }
        let mut by_age: Vec<(u64, CacheKey)> =
            self.known.iter().map(|(key, k)| (k.used, *key)).collect();
        by_age.sort_unstable_by_key(|(used, _)| *used);
        let (wanted, others): (Vec<CacheKey>, Vec<CacheKey>) =
            by_age.into_iter().map(|(_, key)| key).partition(|key| self.wanted.contains(key));
        // Free a little more than needed, so that this is not done for every cell.
        let enough = self.budget_bytes - self.budget_bytes / 16;
        self.drop_while_above(enough, &others, Self::drop_states);
        self.drop_while_above(enough, &others, Self::remove);
        self.drop_while_above(enough, &wanted, Self::drop_states);
    }

    fn drop_while_above(
        &mut self,
        enough: usize,
        keys: &[CacheKey],
        drop: fn(&mut Self, &CacheKey),
    ) {
        for key in keys {
            if self.bytes <= enough {
                return;
            }
            drop(self, key);
        }
    }

    fn drop_states(&mut self, key: &CacheKey) {
        if let Some(known) = self.known.get_mut(key) {
            self.bytes -= known.bytes();
            known.unfinished = Vec::new();
            self.bytes += known.bytes();
        }
    }

    fn remove(&mut self, key: &CacheKey) {
        if let Some(gone) = self.known.remove(key) {
            self.bytes -= gone.bytes();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::NUMBERS;

    use flipmap_scene::Turn;

    const SET: SampleSet = SampleSet { physics: 0, refined: false };

    fn cell(x: u32) -> Cell {
        Cell { level: 10, x: Turn::from_f64(x as f64 / 1024.0), y: Turn::ZERO }
    }

    fn fill(cache: &mut Cache, x: u32, unfinished: usize) {
        let state = IntegratorState::new(0, [0.0; NUMBERS]);
        let unfinished = (0..unfinished as u32).map(|index| (index, state.clone())).collect();
        let (samples, stride) = (Samples::unflipped(SAMPLES), Stride::ONE);
        let known = CellSamples { samples, stride, budget_secs: 30.0, unfinished };
        cache.insert(SET, cell(x), known);
    }

    fn want(cache: &mut Cache, cells: std::ops::Range<u32>) {
        cache.want(cells.map(|x| (SET, cell(x))));
    }

    fn unfinished(cache: &Cache, x: u32) -> usize {
        cache.peek(SET, cell(x)).unwrap().unfinished.len()
    }

    #[test]
    fn the_longest_unused_go_first() {
        let mut cache = Cache::new(8 * TILE_BYTES);
        (0..8).for_each(|x| fill(&mut cache, x, 0));
        cache.get(SET, cell(0));
        fill(&mut cache, 8, 0);
        assert!(cache.peek(SET, cell(1)).is_none() && cache.peek(SET, cell(0)).is_some());
        assert!(cache.bytes() <= 8 * TILE_BYTES);
    }

    #[test]
    fn what_is_wanted_stays_without_its_states() {
        let mut cache = Cache::new(4 * TILE_BYTES);
        want(&mut cache, 0..4);
        (0..4).for_each(|x| fill(&mut cache, x, 1000));
        assert!((0..4).all(|x| cache.peek(SET, cell(x)).is_some()));
        assert!(cache.bytes() <= 4 * TILE_BYTES);
        assert_eq!(unfinished(&cache, 0), 0);
        fill(&mut cache, 9, 0);
        assert!(cache.peek(SET, cell(9)).is_none(), "there is no room for what nobody wants");
        assert!((0..4).all(|x| cache.peek(SET, cell(x)).is_some()));
    }

    #[test]
    fn states_nobody_wants_go_before_any_tile() {
        let mut cache = Cache::new(46 * TILE_BYTES / 10);
        (0..2).for_each(|x| fill(&mut cache, x, 75));
        want(&mut cache, 1..2);
        fill(&mut cache, 2, 75);
        fill(&mut cache, 3, 0);
        assert!((0..4).all(|x| cache.peek(SET, cell(x)).is_some()));
        assert_eq!(
            (unfinished(&cache, 0), unfinished(&cache, 1), unfinished(&cache, 2)),
            (0, 75, 0)
        );
    }

    #[test]
    fn replacing_a_tile_counts_its_bytes_once() {
        let mut cache = Cache::new(100 * TILE_BYTES);
        fill(&mut cache, 1, 0);
        let first = cache.peek(SET, cell(1)).unwrap().serial;
        fill(&mut cache, 1, 0);
        assert_eq!(cache.bytes(), TILE_BYTES);
        assert!(cache.peek(SET, cell(1)).unwrap().serial > first);
        cache.set_budget(TILE_BYTES / 2);
        assert_eq!((cache.bytes(), cache.room(1)), (0, 0));
    }
}
