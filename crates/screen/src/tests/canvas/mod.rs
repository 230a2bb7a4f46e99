//! A map drawn on the graphics card has the same colours as a picture painted on the processor: for
//! each sample, in mirror images, with stand-ins, and with doubts shown.

mod calm;
mod doubtful;
mod fading;
mod finer;
mod moments;
mod offscreen;
mod passes;
mod smooth;
mod standing_in;

use crate::camera::{Camera, Screen};
use crate::hover::sample_at;
use crate::reach::Reach;
use doubtful::{Doubtful, fails, is_uncertain};
use finer::encoded;
use flipmap_engine::mock::MockEngine;
use flipmap_engine::{EventSpec, IntegratorConfig, Method, Precision};
use flipmap_numbers::{Dd, Decimal, Exact, Scalar};
use flipmap_pendulum::{Outcome, Status};
use flipmap_render::tiles::cache::TILE_BYTES;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_render::tiles::view_target::{Physics, ViewTarget};
use flipmap_scene::lattice::{Cell, SIDE, pitch_rad, side_rad};
use flipmap_scene::palette::{FAILED, Ground, Rgb, Tones, equalised, light};
use flipmap_scene::{
    Budget, Fate, Grid, PendulumSpec, PictureTable, QuestionSettings, Scale, Scene,
};
use glam::DVec2;
use offscreen::{Paint, SIZE, Studio};

needs_adapter! {
    checks:
    a_sample_is_a_pixel_of_its_colour
    other_colours_need_no_other_samples
    a_frame_that_is_thrown_away_costs_no_tile
    a_target_that_encodes_shows_the_same
    the_mirror_image_lies_the_right_way_round
    a_smaller_budget_hides_late_flips
    doubts_are_hatched_only_when_asked
    times_that_lie_close_together_have_smooth_colours
    a_changed_pendulum_leaves_the_picture_until_it_is_known
    no_pixel_is_left_out
}

const LEVEL: u32 = 5;
const PLAIN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

fn scene(budget: f64) -> Scene {
    Scene {
        question: QuestionSettings { budget: Budget::secs(budget), ..QuestionSettings::default() },
        ..Scene::default()
    }
}

/// Returns a common corner of four cells, around which some starts are forbidden, some flip, and
/// some flip late.
fn middle() -> [Exact; 2] {
    corner_beside([1.2, 1.0], LEVEL)
}

/// Returns a corner of the cell of this level around these angles.
fn corner_beside(angle: [f64; 2], level: u32) -> [Exact; 2] {
    let half = Exact::from_f64(side_rad(level) / 2.0);
    Cell::around(angle.map(Exact::from_f64), level).center().map(|theta| theta + half)
}

/// A screen on which each pixel is one sample of the level.
fn screen(center: [Exact; 2], level: u32) -> Screen {
    let width_rad = f64::from(SIZE[0]) * pitch_rad(level);
    Screen {
        camera: Camera { center, width_rad, ..Camera::whole(Reach::TORUS) },
        size: DVec2::from(SIZE.map(f64::from)),
        pixels_per_point: 1.0,
    }
}

fn target(screen: &Screen, scene: &Scene) -> ViewTarget {
    let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
    ViewTarget {
        physics: Physics::of(scene, config, false),
        budget_secs: scene.question.budget.secs,
        region: screen.region(),
        level: screen.level(),
        pointer: None,
        refinements: 0,
    }
}

fn explored(screen: &Screen, scene: &Scene) -> Explorer {
    let mut explorer = Explorer::new(1000 * TILE_BYTES);
    explorer.target(&target(screen, scene));
    explorer.work(&mut Doubtful::default(), None).unwrap();
    explorer
}

/// Returns the start under each pixel of a screen that shows one sample per pixel.
fn grid(screen: &Screen, scene: &Scene) -> Grid {
    let pixel = Dd::new(pitch_rad(screen.level()));
    Grid::square(scene, screen.camera.center, pixel, SIZE)
}

fn outcome(fate: Fate, scene: &Scene) -> Outcome {
    match fate {
        Fate::Known(outcome) => outcome,
        Fate::Thrown(_) | Fate::BesideTop(_) => unreachable!("at rest, far from the top"),
        Fate::Open(angle) if fails(angle) => Outcome::without_time(Status::Failed),
        Fate::Open(angle) => MockEngine::answer(&EventSpec::from(scene), angle),
    }
}

/// The colours that the processor paints, computed from starts and not from tiles.
fn painted(screen: &Screen, scene: &Scene, picture: &PictureTable) -> Vec<Rgb> {
    let tones = Tones::new(picture, scene.build.unit_secs(), scene.question.budget.secs).unwrap();
    let grid = grid(screen, scene);
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    pixels.map(|(x, y)| tones.colour(&outcome(grid.fate(x, y), scene))).collect()
}

/// The share of pixels that differ from their expected colours by more than `least` in any channel.
fn beyond(least: u8, pixels: &[u8], colours: &[Rgb]) -> f64 {
    let far = |pixel: &[u8], colour: &Rgb| {
        pixel[3] != 255 || pixel.iter().zip(colour).any(|(a, b)| a.abs_diff(*b) > least)
    };
    let pairs = pixels.chunks(4).zip(colours);
    pairs.filter(|(pixel, colour)| far(pixel, colour)).count() as f64 / colours.len() as f64
}

/// Returns the share of pixels with a wrong colour. Both sides round, so colours may differ by 1.
fn wrong(pixels: &[u8], colours: &[Rgb]) -> f64 {
    beyond(1, pixels, colours)
}

fn share_of(colour: Rgb, colours: &[Rgb]) -> f64 {
    colours.iter().filter(|other| **other == colour).count() as f64 / colours.len() as f64
}

/// Picture settings that use the colour table in different ways.
fn pictures() -> [PictureTable; 3] {
    let plain = PictureTable::default();
    let times = vec![9.0, 14.0, 39.0, 64.0];
    let stretched = PictureTable { times: times.clone(), reverse: true, ..plain.clone() };
    let linear = PictureTable {
        palette: "romao".into(),
        scale: Scale::Linear,
        cycles: 2.0,
        times,
        ..plain.clone()
    };
    [plain, stretched, linear]
}

mod checks {
    use super::*;

    pub(crate) fn times_that_lie_close_together_have_smooth_colours() {
        let level = 2 * LEVEL;
        let (screen, scene) = (screen(corner_beside([1.8, 0.5], level), level), scene(60.0));
        let mut explorer = explored(&screen, &scene);
        let grid = grid(&screen, &scene);
        let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
        let times = pixels.map(|(x, y)| outcome(grid.fate(x, y), &scene).time);
        let times = equalised(times, 16);
        assert!(times.len() == 17 && times[16] / times[0] < 1.01, "{times:?}");
        let picture = &PictureTable { times, ..PictureTable::default() };
        let paint = Paint { picture, scene: &scene, trust: false };
        let pixels = Studio::new(PLAIN).draw(&screen, &mut explorer, &paint);
        let truth = painted(&screen, &scene, picture);
        assert_eq!(beyond(1, &pixels, &truth), 0.0);
    }

    pub(crate) fn a_sample_is_a_pixel_of_its_colour() {
        let (screen, scene) = (screen(middle(), LEVEL), scene(60.0));
        let mut explorer = explored(&screen, &scene);
        let mut studio = Studio::new(PLAIN);
        let mut last = Vec::new();
        for picture in &pictures() {
            let paint = Paint { picture, scene: &scene, trust: false };
            let pixels = studio.draw(&screen, &mut explorer, &paint);
            let truth = painted(&screen, &scene, picture);
            let [inexact, wrong] = [0, 1].map(|least| beyond(least, &pixels, &truth));
            assert!(wrong <= 0.001 && inexact <= 0.12, "{inexact}, {wrong} of {picture:?}");
            for status in [Ground::of(picture).unwrap().forbidden, FAILED] {
                assert!(share_of(status, &truth) > 0.02, "{status:?} is to be seen");
            }
            last = pixels;
        }
        // The comparison detects a wrong picture.
        let [plain, _, linear] = pictures();
        assert!(wrong(&last, &painted(&screen, &scene, &plain)) > 0.3, "another palette");
        let aside = screen.camera.moved(DVec2::splat(pitch_rad(LEVEL)));
        let aside = Screen { camera: aside, ..screen };
        let further = wrong(&last, &painted(&aside, &scene, &linear));
        assert!(further > 0.01, "a pixel further: {further}");
    }

    pub(crate) fn other_colours_need_no_other_samples() {
        let (screen, scene) = (screen(middle(), LEVEL), scene(60.0));
        let mut explorer = explored(&screen, &scene);
        let simulated = explorer.counts().simulated;
        let mut studio = Studio::new(PLAIN);
        let [first, others @ ..] = &pictures();
        studio.draw(&screen, &mut explorer, &Paint { picture: first, scene: &scene, trust: false });
        assert!(studio.uploads > 0);
        for picture in others {
            let paint = Paint { picture, scene: &scene, trust: true };
            studio.draw(&screen, &mut explorer, &paint);
            assert_eq!((studio.uploads, explorer.counts().simulated), (0, simulated));
        }
    }

    pub(crate) fn a_frame_that_is_thrown_away_costs_no_tile() {
        let (screen, scene) = (screen(middle(), LEVEL), scene(60.0));
        let mut explorer = explored(&screen, &scene);
        let pictures = pictures();
        let [first, second, _] =
            pictures.each_ref().map(|picture| Paint { picture, scene: &scene, trust: false });
        let mut studio = Studio::new(PLAIN);
        studio.throw_away(&screen, &mut explorer, &first);
        studio.throw_away(&screen, &mut explorer, &first);
        let pixels = studio.draw(&screen, &mut explorer, &first);
        let uploads = studio.uploads;
        assert!(uploads > 0 && wrong(&pixels, &painted(&screen, &scene, first.picture)) <= 0.001);
        // A frame that is thrown away does not change the colours of the next one either.
        studio.throw_away(&screen, &mut explorer, &second);
        let pixels = studio.draw(&screen, &mut explorer, &second);
        assert!(wrong(&pixels, &painted(&screen, &scene, second.picture)) <= 0.001);
        assert_eq!(studio.uploads, 0, "what is loaded stays loaded");
    }

    pub(crate) fn a_target_that_encodes_shows_the_same() {
        let (screen, scene) = (screen(middle(), LEVEL), scene(60.0));
        let mut explorer = explored(&screen, &scene);
        let picture = &pictures()[1];
        let paint = Paint { picture, scene: &scene, trust: false };
        let pixels =
            Studio::new(wgpu::TextureFormat::Rgba8UnormSrgb).draw(&screen, &mut explorer, &paint);
        assert!(wrong(&pixels, &painted(&screen, &scene, picture)) <= 0.001);
    }

    pub(crate) fn the_mirror_image_lies_the_right_way_round() {
        let scene = scene(60.0);
        let here = screen(middle(), LEVEL);
        let there = screen(middle().map(|theta| -theta), LEVEL);
        for (computed, shown) in [(here, there), (there, here)] {
            let mut explorer = explored(&computed, &scene);
            explorer.target(&target(&shown, &scene));
            assert!(explorer.progress().idle, "its image is known");
            for picture in &pictures() {
                let paint = Paint { picture, scene: &scene, trust: false };
                let pixels = Studio::new(PLAIN).draw(&shown, &mut explorer, &paint);
                assert!(wrong(&pixels, &painted(&shown, &scene, picture)) <= 0.001);
            }
        }
    }

    pub(crate) fn a_smaller_budget_hides_late_flips() {
        let screen = screen(middle(), LEVEL);
        let mut explorer = explored(&screen, &scene(60.0));
        let (picture, less) = (&pictures()[0], scene(30.0));
        let simulated = explorer.counts().simulated;
        explorer.target(&target(&screen, &less));
        assert!(explorer.progress().idle && explorer.counts().simulated == simulated);
        let paint = Paint { picture, scene: &less, trust: false };
        let pixels = Studio::new(PLAIN).draw(&screen, &mut explorer, &paint);
        let truth = painted(&screen, &less, picture);
        let unflipped = share_of(Ground::DARK.unflipped, &truth);
        assert!(
            unflipped > 0.1
                && share_of(Ground::DARK.unflipped, &painted(&screen, &scene(60.0), picture))
                    < 0.01
        );
        assert!(wrong(&pixels, &truth) <= 0.001, "{} {unflipped}", wrong(&pixels, &truth));
    }

    pub(crate) fn doubts_are_hatched_only_when_asked() {
        let (screen, scene) = (screen(middle(), LEVEL), scene(60.0));
        let mut explorer = explored(&screen, &scene);
        let (picture, mut studio) = (&pictures()[0], Studio::new(PLAIN));
        let mut truth = painted(&screen, &scene, picture);
        let grid = grid(&screen, &scene);
        let plain = Paint { picture, scene: &scene, trust: false };
        let pixels = studio.draw(&screen, &mut explorer, &plain);
        assert!(wrong(&pixels, &truth) <= 0.001);
        let (mut marked, mut dark) = (0, 0);
        for (k, colour) in truth.iter_mut().enumerate() {
            let (x, y) = (k as u32 % SIZE[0], k as u32 / SIZE[0]);
            if matches!(grid.fate(x, y), Fate::Open(angle) if is_uncertain(angle)) {
                let stripe = (x + y) % 6 < 3;
                // A linear light of 0.6 is 203 of 255 in sRGB.
                *colour = if stripe { [0, 0, 0] } else { [255, 0, 203] };
                marked += 1;
                dark += usize::from(stripe);
            }
        }
        assert!(marked > 5000 && dark * 3 > marked && dark * 3 < 2 * marked, "{dark} of {marked}");
        let pixels = studio.draw(&screen, &mut explorer, &Paint { trust: true, ..plain });
        assert!(wrong(&pixels, &truth) <= 0.001, "{}", wrong(&pixels, &truth));
    }

    pub(crate) fn a_changed_pendulum_leaves_the_picture_until_it_is_known() {
        let (screen, home) = (screen(middle(), LEVEL), scene(60.0));
        let mut explorer = explored(&screen, &home);
        let (picture, mut studio) = (&pictures()[1], Studio::new(PLAIN));
        let moon = Scene {
            build: PendulumSpec { gravity: Decimal::from(8.0), ..PendulumSpec::default() },
            ..home.clone()
        };
        explorer.target(&target(&screen, &moon));
        let paint = Paint { picture, scene: &moon, trust: false };
        let pixels = studio.draw(&screen, &mut explorer, &paint);
        // The previous samples are shown, in the colours of the new view target.
        assert!(wrong(&pixels, &painted(&screen, &home, picture)) <= 0.001);
        explorer.work(&mut Doubtful::default(), None).unwrap();
        let pixels = studio.draw(&screen, &mut explorer, &paint);
        assert!(wrong(&pixels, &painted(&screen, &moon, picture)) <= 0.001);
        assert!(wrong(&pixels, &painted(&screen, &home, picture)) > 0.3);
    }

    pub(crate) fn no_pixel_is_left_out() {
        let (scene, picture) = (scene(60.0), &pictures()[0]);
        let tones = Tones::new(picture, scene.build.unit_secs(), 60.0).unwrap();
        let seam = [Exact::pi(), Exact::from_f64(-3.0)];
        for (center, width_rad, rotate_deg, stretch) in [
            (seam, 0.7, 0.0, 1.0),
            (seam, 0.53, 30.0, 1.3),
            (middle(), 17.0, -77.0, 0.7),
            (middle(), 0.3, 45.0, 1.0),
        ] {
            let reach = Reach::TORUS;
            let camera = Camera { center, width_rad, rotate_deg, stretch, reach };
            let view = Screen { camera, ..screen(center, LEVEL) };
            let mut explorer = explored(&view, &scene);
            let paint = Paint { picture, scene: &scene, trust: false };
            let pixels = Studio::new(PLAIN).draw(&view, &mut explorer, &paint);
            let bare = pixels.chunks(4).filter(|pixel| pixel[3] != 255).count();
            assert_eq!(bare, 0, "{camera:?}");
            // Away from edges, the light is a mixture of equal colours: those of the samples below.
            let truth: Vec<Rgb> = (0..SIZE[0] * SIZE[1])
                .map(|k| [k % SIZE[0], k / SIZE[0]].map(|at| f64::from(at) + 0.5))
                .map(|at| {
                    let point = DVec2::from(at) - view.size / 2.0;
                    let [start, _] = sample_at(view.angle_at(point), view.level());
                    let grid = Grid::square(&scene, start, Dd::new(1e-9), [1, 1]);
                    tones.colour(&outcome(grid.fate(0, 0), &scene))
                })
                .collect();
            let wrong = wrong(&pixels, &truth);
            assert!(wrong < if width_rad < 1.0 { 0.08 } else { 0.3 }, "{wrong}: {camera:?}");
        }
    }
}
