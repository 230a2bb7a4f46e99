//! The results as a table of text.

use flipmap_estimate::Estimate;
use flipmap_estimate::boxes::BoxDimension;
use flipmap_estimate::entropy::Entropy;
use flipmap_estimate::fat::FatFractal;
use flipmap_estimate::pairs::Exponent;
use flipmap_estimate::survival::Law;
use flipmap_estimate::wada::{Merged, Wada};

use crate::findings::{Areas, Edges, Findings, GrowthFindings, SurvivalFindings};

/// One number of the results.
pub(crate) struct Row {
    /// Name of the statistic.
    pub statistic: &'static str,
    /// What is measured.
    pub what: String,
    /// The number with its interval.
    pub number: Estimate,
    /// Unit, or a remark.
    pub remark: String,
}

impl Row {
    fn new(statistic: &'static str, what: &str, number: Estimate, remark: &str) -> Self {
        Row { statistic, what: what.to_string(), number, remark: remark.to_string() }
    }
}

/// All numbers in the order of the statistics.
pub(crate) fn rows(findings: &Findings) -> Vec<Row> {
    let mut rows = Vec::new();
    rows.extend(findings.areas.as_ref().map(areas).into_iter().flatten());
    rows.extend(findings.survival.as_ref().map(survival).into_iter().flatten());
    rows.extend(findings.edges.as_ref().map(edges).into_iter().flatten());
    let boxes =
        |boxes: &BoxDimension| Row::new("boxes", "box-counting dimension", boxes.dimension, "");
    rows.extend(findings.boxes.as_ref().map(boxes));
    rows.extend(findings.entropy.iter().flatten().flat_map(entropy));
    rows.extend(findings.wada.as_ref().map(wada).into_iter().flatten());
    rows.extend(findings.growth.as_ref().map(growth).into_iter().flatten());
    rows.extend(findings.fat.as_ref().map(fat).into_iter().flatten());
    rows
}

fn areas(areas: &Areas) -> Vec<Row> {
    let of_view = |what: &str, share| Row::new("areas", what, share, "of the view");
    let classes = areas.classes.iter().map(|(name, share)| of_view(name, *share));
    let flips = areas
        .flips
        .iter()
        .map(|(from, to, share)| of_view(&format!("flips between {from} and {to} s"), *share));
    classes.chain(flips).collect()
}

fn survival(survival: &SurvivalFindings) -> Vec<Row> {
    let row = |what: &str, number, remark: &str| Row::new("survival", what, number, remark);
    let mut rows = Vec::new();
    if let Some(last) = survival.curve.last() {
        let what = format!("not flipped after {:.3} s", last.time);
        rows.push(row(&what, last.share, "of what may flip"));
    }
    if let Some(tail) = &survival.tail {
        let [of_rate, of_power] = match tail.law {
            Law::Exponential => ["the better law", "the worse law"],
            Law::Power => ["the worse law", "the better law"],
            Law::Undecided => ["neither law is better"; 2],
        };
        let since = format!("of the tail after {:.2} s", tail.since);
        rows.push(row(&format!("rate {since}"), tail.rate, &format!("1/s, {of_rate}")));
        rows.push(row(&format!("power {since}"), tail.exponent, of_power));
    }
    rows
}

fn edges(edges: &Edges) -> Vec<Row> {
    let Exponent { alpha, dimension, window: [from, to], smooth_below, .. } = &edges.exponent;
    let window = format!("distances from {from:.0e} to {to:.0e}");
    let row = |what, number, remark: &str| Row::new("edges", what, number, remark);
    let mut rows =
        vec![row("exponent α", *alpha, &window), row("dimension 2 − α", *dimension, &window)];
    if let Some(below) = smooth_below {
        let remark = "the budget ends the fractal";
        rows.push(row("smooth below a distance of", Estimate::exact(*below), remark));
    }
    rows
}

fn entropy(one: &Entropy) -> Vec<Row> {
    let side = format!("boxes of {:.1e}", one.side);
    let basin = Row::new("entropy", &format!("basin entropy, {side}"), one.basin, "");
    let boundary = one.boundary.map(|boundary| {
        let remark = if one.is_above_ln2 { "above ln 2: fractal" } else { "" };
        Row::new("entropy", &format!("boundary entropy, {side}"), boundary, remark)
    });
    std::iter::once(basin).chain(boundary).collect()
}

fn wada(wada: &Wada) -> Vec<Row> {
    let verdict = if wada.is_wada { "one boundary" } else { "not one boundary" };
    let row = |picture: &Merged| {
        let what = format!("merged boundaries apart at {0} x {0}", picture.side);
        let remark = format!("of their pixels; {verdict}");
        Row::new("wada", &what, Estimate::exact(picture.apart), &remark)
    };
    wada.pictures.iter().map(row).collect()
}

fn growth(growth: &GrowthFindings) -> Vec<Row> {
    let bound = format!("below {:.3} 1/s", growth.view.bound);
    let row = |what: &str, number, remark: &str| Row::new("growth", what, number, remark);
    let regular = row("regular starts of the view", growth.view.regular, &bound);
    let mean = growth.view.mean.map(|mean| row("mean exponent of the others", mean, "1/s"));
    let sections = growth.sections.iter().map(|section| {
        let what = format!("regular on the section of {:.3} J", section.energy);
        row(&what, section.regular, "above hanging at rest")
    });
    std::iter::once(regular).chain(mean).chain(sections).collect()
}

fn fat(fat: &FatFractal) -> [Row; 2] {
    let remark = if fat.is_fat { "fat: some of it never unmixes" } else { "not fat" };
    [
        Row::new("fat", "exponent β of mixed boxes", fat.beta, ""),
        Row::new("fat", "share that stays mixed", fat.rest, remark),
    ]
}

/// Formats a number to the digits that its interval lets one believe.
pub(crate) fn shown(number: &Estimate) -> [String; 3] {
    if number.low == number.high {
        return [number.value.to_string(), String::new(), String::new()];
    }
    if number.value == 0.0 && number.high < 1e-6 {
        return ["0".to_string(), String::new(), String::new()];
    }
    let width = number.half_width().max(1e-12 * number.value.abs()).max(1e-300);
    let size =
        [number.value, number.low, number.high].map(f64::abs).into_iter().fold(0.0, f64::max);
    if size > 0.0 && !(1e-4..1e6).contains(&size) {
        return [number.value, number.low, number.high].map(|x| format!("{x:.3e}"));
    }
    let digits = (2.0 - width.log10().ceil()).clamp(0.0, 6.0) as usize;
    [number.value, number.low, number.high].map(|x| format!("{x:.digits$}"))
}

/// Writes the results as lines of text with aligned columns, and the reasons for what is missing.
pub fn table(findings: &Findings) -> String {
    let head = ["", "", "value", "95 % from", "to", ""].map(str::to_string);
    let line = |row: &Row| {
        let [value, low, high] = shown(&row.number);
        [row.statistic.to_string(), row.what.clone(), value, low, high, row.remark.clone()]
    };
    let lines: Vec<[String; 6]> =
        std::iter::once(head).chain(rows(findings).iter().map(line)).collect();
    let width =
        |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(width);
    let padded = |(column, cell): (usize, &String)| {
        let space = " ".repeat(widths[column] - cell.chars().count());
        if (2..5).contains(&column) { format!("{space}{cell}") } else { format!("{cell}{space}") }
    };
    let text = |line: &[String; 6]| {
        let cells: Vec<String> = line.iter().enumerate().map(padded).collect();
        format!("{}\n", cells.join("  ").trim_end())
    };
    let missing = findings.missing.iter().map(|it| format!("{}: {}\n", it.what, it.why));
    lines.iter().map(text).chain(missing).collect()
}
