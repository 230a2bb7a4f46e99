//! Comparison of a window with the picture that an export makes of the same view.

use flipmap_engine::choice::EngineRequest;
use flipmap_engine::{Accuracy, EngineKind};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::palette::{Tones, budget_range_secs};
use flipmap_scene::{Document, PictureTable, Sampling, Scene};
use flipmap_window::export::{Export, ExportKind, ExportRequest, ExportStage};
use image::{Rgb, RgbImage};

use super::session::Told;

/// Distance between the compared pixels, in both directions.
const EVERY: f64 = 5.0;
/// Largest difference in any channel between colours that count as the same.
const TOLERANCE: u8 = 20;
/// Minimum share of calm pixels that agree if the picture is right.
const ENOUGH: f64 = 0.9;
/// Amount by which the share of all pixels that agree must drop if the shot is moved a few pixels.
const MARGIN: f64 = 0.03;

/// The picture of a scene as `flipmap render` writes it: decoded, and as bytes.
pub(crate) fn picture(scene: Scene, size: [u32; 2]) -> (RgbImage, Vec<u8>) {
    sampled(scene, size, 1)
}

/// The same with `samples` × `samples` samples per pixel.
fn sampled(scene: Scene, size: [u32; 2], samples: u32) -> (RgbImage, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.png");
    let mut document = Document::default().with_scene(scene);
    let (unit_secs, budget_secs) = (document.pendulum.unit_secs(), document.question.budget.secs);
    document.picture = PictureTable {
        curve: false,
        samples: Sampling::Square(samples),
        denoise: false,
        times: budget_range_secs(unit_secs, budget_secs).to_vec(),
        ..PictureTable::default()
    };
    document.run.accuracy = Some(Accuracy::Fast.to_string());
    let request = ExportRequest { document, size, path: path.clone(), kind: ExportKind::Png };
    let engine_request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
    let stage = Export::start(request, engine_request, || ()).wait();
    assert!(matches!(stage, ExportStage::Done { .. }), "{stage:?}");
    (image::open(&path).unwrap().into_rgb8(), std::fs::read(path).unwrap())
}

/// The picture of the view in a window, with one pixel for every [`EVERY`] in both directions.
pub(crate) fn expected(told: &Told) -> RgbImage {
    let map = told.map_px();
    let size = map.map(|side| (side / EVERY).floor() as u32);
    let mut scene = told.scene();
    // The picture's pixels are as far apart as the compared ones.
    let width = scene.view.width_rad() * Dd::new(EVERY * f64::from(size[0]) / map[0]);
    scene.view.width = width.decimal(30);
    picture(scene, size).0
}

/// Shares of the pixels of a shot that agree with a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Likeness {
    /// Share of all compared pixels that look alike.
    pub all: f64,
    /// Share that looks alike among the pixels whose neighbours on the screen look alike. These lie
    /// outside chaos, where samples slightly apart have different answers.
    pub calm: f64,
}

/// Compares a shot, assumed to be displaced by `moved` pixels, with a picture. The forbidden
/// region, which has a single colour, is left out.
pub(crate) fn likeness(
    told: &Told,
    shot: &RgbImage,
    picture: &RgbImage,
    moved: [f64; 2],
) -> Likeness {
    let map = told.map_px();
    let forbidden = forbidden(&told.scene());
    let (mut all, mut calm) = (Share::default(), Share::default());
    for (i, j, wanted) in picture.enumerate_pixels().filter(|(_, _, rgb)| **rgb != forbidden) {
        let at = |axis: usize, k: u32, count: u32| {
            let from_middle = EVERY * (f64::from(k) + 0.5 - f64::from(count) / 2.0);
            (map[axis] / 2.0 + from_middle + moved[axis]).clamp(1.0, map[axis] - 2.0) as u32
        };
        let (x, y) = (at(0, i, picture.width()), at(1, j, picture.height()));
        let seen = shot.get_pixel(x, y);
        let around = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
        all.count(alike(seen, wanted));
        if around.into_iter().all(|(x, y)| alike(shot.get_pixel(x, y), seen)) {
            calm.count(alike(seen, wanted));
        }
    }
    Likeness { all: all.value(), calm: calm.value() }
}

/// Returns true if the window shows the view that it reports, at exactly that position.
pub(crate) fn is_right(told: &Told, shot: &RgbImage) -> bool {
    let expected = expected(told);
    let here = likeness(told, shot, &expected, [0.0; 2]);
    let beside = [[3.0, 0.0], [-3.0, 0.0], [0.0, 3.0], [0.0, -3.0]]
        .map(|moved| likeness(told, shot, &expected, moved).all);
    eprintln!("{here:.3?}; beside {beside:.3?}");
    here.calm > ENOUGH && beside.iter().all(|share| share + MARGIN < here.all)
}

/// The mean difference of a shot of the map from a picture of it with 4 × 4 samples per pixel, in any
/// channel.
pub(crate) fn distance_from_smooth(told: &Told, shot: &RgbImage) -> f64 {
    let size = told.map_px().map(|side| side.round() as u32);
    let mut scene = told.scene();
    scene.view.width = scene.view.width_rad().decimal(30);
    let smooth = sampled(scene, size, 4).0;
    let differences = smooth.enumerate_pixels().map(|(x, y, pixel)| {
        let pairs = pixel.0.iter().zip(shot.get_pixel(x, y).0);
        f64::from(pairs.map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0))
    });
    differences.sum::<f64>() / f64::from(size[0] * size[1])
}

/// The colour of starts that can never flip.
fn forbidden(Scene { build, question, .. }: &Scene) -> Rgb<u8> {
    let tones =
        Tones::new(&PictureTable::default(), build.unit_secs(), question.budget.secs).unwrap();
    Rgb(tones.colour(&Outcome::without_time(Status::Forbidden)))
}

fn alike(a: &Rgb<u8>, b: &Rgb<u8>) -> bool {
    a.0.iter().zip(b.0).all(|(a, b)| a.abs_diff(b) <= TOLERANCE)
}

/// A count of the times that a condition holds.
#[derive(Default)]
struct Share {
    holds: u32,
    of: u32,
}

impl Share {
    fn count(&mut self, holds: bool) {
        self.of += 1;
        self.holds += u32::from(holds);
    }

    fn value(&self) -> f64 {
        assert!(self.of > 500, "too few pixels to compare");
        f64::from(self.holds) / f64::from(self.of)
    }
}
