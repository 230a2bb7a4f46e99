//! The samples of a cell that a pass computes: one in each square of places, on a grid that the
//! next pass completes, so no sample is computed twice.
//!
//! ```text
//!   . . . . . . . .      . . . . . . . .      x . x . x . x .
//!   . . . . . . . .      . . . . . . . .      . . . . . . . .
//!   . . x . . . . .      . . x . . . x .      x . x . x . x .
//!   . . . . . . . .      . . . . . . . .      . . . . . . . .
//!   . . . . . . . .  ─►  . . . . . . . .  ─►  x . x . x . x .   ─►  all
//!   . . . . . . . .      . . . . . . . .      . . . . . . . .
//!   . . . . . . . .      . . x . . . x .      x . x . x . x .
//!   . . . . . . . .      . . . . . . . .      . . . . . . . .
//!      stride 8             stride 4             stride 2
//! ```

/// Distance between the samples of a pass, in places of the cell: a power of two, at most 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Stride(u32);

/// Column and row of the first sample, if they are below the stride: near the middle of the first
/// square of places, and on the grids of all finer strides.
const FIRST: u32 = 2;

impl Stride {
    /// All samples.
    pub const ONE: Stride = Stride(1);
    /// A quarter of all samples.
    pub(crate) const TWO: Stride = Stride(2);
    /// The strides of the passes over a cell, each with four times the samples of the one before.
    pub(crate) const PASSES: [Stride; 4] = [Stride(8), Stride(4), Stride(2), Stride(1)];

    /// Number of places from one sample to the next.
    pub fn places(self) -> u32 {
        self.0
    }

    /// Column and row of the first sample.
    pub fn first(self) -> u32 {
        FIRST % self.0
    }

    /// Number of samples along a side of a cell with `side` places.
    pub fn side(self, side: u32) -> u32 {
        side / self.0
    }

    /// Number of samples in a cell with `side` places along a side.
    pub(crate) fn count(self, side: u32) -> u32 {
        self.side(side) * self.side(side)
    }

    /// Returns the column and row, among all places, of the sample with this index.
    pub(crate) fn place(self, index: u32, side: u32) -> [u32; 2] {
        [index % self.side(side), index / self.side(side)].map(|k| self.first() + k * self.0)
    }

    /// Returns the index of the sample at a column and row; `None` if there is no sample.
    pub fn index(self, place: [u32; 2], side: u32) -> Option<u32> {
        let index = self.nearest(place, side);
        (self.place(index, side) == place).then_some(index)
    }

    /// Returns the index of the sample in whose square of places a column and row lie.
    pub fn nearest(self, place: [u32; 2], side: u32) -> u32 {
        let [column, row] = place.map(|k| k / self.0);
        row * self.side(side) + column
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::lattice::SIDE;

    #[test]
    fn every_pass_has_the_samples_of_the_one_before() {
        for pair in Stride::PASSES.windows(2) {
            let [coarse, fine] = [pair[0], pair[1]];
            assert_eq!(4 * coarse.count(SIDE), fine.count(SIDE));
            for index in 0..coarse.count(SIDE) {
                let place = coarse.place(index, SIDE);
                assert_eq!(coarse.index(place, SIDE), Some(index));
                assert_eq!(
                    fine.index(place, SIDE).map(|index| fine.place(index, SIDE)),
                    Some(place)
                );
            }
        }
        assert_eq!(Stride::ONE.count(SIDE), SIDE * SIDE);
    }

    #[test]
    fn a_place_without_a_sample_has_a_near_one() {
        let [coarse, ..] = Stride::PASSES;
        assert_eq!(coarse.index([9, 2], SIDE), None);
        for place in [[9, 2], [15, 7], [8, 0]] {
            assert_eq!(coarse.place(coarse.nearest(place, SIDE), SIDE), [10, 2], "{place:?}");
        }
    }
}
