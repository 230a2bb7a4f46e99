//! Estimates the accuracy of an unchecked picture from a sample of its pixels.

use super::direct_check::{AnsweredPixel, DirectCheck};
use super::feasible::follows_cells;
use super::open_tile::OpenTile;
use super::reader::Reader;
use flipmap_engine::trust::{AccuracyEstimate, Opinion};
use flipmap_engine::{Cells, Engine, EngineError, EventSpec, IntegratorConfig};
use flipmap_pendulum::Status;
use flipmap_scene::{Grid, Scene};

/// Number of pixels in the sample.
const SAMPLE: u32 = 256;
/// Number of sampled pixels that lie close together in deep pictures, because they then share the
/// leaves that have to be followed.
const TOGETHER: u32 = 16;

/// Number of pixels that are integrated directly if start maps or first moments answer them; one if
/// that takes seconds.
const DIRECT_PIXELS: usize = 2;

/// Estimates the accuracy of a picture of `size` pixels; returns `None` once `keep_going` returns
/// false.
pub fn outlook(
    scene: &Scene,
    size: [u32; 2],
    (config, cells): (IntegratorConfig, Cells),
    engine: &mut dyn Engine,
    keep_going: &(dyn Fn() -> bool + Sync),
) -> Result<Option<AccuracyEstimate>, EngineError> {
    let grid = Grid::new(scene, size);
    let is_deep = follows_cells(&grid, &config, cells);
    let together = if is_deep { TOGETHER } else { 1 };
    let pixels: Vec<[u32; 2]> = (0..SAMPLE).map(|place| pixel(size, place, together)).collect();
    let open = OpenTile::of_pixels(&grid, config, cells, &pixels, |_| None);
    if open.is_settled() {
        return Ok(Some(AccuracyEstimate::default()));
    }
    let question = EventSpec::from(scene);
    let reader = Reader::new(scene.question.ask, &question);
    let how = (config, reader.ends());
    let Some(sample) =
        AccuracyEstimate::sample(engine, question, how, &open.starts, &|| keep_going())?
    else {
        return Ok(None);
    };
    let beyond = sample.beyond.iter().filter(|beyond| **beyond).count();
    let outlook =
        AccuracyEstimate { sampled: sample.beyond.len(), beyond, opinion: Opinion::default() };
    let Some(check) = DirectCheck::new(scene, &grid) else { return Ok(Some(outlook)) };
    let asked = (0..open.places.len()).filter_map(|k| {
        let [column, row] = pixels[open.places[k] as usize];
        let is_told = is_deep || grid.is_beside_top(column, row);
        let (outcome, end) = (sample.result.outcomes[k], &sample.result.ends[k]);
        let is_asked = is_told && !sample.beyond[k] && outcome.status != Status::Forbidden;
        let (status, values) = reader.read(&outcome, end);
        let values = values[..scene.question.ask.kind().channels.len()].to_vec();
        is_asked.then_some(AnsweredPixel { pixel: [column, row], status, values })
    });
    // Pixels far apart in the sample, so that they do not all lie in one leaf.
    let asked: Vec<_> = asked.collect();
    let most = if check.takes_long() { 1 } else { DIRECT_PIXELS };
    let apart = asked.len().div_ceil(most).max(1);
    let asked: Vec<_> = asked.into_iter().step_by(apart).collect();
    Ok(check.opinion(&asked, keep_going).map(|opinion| AccuracyEstimate { opinion, ..outlook }))
}

/// Returns pixel `place` of a sequence whose groups of `together` neighbours fill a picture evenly,
/// however many are taken: the steps along both sides are powers of the inverse of the plastic
/// number (Roberts 2018, *The unreasonable effectiveness of quasirandom sequences*).
fn pixel(size: [u32; 2], place: u32, together: u32) -> [u32; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    let (group, member) = (place / together, place % together);
    let aside = [member % 4, member / 4].map(|by| 3 * by);
    [0, 1].map(|axis| {
        let share = (0.5 + STEPS[axis] * f64::from(group)).fract();
        ((share * f64::from(size[axis])) as u32 + aside[axis]) % size[axis]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_fill_a_picture_and_groups_share_leaves() {
        for together in [1, TOGETHER] {
            let all: Vec<[u32; 2]> =
                (0..SAMPLE).map(|place| pixel([300, 200], place, together)).collect();
            let quarter = |x: u32, y: u32| {
                let inside = |p: &&[u32; 2]| p[0] / 150 == x && p[1] / 100 == y;
                all.iter().filter(inside).count()
            };
            for [x, y] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
                assert!((40..=90).contains(&quarter(x, y)), "{together}: {}", quarter(x, y));
            }
            let mut distinct = all.clone();
            distinct.sort();
            distinct.dedup();
            assert!(distinct.len() > 240);
        }
    }
}
