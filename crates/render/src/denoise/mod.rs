//! Calms the grain of unresolved chaos.
//!
//! Where the times of neighbouring pixels are unrelated, a pixel's few samples are drawn at random
//! from what lies in it, and the map looks like sand. There, more samples would be spent on the mean
//! colour, and the pixels beside it along the same band have been drawn from much the same colours.
//! Each unresolved pixel therefore becomes a weighted mean, in linear light, of the unresolved
//! pixels around it: far along the band, which the structure tensor finds (Förstner and Gülch,
//! 1987), and hardly across it. A resolved pixel neither changes nor contributes.

mod rows;
mod structure;
mod weights;

use std::ops::Range;

use rayon::prelude::*;

use flipmap_scene::palette::{FAILED, Ground, Rgb, Tint, channel_of, light_of, rounded, tint_of};
pub(crate) use rows::DenoisedRows;
use structure::Structure;
use weights::{BandWeights, RADIUS};

/// Rows above and below a row, and columns beside a column, on which its colours depend.
pub(crate) const REACH: usize = structure::REACH + RADIUS;

/// Difference of a channel, of 255, above which two colours are different.
const DIFFERENT: f32 = 24.0;
/// Distances along a band, in pixels, at which a pixel is compared with others, in both directions.
const COMPARED_PX: [f32; 4] = [-2.0, -1.0, 1.0, 2.0];
/// Number of these comparisons that must differ for a pixel to be entirely unresolved.
const UNRESOLVED: f32 = 3.0;

/// Largest number of columns that are denoised at a time.
const MAX_STRIP: usize = 1 << 11;

/// Denoises pictures of one width.
pub struct Denoiser {
    width: usize,
    /// Columns that are denoised at a time, so that wide pictures need little memory.
    strip: usize,
    weights: BandWeights,
    /// Colours that stay as they are: pixels that are not samples of anything.
    kept: [Tint; 2],
}

/// Some rows and columns of a picture, with a margin of [`REACH`] pixels on all sides. Beyond the
/// picture's edges its outermost pixels are repeated.
pub(super) struct Block {
    tints: Vec<Tint>,
    /// Pixels in a row, margins included.
    stride: usize,
    /// Rows, margins included.
    height: usize,
}

impl Denoiser {
    /// Creates a denoiser of pictures `width` pixels wide, on this ground.
    pub fn new(width: usize, ground: &Ground) -> Self {
        let strip = width.min(MAX_STRIP);
        let weights = BandWeights::new(strip + 2 * REACH);
        Denoiser { width, strip, weights, kept: [ground.forbidden, FAILED].map(tint_of) }
    }

    /// Returns the denoised colours of a whole picture.
    pub fn colours(&self, colours: &[Rgb]) -> Vec<Rgb> {
        let tints: Vec<Tint> = colours.iter().copied().map(tint_of).collect();
        let denoised = self.denoised(&tints, 0..tints.len() / self.width);
        denoised.into_iter().map(rounded).collect()
    }

    /// Returns the denoised pixels of the rows `inner` of `tints`, whole rows of which at least
    /// [`REACH`] more lie above and below, unless the picture ends before.
    pub(crate) fn denoised(&self, tints: &[Tint], inner: Range<usize>) -> Vec<Tint> {
        let mut denoised = tints[inner.start * self.width..inner.end * self.width].to_vec();
        for first in (0..self.width).step_by(self.strip) {
            // The last strip is as wide as the others.
            let first = first.min(self.width - self.strip);
            let block = Block::new(tints, self.width, inner.clone(), first..first + self.strip);
            self.denoise(&block, first, &mut denoised);
        }
        denoised
    }

    /// Denoises the inner pixels of a block, which lie in `rows` from the column `first` on.
    fn denoise(&self, block: &Block, first: usize, rows: &mut [Tint]) {
        let grain = self.grain(block);
        if !grain.contains(&true) {
            return;
        }
        let structure = Structure::of(block);
        let unresolved = unresolved(block, &grain, &structure);
        let light: Vec<[f32; 3]> = block.tints.par_iter().map(|tint| light(*tint)).collect();
        rows.par_chunks_mut(self.width).enumerate().for_each(|(row, pixels)| {
            let places = (row + REACH) * block.stride + REACH..;
            for (at, pixel) in places.zip(&mut pixels[first..first + self.strip]) {
                if unresolved[at] > 0.0 {
                    let (across_rad, band) = structure.at(at);
                    let taps = self.weights.of(across_rad, band);
                    *pixel = mean(at, taps, &light, &unresolved);
                }
            }
        });
    }

    /// Returns for every pixel of a block whether it differs from any of its neighbours, apart from
    /// those that stay as they are.
    fn grain(&self, block: &Block) -> Vec<bool> {
        let mut grain = vec![false; block.tints.len()];
        block.each(&mut grain, 1, |at| {
            let here = block.tints[at];
            let differs = |tint: Tint| !self.kept.contains(&tint) && differ(tint, here);
            !self.kept.contains(&here) && block.around(at).any(differs)
        });
        grain
    }
}

/// Returns for every pixel of a block how unresolved it is, from 0 to 1: where neighbours differ,
/// by the number of pixels along the band that do. On a resolved edge or thread, few do.
fn unresolved(block: &Block, grain: &[bool], structure: &Structure) -> Vec<f32> {
    let mut shares = vec![0.0; block.tints.len()];
    block.each(&mut shares, structure::REACH, |at| {
        if !grain[at] {
            return 0.0;
        }
        let (sin, cos) = structure.at(at).0.sin_cos();
        let along = COMPARED_PX.map(|px| block.between(at, [-px * sin, px * cos]));
        let different = along.into_iter().filter(|tint| differ(*tint, block.tints[at])).count();
        (different as f32 / UNRESOLVED).min(1.0)
    });
    shares
}

impl Block {
    /// Takes some rows and columns of a picture whose rows have `width` pixels.
    fn new(tints: &[Tint], width: usize, rows: Range<usize>, columns: Range<usize>) -> Self {
        let with_margin = |range: Range<usize>, count: usize| {
            let wide = range.start as isize - REACH as isize..(range.end + REACH) as isize;
            wide.map(move |place| place.clamp(0, count as isize - 1) as usize)
        };
        let rows = with_margin(rows, tints.len() / width);
        let columns = with_margin(columns, width);
        let (stride, height) = (columns.len(), rows.len());
        let pixel = |row: usize| columns.clone().map(move |column| tints[row * width + column]);
        Block { tints: rows.flat_map(pixel).collect(), stride, height }
    }

    /// Computes a value for every pixel that is at least `margin` pixels from the block's edges.
    fn each<T: Send>(&self, values: &mut [T], margin: usize, of: impl Fn(usize) -> T + Sync) {
        let rows = values.par_chunks_mut(self.stride).enumerate();
        let inside = rows.skip(margin).take(self.height - 2 * margin);
        inside.for_each(|(row, values)| {
            let inner = values.iter_mut().enumerate().skip(margin).take(self.stride - 2 * margin);
            for (column, value) in inner {
                *value = of(row * self.stride + column);
            }
        });
    }

    /// Returns the colour at an offset of less than the margin from a place, mixed of four pixels.
    fn between(&self, at: usize, [dx, dy]: [f32; 2]) -> Tint {
        let (x, y) = (dx.floor(), dy.floor());
        let [right, down] = [dx - x, dy - y];
        let corner = at.wrapping_add_signed(y as isize * self.stride as isize + x as isize);
        let row = |at: usize| mixed(self.tints[at], self.tints[at + 1], right);
        mixed(row(corner), row(corner + self.stride), down)
    }

    /// Returns the eight pixels around a place.
    fn around(&self, at: usize) -> impl Iterator<Item = Tint> {
        let (above, below) = (at - self.stride, at + self.stride);
        let places = [above - 1, above, above + 1, at - 1, at + 1, below - 1, below, below + 1];
        places.into_iter().map(|place| self.tints[place])
    }
}

/// Returns the linear light of a colour.
fn light(tint: Tint) -> [f32; 3] {
    tint.map(|channel| light_of(channel) as f32)
}

fn mixed(a: Tint, b: Tint, share: f32) -> Tint {
    std::array::from_fn(|channel| a[channel] + (b[channel] - a[channel]) * share)
}

fn differ(a: Tint, b: Tint) -> bool {
    (0..3).any(|channel| (a[channel] - b[channel]).abs() > DIFFERENT)
}

/// Returns the weighted mean around a place.
fn mean(at: usize, taps: &[(isize, f32)], light: &[[f32; 3]], unresolved: &[f32]) -> Tint {
    let (mut sum, mut total) = (light[at], 1.0);
    for (offset, weight) in taps {
        let place = at.wrapping_add_signed(*offset);
        let weight = weight * unresolved[at] * unresolved[place];
        total += weight;
        for (sum, light) in sum.iter_mut().zip(light[place]) {
            *sum += weight * light;
        }
    }
    sum.map(|sum| channel_of(f64::from(sum / total)))
}
