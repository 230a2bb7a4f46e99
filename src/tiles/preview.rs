//! A small picture of a scene, to choose the colours of a large one or the place to go deeper.

use std::time::{Duration, Instant};

use super::{Counts, Samples, Work};
use crate::engine::{Engine, EngineError};

/// Longest wait for the engine before `go_on` is called again.
const PATIENCE: Duration = Duration::from_millis(50);

/// Returns the samples of a picture of `size` pixels, row by row from the top, or `None` once
/// `go_on`, which takes the counts so far, returns false.
pub fn preview(
    work: &mut Work,
    size: [u32; 2],
    engine: &mut dyn Engine,
    go_on: &dyn Fn(&Counts) -> bool,
) -> Result<Option<Samples>, EngineError> {
    let mut all = Samples::unanswered((size[0] * size[1]) as usize, work.channels());
    while !work.is_done() {
        if !go_on(&work.counts()) {
            engine.cancel();
            return Ok(None);
        }
        for part in work.work(engine, Some(Instant::now() + PATIENCE))? {
            for (k, [x, y]) in part.tile.pixels().enumerate() {
                let place = (y * size[0] + x) as usize;
                let status = part.samples.get(k).status;
                all.set_values(place, status, part.samples.values(k));
                all.set_trust(place, part.samples.trust(k));
            }
        }
    }
    Ok(Some(all))
}
