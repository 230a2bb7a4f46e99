//! A report laid out for readers: sections of text, tables and plots, the same for every format.

use flipmap_engine::EngineKind;
use serde::Serialize;

use super::backend::short_name;
use super::motion::TIMES_SECS;
use super::plot::{Plot, Series};
use super::statistics::Errors;
use super::{Report, ReportError, Row, Target, chapters, depth_pages, film_pages, question_pages};

/// A chapter of a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Section {
    /// Title of the chapter.
    pub title: String,
    /// Contents of the chapter.
    pub blocks: Vec<Block>,
}

/// A part of a chapter.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Block {
    /// A paragraph of plain text.
    Text(String),
    /// A table with a caption.
    Table(Table),
    /// A drawing with a caption.
    Figure {
        /// Caption of the drawing.
        caption: String,
        /// An `<svg>` element.
        svg: String,
    },
}

/// A table of plain texts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// Caption of the table; may be empty.
    pub caption: String,
    /// Names of the columns.
    pub head: Vec<String>,
    /// Cells, row by row; each row has as many as there are columns.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with a caption, the names of its columns, and its rows.
    pub(crate) fn new(caption: &str, head: &[&str], rows: Vec<Vec<String>>) -> Self {
        let head = head.iter().map(ToString::to_string).collect();
        Table { caption: caption.to_string(), head, rows }
    }

    /// Returns true if a column other than the first holds numbers, or dashes for missing ones.
    pub(crate) fn is_numeric(&self, column: usize) -> bool {
        let is_number =
            |cell: &String| cell == "–" || cell.starts_with(|c: char| c.is_ascii_digit());
        column > 0 && self.rows.iter().all(|row| row.get(column).is_some_and(is_number))
    }
}

/// The title of a report.
pub(crate) fn title(report: &Report) -> String {
    format!("flipmap {}: speed against error on this machine", report.machine.flipmap)
}

/// The chapters of a report.
pub(crate) fn sections(report: &Report) -> Result<Vec<Section>, ReportError> {
    let mut sections = vec![state(report), targets(report), machine(report)];
    sections.extend(chapters::levels(report));
    for engine in engines(&report.rows) {
        sections.push(speeds(report, &engine)?);
    }
    let optional = [specialising(report), motion(report), not_offered(report)];
    sections.extend(optional.into_iter().flatten());
    sections.extend(depth_pages::depth(report)?);
    sections.extend(chapters::beyond(report));
    sections.extend(question_pages::questions(report)?);
    sections.extend(film_pages::films(report));
    sections.push(how(report));
    Ok(sections)
}

/// A chapter with a title and contents.
pub(crate) fn section(title: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_string(), blocks }
}

/// The chapter on completeness: whether anything is missing, and the list of it.
fn state(report: &Report) -> Section {
    let mut kind =
        if report.quick { "a quick report: fewer settings and starts" } else { "a full report" }
            .to_string();
    if !report.only.is_empty() {
        let chapters: Vec<&str> = report.only.iter().map(|chapter| chapter.name()).collect();
        kind = format!("{kind}, of nothing but {}", chapters.join(", "));
    }
    if report.complete {
        return section("State", vec![Block::Text(format!("Complete; {kind}."))]);
    }
    let text = format!(
        "INCOMPLETE: {} measurements are missing (still running, or stopped); {kind}.",
        report.missing.len()
    );
    let rows = report.missing.iter().map(|name| vec![name.clone()]).collect();
    section("State", vec![Block::Text(text), Block::Table(Table::new("", &["missing"], rows))])
}

fn targets(report: &Report) -> Section {
    let rows = report.targets.iter().map(|target| {
        let verdict = match target.met {
            Some(true) => "met",
            Some(false) => "MISSED",
            None => "not measured",
        };
        vec![target.name.clone(), target.target.clone(), found(target), verdict.to_string()]
    });
    let table = Table::new("", &["what", "target", "measured", "verdict"], rows.collect());
    section("Targets", vec![Block::Text(missed(report)), Block::Table(table)])
}

/// Summarises the targets that were missed.
fn missed(report: &Report) -> String {
    let measured = report.targets.iter().filter(|target| target.met.is_some()).count();
    let missed: Vec<String> = report
        .targets
        .iter()
        .filter(|target| target.met == Some(false))
        .map(|target| format!("{}: {} ({})", target.name, found(target), target.target))
        .collect();
    if missed.is_empty() {
        return format!("All {measured} targets measured so far are met.");
    }
    format!("{} of {measured} targets are MISSED: {}.", missed.len(), missed.join("; "))
}

/// Formats a target's measured value: whole numbers as such, others with four decimals.
fn found(target: &Target) -> String {
    target.measured.map_or("–".to_string(), |value| {
        if value.fract() == 0.0 { format!("{value}") } else { format!("{value:.4}") }
    })
}

fn machine(report: &Report) -> Section {
    let machine = &report.machine;
    let row = |name: &str, value: &str| vec![name.to_string(), value.to_string()];
    let mut rows = vec![
        row("processor", &machine.cpu),
        row("cores", &machine.cores.to_string()),
        row("system", &machine.os),
    ];
    rows.extend(machine.engines.iter().map(|engine| row("engine", engine)));
    rows.extend([
        row("program", &format!("flipmap {}", machine.flipmap)),
        row("date", &machine.date),
    ]);
    section("Machine", vec![Block::Table(Table::new("", &["", ""], rows))])
}

/// Full names of the rows' engines, each once.
fn engines(rows: &[Row]) -> Vec<String> {
    let mut labels: Vec<String> = rows.iter().map(Row::full_name).collect();
    labels.dedup();
    labels
}

/// The chapter on one engine's speed and errors.
fn speeds(report: &Report, engine: &str) -> Result<Section, ReportError> {
    let rows: Vec<&Row> = report.rows.iter().filter(|row| row.full_name() == engine).collect();
    let mut blocks = vec![Block::Table(speed_table(&rows))];
    for (caption, up, value) in PLOTS {
        let series = series(&rows, value);
        let svg = Plot { across: "µs per pixel", up, series }.svg()?;
        blocks.push(Block::Figure { caption: caption.to_string(), svg });
    }
    for (caption, cell) in BY_BAND {
        blocks.push(Block::Table(band_table(caption, &rows, cell)));
    }
    Ok(section(&format!("Speed against error: {engine}"), blocks))
}

fn speed_table(rows: &[&Row]) -> Table {
    let head = [
        "method",
        "µs/pixel",
        "± spread",
        "× scalar",
        "right",
        "wrong class",
        "median s",
        "p90 s",
        "p99 s",
        "max s",
        "RHS",
        "steps",
        "lane use",
        "compared",
    ];
    let line = |row: &&Row| {
        let errors = &row.errors;
        vec![
            words(row),
            short(row.us_per_pixel),
            format!("{:.0} %", 100.0 * row.spread),
            format!("{:.1}", row.times_scalar),
            share(errors.right_1ms),
            share(errors.wrong_class),
            brief(errors.median),
            brief(errors.p90),
            brief(errors.p99),
            brief(errors.max),
            format!("{:.0}", row.rhs_per_pixel),
            format!("{:.0}", row.steps_per_pixel),
            format!("{:.2}", row.lane_use),
            errors.compared.to_string(),
        ]
    };
    Table::new("", &head, rows.iter().map(line).collect())
}

type Value = fn(&Row) -> Option<f64>;

const PLOTS: [(&str, &str, Value); 2] = [
    ("Share of pixels not right within 1 ms, over time", "share not right", |row| {
        row.errors.right_1ms.map(|right| 1.0 - right)
    }),
    ("Median error of the flip time, over time", "median |Δt|, s", |row| row.errors.median),
];

fn series(rows: &[&Row], value: Value) -> Vec<Series> {
    let point = |row: &&Row| Some((row.config, (row.us_per_pixel, value(row)?)));
    Series::by_method(rows.iter().filter_map(point))
}

type CellText = fn(&Errors) -> String;

const BY_BAND: [(&str, CellText); 5] = [
    ("Share right within 1 ms, by true flip time", |errors| share(errors.right_1ms)),
    ("Share in the wrong class, by true flip time", |errors| share(errors.wrong_class)),
    ("Median error in s, by true flip time", |errors| brief(errors.median)),
    ("99 in 100 errors are below, s, by true flip time", |errors| brief(errors.p99)),
    ("Largest error in s, by true flip time", |errors| brief(errors.max)),
];

fn band_table(caption: &str, rows: &[&Row], cell: CellText) -> Table {
    let names = rows.first().map_or(&[][..], |row| &row.bands).iter().map(|band| band.name.clone());
    let head = ["method".to_string()].into_iter().chain(names).collect();
    let line = |row: &&Row| {
        let cells = row.bands.iter().map(|band| cell(&band.errors));
        [words(row)].into_iter().chain(cells).collect()
    };
    Table { caption: caption.to_string(), head, rows: rows.iter().map(line).collect() }
}

fn specialising(report: &Report) -> Option<Section> {
    let line = |gain: &super::Specialising| {
        vec![
            format!(
                "{} on {}",
                super::plan::words(&gain.config),
                short_name(EngineKind::Gpu, &gain.adapter)
            ),
            short(gain.general_us_per_pixel),
            short(gain.specialised_us_per_pixel),
            format!("{:.2}", gain.ratio),
        ]
    };
    let head = ["method", "general, µs/pixel", "made for its scene, µs/pixel", "times faster"];
    let table = Table::new("", &head, report.specialising.iter().map(line).collect());
    let title = "What a kernel made for its scene gains";
    (!table.rows.is_empty()).then(|| section(title, vec![Block::Table(table)]))
}

fn motion(report: &Report) -> Option<Section> {
    let mut tables: Vec<Table> = Vec::new();
    let per_config = report.motion.chunks(TIMES_SECS.len());
    for (what, value) in [("Angle, rad", 0), ("Energy, as a share of P + Q", 1)] {
        for errors in per_config.clone() {
            let caption = format!("{what}: {} motion", errors[0].motion);
            if tables.last().is_none_or(|table| table.caption != caption) {
                let names = TIMES_SECS.map(|secs| format!("after {secs} s"));
                let head = ["method".to_string()].into_iter().chain(names).collect();
                tables.push(Table { caption, head, rows: Vec::new() });
            }
            let cells = errors
                .iter()
                .map(|error| brief(Some([error.angle_rad, error.energy_share][value])));
            let line = [super::plan::words(&errors[0].config)].into_iter().chain(cells).collect();
            tables.last_mut()?.rows.push(line);
        }
    }
    let note = "The worst over four starts each, against the gold standard in double-double. The \
                methods run as plain scalars here, with the engines' step-size control.";
    let blocks = [Block::Text(note.to_string())].into_iter();
    let blocks: Vec<Block> = blocks.chain(tables.into_iter().map(Block::Table)).collect();
    (!report.motion.is_empty()).then(|| section("Errors in angle and energy", blocks))
}

fn not_offered(report: &Report) -> Option<Section> {
    let line = |refusal: &super::Refusal| {
        vec![refusal.engine.clone(), refusal.what.clone(), refusal.reason.clone()]
    };
    let rows: Vec<Vec<String>> = report.not_offered.iter().map(line).collect();
    let table = Table::new("", &["engine", "not offered", "reason"], rows);
    (!table.rows.is_empty()).then(|| section("Not offered", vec![Block::Table(table)]))
}

fn how(report: &Report) -> Section {
    let sample = format!(
        "Errors are those of up to {} open starts, evenly spread, against an adaptive Taylor \
         integrator in f64 with passes of the top proved by bounds; slow methods are compared on \
         fewer (see the column). Right means the same class and, if flipped, a flip time within \
         1 ms; a wrong class is a flip for none, or none for a flip. Quantiles are of |Δt| over \
         starts flipped in both.",
        report.sample
    );
    let texts = [
        "Measured on the home map: points of 1 kg on rods of 1 m, 9.81 m/s², rule second, 30 s. \
         Only open starts count: no forbidden ones, no mirror images.",
        "Each time is the median of several rounds after everything was compiled and warm; the \
         spread is from the fastest to the slowest round, as a share of the median. Between the \
         rounds runs a scalar f64 RK4 loop at 120 steps a second on one core, on some of the same \
         starts; × scalar is the median of the rounds' ratios. On a machine that is shared, \
         believe the ratios before the microseconds.",
        &sample,
        "RHS counts right-hand sides for each pixel, those for locating flips included (a Taylor \
         expansion to order N counts as N); steps counts those tried; lane use is the share of \
         the lanes' steps that were of use. A plotted value of 0 lies on the lower edge.",
    ];
    section("How it was measured", texts.map(|text| Block::Text(text.to_string())).to_vec())
}

fn words(row: &Row) -> String {
    super::plan::words(&row.config)
}

/// Formats a number with three significant digits.
pub(crate) fn short(value: f64) -> String {
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{value:.digits$}")
}

/// Formats a share with four decimals, or as a dash.
pub(crate) fn share(value: Option<f64>) -> String {
    value.map_or("–".to_string(), |value| format!("{value:.4}"))
}

/// Formats a number with two digits and a power of ten, or as a dash.
pub(crate) fn brief(value: Option<f64>) -> String {
    value.map_or("–".to_string(), |value| format!("{value:.1e}"))
}
