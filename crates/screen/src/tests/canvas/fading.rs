//! New tiles appear gradually over those that stood in for them.

use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::palette::Rgb;

use crate::tests::canvas::doubtful::Doubtful;
use crate::tests::canvas::offscreen::{Paint, Studio};
use crate::tests::canvas::{
    LEVEL, PLAIN, beyond, explored, middle, painted, pictures, target, wrong,
};

needs_adapter! {
    checks:
    a_new_tile_appears_over_the_one_that_stood_in
}

mod checks {
    use super::*;

    pub(crate) fn a_new_tile_appears_over_the_one_that_stood_in() {
        let (coarse, scene) =
            (crate::tests::canvas::screen(middle(), LEVEL), crate::tests::canvas::scene(60.0));
        let mut explorer = explored(&coarse, &scene);
        let fine = crate::tests::canvas::screen(middle(), LEVEL + 2);
        let picture = &pictures()[1];
        let paint = Paint { picture, scene: &scene, trust: false };
        let mut studio = Studio::new(PLAIN);
        let mut draw = |explorer: &mut Explorer, now_secs| {
            studio.now_secs = Some(now_secs);
            studio.draw(&fine, explorer, &paint)
        };
        let before = draw(&mut explorer, 1.0);
        explorer.target(&target(&fine, &scene));
        explorer.work(&mut Doubtful::default(), None).unwrap();
        let began = draw(&mut explorer, 2.0);
        assert!(began == before, "nothing jumps");
        let [middle, after] = [2.075, 2.5].map(|now_secs| draw(&mut explorer, now_secs));
        assert!(wrong(&after, &painted(&fine, &scene, picture)) <= 0.001);
        let halves = before.iter().zip(&after).map(|(a, b)| a.midpoint(*b)).collect::<Vec<u8>>();
        let halves: Vec<Rgb> =
            halves.chunks(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        assert!(beyond(2, &middle, &halves) <= 0.001 && beyond(2, &after, &halves) > 0.01);
    }
}
