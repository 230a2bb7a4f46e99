//! The loop from a picture's work to its files: the same on the command line and in a window.

use std::time::{Duration, Instant};

use super::failure::RenderError;
use super::{RowOrder, SinkPass, Sinks};
use crate::engine::Engine;
use crate::tiles::{Counts, Work};

/// How long was spent.
#[derive(Clone, Copy, Debug, Default)]
pub struct RenderClock {
    /// Computing samples.
    pub compute: Duration,
    /// Painting and writing them.
    pub output: Duration,
}

/// How often a stop is looked for.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs one pass and hands its samples on, rows from the top. `go_on` hears what has been done,
/// at least every few hundredths of a second, and answers whether to go on.
pub fn render_pass(
    work: &mut Work,
    engine: &mut dyn Engine,
    sinks: &mut Sinks,
    pass: &SinkPass,
    clock: &mut RenderClock,
    go_on: &mut dyn FnMut(&Counts) -> bool,
) -> Result<(), RenderError> {
    let mut rows = RowOrder::default();
    while !work.is_done() {
        let computing = Instant::now();
        let finished = work.work(engine, Some(computing + PATIENCE))?;
        clock.compute += computing.elapsed();
        let writing = Instant::now();
        for samples in finished.into_iter().flat_map(|tile| rows.push(tile)) {
            sinks.write(pass, &samples)?;
            heed(go_on(&work.counts()))?;
        }
        clock.output += writing.elapsed();
        heed(go_on(&work.counts()))?;
    }
    Ok(())
}

fn heed(go_on: bool) -> Result<(), RenderError> {
    if go_on { Ok(()) } else { Err(RenderError::Stopped) }
}
