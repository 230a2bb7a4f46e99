//! The curves of the results: what is plotted, and written as CSV.

use flipmap_estimate::Estimate;

use crate::findings::Findings;

/// A curve with an interval at every point.
pub(crate) struct Curve {
    /// Name of its files.
    pub name: &'static str,
    /// What it shows, as a title.
    pub title: &'static str,
    /// What is across, with its unit.
    pub across: &'static str,
    /// What is up.
    pub up: &'static str,
    /// True if the axis across is logarithmic; the axis up, if both are.
    pub log: [bool; 2],
    /// The points.
    pub points: Vec<(f64, Estimate)>,
}

/// All curves that there are.
pub(crate) fn curves(findings: &Findings) -> Vec<Curve> {
    let mut curves = Vec::new();
    if let Some(survival) = &findings.survival {
        curves.push(Curve {
            name: "survival",
            title: "Not yet flipped",
            across: "time in s",
            up: "share of what may flip",
            log: [true, true],
            points: survival.curve.iter().map(|point| (point.time, point.share)).collect(),
        });
    }
    if let Some(edges) = &findings.edges {
        curves.push(Curve {
            name: "edges",
            title: "Pairs whose answers differ",
            across: "distance of the pair",
            up: "share of pairs",
            log: [true, true],
            points: edges.shares.clone(),
        });
        let middles = edges.shares.windows(2).map(|two| (two[0].0 * two[1].0).sqrt());
        curves.push(Curve {
            name: "exponent",
            title: "Uncertainty exponent, decade by decade",
            across: "distance of the pair",
            up: "α",
            log: [true, false],
            points: middles.zip(edges.exponent.local.iter().copied()).collect(),
        });
    }
    if let Some(boxes) = &findings.boxes {
        let point = |(size, count): &(usize, u64)| (*size as f64, Estimate::exact(*count as f64));
        curves.push(Curve {
            name: "boxes",
            title: "Boxes with two classes",
            across: "side in pixels",
            up: "number",
            log: [true, true],
            points: boxes.counts.iter().map(point).collect(),
        });
    }
    if let Some(entropies) = &findings.entropy {
        let basin = entropies.iter().map(|one| (one.side, one.basin)).collect();
        let boundary = entropies.iter().filter_map(|one| Some((one.side, one.boundary?))).collect();
        curves.push(Curve {
            name: "entropy",
            title: "Basin entropy",
            across: "side of a box",
            up: "entropy",
            log: [true, true],
            points: basin,
        });
        curves.push(Curve {
            name: "boundary-entropy",
            title: "Boundary basin entropy",
            across: "side of a box",
            up: "entropy",
            log: [true, false],
            points: boundary,
        });
    }
    if let Some(growth) = &findings.growth {
        let bars = &growth.view.histogram;
        curves.push(Curve {
            name: "growth",
            title: "Exponents of growth",
            across: "exponent in 1/s",
            up: "share of starts",
            log: [false, false],
            points: bars.iter().map(|(rate, share)| (*rate, Estimate::exact(*share))).collect(),
        });
        curves.push(Curve {
            name: "sections",
            title: "Regular starts on sections of constant energy",
            across: "energy above hanging at rest in J",
            up: "share of regular starts",
            log: [false, false],
            points: growth.sections.iter().map(|one| (one.energy, one.regular)).collect(),
        });
    }
    if let Some(fat) = &findings.fat {
        curves.push(Curve {
            name: "fat",
            title: "Finely mixed boxes",
            across: "side of a box",
            up: "share of boxes",
            log: [true, true],
            points: fat.shares.clone(),
        });
    }
    curves
}

impl Curve {
    /// The curve as a table of comma-separated values.
    pub(crate) fn csv(&self) -> String {
        let head = format!("{},{},low,high\n", self.across, self.up);
        let line = |(x, y): &(f64, Estimate)| format!("{x},{},{},{}\n", y.value, y.low, y.high);
        self.points.iter().map(line).fold(head, |text, line| text + &line)
    }
}
