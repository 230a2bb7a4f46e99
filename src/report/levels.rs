//! Which rows of a report speak of which accuracy level.

use super::{Report, Row};
use crate::engine::{Accuracy, Recipe};

/// The rows with a recipe, one for each engine that has it.
pub fn rows_with(report: &Report, recipe: Recipe) -> Vec<&Row> {
    report.rows.iter().filter(|row| row.recipe == recipe).collect()
}

/// The rows of a level, one for each engine: that with the first of its recipes that the engine
/// has, or of a level that verifies that in which it did.
pub fn rows_at(report: &Report, level: Accuracy) -> Vec<&Row> {
    if level.verifies() {
        return report.exact.iter().collect();
    }
    let mut found: Vec<&Row> = Vec::new();
    for recipe in level.recipes() {
        for row in rows_with(report, recipe) {
            if found.iter().all(|known| known.full_name() != row.full_name()) {
                found.push(row);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::{made_up, plan};
    use super::*;

    #[test]
    fn an_engine_without_f64_is_balanced_in_df32() {
        let mut report = made_up::report();
        let recipes = |report: &Report| {
            let rows = rows_at(report, Accuracy::Balanced);
            rows.iter().map(|row| row.recipe).collect::<Vec<Recipe>>()
        };
        assert_eq!(recipes(&report), [plan::BALANCED]);
        let mut other = report.rows[0].clone();
        (other.engine, other.recipe) = ("gpu".to_string(), plan::BALANCED_DF32);
        report.rows.push(other);
        assert_eq!(recipes(&report), [plan::BALANCED, plan::BALANCED_DF32]);
        report.rows[2].engine = report.rows[0].engine.clone();
        assert_eq!(recipes(&report), [plan::BALANCED]);
        assert_eq!(rows_at(&report, Accuracy::Exact).len(), report.exact.len());
    }
}
