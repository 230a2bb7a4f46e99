//! A second opinion on a deep picture: some of its pixels integrated directly.

use super::open_tile::OpenTile;
use crate::engine::trust::{Opinion, TrustEngine};
use crate::engine::{Cells, EngineError, IntegratorConfig, Question, Starts};
use crate::scene::{Grid, Scene};

/// Maximum number of pixels that are integrated directly.
const MOST: usize = 8;
/// Number of pixels from which these are chosen, because some may be forbidden or marked.
const CANDIDATES: usize = 32;

/// Integrates some pixels of a picture of `size` pixels directly, if it is deep. If one of them
/// contradicts the start maps, `engine` marks every pixel as uncertain from then on. Returns `None`
/// for a picture that is not deep, or once `go_on` returns false.
pub fn opinion(
    scene: &Scene,
    size: [u32; 2],
    config: IntegratorConfig,
    engine: &mut TrustEngine<'_>,
    go_on: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Opinion>, EngineError> {
    let grid = Grid::new(scene, size);
    let open =
        OpenTile::of_pixels(&grid, config, Cells::Auto, &random_pixels(scene, size), |_| None);
    let opinion = match open.starts {
        Starts::Deep(deep) if !deep.leaves.is_empty() => {
            Opinion::on(engine, (Question::from(scene), config), &deep, MOST, go_on)?
        }
        _ => None,
    };
    engine.distrust(opinion.is_some_and(|opinion| opinion.contradicted > 0));
    Ok(opinion)
}

/// Draws random pixels: always the same ones for a view, and different ones for another view.
fn random_pixels(scene: &Scene, size: [u32; 2]) -> Vec<[u32; 2]> {
    let text = scene.view.center.concat() + &scene.view.width;
    let seed =
        text.bytes().fold(0u64, |seed, byte| seed.wrapping_mul(31).wrapping_add(u64::from(byte)));
    let mut random = fastrand::Rng::with_seed(seed);
    (0..CANDIDATES).map(|_| size.map(|side| random.u32(0..side))).collect()
}
