//! The box-counting dimension of the boundaries in a picture of classes.
//!
//! A box counts if two classes lie in it. The picture misses the thinnest strips, so that the dimension
//! of a rough boundary reads low, whatever its interval says, where strips are thinner than pixels. The uncertainty exponent of [`crate::pairs`] has no such bias.

use serde::{Deserialize, Serialize};

use crate::estimate::quantile_t;
use crate::line::FittedLine;
use crate::{Estimate, EstimateError};

/// A square picture of classes, row by row.
#[derive(Clone, Debug)]
pub struct Raster {
    /// Class of each pixel.
    pub classes: Vec<u8>,
    /// Pixels along a side.
    pub side: usize,
}

/// What the boxes say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoxDimension {
    /// The dimension over all sizes.
    pub dimension: Estimate,
    /// Side of a box in pixels, and number of boxes with two classes.
    pub counts: Vec<(usize, u64)>,
    /// The dimension between each size and the next.
    pub local: Vec<f64>,
}

/// Number of parts along a side, whose spread is the error.
const PARTS: usize = 4;
/// Side of the smallest boxes, pixels: smaller ones miss too many strips.
const SMALLEST: usize = 4;

impl Raster {
    /// Returns true if two classes lie in a box, whose corners are pixels that it shares with its
    /// neighbours: otherwise a boundary between two boxes would lie in neither.
    fn is_mixed(&self, [x, y]: [usize; 2], size: usize) -> bool {
        let first = self.classes[y * self.side + x];
        let [right, below] = [x, y].map(|from| (from + size).min(self.side - 1));
        (y..=below).any(|row| {
            let start = row * self.side;
            self.classes[start + x..=start + right].iter().any(|class| *class != first)
        })
    }

    /// Number of mixed boxes of a size in a part of the picture.
    fn count(&self, size: usize, [column, row]: [usize; 2]) -> u64 {
        let part = self.side / PARTS;
        let places = || (0..part).step_by(size);
        let mixed = |y: usize| {
            places().filter(|x| self.is_mixed([column * part + x, row * part + y], size)).count()
        };
        places().map(mixed).sum::<usize>() as u64
    }
}

/// Estimates the dimension. The side of the picture is a power of two.
pub fn dimension(raster: &Raster) -> Result<BoxDimension, EstimateError> {
    let largest = raster.side / (8 * PARTS);
    let sizes: Vec<usize> = (0..).map(|k| SMALLEST << k).take_while(|s| *s <= largest).collect();
    if sizes.len() < 3 {
        let (have, need) = (raster.side, SMALLEST << 7);
        return Err(EstimateError::TooFew { what: "pixels along a side", have, need });
    }
    let parts: Vec<Vec<u64>> = (0..PARTS * PARTS)
        .map(|k| sizes.iter().map(|s| raster.count(*s, [k % PARTS, k / PARTS])).collect())
        .collect();
    let summed = |left_out: Option<usize>| -> Vec<u64> {
        let kept = || (0..parts.len()).filter(|k| Some(*k) != left_out);
        (0..sizes.len()).map(|s| kept().map(|k| parts[k][s]).sum()).collect()
    };
    let all = summed(None);
    if all.contains(&0) {
        return Err(EstimateError::OneClass);
    }
    let slope = |counts: &[u64]| {
        let point = |(size, count): (&usize, &u64)| {
            [-(*size as f64).ln(), (*count as f64).max(0.5).ln(), 1.0]
        };
        let points: Vec<[f64; 3]> = sizes.iter().zip(counts).map(point).collect();
        FittedLine::fit(&points).map_or(f64::NAN, |line| line.slope)
    };
    let without: Vec<f64> = (0..parts.len()).map(|k| slope(&summed(Some(k)))).collect();
    let local = all.windows(2).map(|two| (two[0] as f64 / two[1] as f64).log2()).collect();
    let dimension = jackknifed(slope(&all), &without);
    Ok(BoxDimension { dimension, counts: sizes.iter().copied().zip(all).collect(), local })
}

/// Returns a value with the interval that follows from leaving out one part after the other.
fn jackknifed(value: f64, without: &[f64]) -> Estimate {
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let squares: f64 = without.iter().map(|one| (one - mean).powi(2)).sum();
    let by = quantile_t(without.len() - 1) * (squares * (n - 1.0) / n).sqrt();
    Estimate { value, low: value - by, high: value + by }
}
