//! The truth that answers are compared with: the gold standard or, where that would take too long
//! or f64 is not above suspicion, expansions in double-double.

use rayon::prelude::*;

use super::{ReportError, StopTest, stopwatch};
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::{EventSpec, IntegratorConfig, Method, Precision};
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::{Outcome, oracle};

/// The config with the finest steps of double-double, which decides late and narrow windows.
pub(crate) const FINEST: IntegratorConfig =
    IntegratorConfig { method: Method::Taylor { tolerance: 1e-28 }, precision: Precision::Dd };

/// The gold standard's outcomes in double-double, times as f64.
pub(crate) fn oracle_dd(question: &EventSpec, starts: &[[Dd; 2]]) -> Vec<Outcome> {
    solve(question, starts, |theta| theta)
}

/// The gold standard's outcomes in f64.
pub(crate) fn oracle_f64(question: &EventSpec, starts: &[[Dd; 2]]) -> Vec<Outcome> {
    solve(question, starts, |theta| theta.hi)
}

fn solve<T: Scalar>(
    question: &EventSpec,
    starts: &[[Dd; 2]],
    as_scalar: fn(Dd) -> T,
) -> Vec<Outcome> {
    let pendulum = question.build.pendulum_in();
    let one = |start: &[Dd; 2]| {
        let budget = T::from_f64(question.budget_secs);
        let outcome = oracle::outcome(&pendulum, start.map(as_scalar), question.rule, budget);
        Outcome { status: outcome.status, time: outcome.time.to_f64() }
    };
    starts.par_iter().map(one).collect()
}

/// The processor's answers by [`FINEST`], in the order of the starts.
pub(crate) fn finest(
    question: &EventSpec,
    starts: &[[Dd; 2]],
    threads: Option<usize>,
    stop: StopTest,
) -> Result<Vec<Outcome>, ReportError> {
    let mut engine = CpuEngine::new(threads)?;
    Ok(stopwatch::run(&mut engine, question, FINEST, starts, stop)?.outcomes)
}
