//! The budget of a pixel: a number of simulated seconds, or as many as the view's depth needs.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Build, View};
use crate::physics::Scalar;

/// Simulated seconds that a pixel may use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Number of seconds.
    pub secs: f64,
    /// True if the seconds follow the view's width.
    pub auto: bool,
}

/// The least automatic budget: that of the home map (30 s), in the default pendulum's units.
const LEAST_UNITS: f64 = 93.962_758_580_194_95;
/// Units of time per decade of width. Neighbours move apart by at most about 0.3 decades a second,
/// so those of a view ten times smaller need 3.3 s (10.4 units) more to be as far apart, and to
/// flip as differently.
const UNITS_A_DECADE: f64 = 10.44;
/// Step of automatic budgets in units of time, so that moving a little recomputes nothing.
const STEP_UNITS: f64 = 31.320_919_526_731_65;

impl Budget {
    /// A fixed budget of `secs` seconds.
    pub const fn secs(secs: f64) -> Self {
        Budget { secs, auto: false }
    }

    /// The same budget, fitted to the width of a view if it is automatic.
    pub fn for_width(self, build: &Build, width_rad: f64) -> Self {
        if !self.auto {
            return self;
        }
        let decades = (std::f64::consts::TAU / width_rad).log10();
        let steps = ((UNITS_A_DECADE * decades).max(LEAST_UNITS) / STEP_UNITS).ceil();
        let secs = steps * STEP_UNITS * build.unit_secs();
        // Whole seconds for the default pendulum.
        Budget { secs: (secs * 100.0).round() / 100.0, auto: true }
    }

    /// The same budget, fitted to a checked view if it is automatic.
    pub fn for_view(self, build: &Build, view: &View) -> Self {
        self.for_width(build, view.width_rad().to_f64())
    }
}

impl Default for Budget {
    fn default() -> Self {
        Budget::secs(30.0)
    }
}

/// The form in files, locations and options: the number of seconds, or `auto`.
impl std::fmt::Display for Budget {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.auto { f.write_str("auto") } else { self.secs.fmt(f) }
    }
}

impl std::str::FromStr for Budget {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        match text.trim() {
            "auto" => Ok(Budget { auto: true, ..Budget::default() }),
            secs => secs.parse().map(Budget::secs).map_err(|_| ()),
        }
    }
}

impl Serialize for Budget {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.auto { serializer.serialize_str("auto") } else { self.secs.serialize(serializer) }
    }
}

impl<'de> Deserialize<'de> for Budget {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl serde::de::Visitor<'_> for Either {
            type Value = Budget;
            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a number of seconds or \"auto\"")
            }
            fn visit_f64<E>(self, secs: f64) -> Result<Budget, E> {
                Ok(Budget::secs(secs))
            }
            fn visit_i64<E>(self, secs: i64) -> Result<Budget, E> {
                Ok(Budget::secs(secs as f64))
            }
            fn visit_u64<E>(self, secs: u64) -> Result<Budget, E> {
                Ok(Budget::secs(secs as f64))
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Budget, E> {
                let wrong = || E::invalid_value(serde::de::Unexpected::Str(text), &self);
                if text == "auto" { text.parse().map_err(|()| wrong()) } else { Err(wrong()) }
            }
        }
        deserializer.deserialize_any(Either)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn automatic_budgets_grow_with_depth_in_steps() {
        let auto: Budget = "auto".parse().unwrap();
        let secs = |width| auto.for_width(&Build::default(), width).secs;
        assert_eq!((secs(6.0), secs(1e-7)), (30.0, 30.0));
        assert_eq!((secs(1e-20), secs(1e-50), secs(1e-100)), (70.0, 170.0, 340.0));
        let moon = Build { gravity: (9.81 / 4.0).into(), ..Build::default() };
        assert_eq!(auto.for_width(&moon, 1.0).secs, 60.0);
        assert_eq!(Budget::secs(7.0).for_width(&moon, 1e-50).secs, 7.0);
    }

    #[test]
    fn budgets_are_written_as_they_are_read() {
        for text in ["auto", "30", "0.5"] {
            assert_eq!(text.parse::<Budget>().unwrap().to_string(), text);
        }
        assert!("long".parse::<Budget>().is_err());
    }
}
