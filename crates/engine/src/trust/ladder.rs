//! The ladder: computations that a start may need until its answer is sure, from the cheapest up.
//!
//! Each computation has an *error scale*: the error at the release (in unit vectors and scaled
//! momenta) that grows into its expected error at the end. Only ratios of scales are ever used.
//! They were measured against the gold standard on the home map, on random scenes and on deep
//! views; `docs/accuracy.md` has the figures.

use super::Trust;
use crate::level::{BALANCED, FAST, FINEST};
use crate::{FinalState, IntegratorConfig, Method, Precision};
use flipmap_scene::question::Needs;

/// One way of computing a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    /// Method and precision of the integration.
    pub config: IntegratorConfig,
    /// Point at which the integration begins.
    pub from: Origin,
    /// Displacement of the start, in rad, or as a share of half a leaf of a start map. Growth acts
    /// on this small, known displacement as it does on errors.
    pub nudge: [f64; 2],
}

/// Point at which a run's own integration begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// The release at rest.
    Rest,
    /// The end of a start map.
    Map,
    /// The end of another start map, with other cuts and smaller errors.
    StrictMap,
}

/// Runs on the starts that are still open, and the trust in those that they make sure.
#[derive(Clone, Debug)]
pub(super) struct Rung {
    pub runs: Vec<Run>,
    pub trust: Trust,
}

impl Run {
    pub(super) const fn new(config: IntegratorConfig, from: Origin) -> Self {
        Run { config, from, nudge: [0.0; 2] }
    }

    pub(super) const fn nudged(self, nudge: [f64; 2]) -> Self {
        Run { nudge, ..self }
    }

    /// Error scale of the configuration in rad, for an integration from the release.
    pub(super) fn scale_from_rest(&self) -> f64 {
        error_scale(&self.config)
    }

    /// Returns true if the run shares neither the method nor the start map with another one.
    pub(super) fn is_independent_of(&self, other: &Run) -> bool {
        let other_way = self.from != other.from || self.from == Origin::Rest;
        other_way && self.config.method.name() != other.config.method.name()
    }

    /// Error scale in rad of this run's answer that ended in `end`; `leaf_half_rad` is half the
    /// side of the leaves of start maps.
    pub(super) fn error_scale(&self, end: &FinalState, leaf_half_rad: f64) -> f64 {
        let nudge = self.nudge[0].hypot(self.nudge[1]);
        match self.from {
            Origin::Rest => error_scale(&self.config).max(nudge),
            Origin::Map | Origin::StrictMap => {
                let own = error_scale_after_a_map(&self.config) / end.grown;
                own + (leaf_half_rad * nudge.max(OF_MAPS)).max(end.map_error)
            }
        }
    }
}

/// Error scale of rounding, whatever the method. The scale of double-double is below all tolerances
/// used with it, so no verdict depends on it.
fn rounding(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 2e-7,
        Precision::Df32 => 1e-13,
        Precision::F64 => 1e-15,
        Precision::Dd => 1e-29,
    }
}

/// Approximate error scale of a configuration from the release.
fn error_scale(config: &IntegratorConfig) -> f64 {
    rounding(config.precision) + config.method.error_scale()
}

/// Approximate error of a configuration that begins after a start map.
fn error_scale_after_a_map(config: &IntegratorConfig) -> f64 {
    rounding(config.precision) + config.method.error_scale_after_map()
}

/// Least error of start maps, as a share of half a leaf: rounding errors and errors of their steps,
/// which come on top of what their polynomials leave out (see [`FinalState::map_error`]).
const OF_MAPS: f64 = 5e-11;

/// Largest error scale at which a configuration is far enough below a probe in f32 to need no finer
/// first run.
const FINE: f64 = 1e-11;

const fn f64_run(method: Method) -> IntegratorConfig {
    IntegratorConfig { method, precision: Precision::F64 }
}
const fn dd_run(method: Method) -> IntegratorConfig {
    IntegratorConfig { method, precision: Precision::Dd }
}

/// A configuration finer than `balanced`.
const FINER: IntegratorConfig = f64_run(Method::dop853(1e-14));
/// A coarser configuration of another method than [`FINER`].
const OTHER: IntegratorConfig = f64_run(Method::dopri5(1e-10));
/// A configuration in double-double, far finer than f64.
const BEYOND: IntegratorConfig = dd_run(Method::Extrapolation { tolerance: 1e-20 });
/// The finest configuration in double-double.
const LAST: IntegratorConfig = dd_run(Method::Taylor { tolerance: 1e-28 });
/// A configuration in double-double that checks [`LAST`].
const CHECK: IntegratorConfig = dd_run(Method::Extrapolation { tolerance: 1e-25 });

/// Returns the rungs that a start climbs until it is sure; `leaf_half_rad` is half the side of the
/// leaves of deep starts. The first rung begins with its finest run. Runs that an earlier rung has
/// made are left out, because repeating a run confirms nothing.
pub(super) fn rungs(config: &IntegratorConfig, leaf_half_rad: Option<f64>) -> Vec<Rung> {
    let mut rungs = match leaf_half_rad {
        Some(half) => deep_rungs(half),
        None => rungs_from_rest(config),
    };
    let mut made: Vec<Run> = Vec::new();
    for rung in &mut rungs {
        rung.runs.retain(|run| !made.contains(run));
        made.extend(&rung.runs);
    }
    rungs.retain(|rung| !rung.runs.is_empty());
    rungs
}

/// Returns what a run computes if its job `needs` something: at least the ends, which are compared.
pub(super) fn compared(needs: Needs) -> Needs {
    if needs == Needs::Outcome { Needs::End } else { needs }
}

fn rungs_from_rest(config: &IntegratorConfig) -> Vec<Rung> {
    let first = if error_scale(config) <= FINE { *config } else { BALANCED };
    // Another method than the first one's, with another test for crossings.
    let probe = match first.method.name() == FAST.method.name() {
        true => IntegratorConfig { method: Method::dop853(5e-8), precision: Precision::F32 },
        false => FAST,
    };
    let rest = |config| Run::new(config, Origin::Rest);
    let rung = |trust, runs| Rung { runs, trust };
    vec![
        rung(Trust::Agreed, vec![rest(first), rest(probe)]),
        rung(Trust::Agreed, vec![rest(probe).nudged([2.4e-7, 1.8e-7])]),
        rung(Trust::Confirmed, vec![rest(FINER), rest(OTHER).nudged([-0.6e-10, 0.8e-10])]),
        rung(
            Trust::Confirmed,
            vec![
                rest(FINEST),
                rest(FINER).nudged([0.8e-12, 0.6e-12]),
                rest(FINER).nudged([-0.6e-12, 0.8e-12]),
                rest(FINER).nudged([0.28e-12, -0.96e-12]),
            ],
        ),
    ]
    .into_iter()
    .chain(rungs_beyond_f64())
    .collect()
}

/// The rungs in double-double, from the release. Their costs differ widely: the first takes a
/// quarter of the second's time.
fn rungs_beyond_f64() -> impl Iterator<Item = Rung> {
    [BEYOND, LAST, CHECK].into_iter().map(|config| {
        let runs = vec![Run::new(config, Origin::Rest)];
        Rung { runs, trust: Trust::Settled }
    })
}

/// Least half side of leaves, in rad, that double-double can tell apart from the release.
const MIN_HALF_SIDE_FOR_DD: f64 = 1e-22;

fn deep_rungs(leaf_half_rad: f64) -> Vec<Rung> {
    let map = |config| Run::new(config, Origin::Map);
    let strict = |config| Run::new(config, Origin::StrictMap);
    let rung = |trust, runs| Rung { runs, trust };
    let mut rungs = vec![
        rung(Trust::Agreed, vec![strict(FINER), map(FAST)]),
        rung(Trust::Agreed, vec![map(OTHER).nudged([-0.6e-6, 0.8e-6])]),
        rung(
            Trust::Confirmed,
            vec![
                map(FINEST),
                map(FINER).nudged([0.8e-7, 0.6e-7]),
                strict(FINER).nudged([0.28e-7, -0.96e-7]),
            ],
        ),
    ];
    if leaf_half_rad >= MIN_HALF_SIDE_FOR_DD {
        rungs.extend(rungs_beyond_f64());
    }
    rungs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_run_is_its_own_witness() {
        for first in [BALANCED, FINER, OTHER, FINEST, BEYOND, LAST] {
            let all: Vec<Run> =
                rungs(&first, None).into_iter().flat_map(|rung| rung.runs).collect();
            let rest = |config| Run::new(config, Origin::Rest);
            for config in [FINER, FINEST, BEYOND, LAST] {
                let count = all.iter().filter(|run| **run == rest(config)).count();
                assert_eq!(count, 1, "{config:?} after {first:?}");
            }
        }
    }
}
