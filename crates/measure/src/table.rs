//! The results as a table of text.

use flipmap_estimate::Estimate;
use flipmap_estimate::survival::Law;

use crate::findings::Findings;

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

/// All numbers in the order of the statistics.
pub(crate) fn rows(findings: &Findings) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut add = |statistic, what: String, number, remark: &str| {
        rows.push(Row { statistic, what, number, remark: remark.to_string() });
    };
    if let Some(areas) = &findings.areas {
        for (name, share) in &areas.classes {
            add("areas", name.clone(), *share, "of the view");
        }
        for (from, to, share) in &areas.flips {
            add("areas", format!("flips between {from} and {to} s"), *share, "of the view");
        }
    }
    if let Some(survival) = &findings.survival {
        if let Some(last) = survival.curve.last() {
            let what = format!("not flipped after {:.3} s", last.time);
            add("survival", what, last.share, "of what may flip");
        }
        if let Some(tail) = &survival.tail {
            let since = format!("after {:.2} s", tail.since);
            let law = match tail.law {
                Law::Exponential => "the better law",
                Law::Power => "the worse law",
                Law::Undecided => "neither law is better",
            };
            add("survival", format!("rate of the tail {since}"), tail.rate, &format!("1/s, {law}"));
            let law = match tail.law {
                Law::Exponential => "the worse law",
                Law::Power => "the better law",
                Law::Undecided => "neither law is better",
            };
            add("survival", format!("power of the tail {since}"), tail.exponent, law);
        }
    }
    if let Some(edges) = &findings.edges {
        let [from, to] = edges.exponent.window;
        let window = format!("distances from {from:.0e} to {to:.0e}");
        add("edges", "exponent α".to_string(), edges.exponent.alpha, &window);
        add("edges", "dimension 2 − α".to_string(), edges.exponent.dimension, &window);
        if let Some(below) = edges.exponent.smooth_below {
            let what = "smooth below a distance of".to_string();
            add("edges", what, Estimate::exact(below), "the budget ends the fractal");
        }
    }
    if let Some(boxes) = &findings.boxes {
        add("boxes", "box-counting dimension".to_string(), boxes.dimension, "");
    }
    for one in findings.entropy.iter().flatten() {
        let side = format!("boxes of {:.1e}", one.side);
        add("entropy", format!("basin entropy, {side}"), one.basin, "");
        if let Some(boundary) = one.boundary {
            let remark = if one.is_above_ln2 { "above ln 2: fractal" } else { "" };
            add("entropy", format!("boundary entropy, {side}"), boundary, remark);
        }
    }
    if let Some(wada) = &findings.wada {
        let verdict = if wada.is_wada { "one boundary" } else { "not one boundary" };
        for picture in &wada.pictures {
            let what = format!("distance of merged boundaries at {0} x {0}", picture.side);
            let number = Estimate::exact(picture.nearly_all.into());
            add("wada", what, number, &format!("pixels; {verdict}"));
        }
    }
    if let Some(growth) = &findings.growth {
        let bound = format!("below {:.3} 1/s", growth.view.bound);
        add("growth", "regular starts of the view".to_string(), growth.view.regular, &bound);
        add("growth", "mean exponent of the others".to_string(), growth.view.mean, "1/s");
        for section in &growth.sections {
            let what = format!("regular on the section of {:.3} J", section.energy);
            add("growth", what, section.regular, "above hanging at rest");
        }
    }
    if let Some(fat) = &findings.fat {
        let remark = if fat.is_fat { "fat: some of it never unmixes" } else { "not fat" };
        add("fat", "exponent β of mixed boxes".to_string(), fat.beta, "");
        add("fat", "share that stays mixed".to_string(), fat.rest, remark);
    }
    rows
}

/// Formats a number to the digits that its interval lets one believe.
pub(crate) fn shown(number: &Estimate) -> [String; 3] {
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
