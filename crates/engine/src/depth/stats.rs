//! Statistics of following the cells of a deep picture.

use serde::Serialize;

use crate::Precision;

/// Statistics of how deep starts came to the point where their own integration began.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DepthStats {
    /// Number of decimal digits in which the middles were followed; 0 where f64 was enough.
    pub digits: u32,
    /// Number of pendulums that had to be integrated, samples of lines among them.
    pub integrated: u64,
    /// Number of cells and strips that were followed below anchors, by this request.
    pub cells: u64,
    /// Number of steps that these cells and strips took.
    pub cell_steps: u64,
    /// Time that jobs waited for cells, strips and anchors, summed over jobs, in s.
    pub cell_secs: f64,
    /// Number of samples of lines that were integrated.
    pub line_samples: u64,
    /// Number of starts that were answered from their neighbours on a line. All other starts that
    /// were not integrated were answered from polynomials.
    pub told_by_lines: u64,
    /// Times at which the first and the last integration of a pendulum began, in s.
    pub begins_secs: [f64; 2],
    /// Rate at which neighbours move apart, in decades per second: the mean over the integrated
    /// starts.
    pub decades_a_second: f64,
}

impl DepthStats {
    /// Statistics before anything has been followed.
    pub(crate) const NOTHING: DepthStats = DepthStats {
        digits: 0,
        integrated: 0,
        cells: 0,
        cell_steps: 0,
        cell_secs: 0.0,
        line_samples: 0,
        told_by_lines: 0,
        begins_secs: [f64::INFINITY, 0.0],
        decades_a_second: 0.0,
    };

    /// Merges the statistics of two jobs or leaves.
    pub(crate) fn and(self, other: DepthStats) -> DepthStats {
        let integrated = self.integrated + other.integrated;
        let weighed = |depth: DepthStats| depth.decades_a_second * depth.integrated as f64;
        DepthStats {
            digits: self.digits.max(other.digits),
            integrated,
            cells: self.cells + other.cells,
            cell_steps: self.cell_steps + other.cell_steps,
            cell_secs: self.cell_secs + other.cell_secs,
            line_samples: self.line_samples + other.line_samples,
            told_by_lines: self.told_by_lines + other.told_by_lines,
            begins_secs: [
                self.begins_secs[0].min(other.begins_secs[0]),
                self.begins_secs[1].max(other.begins_secs[1]),
            ],
            decades_a_second: (weighed(self) + weighed(other)) / (integrated as f64).max(1.0),
        }
    }

    /// Returns the horizon in s, the time up to which answers can be trusted. Then rounding errors,
    /// which grow from the beginning of the last integration on, reach a thousandth of a radian.
    /// Infinite if nothing grows.
    pub fn horizon_secs(&self, precision: Precision) -> f64 {
        if self.decades_a_second <= 0.0 {
            return f64::INFINITY;
        }
        let decades = -3.0 - (4.0 * precision.epsilon()).log10();
        self.begins_secs[1] + decades / self.decades_a_second
    }

    /// The horizon in words.
    pub fn horizon_words(&self, precision: Precision) -> String {
        let horizon_secs = self.horizon_secs(precision);
        if horizon_secs.is_finite() {
            format!("up to {horizon_secs:.0} s")
        } else {
            "throughout".to_string()
        }
    }

    /// Returns the width in rad below which neighbours stay together throughout the budget, so that
    /// no structure is left to see.
    pub fn structure_ends_at(&self, budget_secs: f64) -> f64 {
        10f64.powf(-self.decades_a_second * budget_secs)
    }
}
