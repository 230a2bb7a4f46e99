//! The structure tensor of a picture: the direction in which its colours change fastest, and how
//! clearly they form bands.

use super::Block;
use rayon::prelude::*;

/// Pixels on each side on which the structure depends: the window, a gradient, and the smoothing
/// before it.
pub(super) const REACH: usize = WINDOW + 2;
/// Pixels on each side of the window over which gradients are averaged.
const WINDOW: usize = 9;
/// Standard deviation of that window in pixels.
const WINDOW_PX: f32 = 4.0;
/// Coherence that only one in ten places of pure grain exceeds in such a window: it shows no band.
const OF_GRAIN: f32 = 0.25;

/// Exponent of the strength of bands: below 1, faint bands count for more.
const GAIN: f32 = 0.7;

/// Products of the gradient's components, summed over the channels: xx, xy, yy.
type Tensor = [f32; 3];

/// The structure of a block's inner pixels.
pub(super) struct Structure(Vec<Tensor>);

impl Structure {
    /// Computes the structure of a block.
    pub(super) fn of(block: &Block) -> Self {
        let stride = block.stride;
        let smooth = rows(stride, 1, &block.tints, |above, here, below, at| {
            std::array::from_fn(|channel| {
                let row = |row: &[[f32; 3]]| {
                    row[at - 1][channel] + 2.0 * row[at][channel] + row[at + 1][channel]
                };
                (row(above) + 2.0 * row(here) + row(below)) / 16.0
            })
        });
        let tensors = rows(stride, 2, &smooth, |above, here, below, at| {
            let gradients: [[f32; 2]; 3] = std::array::from_fn(|channel| {
                let of = |row: &[[f32; 3]], at: usize| row[at][channel];
                let down = |at| of(above, at) + 2.0 * of(here, at) + of(below, at);
                let right = |row| of(row, at - 1) + 2.0 * of(row, at) + of(row, at + 1);
                [down(at + 1) - down(at - 1), right(below) - right(above)]
            });
            let sum = |a: usize, b: usize| gradients.iter().map(|g| g[a] * g[b]).sum();
            [sum(0, 0), sum(0, 1), sum(1, 1)]
        });
        Structure(blurred(&tensors, stride))
    }

    /// Returns the direction of the fastest change at a place in rad, clockwise from the right,
    /// and the strength of the bands, from 0 to 1.
    pub(super) fn at(&self, place: usize) -> (f32, f32) {
        let [xx, xy, yy] = self.0[place];
        let difference = ((xx - yy) * (xx - yy) + 4.0 * xy * xy).sqrt();
        let coherence = difference / (xx + yy).max(f32::MIN_POSITIVE);
        let beyond = ((coherence - OF_GRAIN) / (1.0 - OF_GRAIN)).clamp(0.0, 1.0);
        (0.5 * (2.0 * xy).atan2(xx - yy), beyond.powf(GAIN))
    }
}

/// Computes every pixel from its row and the rows above and below it, which `of` takes with the
/// pixel's column; `margin` pixels at the edges stay zero.
fn rows(
    stride: usize,
    margin: usize,
    from: &[[f32; 3]],
    of: impl Fn(&[[f32; 3]], &[[f32; 3]], &[[f32; 3]], usize) -> [f32; 3] + Sync,
) -> Vec<[f32; 3]> {
    let mut to = vec![[0.0; 3]; from.len()];
    let height = from.len() / stride;
    let row = |row: usize| &from[row * stride..(row + 1) * stride];
    to.par_chunks_mut(stride).enumerate().for_each(|(y, pixels)| {
        if (margin..height - margin).contains(&y) {
            let [above, here, below] = [y - 1, y, y + 1].map(row);
            for (x, pixel) in pixels.iter_mut().enumerate().take(stride - margin).skip(margin) {
                *pixel = of(above, here, below, x);
            }
        }
    });
    to
}

/// Averages tensors over the window.
fn blurred(tensors: &[Tensor], stride: usize) -> Vec<Tensor> {
    let weights: [f32; 2 * WINDOW + 1] = std::array::from_fn(|k| {
        let away = (k as f32 - WINDOW as f32) / WINDOW_PX;
        (-0.5 * away * away).exp()
    });
    let mut across = vec![[0.0; 3]; tensors.len()];
    across.par_chunks_mut(stride).zip(tensors.par_chunks(stride)).for_each(|(to, from)| {
        for (window, to) in from.windows(weights.len()).zip(&mut to[WINDOW..]) {
            *to = sum(window.iter().zip(&weights));
        }
    });
    let mut both = vec![[0.0; 3]; tensors.len()];
    let height = tensors.len() / stride;
    both.par_chunks_mut(stride).enumerate().for_each(|(row, to)| {
        if (WINDOW..height - WINDOW).contains(&row) {
            let first = (row - WINDOW) * stride;
            for (column, to) in to.iter_mut().enumerate() {
                let window = across[first + column..].iter().step_by(stride);
                *to = sum(window.zip(&weights));
            }
        }
    });
    both
}

fn sum<'a>(weighed: impl Iterator<Item = (&'a Tensor, &'a f32)>) -> Tensor {
    let mut sum = [0.0; 3];
    for (tensor, weight) in weighed {
        for (sum, part) in sum.iter_mut().zip(tensor) {
            *sum += weight * part;
        }
    }
    sum
}
