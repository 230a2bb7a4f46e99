//! Values that the shader files ask for by name.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::Precision;
use crate::adapters::Pairs;
use crate::integrator_state::SLOPES;
use flipmap_pendulum::tangents::LARGE;
use flipmap_scene::question::Needs;

/// Values of a kernel's text.
#[derive(Serialize)]
pub(super) struct Values {
    pub(super) general: bool,
    pub(super) adaptive: bool,
    pub(super) compensated: bool,
    /// True if numbers are f64.
    pub(super) doubles: bool,
    pub(super) subgroups: bool,
    pub(super) state: Vec<&'static str>,
    /// The numbers of the state that a step changes.
    pub(super) moving: Vec<&'static str>,
    /// The other results of a step, by which it is judged.
    pub(super) judged: Vec<String>,
    #[serde(flatten)]
    pub(super) pairs: PairValues,
    #[serde(flatten)]
    pub(super) carried: CarriedValues,
    pub(super) watched: Vec<usize>,
    pub(super) bobs: usize,
    #[serde(flatten)]
    pub(super) counts: CountValues,
    pub(super) befores: String,
    pub(super) nows: String,
    pub(super) is_watched: &'static str,
    pub(super) moment: &'static str,
    #[serde(flatten)]
    pub(super) control: ControlValues,
    pub(super) quartic: bool,
    pub(super) bows: Vec<String>,
    pub(super) maths: BTreeMap<String, String>,
    #[serde(flatten)]
    pub(super) texts: TextValues,
}

/// Parts of the text of every kernel.
#[derive(Serialize)]
pub(super) struct TextValues {
    pub(super) statuses: String,
    /// The energy below which a pendulum is done early, as a shader literal.
    pub(super) least_energy: Option<String>,
}

/// Values of kernels that count turns or passes.
#[derive(Serialize)]
pub(super) struct CountValues {
    /// The watched bobs as shader literals, filled up to two.
    pub(super) numbers: Vec<String>,
    pub(super) counts_turns: bool,
    pub(super) counts_passes: bool,
    pub(super) passes: u32,
    /// Expression for the length into a step at which the top is passed.
    pub(super) flip_length: &'static str,
}

/// Values of kernels whose number type may be a pair of f32.
#[derive(Serialize)]
pub(super) struct PairValues {
    /// True if the number type is a pair of f32.
    pub(super) pairs: bool,
    pub(super) fused: bool,
    pub(super) guards_results: bool,
    pub(super) guards_all: bool,
}

impl PairValues {
    pub(super) fn new(precision: Precision, pairs: Pairs) -> Self {
        PairValues {
            pairs: precision == Precision::Df32,
            fused: pairs == Pairs::Fused,
            guards_results: matches!(pairs, Pairs::Results | Pairs::Guarded),
            guards_all: pairs == Pairs::Guarded,
        }
    }
}

/// Values of kernels whose pendulums carry additional numbers along.
#[derive(Serialize)]
pub(super) struct CarriedValues {
    pub(super) slopes: &'static [&'static str],
    pub(super) large: String,
    pub(super) smaller: String,
    pub(super) log_large: String,
    /// True if the greatest value of a quantity is looked for, false if the least.
    pub(super) greatest: bool,
}

impl CarriedValues {
    pub(super) fn new(ends: Needs) -> Self {
        CarriedValues {
            greatest: matches!(ends, Needs::Extremum(extremum) if extremum.is_greatest()),
            slopes: SLOPES.as_flattened(),
            large: format!("{LARGE:?}"),
            smaller: format!("{:?}", 1.0 / LARGE),
            log_large: format!("{:?}", LARGE.ln()),
        }
    }
}

/// The constants of steps, of their control and of the tests for crossings.
#[derive(Serialize)]
pub(super) struct ControlValues {
    pub(super) far: String,
    pub(super) slack: String,
    pub(super) exponent: String,
    pub(super) safety: String,
    pub(super) shrink: String,
    pub(super) grow: String,
    pub(super) longest: String,
    /// Number of coefficients of an expansion.
    pub(super) terms: usize,
}

/// Values of the text that packs outcomes.
#[derive(Serialize)]
pub(super) struct PackValues {
    /// Number of words for each outcome.
    pub(super) words: usize,
    pub(super) stepped: bool,
    pub(super) has_rest: bool,
    pub(super) statuses: String,
}

/// Values of the self-check's text.
#[derive(Serialize)]
pub(super) struct SelfcheckValues {
    pub(super) compensated: bool,
    #[serde(flatten)]
    pub(super) pairs: PairValues,
    pub(super) maths: String,
}
