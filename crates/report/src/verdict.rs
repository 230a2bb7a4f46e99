//! The verdict with which a report opens: one sentence on speed, and one on what is wrong.

use super::levels::rows_at;
use super::page::{share, short};
use super::{Checks, HardRow, Report};
use flipmap_engine::Accuracy;

/// The verdict on what was measured so far.
pub(super) fn verdict(report: &Report) -> String {
    format!("{} {}", speed(report), wrong(report))
}

/// How fast the machine is at the level to prefer, and how right.
fn speed(report: &Report) -> String {
    let preferred = [Accuracy::Balanced, Accuracy::Fast, Accuracy::Lesson, Accuracy::Exact];
    let fastest = preferred.into_iter().find_map(|level| {
        let rows = rows_at(report, level).into_iter();
        let row = rows.min_by(|a, b| a.us_per_pixel.total_cmp(&b.us_per_pixel))?;
        Some((level, row))
    });
    let Some((level, row)) = fastest else {
        return "The speed of the accuracy levels was not measured.".to_string();
    };
    format!(
        "At the accuracy {level} this machine takes {} µs per pixel ({}); {} of the {} pixels \
         compared are right: they flip within 1 ms of the truth, or rightly not within 30 s.",
        short(row.us_per_pixel),
        row.short_name(),
        share(row.errors.right_1ms),
        row.errors.compared
    )
}

/// What is not right, and what finds it.
fn wrong(report: &Report) -> String {
    let parts: Vec<String> =
        [window(report), checks(report), hard(&report.hard)].into_iter().flatten().collect();
    match parts.split_last() {
        None => "What is wrong, and what finds it, was not measured.".to_string(),
        Some((last, [])) => format!("Elsewhere, {last}."),
        Some((last, others)) => format!("Elsewhere, {}, and {last}.", others.join("; ")),
    }
}

fn window(report: &Report) -> Option<String> {
    let right = report.windows.iter().filter_map(|row| Some((row.errors.right_1ms?, &row.window)));
    let (right, name) = right.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let count = report.windows.len();
    Some(format!("of {count} windows “{name}” is the least right, {}", share(Some(right))))
}

fn checks(report: &Report) -> Option<String> {
    let home = report.exact.iter().filter_map(|row| row.checks);
    let all: Checks = home.chain(report.late.iter().map(|row| row.checks)).sum();
    let found = match (all.unchecked_wrong, all.unmarked_wrong) {
        (0, 0) => "had no wrong one to find".to_string(),
        (wrong, 0) => format!("finds {} of {wrong} wrong ones", all.caught()),
        (wrong, n) => format!("finds {} of {wrong} wrong ones, leaves {n} UNMARKED", all.caught()),
    };
    let told = format!(
        "the accuracy exact, which checks every pixel, {found} among {} pixels",
        all.pixels
    );
    (all.pixels > 0).then_some(told)
}

fn hard(rows: &[HardRow]) -> Option<String> {
    let failed = rows.iter().filter(|row| !row.held);
    let failed: Vec<String> =
        failed.map(|row| format!("“{}” on {}", row.case, row.engine)).collect();
    let held = rows.len() - failed.len();
    let told = format!("{held} of {} hard cases come out as expected", rows.len());
    let told = if failed.is_empty() { told } else { format!("{told}, NOT {}", failed.join(", ")) };
    (!rows.is_empty()).then_some(told)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{fixtures, plan};

    #[test]
    fn the_verdict_tells_the_speed_and_names_what_failed() {
        let mut report = fixtures::report();
        let text = verdict(&report);
        for words in [
            "accuracy balanced this machine takes 6.00 µs per pixel (cpu); ",
            "66.667 % of the 3 pixels",
            "of 1 windows “filigree” is the least right, 66.667 %",
            "had no wrong one to find among 13 pixels, and 1 of 1 hard cases",
        ] {
            assert!(text.contains(words), "{words}: {text}");
        }
        report.hard[0].held = false;
        let checks = report.exact[0].checks.as_mut().unwrap();
        (checks.unchecked_wrong, checks.corrected) = (5, 3);
        assert!(verdict(&report).contains("finds 3 of 5 wrong ones among 13 pixels"));
        report.exact[0].checks.as_mut().unwrap().unmarked_wrong = 2;
        let text = verdict(&report);
        assert!(
            text.contains("leaves 2 UNMARKED") && text.contains("NOT “made up” on cpu"),
            "{text}"
        );
    }

    #[test]
    fn the_verdict_falls_back_on_what_there_is() {
        let mut report = fixtures::report();
        report.rows.retain(|row| row.config == plan::LESSON);
        assert!(verdict(&report).contains("At the accuracy lesson"));
        let none = verdict(&Report::default());
        assert!(
            none.contains("speed of the accuracy levels was not") && none.contains("What is wrong")
        );
    }
}
