//! Basin entropy: how well one can tell the class of a point that is known only to within a box.
//!
//! A box with shares pⱼ of its classes has the entropy −Σ pⱼ ln pⱼ. The basin entropy is its mean over
//! all boxes, the boundary basin entropy that over boxes with two classes or more. The latter above
//! ln 2 proves a fractal boundary (Daza, Wagemakers, Georgeot, Guéry-Odelin and Sanjuán 2016, Sci. Rep.
//! 6, 31416); two classes alone never reach it. A smooth boundary has a value that depends on the shape
//! of boxes only, so that another value is the mark of a fractal one (Puy, Daza, Wagemakers and Sanjuán
//! 2021, Commun. Nonlinear Sci. Numer. Simul. 95, 105588).

use serde::{Deserialize, Serialize};

use crate::estimate::LEAST_REPLICATES;
use crate::shares::ClassCounts;
use crate::{Estimate, EstimateError};

/// Boxes of one size, in groups that are independent of each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Boxes {
    /// Side of a box.
    pub side: f64,
    /// Samples of each box, by class.
    pub groups: Vec<Vec<ClassCounts>>,
}

/// The entropies of boxes of one size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entropy {
    /// Side of a box.
    pub side: f64,
    /// The basin entropy.
    pub basin: Estimate,
    /// The boundary basin entropy; `None` if too few boxes are mixed.
    pub boundary: Option<Estimate>,
    /// True if the boundary basin entropy lies above ln 2, which proves a fractal boundary.
    pub is_above_ln2: bool,
}

/// Estimates the entropies.
pub fn entropy(boxes: &Boxes) -> Result<Entropy, EstimateError> {
    let per_box = |group: &Vec<ClassCounts>| READINGS.map(|k| [sum(group, k), group.len() as f64]);
    let per_mixed = |group: &Vec<ClassCounts>| READINGS.map(|k| [sum(group, k), mixed(group, k)]);
    let basin: Vec<[[f64; 2]; 3]> = boxes.groups.iter().map(per_box).collect();
    let boundary: Vec<[[f64; 2]; 3]> = boxes.groups.iter().map(per_mixed).collect();
    let groups = boundary.iter().filter(|group| group[1][1] > 0.0).count();
    let is_known = groups >= LEAST_REPLICATES
        && boundary.iter().map(|group| group[1][1]).sum::<f64>() >= FEWEST_MIXED;
    let boundary = if is_known { Some(Estimate::of_ratios(&boundary)?) } else { None };
    Ok(Entropy {
        side: boxes.side,
        basin: Estimate::of_ratios(&basin)?.within(0.0, f64::INFINITY),
        is_above_ln2: boundary.is_some_and(|entropy| entropy.low > std::f64::consts::LN_2),
        boundary,
    })
}

/// Smallest number of mixed boxes for a boundary basin entropy.
const FEWEST_MIXED: f64 = 20.0;

/// The ways in which unsure samples are counted.
const READINGS: [usize; 3] = [0, 1, 2];

fn sum(group: &[ClassCounts], reading: usize) -> f64 {
    group.iter().map(|counts| readings(counts)[reading]).sum()
}

/// Number of boxes with two classes or more.
fn mixed(group: &[ClassCounts], reading: usize) -> f64 {
    group.iter().filter(|counts| readings(counts)[reading] > 0.0).count() as f64
}

/// Returns the entropy of a box with its unsure samples all in its largest class, where they seem to
/// belong, and spread over the smallest classes.
fn readings(counts: &ClassCounts) -> [f64; 3] {
    let unsure: u64 = counts.unsure.iter().sum();
    let seeming: Vec<u64> = counts.sure.iter().zip(&counts.unsure).map(|(a, b)| a + b).collect();
    if unsure == 0 {
        return [of_counts(&seeming); 3];
    }
    let (mut least, mut most) = (counts.sure.clone(), counts.sure.clone());
    if let Some(largest) = least.iter_mut().max() {
        *largest += unsure;
    }
    for _ in 0..unsure {
        if let Some(smallest) = most.iter_mut().min() {
            *smallest += 1;
        }
    }
    [of_counts(&least), of_counts(&seeming), of_counts(&most)]
}

fn of_counts(counts: &[u64]) -> f64 {
    let total: u64 = counts.iter().sum();
    let term = |count: &u64| {
        let share = *count as f64 / total as f64;
        -share * share.ln()
    };
    counts.iter().filter(|count| **count > 0).map(term).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_the_entropy_of_its_shares() {
        let ln2 = std::f64::consts::LN_2;
        assert!((of_counts(&[3, 3]) - ln2).abs() < 1e-15 && of_counts(&[7, 0]) == 0.0);
        let unsure = ClassCounts { sure: vec![4, 0], unsure: vec![0, 2] };
        let [least, seeming, most] = readings(&unsure);
        assert!(least == 0.0 && seeming == of_counts(&[4, 2]) && most == seeming);
    }
}
