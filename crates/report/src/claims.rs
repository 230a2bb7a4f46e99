//! What flipmap claims about its answers, beside what was measured.

use serde::Serialize;

use super::{Checks, Report, Row};

/// A claim and its result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// Quantity that the claim is about, and its engine.
    pub name: String,
    /// The value that it has if the claim holds, in words.
    #[serde(rename = "target")]
    pub promised: String,
    /// Measured value.
    pub measured: f64,
    /// True if the claim holds.
    pub met: bool,
}

impl Claim {
    fn new(name: String, promised: &str, measured: f64, value: f64) -> Self {
        Claim { name, promised: promised.to_string(), measured, met: measured == value }
    }
}

/// The claims about everything that was measured: the accuracy `exact` leaves no wrong pixel
/// unmarked, and every hard case comes out as expected.
pub(super) fn claims(report: &Report) -> Vec<Claim> {
    let exact = |row: &Row| {
        let name = format!("exact: wrong pixels that are not marked, on {}", row.short_name());
        Some(Claim::new(name, "none", row.checks?.unmarked_wrong as f64, 0.0))
    };
    let mut claims: Vec<Claim> = report.exact.iter().filter_map(exact).collect();
    let late: Checks = report.late.iter().map(|row| row.checks).sum();
    if late.pixels > 0 {
        let name = "exact beside double-double, late flips: wrong pixels that are not marked";
        claims.push(Claim::new(name.to_string(), "none", late.unmarked_wrong as f64, 0.0));
    }
    for rows in report.hard.chunk_by(|a, b| a.engine == b.engine) {
        let name = format!("hard cases: share as expected, on {}", rows[0].engine);
        let held = rows.iter().filter(|row| row.held).count() as f64;
        claims.push(Claim::new(name, "all", held / rows.len() as f64, 1.0));
    }
    claims
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures;

    #[test]
    fn each_claim_can_fail_and_none_is_made_without_a_measurement() {
        let mut report = fixtures::report();
        let held = |report: &Report| claims(report).iter().map(|c| c.met).collect::<Vec<_>>();
        assert_eq!(held(&report), [true; 3]);
        report.late[0].checks.unmarked_wrong = 1;
        assert_eq!(held(&report), [true, false, true]);
        report.hard[0].held = false;
        report.exact[0].checks.as_mut().unwrap().unmarked_wrong = 1;
        assert_eq!(held(&report), [false; 3]);
        assert_eq!(held(&Report::default()), [false; 0]);
    }
}
