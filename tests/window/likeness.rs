//! How much a window looks like the picture that an export makes of the same view.

use flipmap::app::export::{Export, ExportKind, ExportRequest, ExportStage};
use flipmap::engine::Accuracy;
use flipmap::engine::choice::{EngineKind, EngineRequest};
use flipmap::physics::{Dd, Outcome, Status};
use flipmap::scene::palette::Tones;
use flipmap::scene::{Document, PictureTable, Scene};
use image::{Rgb, RgbImage};

use super::session::Told;

/// Every so manieth pixel is compared, each way.
const EVERY: f64 = 5.0;
/// Colours that differ by no more in any channel count as the same.
const TOLERANCE: u8 = 20;
/// At least this share of the calm pixels is alike where the picture is right.
const ENOUGH: f64 = 0.9;
/// A few pixels off, so much less of all pixels is.
const MARGIN: f64 = 0.03;

/// The picture of a scene, as `flipmap render` writes it: decoded, and its bytes.
pub fn picture(scene: Scene, size: [u32; 2]) -> (RgbImage, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.png");
    let mut document = Document::default().with_scene(scene);
    document.picture.curve = false;
    document.run.accuracy = Some(Accuracy::Fast.to_string());
    let request = ExportRequest { document, size, path: path.clone(), kind: ExportKind::Png };
    let engine_request = EngineRequest { kind: EngineKind::Cpu, ..EngineRequest::default() };
    let stage = Export::start(request, engine_request, || ()).wait();
    assert!(matches!(stage, ExportStage::Done { .. }), "{stage:?}");
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

/// How much of what a shot shows is what a picture has there.
#[derive(Clone, Copy, Debug)]
pub struct Likeness {
    /// Of all pixels compared, this share looks alike.
    pub all: f64,
    /// Of those whose neighbours on the screen look alike: away from chaos, where samples that
    /// lie a little apart have other answers.
    pub calm: f64,
}

/// Compares a shot, taken to be moved by so many pixels, with a picture. The one-coloured
/// forbidden region is left out.
pub fn likeness(told: &Told, shot: &RgbImage, picture: &RgbImage, moved: [f64; 2]) -> Likeness {
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

/// Whether the window shows what it says, and exactly there.
pub fn is_right(told: &Told, shot: &RgbImage) -> bool {
    let expected = expected(told);
    let here = likeness(told, shot, &expected, [0.0; 2]);
    let beside = [[3.0, 0.0], [-3.0, 0.0], [0.0, 3.0], [0.0, -3.0]]
        .map(|moved| likeness(told, shot, &expected, moved).all);
    eprintln!("{here:.3?}; beside {beside:.3?}");
    here.calm > ENOUGH && beside.iter().all(|share| share + MARGIN < here.all)
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

/// Counts how often something holds.
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
