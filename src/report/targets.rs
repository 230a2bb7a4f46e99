//! What was hoped for, beside what was measured.

use serde::Serialize;

use super::Row;
use super::plan::{BALANCED, BALANCED_DF32, FAST, LESSON};
use crate::engine::Recipe;

/// One hope.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Target {
    /// What it is about, and on which engine.
    pub name: String,
    /// What it asks for.
    pub target: String,
    /// What there is; nothing if it was not measured.
    pub measured: Option<f64>,
    /// Whether that is enough.
    pub met: Option<bool>,
}

/// A hope for every engine that has the recipe.
struct Hope {
    about: &'static str,
    recipe: Recipe,
    target: &'static str,
    measure: fn(&Row) -> Option<f64>,
    /// Least and greatest that will do.
    bounds: [f64; 2],
}

const ENDLESS: f64 = f64::INFINITY;

fn right(row: &Row) -> Option<f64> {
    row.errors.right_1ms
}

fn times_scalar(row: &Row) -> Option<f64> {
    Some(row.times_scalar)
}

/// How many times faster than the scalar loop each thread is; of the processor only.
fn times_scalar_per_core(row: &Row) -> Option<f64> {
    Some(row.times_scalar / row.threads? as f64)
}

/// The hopes.
const HOPES: [Hope; 8] = [
    Hope {
        about: "lesson: share right within 1 ms",
        recipe: LESSON,
        target: "0.89 to 0.92, as the lesson is",
        measure: right,
        bounds: [0.89, 0.92],
    },
    Hope {
        about: "lesson: speed",
        recipe: LESSON,
        target: "at least 20 times the scalar loop",
        measure: times_scalar,
        bounds: [20.0, ENDLESS],
    },
    Hope {
        about: "fast: share right within 1 ms",
        recipe: FAST,
        target: "at least 0.925",
        measure: right,
        bounds: [0.925, ENDLESS],
    },
    Hope {
        about: "fast: speed",
        recipe: FAST,
        target: "at least 30 times the scalar loop",
        measure: times_scalar,
        bounds: [30.0, ENDLESS],
    },
    Hope {
        about: "balanced: share right within 1 ms",
        recipe: BALANCED,
        target: "at least 0.999",
        measure: right,
        bounds: [0.999, ENDLESS],
    },
    Hope {
        about: "balanced: speed",
        recipe: BALANCED,
        target: "at least 10 times the scalar loop",
        measure: times_scalar,
        bounds: [10.0, ENDLESS],
    },
    Hope {
        about: "balanced: speed of each core",
        recipe: BALANCED,
        target: "at least 5 times the scalar loop on one core",
        measure: times_scalar_per_core,
        bounds: [5.0, ENDLESS],
    },
    Hope {
        about: "balanced without f64: share right within 1 ms",
        recipe: BALANCED_DF32,
        target: "at least 0.99",
        measure: right,
        bounds: [0.99, ENDLESS],
    },
];

/// Every hope beside every row that it is about; one without a row is there unmeasured.
pub fn judge(rows: &[Row]) -> Vec<Target> {
    HOPES.iter().flat_map(|hope| hope.judge(rows)).collect()
}

impl Hope {
    fn judge(&self, rows: &[Row]) -> Vec<Target> {
        let about = rows.iter().filter(|row| row.recipe == self.recipe);
        let measured: Vec<Target> = about
            .filter_map(|row| {
                let measured = (self.measure)(row)?;
                let met = measured >= self.bounds[0] && measured <= self.bounds[1];
                let name = format!("{}, on {}", self.about, row.short_name());
                Some(self.target(name, Some((measured, met))))
            })
            .collect();
        if measured.is_empty() {
            return vec![self.target(self.about.to_string(), None)];
        }
        measured
    }

    fn target(&self, name: String, found: Option<(f64, bool)>) -> Target {
        Target {
            name,
            target: self.target.to_string(),
            measured: found.map(|(measured, _)| measured),
            met: found.map(|(_, met)| met),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(recipe: Recipe, right: f64, times: f64) -> Row {
        let mut row = Row::named("cpu", "2 threads", Some(2), recipe);
        (row.errors.right_1ms, row.times_scalar) = (Some(right), times);
        row
    }

    fn met(rows: &[Row], about: &str) -> Option<bool> {
        judge(rows).iter().find(|target| target.name.starts_with(about)).unwrap().met
    }

    #[test]
    fn targets_are_met_missed_or_not_measured() {
        for (about, recipe, good, bad) in [
            ("lesson: share", LESSON, (0.9, 1.0), (0.93, 1.0)),
            ("lesson: share", LESSON, (0.9, 1.0), (0.88, 1.0)),
            ("lesson: speed", LESSON, (0.0, 20.1), (0.0, 19.9)),
            ("fast: share", FAST, (0.926, 1.0), (0.924, 1.0)),
            ("balanced: share", BALANCED, (0.9995, 1.0), (0.9985, 1.0)),
            ("balanced: speed of each core", BALANCED, (0.0, 10.1), (0.0, 9.9)),
            ("balanced without f64", BALANCED_DF32, (0.991, 0.0), (0.989, 0.0)),
        ] {
            assert_eq!(met(&[row(recipe, good.0, good.1)], about), Some(true), "{about}");
            assert_eq!(met(&[row(recipe, bad.0, bad.1)], about), Some(false), "{about}");
            assert_eq!(met(&[], about), None, "{about}");
        }
        assert_eq!(met(&[row(LESSON, f64::NAN, 1.0)], "lesson: share"), Some(false));
    }
}
