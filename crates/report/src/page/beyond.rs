//! The chapters on windows, late flips and hard cases.

use super::home::CHECKS;
use super::{Block, Column, Table, brief, fold, share, text};
use crate::plan::words;
use crate::{Flips, LateRow, Report};

fn median(flips: &Flips) -> String {
    flips.median_secs.map_or("–".to_string(), |secs| format!("{secs:.1}"))
}

/// The chapter on windows beyond the home map.
pub(super) fn windows(report: &Report) -> Option<Block> {
    let table = Table::of(
        &report.windows,
        &[
            ("window", |row| row.window.clone()),
            ("rule", |row| row.rule.to_string()),
            ("median flip, s", |row| median(&row.flips)),
            ("unflipped", |row| share(row.flips.unflipped)),
            ("right", |row| share(row.errors.right_1ms)),
            ("p99 s", |row| brief(row.errors.p99)),
            ("compared", |row| row.errors.compared.to_string()),
            ("truth", |row| row.judge.to_string()),
            ("engine", |row| format!("{}: {}", row.engine, words(&row.config))),
            ("middle and width", |row| row.place.clone()),
        ],
    );
    let about = "The accuracy balanced on open starts of windows, 30 s. The truth is the gold \
                 standard in f64, or, where flips are late or starts so close together that f64 \
                 is not above suspicion, Taylor expansions in double-double.";
    fold("Windows beyond the home map", vec![text(about), Block::Table(table)])
}

const LATE: [Column<LateRow>; 3] = [
    ("window", |row| row.window.clone()),
    ("median flip, s", |row| median(&row.flips)),
    ("unflipped", |row| share(row.flips.unflipped)),
];

const GOLD: [Column<LateRow>; 3] = [
    ("gold asked", |row| row.oracle_asked.to_string()),
    ("gold disagrees", |row| row.oracle_disagrees.to_string()),
    ("middle and width", |row| row.place.clone()),
];

/// The chapter on late flips.
pub(super) fn late(report: &Report) -> Option<Block> {
    let total = LateRow {
        window: "all".to_string(),
        place: String::new(),
        engine: String::new(),
        flips: Flips { unflipped: None, median_secs: None },
        checks: report.late.iter().map(|row| row.checks).sum(),
        oracle_asked: report.late.iter().map(|row| row.oracle_asked).sum(),
        oracle_disagrees: report.late.iter().map(|row| row.oracle_disagrees).sum(),
    };
    let rows = || report.late.iter().chain((!report.late.is_empty()).then_some(&total));
    let table = Table::of(rows(), &LATE)
        .beside(Table::of(rows().map(|row| &row.checks), &CHECKS))
        .beside(Table::of(rows(), &GOLD));
    fold("Exact beside double-double", vec![text(ABOUT_LATE), Block::Table(table)])
}

const ABOUT_LATE: &str = "Windows of late flips, where chaos has amplified every rounding. The truth is Taylor \
     expansions in double-double at a tolerance of 1e-28. Exact itself uses expansions in \
     double-double for the few pixels that get so far (settled), but at 1e-25 with other steps; \
     all other pixels it decides without, by DOP853 in f64 checked by DOPRI5 in f32 or by Taylor \
     expansions in f64, so that for these the comparison is with an independent method and twice \
     the digits. To tie that truth to the gold standard, the gold standard, another formulation \
     (angles instead of unit vectors) with passes of the top proved by bounds, is asked in \
     double-double about some of the same starts.";

/// The chapter on hard cases.
pub(super) fn hard(report: &Report) -> Option<Block> {
    let table = Table::of(
        &report.hard,
        &[
            ("case", |row| row.case.to_string()),
            ("engine", |row| row.engine.clone()),
            ("held", |row| if row.held { "yes" } else { "NO" }.to_string()),
            ("expected", |row| row.expected.to_string()),
            ("measured", |row| row.measured.clone()),
            ("why", |row| row.why.to_string()),
        ],
    );
    fold("Hard cases", vec![Block::Table(table)])
}
