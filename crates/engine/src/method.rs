//! Methods and precisions, with the properties that depend on nothing else.

use std::fmt;
use std::str::FromStr;

use flipmap_scene::named;

use super::IntegratorConfig;
use flipmap_pendulum::embedded::Pair;
use flipmap_pendulum::{extrapolation, series};

/// The method by which a pixel is integrated.
#[derive(Clone, Copy, PartialEq)]
pub enum Method {
    /// The classical Runge–Kutta method with a fixed step in seconds.
    Rk4 {
        /// Length of the step in seconds.
        step_secs: f64,
    },
    /// An embedded pair.
    Embedded {
        /// The pair.
        pair: Pair,
        /// Tolerance of one step just after the release; it rises from there (see
        /// `flipmap_pendulum::control`).
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

/// Names of the methods that are no embedded pairs.
const RK4: &str = "rk4";
const TAYLOR: &str = "taylor";

impl Method {
    /// The lesson's method: RK4 with 120 steps per second.
    pub const LESSON: Method = Method::Rk4 { step_secs: 1.0 / 120.0 };

    /// The method of Dormand and Prince's pair of orders 5 and 4.
    pub const fn dopri5(tolerance: f64) -> Self {
        Method::Embedded { pair: Pair::Dopri5, tolerance }
    }

    /// The method of Dormand and Prince's pair of order 8.
    pub const fn dop853(tolerance: f64) -> Self {
        Method::Embedded { pair: Pair::Dop853, tolerance }
    }

    /// Returns the names of the methods that users can ask for.
    pub fn names() -> Vec<&'static str> {
        let pairs = Pair::ALL.map(|pair| pair.data().name);
        [&[RK4][..], &pairs, &[TAYLOR]].concat()
    }

    /// The method called `name` with the setting that suits `precision`.
    pub fn named(name: &str, precision: Precision) -> Option<Method> {
        let of_pairs = match precision {
            Precision::F32 => 5e-8,
            Precision::Df32 => 1e-12,
            Precision::F64 | Precision::Dd => 3e-13,
        };
        let of_series = if precision == Precision::Dd { 1e-25 } else { 1e-15 };
        match name {
            RK4 => Some(Method::LESSON),
            TAYLOR => Some(Method::Taylor { tolerance: of_series }),
            name => {
                let pair = Pair::ALL.into_iter().find(|pair| pair.data().name == name)?;
                Some(Method::Embedded { pair, tolerance: of_pairs })
            }
        }
    }

    /// Name of the method.
    pub fn name(self) -> &'static str {
        match self {
            Method::Rk4 { .. } => RK4,
            Method::Embedded { pair, .. } => pair.data().name,
            Method::Taylor { .. } => TAYLOR,
            Method::Extrapolation { .. } => "extrapolation",
        }
    }

    /// The precision that suits a method best: small steps are no better than f32.
    pub(crate) fn home_precision(name: &str) -> Precision {
        match Self::named(name, Precision::F64) {
            Some(Method::Rk4 { .. }) => Precision::F32,
            Some(Method::Embedded { pair, .. }) if pair.data().order <= 5 => Precision::F32,
            Some(
                Method::Embedded { .. } | Method::Taylor { .. } | Method::Extrapolation { .. },
            )
            | None => Precision::F64,
        }
    }

    /// The method that suits a precision best.
    pub(crate) fn home_method(precision: Precision) -> &'static str {
        match precision {
            Precision::F32 => Pair::Dopri5.data().name,
            Precision::Df32 | Precision::F64 => Pair::Dop853.data().name,
            Precision::Dd => TAYLOR,
        }
    }

    /// Returns true if steps are taken by Taylor expansions.
    pub(crate) fn is_series(self) -> bool {
        matches!(self, Method::Taylor { .. })
    }

    /// Returns true if the method keeps one tolerance at all times.
    pub(crate) fn is_steady(self) -> bool {
        match self {
            Method::Taylor { .. } | Method::Extrapolation { .. } => true,
            Method::Rk4 { .. } | Method::Embedded { .. } => false,
        }
    }

    /// Returns the length of fixed steps in s, or `None` for adaptive ones.
    pub fn step_secs(self) -> Option<f64> {
        match self {
            Method::Rk4 { step_secs } => Some(step_secs),
            Method::Embedded { .. } | Method::Taylor { .. } | Method::Extrapolation { .. } => None,
        }
    }

    /// Returns the method with another tolerance, or `None` for fixed steps.
    pub(crate) fn with_tolerance(self, tolerance: f64) -> Option<Method> {
        match self {
            Method::Rk4 { .. } => None,
            Method::Embedded { pair, .. } => Some(Method::Embedded { pair, tolerance }),
            Method::Taylor { .. } => Some(Method::Taylor { tolerance }),
            Method::Extrapolation { .. } => Some(Method::Extrapolation { tolerance }),
        }
    }

    /// Returns the method's tolerance, or `None` for fixed steps.
    pub fn tolerance(self) -> Option<f64> {
        match self {
            Method::Rk4 { .. } => None,
            Method::Embedded { tolerance, .. }
            | Method::Taylor { tolerance }
            | Method::Extrapolation { tolerance } => Some(tolerance),
        }
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
            Method::Embedded { tolerance, .. }
            | Method::Taylor { tolerance }
            | Method::Extrapolation { tolerance } => format!("tolerance {tolerance:e}"),
        }
    }

    /// Right-hand sides per step; for an expansion, its order.
    pub(crate) fn rhs_per_step(self, precision: Precision) -> u64 {
        match self {
            Method::Rk4 { .. } => 4,
            Method::Embedded { pair, .. } => pair.data().rhs_per_step,
            Method::Taylor { .. } if precision == Precision::Dd => series::ORDER_DD as u64,
            Method::Taylor { .. } => series::ORDER_F64 as u64,
            Method::Extrapolation { .. } => extrapolation::rhs_per_step(COLUMNS) as u64,
        }
    }

    /// Approximate error scale of the method from the release: its error as one of the release.
    pub(crate) fn error_scale(self) -> f64 {
        match self {
            Method::Rk4 { .. } => 1e-3,
            Method::Embedded { pair, tolerance } => pair.data().error_scale * tolerance,
            Method::Taylor { tolerance } => 0.5 * tolerance,
            Method::Extrapolation { tolerance } => 0.1 * tolerance,
        }
    }

    /// Approximate error of the method after a start map, expressed as an error of the state with
    /// which it begins. That of Taylor expansions is below the map's own error in all leaves that are
    /// followed, so that no verdict depends on it.
    pub(crate) fn error_scale_after_map(self) -> f64 {
        match self {
            Method::Rk4 { .. } => 1e-3,
            Method::Embedded { pair, tolerance } => pair.data().error_scale_after_map * tolerance,
            Method::Taylor { tolerance } | Method::Extrapolation { tolerance } => tolerance,
        }
    }

    /// Number of the method's colour in charts.
    pub fn colour(self) -> usize {
        match self {
            Method::Rk4 { .. } => 0,
            Method::Embedded { pair, .. } => pair.data().colour,
            Method::Taylor { .. } => 3,
            Method::Extrapolation { .. } => 4,
        }
    }

    /// Returns the least tolerance that the method can keep in `precision`, or `None` if the two do
    /// not go together.
    pub(crate) fn least_tolerance(self, precision: Precision) -> Option<f64> {
        match (self, precision) {
            (Method::Rk4 { .. }, Precision::F32 | Precision::F64) => Some(0.0),
            (Method::Rk4 { .. }, Precision::Df32 | Precision::Dd)
            | (Method::Embedded { .. }, Precision::Dd)
            | (Method::Taylor { .. }, Precision::F32 | Precision::Df32)
            | (Method::Extrapolation { .. }, Precision::F32 | Precision::Df32 | Precision::F64) => {
                None
            }
            (Method::Embedded { .. }, Precision::F32) => Some(1e-8),
            (Method::Embedded { .. }, Precision::Df32) => Some(1e-13),
            (Method::Embedded { .. } | Method::Taylor { .. }, Precision::F64) => Some(1e-15),
            (Method::Taylor { .. }, Precision::Dd) => Some(1e-28),
            (Method::Extrapolation { .. }, Precision::Dd) => Some(1e-27),
        }
    }
}

/// Prints each method under its own name. The digests of shards contain this text, so that samples
/// computed earlier stay valid.
impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, setting, value) = match *self {
            Method::Rk4 { step_secs } => ("Rk4".to_string(), "step_secs", step_secs),
            Method::Embedded { pair, tolerance } => (format!("{pair:?}"), "tolerance", tolerance),
            Method::Taylor { tolerance } => ("Taylor".to_string(), "tolerance", tolerance),
            Method::Extrapolation { tolerance } => {
                ("Extrapolation".to_string(), "tolerance", tolerance)
            }
        };
        f.debug_struct(&name).field(setting, &value).finish()
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
        match (self.precision, self.method.step_secs()) {
            (Precision::Dd, _) => 1e-22,
            (Precision::F32, Some(_)) => 1e-6,
            (Precision::Df32 | Precision::F64, Some(_)) => 1e-13,
            // Starts rounded to 1e-7 are soon far from where they should be.
            (Precision::F32, None) => 5e-4,
            (Precision::Df32 | Precision::F64, None) => DEEP_BELOW,
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

    #[test]
    fn methods_are_printed_as_the_digests_of_earlier_shards_have_them() {
        let printed = |method: Method| format!("{method:?}");
        assert_eq!(printed(Method::dop853(3e-13)), "Dop853 { tolerance: 3e-13 }");
        assert_eq!(printed(Method::dopri5(5e-8)), "Dopri5 { tolerance: 5e-8 }");
        assert_eq!(printed(Method::Taylor { tolerance: 1e-15 }), "Taylor { tolerance: 1e-15 }");
        assert_eq!(printed(Method::Rk4 { step_secs: 0.01 }), "Rk4 { step_secs: 0.01 }");
    }

    #[test]
    fn every_method_has_a_setting_and_a_home() {
        for name in Method::names() {
            let precision = Method::home_precision(name);
            let method = Method::named(name, precision).unwrap();
            assert_eq!(method.name(), name);
            assert!(method.least_tolerance(precision).is_some());
        }
        for (_, precision) in Precision::ALL {
            let method = Method::named(Method::home_method(precision), precision).unwrap();
            let least = method.least_tolerance(precision).unwrap();
            assert!(method.tolerance().unwrap() >= least, "{precision}");
        }
        assert_eq!(Method::named("euler", Precision::F32), None);
    }
}
