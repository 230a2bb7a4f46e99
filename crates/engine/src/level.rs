//! Accuracy levels, by which users say how accurate a picture must be, and their configurations.

use std::fmt;
use std::str::FromStr;

use flipmap_scene::named;
use serde::{Deserialize, Serialize};

use super::{IntegratorConfig, Method, Precision};

/// The accuracy that is required of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Accuracy {
    /// RK4 at 120 steps a second in f32, as in the lesson.
    Lesson,
    /// The best accuracy of f32.
    Fast,
    /// Right within 1 ms, except for one pixel in a thousand.
    #[default]
    Balanced,
    /// As [`Accuracy::Balanced`], with every pixel checked, and marked where the checks disagree.
    Exact,
}

/// Configuration of `lesson`.
pub const LESSON: IntegratorConfig =
    IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
/// Configuration of `fast`.
pub const FAST: IntegratorConfig =
    IntegratorConfig { method: Method::dopri5(5e-8), precision: Precision::F32 };
/// Configuration of `balanced` where f64 is trusted.
pub const BALANCED: IntegratorConfig =
    IntegratorConfig { method: Method::dop853(3e-13), precision: Precision::F64 };
/// Configuration of `balanced` where f64 is not trusted, or is slower.
pub const BALANCED_DF32: IntegratorConfig =
    IntegratorConfig { method: Method::dop853(1e-12), precision: Precision::Df32 };

/// The finest configuration in f64, by which `exact` checks the pixels that others leave open.
pub const FINEST: IntegratorConfig =
    IntegratorConfig { method: Method::Taylor { tolerance: 1e-15 }, precision: Precision::F64 };

/// The levels' configurations whose kernels compile fast, and the lesson's in f64.
pub const FAST_TO_COMPILE: [IntegratorConfig; 4] =
    [LESSON, IntegratorConfig { precision: Precision::F64, ..LESSON }, FAST, BALANCED];

impl Accuracy {
    /// Every level with its name.
    pub const ALL: [(&'static str, Accuracy); 4] = [
        ("lesson", Accuracy::Lesson),
        ("fast", Accuracy::Fast),
        ("balanced", Accuracy::Balanced),
        ("exact", Accuracy::Exact),
    ];

    /// Returns the configurations that keep the level's promise, in the order of preference that
    /// holds until a profile shows which of them is fastest on an adapter.
    pub fn configs(self) -> Vec<IntegratorConfig> {
        match self {
            Accuracy::Lesson => vec![LESSON],
            Accuracy::Fast => vec![FAST],
            Accuracy::Balanced | Accuracy::Exact => vec![BALANCED, BALANCED_DF32],
        }
    }

    /// Least share of the simulated pixels of the whole map that the level promises to be right
    /// within 1 ms (docs/accuracy.md).
    pub(crate) fn promised_share(self) -> f64 {
        match self {
            Accuracy::Lesson => 0.89,
            Accuracy::Fast => 0.925,
            Accuracy::Balanced | Accuracy::Exact => 0.999,
        }
    }

    /// Returns true if every pixel is checked.
    pub fn verifies(self) -> bool {
        self == Accuracy::Exact
    }
}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, _) = Self::ALL[Self::ALL.iter().position(|(_, a)| a == self).unwrap_or(0)];
        f.write_str(word)
    }
}

impl FromStr for Accuracy {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        named("levels", &Self::ALL, text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_is_within_its_precisions_reach() {
        for (word, level) in Accuracy::ALL {
            assert_eq!(word.parse::<Accuracy>().unwrap(), level);
            assert_eq!(level.to_string(), word);
            for config in level.configs() {
                let least = config.method.least_tolerance(config.precision).unwrap();
                assert!(config.method.tolerance().is_none_or(|t| t >= least), "{config:?}");
            }
        }
    }
}
