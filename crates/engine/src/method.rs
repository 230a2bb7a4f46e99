//! Methods and precisions, with the properties that depend on nothing else.

use std::fmt;
use std::str::FromStr;

use flipmap_scene::named;

use super::IntegratorConfig;
use flipmap_pendulum::{extrapolation, series};

/// The method by which a pixel is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The classical Runge–Kutta method with a fixed step in seconds.
    Rk4 {
        /// Length of the step in seconds.
        step_secs: f64,
    },
    /// Dormand and Prince's pair of orders 5 and 4: small coefficients, for f32.
    Dopri5 {
        /// Tolerance of one step just after the release; it rises from there (see
        /// `flipmap_pendulum::control`).
        tolerance: f64,
    },
    /// Dormand and Prince's pair of order 8, for everything finer.
    Dop853 {
        /// Tolerance of one step, which rises as for [`Method::Dopri5`].
        tolerance: f64,
    },
    /// Taylor expansions to the precision of the number type: the check of the other methods, and
    /// the method for `dd`.
    Taylor {
        /// Tolerance of one step, the same at all times.
        tolerance: f64,
    },
    /// Extrapolated midpoint rules: the check of expansions in `dd`. Users cannot select this
    /// method by name.
    Extrapolation {
        /// Tolerance of one step, the same at all times; it holds for the result without the last
        /// midpoint rule.
        tolerance: f64,
    },
}

impl Method {
    /// The lesson's method: RK4 with 120 steps per second.
    pub const LESSON: Method = Method::Rk4 { step_secs: 1.0 / 120.0 };

    /// Names of the methods that users can ask for.
    pub const NAMES: [&str; 4] = ["rk4", "dopri5", "dop853", "taylor"];

    /// Name of the method.
    pub fn name(self) -> &'static str {
        match self {
            Method::Rk4 { .. } => "rk4",
            Method::Dopri5 { .. } => "dopri5",
            Method::Dop853 { .. } => "dop853",
            Method::Taylor { .. } => "taylor",
            Method::Extrapolation { .. } => "extrapolation",
        }
    }

    /// Returns true if steps are taken by Taylor expansions.
    pub(crate) fn is_series(self) -> bool {
        matches!(self, Method::Taylor { .. })
    }

    /// The method's step or tolerance as text, for people and files.
    pub fn setting(self) -> String {
        match self {
            Method::Rk4 { step_secs } => {
                let per_second = 1.0 / step_secs;
                if (per_second - per_second.round()).abs() < 1e-9 * per_second {
                    format!("step 1/{per_second:.0}")
                } else {
                    format!("step {step_secs}")
                }
            }
            Method::Dopri5 { tolerance }
            | Method::Dop853 { tolerance }
            | Method::Taylor { tolerance }
            | Method::Extrapolation { tolerance } => format!("tolerance {tolerance:e}"),
        }
    }

    /// Right-hand sides per step; for an expansion, its order.
    pub(crate) fn rhs_per_step(self, precision: Precision) -> u64 {
        match self {
            Method::Rk4 { .. } => 4,
            Method::Dopri5 { .. } => 7,
            Method::Dop853 { .. } => 12,
            Method::Taylor { .. } if precision == Precision::Dd => series::ORDER_DD as u64,
            Method::Taylor { .. } => series::ORDER_F64 as u64,
            Method::Extrapolation { .. } => extrapolation::rhs_per_step(COLUMNS) as u64,
        }
    }

    /// Returns the least tolerance that the method can keep in `precision`, or `None` if the two do
    /// not go together.
    pub(crate) fn least_tolerance(self, precision: Precision) -> Option<f64> {
        match (self, precision) {
            (Method::Rk4 { .. } | Method::Dopri5 { .. } | Method::Dop853 { .. }, Precision::Dd)
            | (Method::Taylor { .. }, Precision::F32 | Precision::Df32) => None,
            (Method::Extrapolation { .. }, precision) => {
                (precision == Precision::Dd).then_some(1e-27)
            }
            (Method::Rk4 { .. }, _) => (precision != Precision::Df32).then_some(0.0),
            (_, Precision::F32) => Some(1e-8),
            (_, Precision::Df32) => Some(1e-13),
            (_, Precision::F64) => Some(1e-15),
            (_, Precision::Dd) => Some(1e-28),
        }
    }
}

impl IntegratorConfig {
    /// Returns true if pixels whose angles change by `pixel_rad` (rad) from one to the next are
    /// deep: closer than [`IntegratorConfig::deep_below`].
    pub fn is_deep(&self, pixel_rad: f64) -> bool {
        pixel_rad < self.deep_below()
    }

    /// Approximate number of pixels along the side of a leaf of a deep picture. With fewer, pixels
    /// begin later and f32 errs less; with more, fewer cells are followed (measured).
    pub fn leaf_pixels(&self) -> u32 {
        if self.precision == Precision::F32 { 16 } else { 64 }
    }

    /// Distance between starts, in rad, below which they are followed as cells and integrated from
    /// where the cells end. Adaptive methods benefit from cells early; fixed steps run from the
    /// release as long as their number type can tell the starts apart.
    pub(crate) fn deep_below(&self) -> f64 {
        match (self.method, self.precision) {
            (_, Precision::Dd) => 1e-22,
            (Method::Rk4 { .. }, Precision::F32) => 1e-6,
            (Method::Rk4 { .. }, _) => 1e-13,
            // Starts rounded to 1e-7 are soon far from where they should be.
            (_, Precision::F32) => 5e-4,
            _ => DEEP_BELOW,
        }
    }
}

/// Distance between starts, in rad, below which polynomials save more than they cost (measured).
const DEEP_BELOW: f64 = 1e-4;

/// Number of midpoint rules that an extrapolation combines: enough for long steps at the tolerances
/// used in double-double.
pub(crate) const COLUMNS: usize = 9;

/// The number type in which a pixel is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// Single precision, 24 bits, with a compensated state where the device can be trusted with it.
    F32,
    /// Two f32: 48 bits, on devices whose compilers keep error terms.
    Df32,
    /// Double precision, 53 bits.
    F64,
    /// Two f64: 106 bits, on the processor.
    Dd,
}

impl Precision {
    /// Every precision with its name.
    pub const ALL: [(&'static str, Precision); 4] = [
        ("f32", Precision::F32),
        ("df32", Precision::Df32),
        ("f64", Precision::F64),
        ("dd", Precision::Dd),
    ];

    /// Unit roundoff: half the distance from 1 to the next number.
    pub(crate) fn epsilon(self) -> f64 {
        match self {
            Precision::F32 => f64::from(f32::EPSILON) / 2.0,
            Precision::Df32 => f64::from(f32::EPSILON).powi(2) / 2.0,
            Precision::F64 => f64::EPSILON / 2.0,
            Precision::Dd => f64::EPSILON.powi(2) / 2.0,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, _) = Self::ALL[Self::ALL.iter().position(|(_, p)| p == self).unwrap_or(0)];
        f.write_str(word)
    }
}

impl FromStr for Precision {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        named("precisions", &Self::ALL, text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_read_well() {
        assert_eq!(Method::LESSON.setting(), "step 1/120");
        assert_eq!(Method::Rk4 { step_secs: 0.3 }.setting(), "step 0.3");
    }
}
