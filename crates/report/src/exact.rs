//! The benefit of checking: answers with their trust, compared with the truth and with the same
//! config's unchecked answers.

use serde::Serialize;

use super::backend::Backend;
use super::measure::{Bench, Compared, least_starts_of_exact};
use super::statistics::{Errors, OutcomePair, bands, is_right};
use super::truth::oracle_dd;
use super::{ReportError, Row};
use flipmap_engine::trust::TrustEngine;
use flipmap_engine::{Accuracy, Assurance, Engine, EngineError, IntegratorConfig, Trust};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status};

/// A pixel answered with and without checks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Checked {
    /// The answer with checks.
    pub answer: Outcome,
    /// Assurance of that answer.
    pub assurance: Assurance,
    /// The answer without checks.
    pub unchecked: Outcome,
    /// The true outcome.
    pub truth: Outcome,
}

/// Counts of the answers of `exact`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Checks {
    /// Number of pixels.
    pub pixels: usize,
    /// Pixels with which a cheap check agreed.
    pub agreed: usize,
    /// Pixels that an expensive check confirmed.
    pub confirmed: usize,
    /// Pixels that double-double decided.
    pub settled: usize,
    /// Pixels marked as uncertain.
    pub marked: usize,
    /// Wrong pixels that are not marked: there must be none.
    pub unmarked_wrong: usize,
    /// Pixels that the same config gets wrong without checks.
    pub unchecked_wrong: usize,
    /// Pixels of `unchecked_wrong` that are right with checks.
    pub corrected: usize,
    /// Pixels of `unchecked_wrong` that are still wrong, but marked.
    pub wrong_but_marked: usize,
    /// Flips that are not marked, with an estimated error.
    pub estimated: usize,
    /// Flips of `estimated` whose true error is at most the estimate.
    pub within_estimate: usize,
}

impl Checks {
    /// Counts `pixels`.
    pub(crate) fn of(pixels: &[Checked]) -> Self {
        let count =
            |fits: &dyn Fn(&Checked) -> bool| pixels.iter().filter(|pixel| fits(pixel)).count();
        let trusted = |trust| count(&|pixel: &Checked| pixel.assurance.trust() == trust);
        Checks {
            pixels: pixels.len(),
            agreed: trusted(Trust::Agreed),
            confirmed: trusted(Trust::Confirmed),
            settled: trusted(Trust::Settled),
            marked: trusted(Trust::Uncertain),
            unmarked_wrong: count(&|pixel| !pixel.is_right() && !pixel.is_marked()),
            unchecked_wrong: count(&|pixel| pixel.was_wrong()),
            corrected: count(&|pixel| pixel.was_wrong() && pixel.is_right()),
            wrong_but_marked: count(&|pixel| {
                pixel.was_wrong() && !pixel.is_right() && pixel.is_marked()
            }),
            estimated: count(&|pixel| pixel.estimate_secs().is_some()),
            within_estimate: count(&|pixel| {
                pixel.estimate_secs().is_some_and(|secs| pixel.error_secs() <= secs)
            }),
        }
    }

    /// Number of pixels wrong without checks that checking corrected or marked.
    pub(crate) fn caught(&self) -> usize {
        self.corrected + self.wrong_but_marked
    }

    /// Share of pixels marked as uncertain, or `None` if there are no pixels.
    pub(crate) fn marked_share(&self) -> Option<f64> {
        (self.pixels > 0).then(|| self.marked as f64 / self.pixels as f64)
    }

    /// Share of the estimated errors that the true ones do not exceed, or `None` without estimates.
    pub(crate) fn within_estimate_share(&self) -> Option<f64> {
        (self.estimated > 0).then(|| self.within_estimate as f64 / self.estimated as f64)
    }
}

impl std::iter::Sum for Checks {
    fn sum<I: Iterator<Item = Checks>>(all: I) -> Checks {
        all.fold(Checks::default(), |a, b| Checks {
            pixels: a.pixels + b.pixels,
            agreed: a.agreed + b.agreed,
            confirmed: a.confirmed + b.confirmed,
            settled: a.settled + b.settled,
            marked: a.marked + b.marked,
            unmarked_wrong: a.unmarked_wrong + b.unmarked_wrong,
            unchecked_wrong: a.unchecked_wrong + b.unchecked_wrong,
            corrected: a.corrected + b.corrected,
            wrong_but_marked: a.wrong_but_marked + b.wrong_but_marked,
            estimated: a.estimated + b.estimated,
            within_estimate: a.within_estimate + b.within_estimate,
        })
    }
}

impl Checked {
    /// Combines the answers pixel by pixel.
    pub(crate) fn all(
        answers: &[Outcome],
        assurances: &[Assurance],
        unchecked: &[Outcome],
        truth: &[Outcome],
    ) -> Vec<Self> {
        let checked = answers.iter().zip(assurances).zip(unchecked.iter().zip(truth));
        checked
            .map(|((&answer, &assurance), (&unchecked, &truth))| Checked {
                answer,
                assurance,
                unchecked,
                truth,
            })
            .collect()
    }

    fn is_right(&self) -> bool {
        is_right(&(self.answer, self.truth))
    }

    fn was_wrong(&self) -> bool {
        !is_right(&(self.unchecked, self.truth))
    }

    /// Returns the estimated error in s of a flip that is not marked.
    fn estimate_secs(&self) -> Option<f64> {
        let is_flip = self.answer.status == Status::Answered && !self.is_marked();
        self.assurance.error_secs().filter(|_| is_flip)
    }

    /// Returns the true error in s of a flip's time; infinite if there is no flip in truth.
    fn error_secs(&self) -> f64 {
        match self.truth.status {
            Status::Answered => (self.answer.time - self.truth.time).abs(),
            Status::Unflipped | Status::Forbidden | Status::Failed => f64::INFINITY,
        }
    }

    fn is_marked(&self) -> bool {
        self.assurance.trust() == Trust::Uncertain
    }
}

/// Returns the first config of `level` that the engine offers.
pub(super) fn config_for(
    engine: &dyn Engine,
    level: Accuracy,
) -> Result<IntegratorConfig, ReportError> {
    let offered = level.configs().into_iter().find(|config| engine.offers(config));
    let none =
        || EngineError::Unsupported(format!("it has no configuration for the accuracy {level}"));
    Ok(offered.ok_or_else(none)?)
}

impl Bench<'_> {
    /// Measures the row of the level `exact`, with the results of its checks.
    pub(super) fn exact(&self, backend: &mut Backend) -> Result<Row, ReportError> {
        let config = config_for(backend.engine(), Accuracy::Exact)?;
        let mut row = Row::new(backend, config);
        let mut compared = {
            let mut engine = TrustEngine::new(Box::new(backend.engine()), self.threads)?;
            self.fill(&mut row, &mut engine, least_starts_of_exact(&config))?
        };
        let unchecked = self.run(backend.engine(), config, &compared.starts)?.outcomes;
        self.judge_again(&mut compared, &unchecked);
        let pairs = compared.pairs();
        (row.errors, row.bands) = (Errors::of(&pairs), bands(&pairs));
        let Compared { ran, truth, .. } = &compared;
        row.checks =
            Some(Checks::of(&Checked::all(&ran.outcomes, &ran.assurances, &unchecked, truth)));
        Ok(row)
    }

    /// Asks the gold standard again, in double-double, about every pixel that contradicts it: among
    /// so many starts, it is not always the answer that is wrong.
    fn judge_again(&self, compared: &mut Compared, unchecked: &[Outcome]) {
        let contradicted = contradicted(&compared.pairs(), unchecked, &compared.truth);
        let starts: Vec<[Dd; 2]> = contradicted.iter().map(|&i| compared.starts[i]).collect();
        for (&i, outcome) in contradicted.iter().zip(oracle_dd(&self.test_set.question, &starts)) {
            compared.truth[i] = outcome;
        }
    }
}

/// Indices of the pixels for which either answer contradicts the truth.
fn contradicted(pairs: &[OutcomePair], unchecked: &[Outcome], truth: &[Outcome]) -> Vec<usize> {
    let is_fine = |i: usize| is_right(&pairs[i]) && is_right(&(unchecked[i], truth[i]));
    (0..pairs.len()).filter(|&i| !is_fine(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan;
    use flipmap_engine::cpu::CpuEngine;
    use flipmap_pendulum::Status;

    fn pixel(answer: f64, trust: Trust, unchecked: f64) -> Checked {
        let flip = Outcome::flipped;
        let assurance = Assurance::new(trust, 5e-4);
        Checked { answer: flip(answer), assurance, unchecked: flip(unchecked), truth: flip(7.0) }
    }

    #[test]
    fn a_wrong_pixel_is_corrected_marked_or_an_unmarked_lie() {
        let all = [
            pixel(7.0, Trust::Agreed, 7.0),
            pixel(7.0, Trust::Confirmed, 7.1),
            pixel(7.0, Trust::Settled, 7.1),
            pixel(8.0, Trust::Uncertain, 7.1),
            pixel(7.0, Trust::Uncertain, 7.0),
            pixel(7.002, Trust::Confirmed, 7.002),
            pixel(7.002, Trust::Settled, 7.0),
        ];
        let checks = Checks::of(&all);
        let expected = Checks {
            pixels: 7,
            agreed: 1,
            confirmed: 2,
            settled: 2,
            marked: 2,
            unmarked_wrong: 2,
            unchecked_wrong: 4,
            corrected: 2,
            wrong_but_marked: 1,
            estimated: 5,
            within_estimate: 3,
        };
        assert_eq!(checks, expected);
        assert_eq!((checks.caught(), checks.marked_share()), (3, Some(2.0 / 7.0)));
        assert_eq!(Checks::of(&all[..1]).unmarked_wrong, 0);
        assert_eq!([&all[..3], &all[3..]].map(Checks::of).into_iter().sum::<Checks>(), checks);
        assert_eq!(Checks::default().marked_share(), None);
    }

    #[test]
    fn a_class_for_another_is_wrong_too() {
        let still = Outcome::without_time(Status::Unflipped);
        let lie = Checked { answer: still, ..pixel(7.0, Trust::Agreed, 7.0) };
        assert_eq!(Checks::of(&[lie]).unmarked_wrong, 1);
    }

    #[test]
    fn whoever_contradicts_the_truth_is_judged_again() {
        let flip = Outcome::flipped;
        let truth = [1.0, 2.0, 3.0].map(flip);
        let pairs: Vec<OutcomePair> = [1.0, 2.5, 3.0].map(flip).into_iter().zip(truth).collect();
        assert_eq!(contradicted(&pairs, &[1.0, 2.0, 3.5].map(flip), &truth), [1, 2]);
        assert_eq!(contradicted(&pairs[..1], &truth[..1], &truth[..1]), [0usize; 0]);
    }

    #[test]
    fn the_processor_has_the_first_configuration() {
        let processor = CpuEngine::new(Some(1)).unwrap();
        assert_eq!(config_for(&processor, Accuracy::Exact).unwrap(), plan::BALANCED);
    }
}
