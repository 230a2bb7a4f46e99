//! How much a window looks like the picture that an export makes of the same view.

use flipmap::app::export::{Export, ExportKind, ExportRequest, Stage};
use flipmap::engine::Accuracy;
use flipmap::engine::choice::{Demand, Kind, Wish};
use flipmap::physics::{Dd, Outcome, Status};
use flipmap::scene::palette::Tones;
use flipmap::scene::{Document, PictureTable, Scene};
use image::{Rgb, RgbImage};

use super::session::Told;

/// Every so manieth pixel is compared, each way.
const EVERY: f64 = 5.0;
/// Colours that differ by no more in any channel count as the same.
const TOLERANCE: u8 = 20;
/// So many of the pixels are alike where the picture is right. Samples lie on a lattice of their
/// own, so in chaos neighbours are seen, and answers differ.
const ENOUGH: f64 = 0.7;
/// So many fewer if it is a few pixels off.
const MARGIN: f64 = 0.03;

/// The picture of a scene, as `flipmap render` writes it: decoded, and its bytes.
pub fn picture(scene: Scene, size: [u32; 2]) -> (RgbImage, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.png");
    let mut document = Document::default().with_scene(scene);
    document.picture.curve = false;
    let request = ExportRequest { document, size, path: path.clone(), kind: ExportKind::Png };
    let demand = Demand::Level(Accuracy::Fast);
    let wish = Wish { kind: Kind::Cpu, demand, ..Wish::default() };
    let stage = Export::start(request, wish, || ()).wait();
    assert!(matches!(stage, Stage::Done { .. }), "{stage:?}");
    (image::open(&path).unwrap().into_rgb8(), std::fs::read(path).unwrap())
}

/// The picture of what a window shows, one pixel for every [`EVERY`] each way.
pub fn expected(told: &Told) -> RgbImage {
    let map = told.map_px();
    let size = map.map(|side| (side / EVERY).floor() as u32);
    let mut scene = told.scene();
    // The picture has pixels of the same distance as those compared.
    let width = scene.view.width_rad() * Dd::new(EVERY * f64::from(size[0]) / map[0]);
    scene.view.width = width.decimal(30);
    picture(scene, size).0
}

/// The share of pixels that look alike, the one-coloured forbidden region left out, where the
/// shot is taken to be moved by so many pixels.
pub fn share_alike(told: &Told, shot: &RgbImage, expected: &RgbImage, moved: [f64; 2]) -> f64 {
    let map = told.map_px();
    let size = [expected.width(), expected.height()].map(f64::from);
    let Scene { build, question, .. } = told.scene();
    let tones = Tones::new(&PictureTable::default(), build.unit_secs(), question.budget).unwrap();
    let forbidden = Rgb(tones.colour(&Outcome::without_time(Status::Forbidden)));
    let open = expected.enumerate_pixels().filter(|(_, _, wanted)| **wanted != forbidden);
    let alike: Vec<bool> = open
        .map(|(i, j, wanted)| {
            let at = |axis: usize, k: u32| {
                map[axis] / 2.0 + EVERY * (f64::from(k) + 0.5 - size[axis] / 2.0) + moved[axis]
            };
            let seen = shot.get_pixel(at(0, i).max(0.0) as u32, at(1, j).max(0.0) as u32);
            seen.0.iter().zip(wanted.0).all(|(a, b)| a.abs_diff(b) <= TOLERANCE)
        })
        .collect();
    assert!(alike.len() > 500, "too few pixels to compare");
    alike.iter().filter(|alike| **alike).count() as f64 / alike.len() as f64
}

/// Whether the window shows what it says, and exactly there.
pub fn is_right(told: &Told, shot: &RgbImage) -> bool {
    let expected = expected(told);
    let share = |moved| share_alike(told, shot, &expected, moved);
    let right = share([0.0, 0.0]);
    let beside = [[3.0, 0.0], [-3.0, 0.0], [0.0, 3.0], [0.0, -3.0]].map(share);
    eprintln!("{right:.3} of the pixels are as they should be; beside: {beside:.3?}");
    right > ENOUGH && beside.iter().all(|share| share + MARGIN < right)
}
