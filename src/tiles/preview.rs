//! A small picture of a scene: what colours a large one needs, or where to go deeper.

use std::time::{Duration, Instant};

use super::{Samples, Work};
use crate::engine::{Engine, EngineError, Recipe};
use crate::scene::Scene;

/// How often a stop is looked for.
const PATIENCE: Duration = Duration::from_millis(50);

/// The samples of a picture of `size` pixels, by rows from the top; nothing once `go_on` says no.
pub fn preview(
    scene: &Scene,
    size: [u32; 2],
    recipe: Recipe,
    engine: &mut dyn Engine,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Samples>, EngineError> {
    let count = (size[0] * size[1]) as usize;
    let mut all = Samples::unflipped(count);
    let mut work = Work::new(scene, size, recipe, count);
    while !work.is_done() {
        if !go_on() {
            engine.cancel();
            return Ok(None);
        }
        for part in work.work(engine, Some(Instant::now() + PATIENCE))? {
            for (k, [x, y]) in part.tile.pixels().enumerate() {
                all.set((y * size[0] + x) as usize, part.samples.get(k));
            }
        }
    }
    Ok(Some(all))
}
