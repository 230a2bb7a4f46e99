//! The choice between following cells of starts and integrating every start from its release.

use std::fmt;
use std::str::FromStr;

use super::{IntegratorConfig, Precision};

/// A choice of the starts that are first followed as cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cells {
    /// Starts so close together that following cells saves time, or that their number type cannot
    /// tell them apart.
    #[default]
    Auto,
    /// No starts.
    Never,
    /// All starts.
    Always,
}

/// The error for starts that would be integrated from their release although their number type
/// cannot tell them apart.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "starts {pixel_rad:.1e} {unit} apart cannot be integrated from their release in {precision}, \
     which tells them apart down to {min_rad:.1e} {unit}"
)]
pub struct Indistinguishable {
    pixel_rad: f64,
    min_rad: f64,
    precision: Precision,
    unit: &'static str,
}

impl Indistinguishable {
    /// The same error for starts on a plane whose coordinates are not in rad.
    #[must_use]
    pub fn in_unit(self, unit: &'static str) -> Self {
        Indistinguishable { unit, ..self }
    }
}

/// Least distance between starts that a number type can tell apart, in rounding errors of π.
const ROUNDINGS: f64 = 30.0;

impl Cells {
    /// Every choice.
    pub const ALL: [Cells; 3] = [Cells::Auto, Cells::Never, Cells::Always];

    /// Returns true if starts `pixel_rad` (rad) apart are followed as cells.
    pub fn are_followed(self, config: &IntegratorConfig, pixel_rad: f64) -> bool {
        match self {
            Cells::Auto => config.is_deep(pixel_rad),
            Cells::Never => false,
            Cells::Always => true,
        }
    }

    /// Returns an error if starts `pixel_rad` (rad) apart would have to be integrated from their
    /// release but are too close together for that.
    pub fn check(self, config: &IntegratorConfig, pixel_rad: f64) -> Result<(), Indistinguishable> {
        let precision = config.precision;
        let min_rad = ROUNDINGS * std::f64::consts::PI * precision.epsilon();
        if self == Cells::Never && pixel_rad < min_rad {
            return Err(Indistinguishable { pixel_rad, min_rad, precision, unit: "rad" });
        }
        Ok(())
    }
}

/// Writes the word that stands for the choice in options and files.
impl fmt::Display for Cells {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Cells::Auto => "auto",
            Cells::Never => "never",
            Cells::Always => "always",
        })
    }
}

impl FromStr for Cells {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let named = Cells::ALL.into_iter().find(|cells| cells.to_string() == word);
        named.ok_or_else(|| "it is auto, never or always".to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::level::{BALANCED, FAST};

    #[test]
    fn starts_that_are_too_close_are_refused_where_cells_are() {
        assert!(Cells::Never.check(&BALANCED, 1e-12).is_ok());
        let refused = Cells::Never.check(&BALANCED, 1e-15).unwrap_err().to_string();
        assert!(refused.contains("1.0e-15 rad") && refused.contains("f64"), "{refused}");
        let speeds = Cells::Never.check(&FAST, 1e-9).unwrap_err().in_unit("rad/s").to_string();
        assert!(speeds.contains("starts 1.0e-9 rad/s apart") && speeds.ends_with("rad/s"));
        assert!(Cells::Auto.check(&FAST, 1e-9).is_ok());
        assert!(Cells::Auto.are_followed(&BALANCED, 1e-9));
        assert!(!Cells::Never.are_followed(&BALANCED, 1e-9));
        assert!(Cells::Always.are_followed(&BALANCED, 1e-1));
    }
}
