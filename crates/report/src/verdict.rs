//! The verdict with which a report opens: one sentence on speed, and one on what is wrong.

use super::levels::rows_at;
use super::page::{share, short};
use super::{Checks, HardRow, Report};
use flipmap_engine::Accuracy;

/// The verdict on what was measured so far.
pub(super) fn verdict(report: &Report) -> String {
    format!("{} {}", speed(report), wrong(report))
}

/// Returns the sentence on the speed and accuracy of the most useful level that was measured.
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
        "On this machine, {level} takes {} µs per pixel ({}), and {} of the {} pixels compared are \
         right: they flip within 1 ms of the true time, or truly not within 30 s.",
        short(row.us_per_pixel),
        row.short_name(),
        share(row.errors.right_1ms),
        row.errors.compared
    )
}

/// Returns the sentence on wrong pixels and the checks that find them.
fn wrong(report: &Report) -> String {
    let parts: Vec<String> =
        [window(report), checks(report), hard(&report.hard)].into_iter().flatten().collect();
    match parts.split_last() {
        None => "No windows, checks or hard cases were measured.".to_string(),
        Some((last, [])) => format!("In further tests, {last}."),
        Some((last, others)) => format!("In further tests, {}, and {last}.", others.join("; ")),
    }
}

fn window(report: &Report) -> Option<String> {
    let right = report.windows.iter().filter_map(|row| Some((row.errors.right_1ms?, &row.window)));
    let (right, name) = right.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let count = report.windows.len();
    Some(format!(
        "“{name}” is the least accurate of {count} windows ({} right)",
        share(Some(right))
    ))
}

fn checks(report: &Report) -> Option<String> {
    let home = report.exact.iter().filter_map(|row| row.checks);
    let all: Checks = home.chain(report.late.iter().map(|row| row.checks)).sum();
    let found = match (all.unchecked_wrong, all.unmarked_wrong) {
        (0, 0) => "found no wrong pixel".to_string(),
        (0, n) => format!("left {n} wrong pixels UNMARKED"),
        (wrong, 0) => format!("found {} of {wrong} wrong pixels", all.caught()),
        (wrong, n) => format!("found {} of {wrong} wrong pixels, left {n} UNMARKED", all.caught()),
    };
    let sentence = format!("exact, which checks every pixel, {found} among {} answers", all.pixels);
    (all.pixels > 0).then_some(sentence)
}

fn hard(rows: &[HardRow]) -> Option<String> {
    let failed = rows.iter().filter(|row| !row.held);
    let failed: Vec<String> =
        failed.map(|row| format!("“{}” on {}", row.case, row.engine)).collect();
    let held = rows.len() - failed.len();
    let names =
        if failed.is_empty() { String::new() } else { format!(", NOT {}", failed.join(", ")) };
    let sentence = format!("{held} of {} hard cases came out as expected{names}", rows.len());
    (!rows.is_empty()).then_some(sentence)
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
            "On this machine, balanced takes 6.00 µs per pixel (cpu), and ",
            "66.667 % of the 3 pixels",
            "“filigree” is the least accurate of 1 windows (66.667 % right)",
            "found no wrong pixel among 13 answers, and 1 of 1 hard cases",
        ] {
            assert!(text.contains(words), "{words}: {text}");
        }
        report.hard[0].held = false;
        let checks = report.exact[0].checks.as_mut().unwrap();
        (checks.unchecked_wrong, checks.corrected) = (5, 3);
        assert!(verdict(&report).contains("found 3 of 5 wrong pixels among 13 answers"));
        report.exact[0].checks.as_mut().unwrap().unmarked_wrong = 2;
        let text = verdict(&report);
        assert!(
            text.contains("left 2 UNMARKED") && text.contains("NOT “made up” on cpu"),
            "{text}"
        );
    }

    #[test]
    fn the_verdict_falls_back_on_what_there_is() {
        let mut report = fixtures::report();
        report.rows.retain(|row| row.config == plan::LESSON);
        assert!(verdict(&report).contains("On this machine, lesson"));
        let none = verdict(&Report::default());
        assert!(
            none.contains("speed of the accuracy levels was not") && none.contains("No windows")
        );
    }
}
