//! The computations that a start may need until its answer is sure, from the cheapest up.
//!
//! Each has an *error scale*: about how far off (in unit vectors and scaled momenta) it is, taken
//! back to the release, so that the growth of errors from there to the end gives its error at
//! the end. Only ratios of scales are ever used. They were measured against the gold standard on
//! the home map and on random scenes; `docs/accuracy.md` has the figures.

use crate::engine::level::{BALANCED, FAST};
use crate::engine::{Method, Precision, Recipe};
use crate::physics::Dd;

/// One way of computing a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// How it is integrated.
    pub recipe: Recipe,
    /// How far its start is moved, rad: what growth makes of so small and known a displacement,
    /// it has made of errors.
    pub nudge_rad: [f64; 2],
    /// Of deep starts whether they are followed on start maps with other cuts and smaller errors.
    pub strict: bool,
}

impl Run {
    const fn plain(recipe: Recipe) -> Self {
        Run { recipe, nudge_rad: [0.0; 2], strict: false }
    }

    const fn nudged(recipe: Recipe, nudge_rad: [f64; 2]) -> Self {
        Run { recipe, nudge_rad, strict: false }
    }

    /// The start of a run from a start at rest.
    pub fn start(&self, angle: [Dd; 2]) -> [Dd; 2] {
        [0, 1].map(|i| angle[i] + Dd::new(self.nudge_rad[i]))
    }

    /// Its error scale.
    pub fn error_scale(&self) -> f64 {
        let [first, second] = self.nudge_rad;
        error_scale(&self.recipe).max(first.hypot(second))
    }
}

/// About how far off a recipe is, taken back to the release.
fn error_scale(recipe: &Recipe) -> f64 {
    let rounding = match recipe.precision {
        Precision::F32 => 2e-7,
        Precision::Df32 => 1e-13,
        Precision::F64 => 1e-15,
        Precision::Dd => 1e-29,
    };
    rounding
        + match recipe.method {
            Method::Rk4 { .. } => 1e-3,
            Method::Dopri5 { tolerance } => 2.5 * tolerance,
            Method::Dop853 { tolerance } => 0.7 * tolerance,
            Method::Taylor { tolerance } => 0.5 * tolerance,
            Method::Extrapolation { tolerance } => 0.1 * tolerance,
        }
}

/// A recipe whose errors are this far below those of a probe in f32 needs no finer first run.
const FINE: f64 = 1e-11;

const fn f64_run(method: Method) -> Recipe {
    Recipe { method, precision: Precision::F64 }
}
const fn extrapolated(tolerance: f64) -> Recipe {
    Recipe { method: Method::Extrapolation { tolerance }, precision: Precision::Dd }
}
const fn dd_run(tolerance: f64) -> Recipe {
    Recipe { method: Method::Taylor { tolerance }, precision: Precision::Dd }
}

/// Finer than `balanced`, and a coarser one of another method.
const FINER: Recipe = f64_run(Method::Dop853 { tolerance: 1e-14 });
const OTHER: Recipe = f64_run(Method::Dopri5 { tolerance: 1e-10 });
/// The finest in f64, and one whose errors are far below its nudge.
const FINEST: Recipe = f64_run(Method::Taylor { tolerance: 1e-15 });
const NUDGED: Recipe = f64_run(Method::Dop853 { tolerance: 1e-14 });

/// The runs that are made one after the other, as long as a start is not sure: all of a rung, on
/// the starts that are left. The first rung begins with the finest it has.
pub fn rungs(recipe: &Recipe, deep: bool) -> Vec<Vec<Run>> {
    let fine = error_scale(recipe) <= FINE;
    let first = if fine { *recipe } else { BALANCED };
    if deep {
        return deep_rungs(first);
    }
    let probe = match first.method {
        // Another method than the first one's, with another test for passes.
        Method::Dopri5 { tolerance: _ } => {
            Recipe { method: Method::Dop853 { tolerance: 5e-8 }, precision: Precision::F32 }
        }
        _ => FAST,
    };
    vec![
        vec![Run::plain(first), Run::plain(probe)],
        vec![Run::nudged(probe, [2.4e-7, 1.8e-7])],
        vec![Run::plain(FINER), Run::nudged(OTHER, [-0.6e-10, 0.8e-10])],
        vec![
            Run::plain(FINEST),
            Run::nudged(NUDGED, [0.8e-12, 0.6e-12]),
            Run::nudged(NUDGED, [-0.6e-12, 0.8e-12]),
            Run::nudged(NUDGED, [0.28e-12, -0.96e-12]),
        ],
        vec![Run::plain(extrapolated(1e-20))],
        vec![Run::plain(dd_run(1e-28)), Run::plain(extrapolated(1e-25))],
    ]
}

fn deep_rungs(first: Recipe) -> Vec<Vec<Run>> {
    let strict = |recipe| Run { strict: true, ..Run::plain(recipe) };
    vec![
        vec![strict(first), Run::plain(FAST)],
        vec![Run::plain(OTHER)],
        vec![strict(dd_run(1e-26)), Run::plain(dd_run(1e-23))],
    ]
}

/// Rungs up to this one are cheap,
pub const CHEAP: usize = 2;
/// and up to this one in f64.
pub const IN_F64: usize = 4;
