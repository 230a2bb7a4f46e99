//! Tiles that finish in any order, passed on as rows from the top.

use std::collections::BTreeMap;

use crate::tiles::{FinishedTile, Samples};

/// Holds whole-width bands back until it is their turn.
#[derive(Debug, Default)]
pub struct RowOrder {
    next_row: u32,
    waiting: BTreeMap<u32, FinishedTile>,
}

impl RowOrder {
    /// Expects bands from this row on.
    pub(crate) fn from(next_row: u32) -> Self {
        RowOrder { next_row, waiting: BTreeMap::new() }
    }

    /// Takes a band and returns those that can be written now, top first.
    pub fn push(&mut self, band: FinishedTile) -> Vec<Samples> {
        self.waiting.insert(band.tile.origin[1], band);
        let mut ready = Vec::new();
        while let Some(band) = self.waiting.remove(&self.next_row) {
            self.next_row += band.tile.size[1];
            ready.push(band.samples);
        }
        ready
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::plan;

    #[test]
    fn bands_come_out_from_the_top() {
        let mut bands = plan(4, 0..9, 12);
        bands.reverse();
        let mut order = RowOrder::default();
        let heights: Vec<usize> = bands
            .into_iter()
            .map(|tile| {
                let samples = Samples::unflipped((tile.size[0] * tile.size[1]) as usize);
                order.push(FinishedTile { tile, samples }).len()
            })
            .collect();
        assert_eq!(heights, [0, 0, 3]);
    }
}
