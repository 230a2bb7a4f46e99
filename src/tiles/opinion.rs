//! A second opinion on a deep picture: some of its pixels integrated directly.

use super::sample;
use crate::engine::trust::Opinion;
use crate::engine::{Engine, EngineError, IntegratorConfig, Question, Starts};
use crate::scene::Scene;

/// Pixels that are integrated directly,
const MOST: usize = 8;
/// drawn from so many, of which some may be forbidden or marked.
const CANDIDATES: usize = 32;

/// What direct integration says of a picture of `size` pixels that `engine` checks, if it is deep; none
/// once `go_on` says no.
pub fn opinion(
    scene: &Scene,
    size: [u32; 2],
    config: IntegratorConfig,
    engine: &mut dyn Engine,
    go_on: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Opinion>, EngineError> {
    let pixels = random_pixels(scene, size);
    match sample::open(scene, size, config, &pixels).into_starts() {
        Starts::Deep(deep) if !deep.leaves.is_empty() => {
            Opinion::on(engine, (Question::from(scene), config), &deep, MOST, go_on)
        }
        _ => Ok(None),
    }
}

/// Other ones in every view, and always the same in one.
fn random_pixels(scene: &Scene, size: [u32; 2]) -> Vec<[u32; 2]> {
    let text = scene.view.center.concat() + &scene.view.width;
    let seed = text.bytes().fold(0u64, |seed, byte| seed.wrapping_mul(31) + u64::from(byte));
    let mut random = fastrand::Rng::with_seed(seed);
    (0..CANDIDATES).map(|_| size.map(|side| random.u32(0..side))).collect()
}
