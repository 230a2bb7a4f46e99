//! The chapters on accuracy levels, windows, late flips and hard cases.

use super::levels::{rows_at, rows_with};
use super::pages::{Block, Section, Table, brief, section, share, short};
use super::plan::{self, BALANCED, BALANCED_DF32};
use super::{Checks, Flips, Report, Row};
use flipmap_engine::Accuracy;

/// The chapter on the accuracy levels, or `None` while no level has a row.
pub(super) fn levels(report: &Report) -> Option<Section> {
    let levels = level_table(report);
    if levels.rows.is_empty() {
        return None;
    }
    let mut blocks = vec![Block::Table(levels)];
    if !report.exact.is_empty() {
        blocks.push(Block::Text(ABOUT_EXACT.to_string()));
        blocks.push(Block::Table(exact_table(report)));
    }
    let forced = forced_table(report);
    if !forced.rows.is_empty() {
        blocks.push(Block::Table(forced));
    }
    Some(section("Accuracy levels", blocks))
}

const ABOUT_EXACT: &str = "Exact checks every pixel. Where its answer, or that of the same configuration without checks, \
     contradicts the gold standard in f64, the gold standard in double-double decides who is \
     wrong. Wrong without checks are the pixels that the configuration alone has wrong; of these, caught \
     are those that checking corrected or marked.";

fn level_table(report: &Report) -> Table {
    let head =
        ["level", "engine", "method", "µs/pixel", "± spread", "× scalar", "right", "compared"];
    let line = |word: &str, row: &Row| {
        vec![
            word.to_string(),
            row.short_name(),
            plan::words(&row.config),
            short(row.us_per_pixel),
            format!("{:.0} %", 100.0 * row.spread),
            format!("{:.1}", row.times_scalar),
            share(row.errors.right_1ms),
            row.errors.compared.to_string(),
        ]
    };
    let of_level = |(word, level): (&'static str, Accuracy)| {
        rows_at(report, level).into_iter().map(move |row| line(word, row))
    };
    Table::new("", &head, Accuracy::ALL.into_iter().flat_map(of_level).collect())
}

/// Columns of [`check_cells`].
const CHECK_HEAD: [&str; 9] = [
    "pixels",
    "agreed",
    "confirmed",
    "settled",
    "marked",
    "marked share",
    "wrong unmarked",
    "wrong without checks",
    "caught",
];

fn check_cells(checks: &Checks) -> Vec<String> {
    let counts = [checks.pixels, checks.agreed, checks.confirmed, checks.settled, checks.marked];
    let mut cells: Vec<String> = counts.iter().map(ToString::to_string).collect();
    cells.push(share(checks.marked_share()));
    let counts = [checks.unmarked_wrong, checks.unchecked_wrong, checks.caught()];
    cells.extend(counts.iter().map(ToString::to_string));
    cells
}

fn exact_table(report: &Report) -> Table {
    let head = [&["engine"][..], &CHECK_HEAD].concat();
    let rows = report.exact.iter().filter_map(|row| {
        let cells = check_cells(row.checks.as_ref()?);
        Some([vec![row.short_name()], cells].concat())
    });
    Table::new("Exact: pixels by trust", &head, rows.collect())
}

/// The table of balanced in df32 beside balanced in f64, on the adapters that have both.
fn forced_table(report: &Report) -> Table {
    let head = ["engine", "f64, µs/pixel", "df32, µs/pixel", "times slower", "right in df32"];
    let in_f64 = rows_with(report, BALANCED);
    let rows = rows_with(report, BALANCED_DF32).into_iter().map(|forced| {
        let beside = in_f64.iter().find(|row| row.full_name() == forced.full_name());
        // From multiples of the scalar loop, which withstand what disturbs a shared machine.
        let slower = beside.map(|row| row.times_scalar / forced.times_scalar);
        vec![
            forced.short_name(),
            beside.map_or("–".to_string(), |row| short(row.us_per_pixel)),
            short(forced.us_per_pixel),
            slower.map_or("–".to_string(), |ratio| format!("{ratio:.2}")),
            share(forced.errors.right_1ms),
        ]
    });
    Table::new("Balanced forced to df32", &head, rows.collect())
}

/// The chapters on hard windows and cases.
pub(super) fn beyond(report: &Report) -> Vec<Section> {
    [windows(report), late(report), hard(report)].into_iter().flatten().collect()
}

fn flip_cells(flips: &Flips) -> [String; 2] {
    let median = flips.median_secs.map_or("–".to_string(), |secs| format!("{secs:.1}"));
    [share(flips.unflipped), median]
}

fn windows(report: &Report) -> Option<Section> {
    let head = [
        "window",
        "rule",
        "median flip, s",
        "unflipped",
        "right",
        "hoped for",
        "p99 s",
        "compared",
        "truth",
        "engine",
        "middle and width",
    ];
    let rows = report.windows.iter().map(|row| {
        let [unflipped, median] = flip_cells(&row.flips);
        vec![
            row.window.clone(),
            row.rule.to_string(),
            median,
            unflipped,
            share(row.errors.right_1ms),
            format!("≥ {}", row.least_right),
            brief(row.errors.p99),
            row.errors.compared.to_string(),
            row.judge.to_string(),
            format!("{}: {}", row.engine, plan::words(&row.config)),
            row.place.clone(),
        ]
    });
    let table = Table::new("", &head, rows.collect());
    let text = "The accuracy balanced on open starts of windows, 30 s. The truth is the gold \
                standard in f64, or, where flips are late or starts so close together that f64 \
                is not above suspicion, Taylor expansions in double-double.";
    let blocks = vec![Block::Text(text.to_string()), Block::Table(table)];
    (!report.windows.is_empty()).then(|| section("Windows", blocks))
}

fn late(report: &Report) -> Option<Section> {
    let flips = ["window", "median flip, s", "unflipped"];
    let gold = ["gold asked", "gold disagrees", "middle and width"];
    let head = [&flips[..], &CHECK_HEAD, &gold].concat();
    let line = |name: &str, flips: [String; 2], checks: &Checks, rest: [String; 3]| {
        let [unflipped, median] = flips;
        [vec![name.to_string(), median, unflipped], check_cells(checks), rest.to_vec()].concat()
    };
    let mut rows: Vec<Vec<String>> = report
        .late
        .iter()
        .map(|row| {
            let rest =
                [row.oracle_asked.to_string(), row.oracle_disagrees.to_string(), row.place.clone()];
            line(&row.window, flip_cells(&row.flips), &row.checks, rest)
        })
        .collect();
    let total: Checks = report.late.iter().map(|row| row.checks).sum();
    let sum = |count: fn(&super::LateRow) -> usize| {
        report.late.iter().map(count).sum::<usize>().to_string()
    };
    let rest = [sum(|row| row.oracle_asked), sum(|row| row.oracle_disagrees), String::new()];
    let dash = || "–".to_string();
    rows.push(line("all", [dash(), dash()], &total, rest));
    let blocks =
        vec![Block::Text(ABOUT_LATE.to_string()), Block::Table(Table::new("", &head, rows))];
    (!report.late.is_empty()).then(|| section("Exact beside double-double", blocks))
}

const ABOUT_LATE: &str = "Windows of late flips, where chaos has amplified every rounding. The truth is Taylor \
     expansions in double-double at a tolerance of 1e-28. Exact itself uses expansions in \
     double-double for the few pixels that get so far (settled), but at 1e-25 with other steps; \
     all other pixels it decides without, by DOP853 in f64 checked by DOPRI5 in f32 or by Taylor \
     expansions in f64, so that for these the comparison is with an independent method and twice \
     the digits. To tie that truth to the gold standard, the gold standard, another formulation \
     (angles instead of unit vectors) with passes of the top proved by bounds, is asked in \
     double-double about some of the same starts.";

fn hard(report: &Report) -> Option<Section> {
    let head = ["case", "engine", "expected", "measured", "held", "why"];
    let rows = report.hard.iter().map(|row| {
        let held = if row.held { "yes" } else { "NO" };
        let cells = [row.case, &row.engine, row.expected, &row.measured, held, row.why];
        cells.map(str::to_string).to_vec()
    });
    let table = Table::new("", &head, rows.collect());
    (!report.hard.is_empty()).then(|| section("Hard cases", vec![Block::Table(table)]))
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;

    fn table(section: &Section) -> &Table {
        let is_table = |block: &&Block| matches!(block, Block::Table(_));
        let Some(Block::Table(table)) = section.blocks.iter().rfind(is_table) else {
            panic!("{} has no table", section.title);
        };
        table
    }

    #[test]
    fn every_measurement_is_in_a_line_as_long_as_its_head() {
        let mut report = fixtures::report();
        report.hard[0].held = false;
        let mut forced = report.rows[0].clone();
        forced.config = BALANCED_DF32;
        report.rows.push(forced);
        let sections = [vec![levels(&report).unwrap()], beyond(&report)].concat();
        let titles: Vec<&str> = sections.iter().map(|section| section.title.as_str()).collect();
        let expected = ["Accuracy levels", "Windows", "Exact beside double-double", "Hard cases"];
        assert_eq!(titles, expected);
        for block in sections.iter().flat_map(|section| &section.blocks) {
            if let Block::Table(table) = block {
                assert!(table.rows.iter().all(|row| row.len() == table.head.len()));
            }
        }
        let counts: Vec<usize> = sections.iter().map(|section| table(section).rows.len()).collect();
        assert_eq!(counts, [1, 1, 2, 1]);
        assert!(table(&sections[3]).rows[0].contains(&"NO".to_string()));
    }

    #[test]
    fn there_is_no_chapter_on_nothing() {
        let mut report = fixtures::report();
        (report.windows, report.late, report.hard) = Default::default();
        (report.rows, report.exact) = Default::default();
        assert!(levels(&report).is_none() && beyond(&report).is_empty());
    }
}
