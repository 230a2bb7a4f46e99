//! The loop from a picture's work to its files, the same on the command line and in a window.

use std::time::{Duration, Instant};

use super::failure::RenderError;
use super::{RowOrder, SinkPass, Sinks};
use crate::engine::Engine;
use crate::tiles::{Counts, Work};

/// Time spent on a render.
#[derive(Clone, Copy, Debug, Default)]
pub struct RenderClock {
    /// Time spent on computing samples.
    pub compute: Duration,
    /// Time spent on painting and writing them.
    pub output: Duration,
}

/// Interval at which a request to stop is looked for.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs one pass and hands its samples to `sinks`, rows from the top. `go_on` takes the counts so
/// far, at least every few hundredths of a second, and returns false to stop.
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
