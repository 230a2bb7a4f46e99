//! The only path from a pendulum's motion to the rows of its table.

use std::io::{self, Write};

use super::trace::{Advance, Trace};
use crate::Watch;

/// Reasons why a table was not completed.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// The motion is so fast that its numbers are no longer finite.
    #[error("the motion is no longer finite")]
    NotFinite,
    /// A row could not be written.
    #[error(transparent)]
    Write(#[from] io::Error),
    /// A request to stop.
    #[error("stopped")]
    Stopped,
}

/// Index of the column with the energy error.
const ENERGY_ERROR: usize = 5;

impl Trace {
    /// Follows the motion to its end, and passes each row to `take` in the order of
    /// [`Trace::columns`]; NaN where a channel has no value yet.
    pub fn follow(
        &mut self,
        watch: &dyn Watch,
        take: &mut dyn FnMut(&[f64]) -> io::Result<()>,
    ) -> Result<(), TraceError> {
        loop {
            let [done, total] = self.rows();
            if !watch.keep_going(done, total) {
                return Err(TraceError::Stopped);
            }
            match self.advance()? {
                Advance::Row(row) => take(&row)?,
                Advance::Step => {}
                Advance::End => return Ok(()),
            }
        }
    }

    /// Writes the names of the columns and all rows, separated by commas: the energy error, which
    /// is very small, with an exponent, and NaN as an empty cell.
    pub fn write_table(
        &mut self,
        out: &mut dyn Write,
        watch: &dyn Watch,
    ) -> Result<(), TraceError> {
        writeln!(out, "{}", self.columns().join(","))?;
        self.follow(watch, &mut |row| {
            let words = row.iter().enumerate().map(|(column, number)| match column {
                _ if number.is_nan() => String::new(),
                ENERGY_ERROR => format!("{number:e}"),
                _ => number.to_string(),
            });
            writeln!(out, "{}", words.collect::<Vec<_>>().join(","))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::Scene;

    fn trace(until: &str, every: &str) -> Trace {
        Trace::from_text(&Scene::default(), "3,3", until, every).unwrap()
    }

    #[test]
    fn a_table_has_every_row_unless_it_is_stopped() {
        let mut table = Vec::new();
        trace("2", "0.5").write_table(&mut table, &|done, total| done <= total).unwrap();
        assert_eq!(String::from_utf8(table).unwrap().lines().count(), 1 + 5);
        let mut rows = 0;
        let stopped = trace("2", "0.5").follow(&|done, _| done < 3, &mut |_| {
            rows += 1;
            Ok(())
        });
        assert!(matches!(stopped, Err(TraceError::Stopped)) && rows == 3, "{rows}");
    }

    #[test]
    fn a_table_of_too_many_rows_is_refused() {
        let refused = Trace::from_text(&Scene::default(), "3,3", "1e5", "1e-9");
        let error = refused.err().unwrap().to_string();
        assert!(error.starts_with("`every` is 1e-9;") && error.contains("1e14 rows"), "{error}");
    }
}
