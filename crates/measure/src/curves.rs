//! The curves of the results: what is plotted, and written as CSV.

use flipmap_estimate::Estimate;
use flipmap_estimate::boxes::BoxDimension;
use flipmap_estimate::entropy::Entropy;
use flipmap_estimate::fat::FatFractal;

use crate::findings::{Edges, Findings, GrowthFindings, SurvivalFindings};

/// A curve with an interval at every point.
pub(crate) struct MeasuredCurve {
    /// Name of its files.
    pub name: &'static str,
    /// What it shows, as a title.
    pub title: &'static str,
    /// What is across, with its unit.
    pub across: &'static str,
    /// What is up.
    pub up: &'static str,
    /// True for an axis that is logarithmic: across, up.
    pub log: [bool; 2],
    /// The points.
    pub points: Vec<(f64, Estimate)>,
}

/// The names of all curves.
pub(crate) const CURVES: [&str; 9] = [
    "survival",
    "edges",
    "exponent",
    "boxes",
    "entropy",
    "boundary-entropy",
    "growth",
    "sections",
    "fat",
];

/// All curves that there are.
pub(crate) fn curves(findings: &Findings) -> Vec<MeasuredCurve> {
    let mut curves = Vec::new();
    curves.extend(findings.survival.as_ref().map(survival));
    curves.extend(findings.edges.as_ref().map(edges).into_iter().flatten());
    curves.extend(findings.boxes.as_ref().map(boxes));
    curves.extend(findings.entropy.as_deref().map(entropies).into_iter().flatten());
    curves.extend(findings.growth.as_ref().map(growth).into_iter().flatten());
    curves.extend(findings.fat.as_ref().map(fat));
    curves
}

fn survival(survival: &SurvivalFindings) -> MeasuredCurve {
    MeasuredCurve {
        name: "survival",
        title: "Not yet flipped",
        across: "time in s",
        up: "share of what may flip",
        log: [true, true],
        points: survival.curve.iter().map(|point| (point.time, point.share)).collect(),
    }
}

fn edges(edges: &Edges) -> [MeasuredCurve; 2] {
    let across = "distance of the pair";
    let shares = MeasuredCurve {
        name: "edges",
        title: "Pairs whose answers differ",
        across,
        up: "share of pairs",
        log: [true, true],
        points: edges.shares.clone(),
    };
    let middles = edges.shares.windows(2).map(|two| (two[0].0 * two[1].0).sqrt());
    let exponents = MeasuredCurve {
        name: "exponent",
        title: "Uncertainty exponent, decade by decade",
        across,
        up: "α",
        log: [true, false],
        points: middles.zip(edges.exponent.local.iter().copied()).collect(),
    };
    [shares, exponents]
}

fn boxes(boxes: &BoxDimension) -> MeasuredCurve {
    let point = |(size, count): &(usize, u64)| (*size as f64, Estimate::exact(*count as f64));
    MeasuredCurve {
        name: "boxes",
        title: "Boxes with two classes",
        across: "side in pixels",
        up: "number",
        log: [true, true],
        points: boxes.counts.iter().map(point).collect(),
    }
}

fn entropies(entropies: &[Entropy]) -> [MeasuredCurve; 2] {
    let (across, up) = ("side of a box", "entropy");
    let basin = MeasuredCurve {
        name: "entropy",
        title: "Basin entropy",
        across,
        up,
        log: [true, true],
        points: entropies.iter().map(|one| (one.side, one.basin)).collect(),
    };
    let boundary = MeasuredCurve {
        name: "boundary-entropy",
        title: "Boundary basin entropy",
        across,
        up,
        log: [true, false],
        points: entropies.iter().filter_map(|one| Some((one.side, one.boundary?))).collect(),
    };
    [basin, boundary]
}

fn growth(growth: &GrowthFindings) -> [MeasuredCurve; 2] {
    let bars = growth.view.histogram.iter();
    let exponents = MeasuredCurve {
        name: "growth",
        title: "Exponents of growth",
        across: "exponent in 1/s",
        up: "share of starts",
        log: [false, false],
        points: bars.map(|(rate, share)| (*rate, Estimate::exact(*share))).collect(),
    };
    let sections = MeasuredCurve {
        name: "sections",
        title: "Regular starts on sections of constant energy",
        across: "energy above hanging at rest in J",
        up: "share of regular starts",
        log: [false, false],
        points: growth.sections.iter().map(|one| (one.energy, one.regular)).collect(),
    };
    [exponents, sections]
}

fn fat(fat: &FatFractal) -> MeasuredCurve {
    MeasuredCurve {
        name: "fat",
        title: "Finely mixed boxes",
        across: "side of a box",
        up: "share of boxes",
        log: [true, true],
        points: fat.shares.clone(),
    }
}

impl MeasuredCurve {
    /// The curve as a table of comma-separated values.
    pub(crate) fn csv(&self) -> String {
        let head = format!("{},{},low,high\n", self.across, self.up);
        let line = |(x, y): &(f64, Estimate)| format!("{x},{},{},{}\n", y.value, y.low, y.high);
        self.points.iter().map(line).fold(head, |text, line| text + &line)
    }
}
