//! Rows of samples under light from the side: each waits for the one below it.

use crate::scene::palette::{Relief, Tint, channel_of, light_of};

/// Lights the rows of a picture from the top.
pub(super) struct LitRows {
    relief: Relief,
    /// Samples in a row.
    across: usize,
    rows_left: u32,
    /// Heights of the row above those that wait; none above the first row.
    above: Vec<f32>,
    /// Colours and heights of the rows that wait.
    tints: Vec<Tint>,
    heights: Vec<f32>,
}

impl LitRows {
    /// The rows of a picture of `size` samples.
    pub(super) fn new(relief: Relief, size: [u32; 2]) -> Self {
        let (across, rows_left) = (size[0] as usize, size[1]);
        let (above, tints, heights) = (Vec::new(), Vec::new(), Vec::new());
        LitRows { relief, across, rows_left, above, tints, heights }
    }

    /// Takes the next samples and returns those that can be lit now. Heights that are no numbers are
    /// not lit, nor are their neighbours.
    pub(super) fn light(
        &mut self,
        tints: impl Iterator<Item = Tint>,
        heights: impl Iterator<Item = f32>,
    ) -> Vec<Tint> {
        self.tints.extend(tints);
        self.heights.extend(heights);
        let rows = self.heights.len() / self.across;
        // The last row of the picture has none below it to wait for.
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

    /// Lights a row of those that wait.
    fn row(&self, row: usize) -> Vec<Tint> {
        let rows = |row: usize| self.heights.get(row * self.across..(row + 1) * self.across);
        let here = rows(row).unwrap_or_default();
        let above = if row > 0 { rows(row - 1) } else { Some(&*self.above) };
        let above = above.filter(|above| !above.is_empty()).unwrap_or(here);
        let below = rows(row + 1).unwrap_or(here);
        let lit = |column: usize| {
            let [left, right] = [column.saturating_sub(1), (column + 1).min(self.across - 1)];
            let beside = [here[left], here[right], below[column], above[column]];
            let most = most_apart(here[column], beside);
            let rise = [
                (here[right] - here[left]) / ((right - left).max(1)) as f32,
                (above[column] - below[column]) / self.rows_between(row) as f32,
            ];
            let factor = self.relief.factor(rise, most, self.across as f32);
            brighter(self.tints[row * self.across + column], factor)
        };
        (0..self.across).map(lit).collect()
    }

    /// Number of rows from the one below a row that waits to the one above it.
    fn rows_between(&self, row: usize) -> u32 {
        let above = u32::from(row > 0 || !self.above.is_empty());
        let below = u32::from(row as u32 + 1 < self.rows_left);
        (above + below).max(1)
    }
}

/// The largest difference of heights; NaN if one of them is.
fn most_apart(here: f32, beside: [f32; 4]) -> f32 {
    let apart = beside.map(|other| (other - here).abs());
    if apart.iter().any(|apart| apart.is_nan()) {
        return f32::NAN;
    }
    apart.into_iter().fold(0.0, f32::max)
}

/// A colour with this factor of its light, as far as there is a brighter one.
fn brighter(tint: Tint, factor: f32) -> Tint {
    if factor == 1.0 {
        return tint;
    }
    tint.map(|channel| channel_of(light_of(channel) * f64::from(factor)))
}
