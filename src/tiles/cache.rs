//! Tiles that were computed, kept as long as their bytes fit.

use std::collections::HashMap;
use std::sync::Arc;

use super::lattice::{Cell, SAMPLES};
use super::samples::Samples;
use crate::engine::Paused;

/// What is known of a cell.
#[derive(Clone, Debug)]
pub struct Known {
    /// Its samples, row by row from the top.
    pub samples: Arc<Samples>,
    /// Simulated seconds that the unflipped ones have had.
    pub budget_secs: f64,
    /// Changes whenever the samples do, and is never used twice.
    pub serial: u64,
    /// Where the unflipped ones are, by their places among the samples.
    pub(super) paused: Vec<(u32, Paused)>,
    used: u64,
}

/// Which physics, and which cell of it.
type Key = (usize, Cell);

/// Known cells by physics, within a budget of bytes.
#[derive(Debug)]
pub struct Cache {
    budget_bytes: usize,
    bytes: usize,
    known: HashMap<Key, Known>,
    /// Counts looks, so that what was not looked at for longest goes first.
    clock: u64,
    /// Cells looked at since then are in use.
    in_use_since: u64,
    serial: u64,
}

/// Bytes of a tile without paused pendulums.
pub const TILE_BYTES: usize = SAMPLES * Samples::BYTES;

impl Known {
    fn bytes(&self) -> usize {
        TILE_BYTES + self.paused.capacity() * size_of::<(u32, Paused)>()
    }
}

impl Cache {
    /// An empty one.
    pub fn new(budget_bytes: usize) -> Self {
        Cache {
            budget_bytes,
            bytes: 0,
            known: HashMap::new(),
            clock: 0,
            in_use_since: 0,
            serial: 0,
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// How many whole tiles fit at the same time.
    pub fn room(&self) -> usize {
        self.budget_bytes / TILE_BYTES
    }

    /// Lets go of what does not fit a new budget.
    pub fn set_budget(&mut self, budget_bytes: usize) {
        self.budget_bytes = budget_bytes;
        self.shrink();
    }

    /// What is known of a cell; it counts as used.
    pub fn get(&mut self, physics: usize, cell: Cell) -> Option<&Known> {
        self.clock += 1;
        let known = self.known.get_mut(&(physics, cell))?;
        known.used = self.clock;
        Some(known)
    }

    /// What is known of a cell.
    pub fn peek(&self, physics: usize, cell: Cell) -> Option<&Known> {
        self.known.get(&(physics, cell))
    }

    /// From now on cells that are looked at are in use, and the others may go.
    pub fn begin_use(&mut self) {
        self.in_use_since = self.clock;
    }

    /// Keeps a cell's samples.
    pub fn insert(
        &mut self,
        physics: usize,
        cell: Cell,
        samples: Samples,
        budget_secs: f64,
        mut paused: Vec<(u32, Paused)>,
    ) {
        paused.shrink_to_fit();
        self.clock += 1;
        self.serial += 1;
        let samples = Arc::new(samples);
        let (serial, used) = (self.serial, self.clock);
        let known = Known { samples, budget_secs, serial, paused, used };
        self.bytes += known.bytes();
        if let Some(old) = self.known.insert((physics, cell), known) {
            self.bytes -= old.bytes();
        }
        self.shrink();
    }

    /// Lets the longest unused go; of those in use only the states of their pendulums, which a
    /// larger budget would then begin anew.
    fn shrink(&mut self) {
        if self.bytes <= self.budget_bytes {
            return;
        }
        let mut by_age: Vec<(u64, Key)> =
            self.known.iter().map(|(key, k)| (k.used, *key)).collect();
        by_age.sort_unstable_by_key(|(used, _)| *used);
        // A little more than needed, so that this is not done for every tile.
        let enough = self.budget_bytes - self.budget_bytes / 16;
        for (used, key) in &by_age {
            if self.bytes <= enough {
                return;
            }
            if *used <= self.in_use_since
                && let Some(gone) = self.known.remove(key)
            {
                self.bytes -= gone.bytes();
            }
        }
        for (_, key) in by_age {
            if self.bytes <= enough {
                return;
            }
            if let Some(known) = self.known.get_mut(&key) {
                self.bytes -= known.bytes();
                known.paused = Vec::new();
                self.bytes += known.bytes();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::NUMBERS;

    fn cell(x: u128) -> Cell {
        Cell { level: 10, x, y: 0 }
    }

    fn fill(cache: &mut Cache, x: u128, paused: usize) {
        let state = Paused { steps: 0, numbers: [0.0; NUMBERS] };
        let paused = (0..paused as u32).map(|place| (place, state)).collect();
        cache.insert(0, cell(x), Samples::unflipped(SAMPLES), 30.0, paused);
    }

    #[test]
    fn the_longest_unused_go_first() {
        let mut cache = Cache::new(8 * TILE_BYTES);
        (0..8).for_each(|x| fill(&mut cache, x, 0));
        cache.get(0, cell(0));
        cache.begin_use();
        fill(&mut cache, 8, 0);
        assert!(cache.peek(0, cell(1)).is_none() && cache.peek(0, cell(0)).is_some());
        assert!(cache.bytes() <= 8 * TILE_BYTES);
    }

    #[test]
    fn what_is_in_use_stays_without_its_states() {
        let mut cache = Cache::new(4 * TILE_BYTES);
        cache.begin_use();
        (0..3).for_each(|x| fill(&mut cache, x, 1000));
        assert!((0..3).all(|x| cache.peek(0, cell(x)).is_some()));
        (3..4).for_each(|x| fill(&mut cache, x, 1000));
        assert!((0..4).all(|x| cache.peek(0, cell(x)).is_some()));
        assert!(cache.bytes() <= 4 * TILE_BYTES);
        assert_eq!(cache.peek(0, cell(0)).unwrap().paused.len(), 0);
    }

    #[test]
    fn replacing_a_tile_counts_its_bytes_once() {
        let mut cache = Cache::new(100 * TILE_BYTES);
        fill(&mut cache, 1, 0);
        let first = cache.peek(0, cell(1)).unwrap().serial;
        fill(&mut cache, 1, 0);
        assert_eq!(cache.bytes(), TILE_BYTES);
        assert!(cache.peek(0, cell(1)).unwrap().serial > first);
        cache.set_budget(TILE_BYTES / 2);
        assert_eq!((cache.bytes(), cache.room()), (TILE_BYTES, 0), "in use: nothing began since");
        cache.begin_use();
        cache.set_budget(TILE_BYTES / 2);
        assert_eq!(cache.bytes(), 0);
    }
}
