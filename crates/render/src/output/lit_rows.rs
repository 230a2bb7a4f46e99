//! Rows of samples under light from the side: each waits for the one below it.

use flipmap_scene::palette::{Relief, Tint, channel_of, light_of};

/// Lights the rows of a picture from the top.
pub(super) struct LitRows {
    relief: Relief,
    /// Samples in a row.
    across: usize,
    rows_left: u32,
    /// Heights of the row above those that wait; empty at the first row.
    above: Vec<f32>,
    /// Colours and heights of the rows that wait.
    tints: Vec<Tint>,
    heights: Vec<f32>,
}

impl LitRows {
    /// Creates the rows of a picture of `size` samples.
    pub(super) fn new(relief: Relief, size: [u32; 2]) -> Self {
        let (across, rows_left) = (size[0] as usize, size[1]);
        let (above, tints, heights) = (Vec::new(), Vec::new(), Vec::new());
        LitRows { relief, across, rows_left, above, tints, heights }
    }

    /// Takes the next samples and returns those that can be lit now. A sample whose height is NaN
    /// stays unlit, as do its neighbours.
    pub(super) fn light(
        &mut self,
        tints: impl Iterator<Item = Tint>,
        heights: impl Iterator<Item = f32>,
    ) -> Vec<Tint> {
        self.tints.extend(tints);
        self.heights.extend(heights);
        let rows = self.heights.len() / self.across;
        // The last row of the picture waits for no row below it.
        let rows = if rows == self.rows_left as usize { rows } else { rows.saturating_sub(1) };
        let lit = (0..rows).flat_map(|row| self.row(row)).collect();
        if rows > 0 {
            self.above = self.heights[(rows - 1) * self.across..rows * self.across].to_vec();
            self.tints.drain(..rows * self.across);
            self.heights.drain(..rows * self.across);
            self.rows_left -= rows as u32;
        }
        lit
    }

    /// Lights one of the waiting rows.
    fn row(&self, row: usize) -> Vec<Tint> {
        let row_of = |row: usize| self.heights.get(row * self.across..(row + 1) * self.across);
        let before = Some(&*self.above).filter(|above| !above.is_empty());
        let above = if row > 0 { row_of(row - 1) } else { before };
        let rows = [above, row_of(row), row_of(row + 1)];
        let lit = |column: usize| {
            let factor = self.relief.factor_beside(rows, column);
            brighter(self.tints[row * self.across + column], factor)
        };
        (0..self.across).map(lit).collect()
    }
}

/// Multiplies the light of a colour by a factor, up to the brightest colour.
fn brighter(tint: Tint, factor: f32) -> Tint {
    if factor == 1.0 {
        return tint;
    }
    tint.map(|channel| channel_of(light_of(channel) * f64::from(factor)))
}
