//! Whether three classes or more share one boundary.
//!
//! The merging method (Daza, Wagemakers and Sanjuán 2018, Sci. Rep. 8, 9954): for each class, all
//! others are taken as one, and the boundary of what is left is compared with those of the other
//! mergers. In a Wada set all are the same, so that at any resolution none lies more than a few pixels
//! from any other; elsewhere that distance grows with the resolution.

use serde::{Deserialize, Serialize};

use crate::EstimateError;
use crate::boxes::Raster;

/// What the merged boundaries say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Merged {
    /// Pixels along a side of the picture.
    pub side: usize,
    /// Greatest distance of a pixel of a merged boundary from any other one, pixels.
    pub farthest: u32,
    /// The share of such pixels that are farther than a few pixels from some other one.
    pub apart: f64,
}

/// What pictures of several resolutions say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wada {
    /// The merged boundaries, the coarsest picture first.
    pub pictures: Vec<Merged>,
    /// True if the boundaries stay within a few pixels of each other at every resolution.
    pub is_wada: bool,
}

/// Distance in pixels that counts as the same boundary.
const SAME: u32 = 6;
/// Share of pixels that may be farther away in a shared boundary: the ends of its thinnest tongues.
const ENDS: f64 = 1e-3;

/// Judges pictures of the same region, the coarsest first.
pub fn wada(pictures: &[Raster]) -> Result<Wada, EstimateError> {
    if pictures.len() < 2 {
        return Err(EstimateError::TooFew { what: "pictures", have: pictures.len(), need: 2 });
    }
    let pictures: Vec<Merged> = pictures.iter().map(merged).collect::<Result<_, _>>()?;
    let is_wada = pictures.iter().all(|picture| picture.apart <= ENDS);
    Ok(Wada { pictures, is_wada })
}

/// Compares the merged boundaries of one picture.
pub fn merged(raster: &Raster) -> Result<Merged, EstimateError> {
    let mut classes: Vec<u8> = raster.classes.clone();
    classes.sort_unstable();
    classes.dedup();
    if classes.len() < 3 {
        return Err(EstimateError::FewClasses { have: classes.len(), need: 3 });
    }
    let edges: Vec<Vec<bool>> = classes.iter().map(|class| boundary(raster, *class)).collect();
    let away: Vec<Vec<u32>> = edges.iter().map(|edge| distances(edge, raster.side)).collect();
    let is_edge = |pixel: &usize| edges.iter().any(|edge| edge[*pixel]);
    let farthest_of = |pixel: usize| away.iter().map(|away| away[pixel]).max().unwrap_or(0);
    let all: Vec<u32> = (0..raster.classes.len()).filter(is_edge).map(farthest_of).collect();
    let farthest = all.iter().copied().max().ok_or(EstimateError::OneClass)?;
    let apart = all.iter().filter(|far| **far > SAME).count() as f64 / all.len() as f64;
    Ok(Merged { side: raster.side, farthest, apart })
}

/// Returns the pixels beside which a class begins or ends.
fn boundary(raster: &Raster, class: u8) -> Vec<bool> {
    let side = raster.side;
    let is_in = |k: usize| raster.classes[k] == class;
    let differs = |k: usize| {
        let (x, y) = (k % side, k / side);
        let beside = [
            (x > 0).then(|| k - 1),
            (x + 1 < side).then(|| k + 1),
            (y > 0).then(|| k - side),
            (y + 1 < side).then(|| k + side),
        ];
        beside.into_iter().flatten().any(|other| is_in(other) != is_in(k))
    };
    (0..raster.classes.len()).map(differs).collect()
}

/// Returns the distance of every pixel from the nearest marked one, along rows and columns, by two
/// sweeps (Rosenfeld and Pfaltz 1966).
fn distances(marked: &[bool], side: usize) -> Vec<u32> {
    let far = 2 * side as u32;
    let mut away: Vec<u32> = marked.iter().map(|m| if *m { 0 } else { far }).collect();
    for k in 0..away.len() {
        let left = if k % side > 0 { away[k - 1] + 1 } else { far };
        let above = if k >= side { away[k - side] + 1 } else { far };
        away[k] = away[k].min(left).min(above);
    }
    for k in (0..away.len()).rev() {
        let right = if (k + 1) % side > 0 { away[k + 1] + 1 } else { far };
        let below = if k + side < away.len() { away[k + side] + 1 } else { far };
        away[k] = away[k].min(right).min(below);
    }
    away
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(side: usize, width: usize) -> Raster {
        let class = |k: usize| ((k % side) / width % 3) as u8;
        Raster { classes: (0..side * side).map(class).collect(), side }
    }

    #[test]
    fn stripes_share_no_boundary_and_single_columns_do() {
        let stripes = [48, 96].map(|side| columns(side, side / 3));
        let found = wada(&stripes).unwrap();
        assert!(!found.is_wada);
        // A boundary of the first stripe alone is a whole stripe away from that of the third.
        assert_eq!([0, 1].map(|k| found.pictures[k].farthest), [16, 32]);
        assert!(wada(&[48, 96].map(|side| columns(side, 1))).unwrap().is_wada);
    }

    #[test]
    fn two_classes_are_too_few() {
        let halves = Raster { classes: vec![0, 0, 1, 1], side: 2 };
        assert_eq!(merged(&halves), Err(EstimateError::FewClasses { have: 2, need: 3 }));
    }

    #[test]
    fn distances_are_counted_along_rows_and_columns() {
        let mut marked = vec![false; 25];
        marked[7] = true;
        let away = distances(&marked, 5);
        assert_eq!([away[7], away[0], away[24], away[20]], [0, 3, 5, 5]);
    }
}
