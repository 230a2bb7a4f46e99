//! Joins parts into the files of a still.

use std::sync::Arc;

use super::task::StillPass;
use super::{PartError, Parts};
use crate::Watch;
use crate::output::{OutputError, Paths, Sinks};
use crate::tiles::{PlainPixels, Samples};
use flipmap_scene::palette::AnswerColours;
use flipmap_scene::{Document, Sampling};

/// Reasons why the parts could not be joined.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// An error of a part.
    #[error(transparent)]
    Part(#[from] PartError),
    /// An error of a still's file.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// A request to stop.
    #[error("stopped; what was computed is kept, merge again")]
    Stopped,
}

/// Number of rows that are passed on together.
const ROWS: u32 = 64;

/// Writes a still from its parts.
pub fn merge_still(
    document: &Document,
    passes: &[StillPass],
    parts: &mut Parts,
    paths: &Paths,
    watch: &dyn Watch,
) -> Result<(), MergeError> {
    let size = document.run.size.unwrap_or([1, 1]);
    let mut sinks = Sinks::open(paths, document, size)?;
    let count = |pass: &StillPass| u64::from(pass.size[0]) * u64::from(pass.size[1]);
    let (mut done, total) = (0, passes.iter().map(count).sum());
    let mut each = |sampling: Sampling,
                    take: &mut dyn FnMut(Samples) -> Result<(), OutputError>| {
        let rows = passes.iter().find(|rows| rows.sampling == sampling).ok_or(PartError::Gone)?;
        let mut row = 0;
        while row < rows.size[1] {
            let samples = some_rows(rows, parts, row)?;
            row += (samples.len() / rows.size[0] as usize) as u32;
            done += samples.len() as u64;
            take(samples)?;
            if !watch.keep_going(done, total) {
                return Err(MergeError::Stopped);
            }
        }
        Ok(())
    };
    for pass in sinks.passes(document.picture.samples) {
        if pass.sampling == Sampling::Corners {
            let mut middles = Samples::default();
            each(Sampling::SINGLE, &mut |samples| {
                middles.append(samples);
                Ok(())
            })?;
            let colours = AnswerColours::new(&document.scene(), &document.picture)
                .map_err(OutputError::from)?;
            let plain = PlainPixels::among(middles, size, &colours, pass.sampling);
            sinks.write_middles(&pass, &Arc::new(plain))?;
        }
        each(pass.sampling, &mut |samples| sinks.write(&pass, &samples))?;
    }
    Ok(sinks.finish()?)
}

/// Returns some rows of samples from `row` on; a row that is not computed is read from its mirror
/// image.
pub(super) fn some_rows(
    pass: &StillPass,
    parts: &mut Parts,
    row: u32,
) -> Result<Samples, PartError> {
    if row < pass.rows {
        return parts.rows(&pass.of, row, ROWS.min(pass.rows - row));
    }
    parts.rows(&pass.of, pass.size[1] - 1 - row, 1).map(|row| row.image(row.len()))
}
