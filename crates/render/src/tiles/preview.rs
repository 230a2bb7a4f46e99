//! A small picture of a scene, to choose the colours of a large one or the place to go deeper.

use std::time::Duration;

use super::{Counts, FinishedTile, Samples, Work};
use flipmap_engine::clock::Instant;
use flipmap_engine::{Engine, EngineError};

/// Longest wait for the engine before `keep_going` is called again.
const PATIENCE: Duration = Duration::from_millis(50);

/// Returns the samples of a picture of `size` pixels, row by row from the top, or `None` once
/// `keep_going`, which takes the counts so far, returns false.
pub fn preview(
    work: &mut Work,
    size: [u32; 2],
    engine: &mut dyn Engine,
    keep_going: &dyn Fn(&Counts) -> bool,
) -> Result<Option<Samples>, EngineError> {
    let mut all = Samples::unanswered(size[0] as usize * size[1] as usize, work.channels());
    while !work.is_done() {
        if !keep_going(&work.counts()) {
            engine.cancel();
            return Ok(None);
        }
        for FinishedTile { tile, samples } in work.work(engine, Some(Instant::now() + PATIENCE))? {
            let ([x, y], [width, height]) = (tile.origin, tile.size);
            for row in 0..height {
                let place = ((y + row) * size[0] + x) as usize;
                let part = (row * width) as usize..((row + 1) * width) as usize;
                all.copy(place, &samples, part);
            }
        }
    }
    Ok(Some(all))
}
