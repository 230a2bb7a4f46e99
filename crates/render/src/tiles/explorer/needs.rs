//! Decides if a cell has to be computed.

use super::{Cell, Explorer, Stride, Wanted};
use crate::tiles::order::CellPass;
use crate::tiles::refinement::quarter_of;

/// Number of levels up to the coarsest ancestor of a cell that is as fine as the cell's first pass.
const MAX_LEVELS: u32 = 3;

impl Explorer {
    /// Returns true if a cell has to be computed: to complete it, to show it before it is complete,
    /// to show it when the view moves, or because its parent has edges there.
    pub(super) fn needs(&self, Wanted { cell, pass }: Wanted, budget_secs: f64) -> bool {
        let known = self.peek(cell);
        let stride = known.map(|known| known.stride);
        let is_due = known.is_some_and(|known| known.budget_secs < budget_secs);
        match pass {
            CellPass::Own(own) if stride == Some(own) => is_due,
            CellPass::Own(Stride::ONE) => stride.is_none_or(|stride| stride > Stride::ONE),
            CellPass::Own(own) => {
                let finer = stride.is_none_or(|stride| stride > own);
                finer && self.stand_in_places(cell).is_none_or(|places| places > own.places())
            }
            CellPass::Around => {
                let all_quarters =
                    cell.children().into_iter().all(|cell| self.peek(cell).is_some());
                known.is_none() && !all_quarters
            }
            CellPass::Finer => self.peek_finer(cell).is_none() && self.has_edges(cell),
        }
    }

    /// Returns the distance, in places of a cell, between samples of other levels that stand in for
    /// it; `None` if there are none.
    fn stand_in_places(&self, cell: Cell) -> Option<u32> {
        let places = |cell: Cell| Some(self.peek(cell)?.stride.places());
        let quarters: Option<Vec<u32>> = cell.children().into_iter().map(places).collect();
        let quarters = quarters.and_then(|places| Some((places.into_iter().max()? / 2).max(1)));
        let ancestors = std::iter::successors(cell.parent(), Cell::parent);
        let coarser = (1..=MAX_LEVELS).zip(ancestors);
        let coarser = coarser.filter_map(|(level, cell)| Some(places(cell)? << level));
        coarser.chain(quarters).min()
    }

    /// Returns true if the parent of a cell has edges where the cell lies.
    fn has_edges(&self, cell: Cell) -> bool {
        let Some(parent) = cell.parent() else { return false };
        let (_, mirrored) = parent.computed(self.mirrors(self.key));
        let quarter = quarter_of(&cell, &parent, mirrored);
        self.peek_finer(parent).is_some_and(|parent| parent.edges()[quarter])
    }
}
