//! The gradual appearance of new tiles over what was drawn in their place before.

use std::collections::{HashMap, HashSet};

use flipmap_scene::lattice::Cell;

/// Time that a tile takes to appear, in s.
const FADE_SECS: f64 = 0.15;

/// The tiles of the last frame, and the times at which they began to appear.
#[derive(Debug, Default)]
pub struct Fading {
    /// Time of the current frame on the window's clock, in s; none if nothing fades.
    now_secs: Option<f64>,
    last: DrawnCells,
    drawn: DrawnCells,
    running: bool,
}

/// The cells drawn in a frame.
#[derive(Debug, Default)]
struct DrawnCells {
    /// Times in s at which cells drawn with their own samples began to appear.
    own: HashMap<Cell, f64>,
    /// Cells for which coarser samples stood in.
    stood_in: HashSet<Cell>,
}

impl Fading {
    /// Begins a frame at a moment of the window's clock; without one, nothing fades.
    pub fn begin(&mut self, now_secs: Option<f64>) {
        self.now_secs = now_secs;
        self.last = std::mem::take(&mut self.drawn);
        self.running = false;
    }

    /// Returns true if a tile of the frame has not yet fully appeared.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Notes that other samples stand in for a cell.
    pub(super) fn stand_in(&mut self, cell: Cell) {
        self.drawn.stood_in.insert(cell);
    }

    /// Returns the opacity of a cell's own samples over those that stood in for them, from 0 to 1.
    /// Cells that come into view from the side appear at once.
    pub(super) fn cover(&mut self, cell: Cell) -> f32 {
        let Some(now_secs) = self.now_secs else { return 1.0 };
        let begins = if self.last.stood_in.contains(&cell) { now_secs } else { f64::NEG_INFINITY };
        let since_secs = self.last.own.get(&cell).copied().unwrap_or(begins);
        self.drawn.own.insert(cell, since_secs);
        let share = ((now_secs - since_secs) / FADE_SECS).clamp(0.0, 1.0);
        self.running |= share < 1.0;
        share as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_replaces_something_fades_in_once() {
        let [a, b, ..] = Cell::WHOLE.children();
        let mut fading = Fading::default();
        fading.begin(Some(1.0));
        fading.stand_in(a);
        assert_eq!(fading.cover(b), 1.0, "nothing was there before");
        for (now_secs, expected) in [(2.0, 0.0), (2.075, 0.5), (2.2, 1.0), (9.0, 1.0)] {
            fading.begin(Some(now_secs));
            let cover = fading.cover(a);
            assert!((cover - expected).abs() < 1e-5, "{now_secs}: {cover}");
            assert_eq!((fading.cover(b), fading.is_running()), (1.0, expected < 1.0));
        }
        fading.begin(None);
        fading.stand_in(a);
        fading.begin(None);
        assert!(fading.cover(a) == 1.0 && !fading.is_running(), "no clock");
    }
}
