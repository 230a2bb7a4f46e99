//! Finer samples at edges: a pixel shows the mean light of all its samples.

use flipmap_numbers::Dd;
use flipmap_render::tiles::cache::TILE_BYTES;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_render::tiles::view_target::ViewTarget;
use flipmap_scene::lattice::pitch_rad;
use flipmap_scene::palette::{Rgb, Tones, light};
use flipmap_scene::{Grid, Scene};

use crate::tests::canvas::doubtful::Doubtful;
use crate::tests::canvas::offscreen::{Paint, SIZE, Studio};
use crate::tests::canvas::{
    LEVEL, PLAIN, beyond, middle, outcome, painted, pictures, scene, screen, target,
};

needs_adapter! {
    checks:
    a_pixel_has_the_mean_light_of_its_samples
    what_arrives_is_drawn_into_the_picture_that_is_kept
}

/// Number of samples along each side of a pixel at the second finer level.
const ALONG: u32 = 4;

/// Returns the sRGB value of linear light, by the formula of the standard.
pub(crate) fn encoded(light: f64) -> u8 {
    let curve = 1.055 * light.powf(1.0 / 2.4) - 0.055;
    let value = if light <= 0.003_130_8 { 12.92 * light } else { curve };
    (255.0 * value).round() as u8
}

/// The colours of pixels of 4 × 4 samples, computed from starts and not from tiles.
fn mean(grid: &Grid, scene: &Scene, tones: &Tones) -> Vec<Rgb> {
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    let of_pixel = |[x, y]: [u32; 2]| {
        let samples = (0..ALONG * ALONG).map(|k| [ALONG * x + k % ALONG, ALONG * y + k / ALONG]);
        let mut sum = [0.0; 3];
        for [column, row] in samples {
            let colour = tones.colour(&outcome(grid.fate(column, row), scene));
            (0..3).for_each(|i| sum[i] += light(colour[i]) / f64::from(ALONG * ALONG));
        }
        sum.map(encoded)
    };
    pixels.map(of_pixel).collect()
}

mod checks {
    use super::*;

    pub(crate) fn a_pixel_has_the_mean_light_of_its_samples() {
        let (screen, scene, picture) = (screen(middle(), LEVEL), scene(60.0), &pictures()[1]);
        let tones = Tones::new(picture, scene.build.unit_secs(), 60.0).unwrap();
        let fine = Dd::new(pitch_rad(LEVEL) / f64::from(ALONG));
        let grid = Grid::square(&scene, screen.camera.center, fine, SIZE.map(|side| ALONG * side));
        let truth = mean(&grid, &scene, &tones);
        let paint = Paint { picture, scene: &scene, trust: false };
        let mut wrong = Vec::new();
        for refinements in [0, 1, 2] {
            let mut explorer = Explorer::new(2000 * TILE_BYTES);
            explorer.target(&ViewTarget { refinements, ..target(&screen, &scene) });
            explorer.work(&mut Doubtful::default(), None).unwrap();
            let mut studio = Studio::new(PLAIN);
            let plain = studio.draw(&screen, &mut explorer, &paint);
            assert!(beyond(1, &plain, &painted(&screen, &scene, picture)) <= 0.001, "as before");
            studio.map_renderer.finer_levels = 2;
            let pixels = studio.draw(&screen, &mut explorer, &paint);
            wrong.push([1, 24].map(|least| beyond(least, &pixels, &truth)));
        }
        println!("off by more than 1 and 24 of 255, by finer levels: {wrong:?}");
        assert!(wrong[0][1] > 0.002, "there are edges: {wrong:?}");
        assert!(wrong[1][1] < 0.6 * wrong[0][1], "four samples: {wrong:?}");
        assert!(wrong[2][0] <= 0.001, "sixteen samples: {wrong:?}");
    }

    pub(crate) fn what_arrives_is_drawn_into_the_picture_that_is_kept() {
        let (screen, scene, picture) = (screen(middle(), LEVEL), scene(60.0), &pictures()[1]);
        let paint = Paint { picture, scene: &scene, trust: false };
        let (mut explorer, mut engine) = (Explorer::new(2000 * TILE_BYTES), Doubtful::default());
        let mut studio = Studio::new(PLAIN);
        studio.map_renderer.finer_levels = 2;
        let mut last = Vec::new();
        for refinements in [0, 1, 2] {
            explorer.target(&ViewTarget { refinements, ..target(&screen, &scene) });
            explorer.work(&mut engine, None).unwrap();
            let pixels = studio.draw(&screen, &mut explorer, &paint);
            let mut anew = Studio::new(PLAIN);
            anew.map_renderer.finer_levels = 2;
            assert!(pixels == anew.draw(&screen, &mut explorer, &paint), "{refinements}");
            assert_ne!(pixels, last, "{refinements}");
            assert!(pixels == studio.draw(&screen, &mut explorer, &paint) && studio.uploads == 0);
            last = pixels;
        }
    }
}
