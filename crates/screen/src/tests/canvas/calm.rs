//! A map at rest loses its grain, as a picture in a file does.

use std::time::{Duration, Instant};

use flipmap_render::Denoiser;
use flipmap_render::tiles::cache::TILE_BYTES;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::PictureTable;
use flipmap_scene::palette::{Ground, Rgb};

use crate::tests::canvas::doubtful::Doubtful;
use crate::tests::canvas::offscreen::{Paint, SIZE, Studio};
use crate::tests::canvas::{LEVEL, PLAIN, corner_beside, scene, screen, target};

needs_adapter! {
    checks:
    a_map_at_rest_is_denoised_like_a_file_and_grainy_again_when_it_need_not_be
}

mod checks {
    use super::*;

    pub(crate) fn a_map_at_rest_is_denoised_like_a_file_and_grainy_again_when_it_need_not_be() {
        let scene = scene(30.0);
        let screen = screen(corner_beside([1.2, 1.0], LEVEL), LEVEL);
        let picture = &PictureTable { curve: false, ..PictureTable::default() };
        let (mut explorer, mut engine) = (Explorer::new(1000 * TILE_BYTES), Doubtful::default());
        explorer.target(&target(&screen, &scene));
        explorer.work(&mut engine, None).unwrap();
        let paint = Paint { picture, scene: &scene, trust: false };
        let mut studio = Studio::new(PLAIN);
        studio.draw(&screen, &mut explorer, &paint);
        let grainy = studio.draw(&screen, &mut explorer, &paint);
        let ground = Ground::of(picture).unwrap();
        studio.map_renderer.ground = Some(ground);
        let begun = Instant::now();
        let calm = loop {
            let pixels = studio.draw(&screen, &mut explorer, &paint);
            if !studio.map_renderer.is_grainy() {
                break pixels;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "it is never denoised");
            std::thread::sleep(Duration::from_millis(20));
        };
        let colours = |pixels: &[u8]| -> Vec<Rgb> {
            pixels.as_chunks::<4>().0.iter().map(|&[r, g, b, _]| [r, g, b]).collect()
        };
        let expected = Denoiser::new(SIZE[0] as usize, &ground).colours(&colours(&grainy));
        assert!(colours(&calm) == expected, "the same code");
        assert!(calm != grainy, "there was grain");
        studio.map_renderer.ground = None;
        assert!(studio.draw(&screen, &mut explorer, &paint) == grainy);
    }
}
