//! The map at a moment of the clock: only flips up to that moment are shown.

use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::palette::{Ground, Rgb, Tones};
use flipmap_scene::{PictureTable, Scene};

use crate::tests::canvas::offscreen::{Paint, SIZE, Studio};
use crate::tests::canvas::{
    LEVEL, PLAIN, corner_beside, explored, outcome, painted, pictures, share_of, wrong,
};

needs_adapter! {
    checks:
    a_moment_shows_the_flips_before_it_and_computes_nothing
}

/// Returns the colours of the map with only the flips up to a moment.
fn painted_until(
    screen: &crate::camera::Screen,
    scene: &Scene,
    picture: &PictureTable,
    until_secs: f64,
) -> Vec<Rgb> {
    let tones = Tones::new(picture, scene.build.unit_secs(), scene.question.budget.secs).unwrap();
    let grid = crate::tests::canvas::grid(screen, scene);
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let seen = |outcome: Outcome| match outcome.status {
        Status::Answered if outcome.time > until_secs => Outcome::without_time(Status::Unflipped),
        _ => outcome,
    };
    pixels.map(|(x, y)| tones.colour(&seen(outcome(grid.fate(x, y), scene)))).collect()
}

mod checks {
    use super::*;

    pub(crate) fn a_moment_shows_the_flips_before_it_and_computes_nothing() {
        // Some starts flip at about 12.2 s, the others from 40 s on.
        let (screen, scene) = (
            crate::tests::canvas::screen(corner_beside([2.0, 0.9], LEVEL), LEVEL),
            crate::tests::canvas::scene(60.0),
        );
        let mut explorer = explored(&screen, &scene);
        let simulated = explorer.counts().simulated;
        // Colours from a table, and colours that are painted before the upload to the card.
        let fine = PictureTable { times: vec![10.0, 12.0, 12.01, 60.0], ..pictures()[0].clone() };
        for picture in [&pictures()[0], &fine] {
            let mut studio = Studio::new(PLAIN);
            let paint = Paint { picture, scene: &scene, trust: false };
            let whole = studio.draw(&screen, &mut explorer, &paint);
            assert!(wrong(&whole, &painted(&screen, &scene, picture)) <= 0.001);
            let mut last = -1.0;
            for until_secs in [0.0, 12.25, 45.0] {
                studio.until_secs = Some(until_secs);
                let pixels = studio.draw(&screen, &mut explorer, &paint);
                let truth = painted_until(&screen, &scene, picture, until_secs);
                assert!(
                    wrong(&pixels, &truth) <= 0.002,
                    "{until_secs}: {}",
                    wrong(&pixels, &truth)
                );
                let lit = 1.0 - share_of(Ground::DARK.unflipped, &truth);
                assert!(lit > last, "{until_secs} s: {lit}");
                last = lit;
            }
            assert_eq!(explorer.counts().simulated, simulated);
        }
    }
}
