//! Shares of classes, and the areas that follow from them.

use serde::{Deserialize, Serialize};

use crate::{Estimate, EstimateError};

/// The answers of one replicate, by class.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClassCounts {
    /// Number of sure answers of each class.
    pub sure: Vec<u64>,
    /// Number of answers of each class that nobody is sure of.
    pub unsure: Vec<u64>,
}

impl ClassCounts {
    /// Counts without answers, for a number of classes.
    pub fn new(classes: usize) -> Self {
        ClassCounts { sure: vec![0; classes], unsure: vec![0; classes] }
    }

    /// Adds an answer.
    pub fn add(&mut self, class: usize, is_sure: bool) {
        let counts = if is_sure { &mut self.sure } else { &mut self.unsure };
        counts[class] += 1;
    }

    /// Number of answers.
    pub fn total(&self) -> u64 {
        self.sure.iter().chain(&self.unsure).sum()
    }

    /// Returns the share of a class with all unsure answers elsewhere, where they seem to belong,
    /// and in it.
    fn readings(&self, class: usize) -> [[f64; 2]; 3] {
        let (sure, unsure) = (self.sure[class], self.unsure.iter().sum::<u64>());
        let counts = [sure, sure + self.unsure[class], sure + unsure];
        counts.map(|count| [count as f64, self.total() as f64])
    }
}

/// Smallest number of answers in and out of a class from which a spread of replicates is believed.
const MANY: u64 = 30;

/// Returns the share of a class among all answers.
///
/// The interval is Student's, of the replicates. Where hardly any answers, or hardly any others, are
/// of the class, that of independent trials is taken too; low-discrepancy points are at least as good.
pub fn share(replicates: &[ClassCounts], class: usize) -> Result<Estimate, EstimateError> {
    let readings: Vec<[[f64; 2]; 3]> =
        replicates.iter().map(|counts| counts.readings(class)).collect();
    if replicates.iter().all(|counts| counts.total() == 0) {
        return Err(EstimateError::TooFew { what: "answers", have: 0, need: 1 });
    }
    let interval = Estimate::of_ratios(&readings)?;
    let sum = |part: &dyn Fn(&ClassCounts) -> u64| replicates.iter().map(part).sum::<u64>();
    let (count, total) = (sum(&|counts| counts.sure[class]), sum(&ClassCounts::total));
    let unsure = sum(&|counts| counts.unsure.iter().sum());
    let guessed = sum(&|counts| counts.unsure[class]);
    let is_many = count >= MANY && total.saturating_sub(count + unsure) >= MANY;
    let interval = match is_many {
        true => interval,
        false => interval.and(Estimate::of_trials(count, unsure, guessed, total)),
    };
    Ok(interval.within(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scatter::scattered;
    use std::f64::consts::FRAC_PI_4;

    /// Counts points of the unit square in a quarter of a disc; every `step`-th point is unsure.
    fn disc(seed: u64, points: u32, step: u32) -> Vec<ClassCounts> {
        let count = |replicate| {
            let mut counts = ClassCounts::new(2);
            for index in 0..points {
                let [x, y] =
                    scattered(seed, replicate, index).map(|x| f64::from(x) / 2f64.powi(32));
                let is_sure = step == 0 || index % step > 0;
                counts.add(usize::from(x.hypot(y) > 1.0), is_sure);
            }
            counts
        };
        (0..16).map(count).collect()
    }

    #[test]
    fn intervals_hold_the_area_of_a_disc_in_95_of_100_seeds() {
        let holds = |seed: &u64| share(&disc(*seed, 512, 0), 0).unwrap().contains(FRAC_PI_4);
        let held = (0..200).filter(holds).count();
        assert!((184..=196).contains(&held), "{held} of 200");
    }

    #[test]
    fn unsure_answers_widen_the_interval_by_their_share() {
        let [sure, unsure] = [0, 10].map(|step| share(&disc(3, 500, step), 0).unwrap());
        let wider = 2.0 * (unsure.half_width() - sure.half_width());
        assert!(unsure.value == sure.value && (wider - 0.1).abs() < 0.01, "{wider}");
    }

    #[test]
    fn a_class_that_was_not_met_may_still_be_there() {
        let none = vec![ClassCounts { sure: vec![100, 0], unsure: vec![0, 0] }; 16];
        let share = share(&none, 1).unwrap();
        // The rule of three: 3.69 in 1600 for one side of 95 %.
        assert!(share.value == 0.0 && (share.high - 0.0023).abs() < 1e-4, "{share:?}");
    }
}
