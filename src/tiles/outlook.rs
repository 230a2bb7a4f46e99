//! What to expect of a picture that nobody checks, by a sample of its pixels.

use super::sample;
use crate::engine::trust::Outlook;
use crate::engine::{Engine, EngineError, Question, Recipe};
use crate::scene::Scene;

/// Pixels that are looked at.
const SAMPLE: u32 = 256;

/// The outlook of a picture of `size` pixels; none once `go_on` says no.
pub fn outlook(
    scene: &Scene,
    size: [u32; 2],
    recipe: Recipe,
    engine: &mut dyn Engine,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Outlook>, EngineError> {
    let pixels: Vec<[u32; 2]> = (0..SAMPLE).map(|place| pixel(size, place)).collect();
    let open = sample::open(scene, size, recipe, &pixels);
    if open.is_settled() {
        return Ok(Some(Outlook::default()));
    }
    Outlook::of(engine, Question::from(scene), recipe, &open.into_starts(), go_on)
}

/// Pixels that fill a picture evenly, however many are taken: steps along both sides by powers of
/// the inverse of the plastic number (Roberts 2018, *The unreasonable effectiveness of quasirandom
/// sequences*).
fn pixel(size: [u32; 2], place: u32) -> [u32; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    [0, 1].map(|axis| {
        let share = (0.5 + STEPS[axis] * f64::from(place)).fract();
        ((share * f64::from(size[axis])) as u32).min(size[axis] - 1)
    })
}
