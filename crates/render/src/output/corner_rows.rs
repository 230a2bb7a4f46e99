//! Rows of pixels whose colours are the means of samples in the middle and in the corners.

use std::sync::Arc;

use rayon::prelude::*;

use crate::tiles::PlainPixels;
use flipmap_scene::palette::{Tint, channel_of, light_of};

/// Share of a pixel that lies nearer to its middle than to its corners; the corners share the rest.
const MIDDLE: f64 = 0.5;
/// Share of a pixel that lies nearest to one of its corners.
const CORNER: f64 = (1.0 - MIDDLE) / 4.0;

/// Mixes the rows of a picture from the top.
pub(super) struct CornerRows {
    plain: Arc<PlainPixels>,
    /// Number of pixels in a row.
    width: usize,
    next_row: usize,
    /// Colours of the corners that have come, from the upper ones of the next row on.
    waiting: Vec<Tint>,
}

impl CornerRows {
    /// Creates the rows of a picture of these pixels, `width` of them in a row.
    pub(super) fn new(plain: Arc<PlainPixels>, width: usize) -> Self {
        CornerRows { plain, width, next_row: 0, waiting: Vec::new() }
    }

    /// Returns the pixels, with the samples in their middles.
    pub(super) fn pixels(&self) -> &PlainPixels {
        &self.plain
    }

    /// Takes the colours of the next corners. Returns the index of the first pixel whose corners
    /// are now complete, and the colours of all such pixels.
    pub(super) fn mixed(&mut self, corners: &[Tint]) -> (usize, Vec<Tint>) {
        self.waiting.extend(corners);
        let across = self.width + 1;
        let rows = (self.waiting.len() / across).saturating_sub(1);
        let first = self.next_row * self.width;
        let mut pixels = vec![Tint::default(); rows * self.width];
        let around = self.waiting.par_chunks(across).zip(self.waiting.par_chunks(across).skip(1));
        let mixed = pixels.par_chunks_mut(self.width).zip(around).enumerate();
        mixed.for_each(|(row, (pixels, (above, below)))| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let corners = [above[column], above[column + 1], below[column], below[column + 1]];
                *pixel = self.pixel([column, self.next_row + row], corners);
            }
        });
        self.waiting.drain(..rows * across);
        self.next_row += rows;
        (first, pixels)
    }

    /// Returns the mean colour of a pixel, computed in linear light. A corner without a sample has
    /// the colour of the middle.
    fn pixel(&self, [column, row]: [usize; 2], corners: [Tint; 4]) -> Tint {
        let middle = self.plain.tint(row * self.width + column);
        let [x, y] = [column as u32, row as u32];
        let places = [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]];
        let is_sampled = places.map(|place| self.plain.has_corner(place));
        if is_sampled == [false; 4] {
            return middle;
        }
        std::array::from_fn(|channel| {
            let own = light_of(middle[channel]);
            let corner = |(tint, is_sampled): (Tint, bool)| match is_sampled {
                true => light_of(tint[channel]),
                false => own,
            };
            let sum: f64 = corners.into_iter().zip(is_sampled).map(corner).sum();
            channel_of(MIDDLE * own + CORNER * sum)
        })
    }
}
