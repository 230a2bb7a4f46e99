//! Light from the side on a frame, computed from the slopes between its pixels' heights.

use rayon::prelude::*;

use flipmap_scene::palette::Relief;

/// Heights of a frame's pixels under light from the side.
pub(super) struct LitFrame {
    relief: Relief,
    across: usize,
    /// Rows from the top; NaN where a pixel has no height.
    heights: Vec<f32>,
}

impl LitFrame {
    /// Evaluates `height` at the column and row of each pixel of a frame of `size` pixels.
    pub(super) fn new(
        relief: Relief,
        size: [u32; 2],
        height: impl Fn([usize; 2]) -> Option<f32> + Sync,
    ) -> Self {
        let [across, rows] = size.map(|side| side as usize);
        let places = (0..across * rows).into_par_iter();
        let height = |place| height([place % across, place / across]).unwrap_or(f32::NAN);
        LitFrame { relief, across, heights: places.map(height).collect() }
    }

    /// Returns the factor by which a pixel's light is multiplied.
    pub(super) fn factor(&self, [column, row]: [usize; 2]) -> f32 {
        let row_of = |row: usize| self.heights.get(row * self.across..(row + 1) * self.across);
        let here = row_of(row).unwrap_or_default();
        let above = row.checked_sub(1).and_then(row_of);
        self.relief.factor_beside([above, Some(here), row_of(row + 1)], column)
    }
}
