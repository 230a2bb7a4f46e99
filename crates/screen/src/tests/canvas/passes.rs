//! Cells with only some samples known: each known sample is drawn in its place.

use std::time::Instant;

use crate::hover::known_at;
use flipmap_numbers::{Exact, Scalar};
use flipmap_render::tiles::cache::TILE_BYTES;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::PictureTable;
use flipmap_scene::lattice::Cell;
use glam::DVec2;

use crate::tests::canvas::doubtful::Doubtful;
use crate::tests::canvas::offscreen::{Paint, SIZE, Studio};
use crate::tests::canvas::{LEVEL, PLAIN, corner_beside, painted, scene, screen, target};

needs_adapter! {
    checks:
    the_samples_of_every_pass_are_drawn_where_they_lie
}

/// Returns the number of pixels with known samples, and how many of those have a wrong colour.
fn compared(center: [Exact; 2], turns: usize) -> [usize; 2] {
    let scene = scene(30.0);
    let screen = screen(center, LEVEL);
    let picture = &PictureTable { curve: false, ..PictureTable::default() };
    let (mut explorer, mut engine) = (Explorer::new(1000 * TILE_BYTES), Doubtful::default());
    explorer.target(&target(&screen, &scene));
    for _ in 0..turns {
        explorer.work(&mut engine, Some(Instant::now())).unwrap();
    }
    let truth = painted(&screen, &scene, picture);
    let paint = Paint { picture, scene: &scene, trust: false };
    let pixels = Studio::new(PLAIN).draw(&screen, &mut explorer, &paint);
    let middle = DVec2::from(SIZE.map(f64::from)) / 2.0;
    let mut counts = [0; 2];
    for (index, (pixel, colour)) in pixels.chunks(4).zip(&truth).enumerate() {
        let [x, y] = [index as u32 % SIZE[0], index as u32 / SIZE[0]];
        let point = DVec2::new(f64::from(x), f64::from(y)) + 0.5 - middle;
        let angle = screen.angle_at(point);
        if known_at(&mut explorer, Cell::around(angle, LEVEL), angle).is_none() {
            continue;
        }
        let differs = pixel.iter().zip(colour).any(|(a, b)| a.abs_diff(*b) > 1);
        counts = [counts[0] + 1, counts[1] + usize::from(differs)];
    }
    counts
}

mod checks {
    use super::*;

    pub(crate) fn the_samples_of_every_pass_are_drawn_where_they_lie() {
        let all = (SIZE[0] * SIZE[1]) as usize;
        // Cells that are computed, and mirror images of such cells.
        for angle in [[1.2, 1.0], [-1.2, -1.0]] {
            let center = corner_beside(angle, LEVEL);
            assert!(center[0].to_f64().abs() > 1.0);
            let mut partly = 0;
            for turns in [1, 3, 6, 9, 11] {
                let [known, wrong] = compared(center, turns);
                println!("{angle:?}, {turns} turns: {known} of {all} known, {wrong} wrong");
                assert_eq!(wrong, 0, "{angle:?}, {turns} turns, {known} known");
                partly += usize::from(known > 100 && known < all);
            }
            assert!(partly > 2, "{angle:?}: {partly}");
        }
    }
}
