//! The verdict of the self-check on an adapter's arithmetic.

use super::Pairs;
use crate::{IntegratorConfig, Precision};

/// The name of the check of expansions. Their kernel is by far the largest, and it can be wrong
/// although the arithmetic and the other kernels are right.
pub(crate) const BY_SERIES: &str = "orbits by taylor";

/// One check of a device, and its result.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// The number type.
    pub precision: Precision,
    /// Name of the check.
    pub name: &'static str,
    /// True if the device passed.
    pub passed: bool,
    /// The worst error, or what went wrong.
    pub detail: String,
}

/// The arithmetic that a device is trusted with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// All checks that were made.
    pub checks: Vec<Check>,
    /// True if f32 arithmetic can be trusted.
    pub f32: bool,
    /// True if f32 error terms survive the compiler, so that states can be compensated.
    pub compensated: bool,
    /// True if pairs of f32 keep 44 bits or more.
    pub df32: bool,
    /// The cheapest arithmetic on pairs of f32 that passes the checks.
    pub pairs: Pairs,
    /// True if the device has f64 arithmetic that can be trusted.
    pub f64: bool,
}

impl Verdict {
    /// Returns the reason as an error if a method is not offered in its precision.
    pub(crate) fn allows(&self, config: &IntegratorConfig) -> Result<(), String> {
        self.require(config.precision)?;
        let failed =
            |check: &&Check| config.method.is_series() && check.name == BY_SERIES && !check.passed;
        match self.checks.iter().find(failed) {
            None => Ok(()),
            Some(check) => Err(format!(
                "this adapter is not trusted with the method taylor: {BY_SERIES} ({}); use the cpu engine",
                check.detail
            )),
        }
    }

    /// Returns the reason as an error if a precision is not offered.
    pub(crate) fn require(&self, precision: Precision) -> Result<(), String> {
        let offered = match precision {
            Precision::F32 => self.f32,
            Precision::Df32 => self.df32,
            Precision::F64 => self.f64,
            Precision::Dd => false,
        };
        if offered {
            return Ok(());
        }
        if precision == Precision::Dd {
            return Err("graphics adapters have no dd; use the cpu engine".to_string());
        }
        let failed: Vec<String> = self
            .checks
            .iter()
            .filter(|check| check.precision == precision && !check.passed)
            .map(|check| format!("{} ({})", check.name, check.detail))
            .collect();
        Err(format!(
            "this adapter is not trusted with the precision {precision}: {}",
            failed.join(", ")
        ))
    }
}
