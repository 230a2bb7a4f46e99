//! What following the cells of a deep picture has shown.

use serde::Serialize;

use crate::engine::Precision;

/// How deep starts came to where their own integration began.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DepthStats {
    /// Decimal digits in which the middles were followed; 0 where f64 was enough.
    pub digits: u32,
    /// Starts that had to be integrated; of the others all was known from polynomials.
    pub integrated: u64,
    /// When the first and the last of their own integrations began, s.
    pub begins_secs: [f64; 2],
    /// How fast neighbours move apart, decades a second: the mean over the starts.
    pub decades_a_second: f64,
}

impl DepthStats {
    /// Nothing followed yet.
    pub const NOTHING: DepthStats = DepthStats {
        digits: 0,
        integrated: 0,
        begins_secs: [f64::INFINITY, 0.0],
        decades_a_second: 0.0,
    };

    /// Both together.
    pub fn and(self, other: DepthStats) -> DepthStats {
        let integrated = self.integrated + other.integrated;
        let weighed = |depth: DepthStats| depth.decades_a_second * depth.integrated as f64;
        DepthStats {
            digits: self.digits.max(other.digits),
            integrated,
            begins_secs: [
                self.begins_secs[0].min(other.begins_secs[0]),
                self.begins_secs[1].max(other.begins_secs[1]),
            ],
            decades_a_second: (weighed(self) + weighed(other)) / (integrated as f64).max(1.0),
        }
    }

    /// Until when answers can be trusted, s: from the begin of the last integration on, until
    /// roundings have grown to a thousandth of a radian; infinite where nothing grows.
    pub fn horizon_secs(&self, precision: Precision) -> f64 {
        if self.decades_a_second <= 0.0 {
            return f64::INFINITY;
        }
        let decades = -3.0 - (4.0 * precision.epsilon()).log10();
        self.begins_secs[1] + decades / self.decades_a_second
    }

    /// The same in words.
    pub fn horizon_words(&self, precision: Precision) -> String {
        let horizon_secs = self.horizon_secs(precision);
        if horizon_secs.is_finite() {
            format!("up to {horizon_secs:.0} s")
        } else {
            "throughout".to_string()
        }
    }

    /// The width (rad) at which neighbours no longer move apart within the budget, so that
    /// nothing is left to see below.
    pub fn structure_ends_at(&self, budget_secs: f64) -> f64 {
        10f64.powf(-self.decades_a_second * budget_secs)
    }
}
