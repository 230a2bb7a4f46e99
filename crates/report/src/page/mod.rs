//! The page of a report: one document, which chapters fill once and two small writers write as
//! Markdown and as HTML.

mod beyond;
mod home;
mod html;
mod markdown;
mod plot;
mod zoom;

use self::plot::Plot;
use super::{Report, verdict};

/// A part of a document.
#[derive(Clone, Debug)]
enum Block {
    /// A paragraph.
    Text(String),
    /// A table.
    Table(Table),
    /// A plot with a caption.
    Plot(String, Plot),
    /// A title that opens and closes the blocks under it.
    Fold(String, Vec<Block>),
}

/// A table of plain texts.
#[derive(Clone, Debug)]
struct Table {
    /// Caption of the table; may be empty.
    caption: String,
    /// Names of the columns.
    head: Vec<String>,
    /// Cells, row by row; each row has as many as there are columns.
    rows: Vec<Vec<String>>,
}

/// Name of a column, and the text of its cell for a measurement.
type Column<T> = (&'static str, fn(&T) -> String);

impl Table {
    /// A table with a line for each measurement.
    fn of<'a, T: 'a>(rows: impl IntoIterator<Item = &'a T>, columns: &[Column<T>]) -> Self {
        let line = |row| columns.iter().map(|(_, cell)| cell(row)).collect();
        let head = columns.iter().map(|(name, _)| name.to_string()).collect();
        Table { caption: String::new(), head, rows: rows.into_iter().map(line).collect() }
    }

    /// Adds the columns of a table with as many rows.
    fn beside(mut self, other: Table) -> Self {
        self.head.extend(other.head);
        self.rows.iter_mut().zip(other.rows).for_each(|(row, more)| row.extend(more));
        self
    }

    /// The table as a block with a caption.
    fn named(self, caption: &str) -> Block {
        Block::Table(Table { caption: caption.to_string(), ..self })
    }

    /// Returns true if a column other than the first holds numbers, or dashes for missing ones.
    fn is_numeric(&self, column: usize) -> bool {
        let is_number = |cell: &String| {
            cell == "–" || (cell.starts_with(|c: char| c.is_ascii_digit()) && cell.len() < 12)
        };
        column > 0 && self.rows.iter().all(|row| row.get(column).is_some_and(is_number))
    }
}

fn text(words: &str) -> Block {
    Block::Text(words.to_string())
}

/// A fold without its empty tables and plots, or `None` if it shows nothing else than text.
fn fold(title: &str, mut blocks: Vec<Block>) -> Option<Block> {
    blocks.retain(|block| match block {
        Block::Text(_) | Block::Fold(..) => true,
        Block::Table(table) => !table.rows.is_empty(),
        Block::Plot(_, plot) => plot.series.iter().any(|series| !series.points.is_empty()),
    });
    let shows = blocks.iter().any(|block| !matches!(block, Block::Text(_)));
    shows.then(|| Block::Fold(title.to_string(), blocks))
}

/// The page as Markdown.
pub(super) fn markdown(report: &Report) -> String {
    markdown::write(&title(report), &blocks(report))
}

/// The page as HTML that needs no other file.
pub(super) fn html(report: &Report) -> String {
    html::write(&title(report), &blocks(report))
}

fn title(report: &Report) -> String {
    format!("flipmap {}: speed against error on this machine", report.machine.flipmap)
}

/// The verdict and the plot of everything, and below them the chapters, folded.
fn blocks(report: &Report) -> Vec<Block> {
    let opening = vec![Block::Text(verdict::verdict(report)), home::plot(report)];
    let unfinished = (!report.complete).then(|| Block::Text(extent(report)));
    let missing = Table::of(&report.missing, &[("missing", String::clone)]);
    let folds = [
        fold("What is missing", vec![Block::Table(missing)]),
        home::levels(report),
        home::methods(report),
        beyond::windows(report),
        beyond::late(report),
        zoom::depth(report),
        zoom::questions(report),
        beyond::hard(report),
        zoom::films(report),
        home::motion(report),
        home::kernels(report),
        machine(report),
    ];
    opening.into_iter().chain(unfinished).chain(folds.into_iter().flatten()).collect()
}

/// Says how much was measured.
fn extent(report: &Report) -> String {
    let chapters: Vec<&str> = report.only.iter().map(|chapter| chapter.name()).collect();
    let only = match chapters.join(", ") {
        none if none.is_empty() => none,
        some => format!(", of nothing but {some}"),
    };
    let kind = if report.quick { "quick report: fewer settings and starts" } else { "full report" };
    match report.missing.len() {
        0 => format!("Complete; a {kind}{only}."),
        n => format!(
            "INCOMPLETE: {n} measurements are missing (still running, or stopped); a {kind}{only}."
        ),
    }
}

fn machine(report: &Report) -> Option<Block> {
    let machine = &report.machine;
    let mut rows = vec![
        ("processor", machine.cpu.clone()),
        ("cores", machine.cores.to_string()),
        ("system", machine.os.clone()),
    ];
    rows.extend(machine.engines.iter().map(|engine| ("engine", engine.clone())));
    rows.push(("program", format!("flipmap {}", machine.flipmap)));
    rows.push(("date", machine.date.clone()));
    let table =
        Table::of(&rows, &[("what", |row| row.0.to_string()), ("which", |row| row.1.clone())]);
    let refused = Table::of(
        &report.not_offered,
        &[
            ("engine", |refusal| refusal.engine.clone()),
            ("not offered", |refusal| refusal.what.clone()),
            ("reason", |refusal| refusal.reason.clone()),
        ],
    );
    let sample = format!(
        "Errors are those of up to {} open starts, evenly spread, against an adaptive Taylor \
         integrator in f64 with passes of the top proved by bounds; slow methods are compared on \
         fewer (see the column).",
        report.sample
    );
    let blocks = vec![Block::Text(extent(report)), Block::Table(table), Block::Table(refused)];
    let how = HOW.iter().map(|words| text(words)).chain([Block::Text(sample)]);
    fold("The machine, and how it was measured", blocks.into_iter().chain(how).collect())
}

const HOW: [&str; 3] = [
    "Measured on the home map: points of 1 kg on rods of 1 m, 9.81 m/s², rule second, 30 s. Only \
     open starts count: no forbidden ones, no mirror images. Right means the same class and, if \
     flipped, a flip time within 1 ms; a wrong class is a flip for none, or none for a flip. \
     Quantiles are of |Δt| over starts flipped in both.",
    "Each time is the median of several rounds after everything was compiled and warm; the spread \
     is from the fastest to the slowest round, as a share of the median. Between the rounds runs a \
     scalar f64 RK4 loop at 120 steps a second on one core, on some of the same starts; × scalar \
     is the median of the rounds' ratios. On a machine that is shared, believe the ratios before \
     the microseconds.",
    "RHS counts right-hand sides for each pixel, those for locating flips included (a Taylor \
     expansion to order N counts as N); steps counts those tried; lane use is the share of the \
     lanes' steps that were of use.",
];

/// Formats a number with three significant digits.
pub(super) fn short(value: f64) -> String {
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{value:.digits$}")
}

/// Formats a share in percent with up to three decimals, or as a dash.
pub(super) fn share(value: Option<f64>) -> String {
    let percent = |value: f64| {
        let digits = format!("{:.3}", 100.0 * value);
        format!("{} %", digits.trim_end_matches('0').trim_end_matches('.'))
    };
    value.map_or("–".to_string(), percent)
}

/// Formats a number with two digits and a power of ten, or as a dash.
fn brief(value: Option<f64>) -> String {
    value.map_or("–".to_string(), |value| format!("{value:.1e}"))
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;

    /// Calls `see` for every block, those in folds included.
    fn walk(blocks: &[Block], see: &mut dyn FnMut(&Block)) {
        for block in blocks {
            see(block);
            if let Block::Fold(_, inside) = block {
                walk(inside, see);
            }
        }
    }

    fn titles(report: &Report) -> Vec<String> {
        let mut titles = Vec::new();
        walk(&blocks(report), &mut |block| {
            if let Block::Fold(title, _) = block {
                titles.push(title.clone());
            }
        });
        titles
    }

    #[test]
    fn the_page_opens_with_the_verdict_and_one_plot_and_folds_the_rest() {
        let mut report = fixtures::report();
        report.complete = true;
        report.missing.clear();
        let blocks = blocks(&report);
        assert!(matches!(blocks[..2], [Block::Text(_), Block::Plot(..)]));
        assert!(blocks[2..].iter().all(|block| matches!(block, Block::Fold(..))));
    }

    #[test]
    fn every_measurement_has_a_line_as_long_as_its_head() {
        let (mut tables, mut curves) = (Vec::new(), 0);
        walk(&blocks(&fixtures::report()), &mut |block| match block {
            Block::Table(table) => {
                assert!(table.rows.iter().all(|row| row.len() == table.head.len()), "{table:?}");
                tables.push(table.rows.len());
            }
            Block::Plot(_, plot) => curves += plot.series.len(),
            Block::Text(_) | Block::Fold(..) => {}
        });
        let told: Vec<String> = tables.iter().map(ToString::to_string).collect();
        // Missing; levels, checks, claims; methods and their five bands; window; late, and all of
        // it; depth; question; hard; zooms, painting; machine, refusals.
        assert_eq!(told.join(" "), "1 3 1 3 2 2 2 2 2 2 1 2 2 1 1 16 1 6 1");
        // Methods and levels, twice; depth three times and its ways; the question twice.
        assert_eq!(curves, 5 + 2 + 3 + 3 + 2);
    }

    #[test]
    fn there_is_no_chapter_on_nothing() {
        let some = titles(&fixtures::report());
        for title in ["Accuracy levels", "Windows beyond the home map", "Hard cases", "Films"] {
            assert!(some.iter().any(|found| found == title), "{title} in {some:?}");
        }
        let machine = fixtures::report().machine;
        let none = titles(&Report { machine, ..Report::default() });
        assert_eq!(none, ["The machine, and how it was measured"]);
    }

    #[test]
    fn both_pages_say_what_is_missing() {
        let mut report = fixtures::report();
        let (md, page) = (markdown(&report), html(&report));
        assert!(md.contains("INCOMPLETE: 1 measurements") && md.contains("something\\|else"));
        assert!(page.contains("INCOMPLETE: 1 measurements") && page.contains("something|else"));
        (report.complete, report.missing) = (true, Vec::new());
        for text in [markdown(&report), html(&report)] {
            assert!(!text.contains("INCOMPLETE") && text.contains("Complete; "));
        }
    }

    #[test]
    fn the_page_needs_nothing_else() {
        let page = html(&fixtures::report());
        for outside in ["http", "src=", "<link", "@import", "url("] {
            assert!(!page.contains(outside), "{outside}");
        }
        assert_eq!(page.matches("<svg").count(), 8);
        assert_eq!(page.matches("<details").count(), page.matches("</details>").count());
    }

    #[test]
    fn a_share_is_whole_only_if_nothing_is_missing() {
        assert_eq!(
            [1.0, 0.99995, 0.9234, 0.0].map(Some).map(share),
            ["100 %", "99.995 %", "92.34 %", "0 %"]
        );
        assert_eq!(
            (share(None), short(0.0234), short(1234.5)),
            ("–".into(), "0.0234".into(), "1234".into())
        );
    }
}
