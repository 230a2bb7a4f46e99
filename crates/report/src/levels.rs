//! Selection of the report's rows by accuracy level.

use super::{Report, Row};
use flipmap_engine::Accuracy;

/// The rows of a level, one for each engine: the row with the first of the level's configs that the
/// engine has, or, for a level that verifies, the row measured with its checks.
pub(super) fn rows_at(report: &Report, level: Accuracy) -> Vec<&Row> {
    if level.verifies() {
        return report.exact.iter().collect();
    }
    let mut found: Vec<&Row> = Vec::new();
    for config in level.configs() {
        for row in report.rows.iter().filter(|row| row.config == config) {
            if found.iter().all(|known| known.full_name() != row.full_name()) {
                found.push(row);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::{EngineKind, fixtures, plan};
    use super::*;

    #[test]
    fn an_engine_without_f64_is_balanced_in_df32() {
        let mut report = fixtures::report();
        let configs = |report: &Report| {
            let rows = rows_at(report, Accuracy::Balanced);
            rows.iter().map(|row| row.config).collect::<Vec<_>>()
        };
        assert_eq!(configs(&report), [plan::BALANCED]);
        let mut other = report.rows[0].clone();
        (other.engine, other.config) = (EngineKind::Gpu, plan::BALANCED_DF32);
        report.rows.push(other);
        assert_eq!(configs(&report), [plan::BALANCED, plan::BALANCED_DF32]);
        report.rows[2].engine = report.rows[0].engine;
        assert_eq!(configs(&report), [plan::BALANCED]);
        assert_eq!(rows_at(&report, Accuracy::Exact).len(), report.exact.len());
    }
}
