//! The chapters on the home map: levels, methods, the motion, and kernels made for their scene.

use super::plot::{Plot, Series};
use super::{Block, Column, Table, brief, fold, share, short, text};
use crate::backend::short_name;
use crate::levels::rows_at;
use crate::motion::TIMES_SECS;
use crate::plan::words;
use crate::{Checks, Errors, MotionError, Report, Row};
use flipmap_engine::{Accuracy, EngineKind};

const ABOUT_EXACT: &str = "Exact checks every pixel. Where its answer, or that of the same configuration without checks, \
     contradicts the gold standard in f64, the gold standard in double-double decides who is \
     wrong. Wrong without checks are the pixels that the configuration alone has wrong; of these, caught \
     are those that checking corrected or marked.";

const SPEED: [Column<Row>; 5] = [
    ("method", |row| words(&row.config)),
    ("µs/pixel", |row| short(row.us_per_pixel)),
    ("± spread", |row| format!("{:.0} %", 100.0 * row.spread)),
    ("× scalar", |row| format!("{:.1}", row.times_scalar)),
    ("right", |row| share(row.errors.right_1ms)),
];

const ERRORS: [Column<Row>; 9] = [
    ("wrong class", |row| share(row.errors.wrong_class)),
    ("median s", |row| brief(row.errors.median)),
    ("p90 s", |row| brief(row.errors.p90)),
    ("p99 s", |row| brief(row.errors.p99)),
    ("max s", |row| brief(row.errors.max)),
    ("RHS", |row| format!("{:.0}", row.rhs_per_pixel)),
    ("steps", |row| format!("{:.0}", row.steps_per_pixel)),
    ("lane use", |row| format!("{:.2}", row.lane_use)),
    ("compared", |row| row.errors.compared.to_string()),
];

/// Columns of what checking does.
pub(super) const CHECKS: [Column<Checks>; 10] = [
    ("pixels", |checks| checks.pixels.to_string()),
    ("agreed", |checks| checks.agreed.to_string()),
    ("confirmed", |checks| checks.confirmed.to_string()),
    ("settled", |checks| checks.settled.to_string()),
    ("marked", |checks| checks.marked.to_string()),
    ("marked share", |checks| share(checks.marked_share())),
    ("wrong unmarked", |checks| checks.unmarked_wrong.to_string()),
    ("wrong without checks", |checks| checks.unchecked_wrong.to_string()),
    ("caught", |checks| checks.caught().to_string()),
    ("error within its estimate", |checks| share(checks.within_estimate_share())),
];

/// The rows of all levels, each with the level's name.
fn levels_of(report: &Report) -> Vec<(&'static str, &Row)> {
    let of_level = |(name, level)| rows_at(report, level).into_iter().map(move |row| (name, row));
    Accuracy::ALL.into_iter().flat_map(of_level).collect()
}

/// The plot of every engine and method, with the names of the levels.
pub(super) fn plot(report: &Report) -> Block {
    let point = |row: &Row| {
        let wrong = 1.0 - row.errors.right_1ms?;
        Some((row.short_name(), row.config, [row.us_per_pixel, wrong]))
    };
    let mut series = Series::by_method(report.rows.iter().filter_map(point));
    // One name for each level, where it is fastest: more would cover each other.
    for rows in levels_of(report).chunk_by(|a, b| a.0 == b.0) {
        let fastest = rows.iter().min_by(|a, b| a.1.us_per_pixel.total_cmp(&b.1.us_per_pixel));
        let named = fastest.and_then(|(name, row)| Some(Series::named(point(row)?, name)));
        series.extend(named);
    }
    let caption = "Time of a pixel and share of pixels not right: every engine and method";
    let plot = Plot { across: "µs per pixel", up: "share not right", series };
    Block::Plot(caption.to_string(), plot)
}

/// Returns a count as it is, and a share with four decimals.
fn rounded(value: f64) -> String {
    if value.fract() == 0.0 { value.to_string() } else { format!("{value:.4}") }
}

/// The chapter on accuracy levels.
pub(super) fn levels(report: &Report) -> Option<Block> {
    let levels = levels_of(report);
    let rows = || levels.iter().map(|(_, row)| *row);
    let names: [Column<(&str, &Row)>; 2] =
        [("level", |(name, _)| name.to_string()), ("engine", |(_, row)| row.short_name())];
    let table = Table::of(&levels, &names)
        .beside(Table::of(rows(), &SPEED))
        .beside(Table::of(rows(), &ERRORS[8..]));
    let claims = Table::of(
        &report.claims,
        &[
            ("what holds", |claim| claim.name.clone()),
            ("promised", |claim| claim.promised.clone()),
            ("measured", |claim| rounded(claim.measured)),
            ("holds", |claim| if claim.met { "yes" } else { "NO" }.to_string()),
        ],
    );
    let checked: Vec<&Row> = report.exact.iter().filter(|row| row.checks.is_some()).collect();
    let checks = Table::of(checked.iter().copied(), &[("engine", Row::short_name)])
        .beside(Table::of(checked.iter().filter_map(|row| row.checks.as_ref()), &CHECKS));
    let mut blocks = vec![Block::Table(table), checks.named("Exact: pixels by trust")];
    if !checked.is_empty() {
        blocks.push(text(ABOUT_EXACT));
    }
    blocks.push(Block::Table(claims));
    fold("Accuracy levels", blocks)
}

type CellText = fn(&Errors) -> String;

const BY_BAND: [(&str, CellText); 5] = [
    ("Share right within 1 ms, by true flip time", |errors| share(errors.right_1ms)),
    ("Share in the wrong class, by true flip time", |errors| share(errors.wrong_class)),
    ("Median error in s, by true flip time", |errors| brief(errors.median)),
    ("99 in 100 errors are below, s, by true flip time", |errors| brief(errors.p99)),
    ("Largest error in s, by true flip time", |errors| brief(errors.max)),
];

/// The chapter on the speed and errors of every engine and method.
pub(super) fn methods(report: &Report) -> Option<Block> {
    let point =
        |row: &Row| Some((row.short_name(), row.config, [row.us_per_pixel, row.errors.median?]));
    let series = Series::by_method(report.rows.iter().filter_map(point));
    let plot = Plot { across: "µs per pixel", up: "median |Δt|, s", series };
    let mut blocks =
        vec![Block::Plot("Median error of the flip time, over time".to_string(), plot)];
    for rows in report.rows.chunk_by(|a, b| a.full_name() == b.full_name()) {
        let table = Table::of(rows, &SPEED).beside(Table::of(rows, &ERRORS));
        let bands = BY_BAND.map(|(caption, cell)| band_table(rows, cell).named(caption)).to_vec();
        blocks.push(table.named(&rows[0].full_name()));
        blocks.extend(fold(&format!("{}, by true flip time", rows[0].full_name()), bands));
    }
    fold("Speed against error of every method", blocks)
}

fn band_table(rows: &[Row], cell: CellText) -> Table {
    let names = rows[0].bands.iter().map(|band| band.name.clone());
    let cells = |row: &Row| row.bands.iter().map(|band| cell(&band.errors)).collect();
    let (head, rows_of_bands) = (names.collect(), rows.iter().map(cells).collect());
    let bands = Table { caption: String::new(), head, rows: rows_of_bands };
    Table::of(rows, &SPEED[..1]).beside(bands)
}

type Quantity = fn(&MotionError) -> f64;

/// The chapter on errors in angle and energy.
pub(super) fn motion(report: &Report) -> Option<Block> {
    let mut blocks = vec![text(
        "The worst over four starts each, against the gold standard in double-double. The \
         methods run as plain scalars here, with the engines' step-size control.",
    )];
    let quantities: [(_, Quantity); 2] = [
        ("Angle, rad", |error| error.angle_rad),
        ("Energy, as a share of P + Q", |error| error.energy_share),
    ];
    for (what, value) in quantities {
        for errors in report.motion.chunk_by(|a, b| a.motion == b.motion) {
            let lines: Vec<&[MotionError]> = errors.chunks(TIMES_SECS.len()).collect();
            let cells = |line: &&[MotionError]| {
                line.iter().map(|error| brief(Some(value(error)))).collect()
            };
            let head = TIMES_SECS.map(|secs| format!("after {secs} s")).to_vec();
            let times =
                Table { caption: String::new(), head, rows: lines.iter().map(cells).collect() };
            let table = Table::of(&lines, &[("method", |line| words(&line[0].config))]);
            blocks.push(table.beside(times).named(&format!("{what}: {} motion", errors[0].motion)));
        }
    }
    fold("Errors in angle and energy", blocks)
}

/// The chapter on kernels made for their scene.
pub(super) fn kernels(report: &Report) -> Option<Block> {
    let table = Table::of(
        &report.specialising,
        &[
            ("method", |gain| {
                let adapter = short_name(EngineKind::Gpu, &gain.adapter);
                format!("{} on {adapter}", words(&gain.config))
            }),
            ("general, µs/pixel", |gain| short(gain.general_us_per_pixel)),
            ("made for its scene, µs/pixel", |gain| short(gain.specialised_us_per_pixel)),
            ("times faster", |gain| format!("{:.2}", gain.ratio)),
        ],
    );
    fold("What a kernel made for its scene gains", vec![Block::Table(table)])
}
