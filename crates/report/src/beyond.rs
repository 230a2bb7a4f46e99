//! Measurements in windows: `balanced` against the truth, and `exact` where flips come late.

use serde::Serialize;

use super::backend::Backend;
use super::exact::{Checked, Checks, config_for};
use super::hard::apart;
use super::measure::Bench;
use super::statistics::{Errors, RIGHT_SECS, median};
use super::test_set::spread;
use super::truth::{finest, oracle_dd};
use super::windows::Window;
use super::{ReportError, as_words, stopwatch};
use flipmap_engine::trust::TrustEngine;
use flipmap_engine::{Accuracy, IntegratorConfig};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Rule, Status};

/// A window, and the errors of `balanced` in it.
#[derive(Clone, Debug, Serialize)]
pub struct WindowRow {
    /// Name of the window.
    pub window: String,
    /// Centre and width of the window, in words.
    pub place: String,
    /// The bob or bobs that are watched.
    pub rule: Rule,
    /// Short name of the engine that answered.
    pub engine: String,
    /// The integrator config of the answers.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// The truth that the answers were compared with, in words.
    pub judge: &'static str,
    /// Errors of the answers.
    #[serde(flatten)]
    pub errors: Errors,
    /// Flip times of the window's starts.
    #[serde(flatten)]
    pub flips: Flips,
    /// The share of right pixels that is promised.
    pub least_right: f64,
}

/// A window of late flips, and the results of checking in it.
#[derive(Clone, Debug, Serialize)]
pub struct LateRow {
    /// Name of the window.
    pub window: String,
    /// Centre and width of the window, in words.
    pub place: String,
    /// Short name of the engine that answered.
    pub engine: String,
    /// Flip times of the window's starts.
    #[serde(flatten)]
    pub flips: Flips,
    /// Results of the checks.
    pub checks: Checks,
    /// Number of starts that the gold standard answered as well.
    pub oracle_asked: usize,
    /// Number of those on which it disagrees with the truth used here.
    pub oracle_disagrees: usize,
}

/// Statistics of the true flip times.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Flips {
    /// Share of starts that do not flip within the budget.
    pub unflipped: Option<f64>,
    /// Median flip time of the others, s.
    pub median_secs: Option<f64>,
}

impl Flips {
    fn of(truth: &[Outcome]) -> Self {
        let times: Vec<f64> = truth
            .iter()
            .filter(|outcome| outcome.status == Status::Answered)
            .map(|outcome| outcome.time)
            .collect();
        let unflipped = (truth.len() - times.len()) as f64 / truth.len() as f64;
        Flips { unflipped: (!truth.is_empty()).then_some(unflipped), median_secs: median(&times) }
    }
}

impl Bench<'_> {
    /// Measures `balanced` in a window.
    pub(super) fn window(
        &self,
        window: &Window,
        backend: &mut Backend,
    ) -> Result<WindowRow, ReportError> {
        let config = config_for(backend.engine(), Accuracy::Balanced)?;
        self.window_with(window, backend, config)
    }

    fn window_with(
        &self,
        window: &Window,
        backend: &mut Backend,
        config: IntegratorConfig,
    ) -> Result<WindowRow, ReportError> {
        let starts = window.starts(self.care.window_starts);
        let truth = window.truth(&starts, self.threads, self.stop)?;
        let ran = stopwatch::run(backend.engine(), &window.question(), config, &starts, self.stop)?;
        let flips = Flips::of(&truth);
        let pairs: Vec<_> = ran.outcomes.into_iter().zip(truth).collect();
        Ok(WindowRow {
            window: window.name.to_string(),
            place: window.place(),
            rule: window.rule,
            engine: backend.short_name(),
            config,
            judge: window.judge.words(),
            errors: Errors::of(&pairs),
            flips,
            least_right: window.least_right(),
        })
    }

    /// Measures `exact` in a window of late flips, against double-double.
    pub(super) fn late(
        &self,
        window: &Window,
        backend: &mut Backend,
    ) -> Result<LateRow, ReportError> {
        let config = config_for(backend.engine(), Accuracy::Exact)?;
        let (question, starts) = (window.question(), window.starts(self.care.late_starts));
        let truth = finest(&question, &starts, self.threads, self.stop)?;
        let checked = {
            let mut engine = TrustEngine::new(Box::new(backend.engine()), self.threads)?;
            stopwatch::run(&mut engine, &question, config, &starts, self.stop)?
        };
        let unchecked =
            stopwatch::run(backend.engine(), &question, config, &starts, self.stop)?.outcomes;
        let pixels = Checked::all(&checked.outcomes, &checked.assurances, &unchecked, &truth);
        let pairs: Vec<([Dd; 2], Outcome)> =
            starts.into_iter().zip(truth.iter().copied()).collect();
        let (asked, truth_of_them): (Vec<_>, Vec<_>) =
            spread(&pairs, self.care.oracle_starts).into_iter().unzip();
        let gold = oracle_dd(&question, &asked);
        Ok(LateRow {
            window: window.name.to_string(),
            place: window.place(),
            engine: backend.short_name(),
            flips: Flips::of(&truth),
            checks: Checks::of(&pixels),
            oracle_asked: asked.len(),
            oracle_disagrees: disagreements(&gold, &truth_of_them),
        })
    }
}

/// Number of outcomes that are further apart than [`RIGHT_SECS`].
fn disagreements(a: &[Outcome], b: &[Outcome]) -> usize {
    a.iter().zip(b).filter(|(a, b)| apart(a, b) > RIGHT_SECS).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::windows::{LATE, WINDOWS};
    use crate::{TestSet, Thoroughness, plan};

    const FEW: Thoroughness = Thoroughness {
        window_starts: 100,
        late_starts: 60,
        oracle_starts: 2,
        ..Thoroughness::QUICK
    };

    fn with_bench<T>(measure: impl Fn(&Bench, &mut Backend) -> T) -> T {
        let test_set = TestSet::home(0, &|| false).unwrap();
        let bench = Bench { test_set: &test_set, care: &FEW, threads: Some(2), stop: &|| false };
        measure(&bench, &mut Backend::processor(Some(2)).unwrap())
    }

    #[test]
    fn a_window_tells_balanced_from_the_lesson() {
        let window = WINDOWS.iter().find(|window| window.name == "filigree").unwrap();
        with_bench(|bench, backend| {
            let right = |row: WindowRow| row.errors.right_1ms.unwrap();
            let row = bench.window(window, backend).unwrap();
            assert_eq!((row.errors.compared, row.config), (100, plan::BALANCED));
            assert!(right(row) >= window.least_right());
            let lesson = bench.window_with(window, backend, plan::LESSON).unwrap();
            assert!(right(lesson) < window.least_right());
        });
    }

    #[test]
    fn late_flips_are_right_or_marked() {
        let row = with_bench(|bench, backend| bench.late(&LATE[0], backend).unwrap());
        assert_eq!((row.checks.pixels, row.checks.unmarked_wrong), (60, 0));
        assert_eq!((row.oracle_asked, row.oracle_disagrees), (2, 0));
        assert!(row.flips.median_secs.unwrap() > 3.0);
    }

    #[test]
    fn the_gold_standard_may_disagree() {
        let flip = Outcome::flipped;
        let still = Outcome::without_time(Status::Unflipped);
        let found = [flip(1.0), flip(2.0), still, still];
        assert_eq!(disagreements(&found, &[flip(1.0005), flip(2.002), still, flip(3.0)]), 2);
        assert_eq!(Flips::of(&found), Flips { unflipped: Some(0.5), median_secs: Some(1.0) });
    }
}
