//! Small pictures, compared with golden pictures that were inspected by eye.
//!
//! There are two tolerances: one for the error of a channel, and one for the share of pixels that
//! exceed it. In chaotic places correct engines differ; the share allows for that, and the channel
//! tolerance is never widened. The pictures and their differences are written to
//! `target/goldens`, even if a golden is missing, which fails the test.
//! `FLIPMAP_UPDATE_GOLDENS=1` replaces the goldens.

use std::path::{Path, PathBuf};

use crate::common::*;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::{Engine, Precision};
use flipmap_pendulum::Rule;
use flipmap_render::output::compare::{Comparison, Difference, ResultRows, Yardstick, compare};
use flipmap_render::output::{RowOrder, RowPainter};
use flipmap_render::tiles::Work;
use flipmap_scene::{
    Budget, BuiltIn, Kind, PendulumSpec, PictureTable, QuestionSettings, Sampling, Scene, View,
};
use image::{Rgb, RgbImage};

const SIZE: [u32; 2] = [120, 96];
/// The largest allowed error of a channel, in levels of 255.
const CHANNEL: f64 = 6.0;

struct Golden {
    name: &'static str,
    scene: Scene,
    picture: PictureTable,
    /// Share of the pixels that may exceed the channel tolerance.
    wrong: f64,
}

fn goldens() -> Vec<Golden> {
    let question = |rule, secs| QuestionSettings {
        rule,
        budget: Budget::secs(secs),
        ..QuestionSettings::default()
    };
    let rods = PendulumSpec { kind: Kind::Rods, ..PendulumSpec::default() };
    let uneven = PendulumSpec::new(Kind::Points, [1.0, 2.0], [1.0, 0.6], 9.81);
    let turned = View {
        center: ["-2.2".into(), "0.5".into()],
        width: "1.6".into(),
        rotate: 30.0,
        stretch: 2.0,
        ..View::default()
    };
    // Grain is compared as it is: smoothed, it would hide differences between engines.
    let plain = PictureTable { denoise: false, ..PictureTable::default() };
    let mut home = BuiltIn::home().document().scene();
    home.view = home.view.fitted(SIZE.map(f64::from));
    // The default of the first versions; their pictures must still open unchanged.
    let first = PictureTable { palette: "batlow".into(), ..plain.clone() };
    vec![
        Golden { name: "home", scene: home, picture: plain.clone(), wrong: 0.05 },
        Golden { name: "lesson", scene: Scene::default(), picture: first, wrong: 0.05 },
        Golden {
            name: "rods-either",
            scene: Scene { build: rods, question: question(Rule::Either, 8.0), ..Scene::default() },
            picture: PictureTable { palette: "viridis".into(), ..plain.clone() },
            wrong: 0.02,
        },
        Golden {
            name: "uneven-first",
            scene: Scene {
                build: uneven,
                question: question(Rule::First, 8.0),
                ..Scene::default()
            },
            picture: PictureTable { curve: false, palette: "magma".into(), ..plain.clone() },
            wrong: 0.02,
        },
        Golden {
            name: "turned-samples",
            scene: Scene {
                question: question(Rule::Second, 8.0),
                view: turned,
                ..Scene::default()
            },
            picture: PictureTable { samples: Sampling::Square(2), ..plain },
            wrong: 0.02,
        },
    ]
}

fn paint(golden: &Golden, engine: &mut dyn Engine, precision: Precision) -> RgbImage {
    let along = golden.picture.samples.along();
    let fine = SIZE.map(|side| side * along);
    let mut work = Work::new(&golden.scene, fine, lesson(precision), 4096);
    let mut painter = RowPainter::new(&golden.scene, SIZE, &golden.picture).unwrap();
    let (mut rows, mut bytes) = (RowOrder::default(), Vec::new());
    while !work.is_done() {
        for tile in work.work(engine, None).unwrap() {
            bytes.extend(rows.push(tile).iter().flat_map(|samples| painter.paint(samples)));
        }
    }
    RgbImage::from_raw(SIZE[0], SIZE[1], bytes).expect("all rows were painted")
}

/// Compares two picture files with the code of `flipmap compare`, and saves a picture of the
/// differences beside the second file.
fn compared(expected: &Path, actual: &Path) -> Comparison {
    let [a, b] = [expected, actual].map(|path| ResultRows::open(path).unwrap());
    let mut difference = RgbImage::new(SIZE[0], SIZE[1]);
    let mut y = 0;
    let comparison = compare(a, b, (&Yardstick::Plain, CHANNEL), &mut |row| {
        for (x, by) in (0..).zip(row) {
            let Difference::By(by) = by else { unreachable!("colours have no classes") };
            difference.put_pixel(x, y, Rgb([*by as u8; 3]));
        }
        y += 1;
        Ok(())
    });
    difference.save(actual.with_extension("difference.png")).unwrap();
    comparison.unwrap()
}

fn judge(golden: &Golden, actual: &RgbImage, engine: &str) {
    let path = Path::new("tests/goldens").join(format!("{}.png", golden.name));
    if std::env::var_os("FLIPMAP_UPDATE_GOLDENS").is_some_and(|value| value == "1") {
        actual.save(&path).unwrap();
    }
    let kept = leave(golden.name, engine, actual);
    assert!(path.exists(), "{} is missing; look at {} first", path.display(), kept.display());
    let comparison = compared(&path, &kept);
    assert!(
        comparison.share() <= golden.wrong,
        "{} {engine}: {} of {} pixels are quite wrong; see {} and the difference beside it",
        golden.name,
        comparison.differing,
        comparison.pixels,
        kept.display()
    );
}

fn leave(name: &str, engine: &str, picture: &RgbImage) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../goldens");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}-{engine}.png"));
    picture.save(&path).unwrap();
    path
}

#[test]
fn cpu_pictures_are_as_they_were() {
    for golden in goldens() {
        let mut engine = CpuEngine::new(None).unwrap();
        judge(&golden, &paint(&golden, &mut engine, Precision::F64), "cpu");
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn gpu_pictures_are_as_they_were() {
    let mut engine = gpu_engine();
    for golden in goldens() {
        judge(&golden, &paint(&golden, &mut engine, Precision::F32), "gpu");
    }
}

#[test]
fn a_wrong_picture_is_found_out() {
    let golden = &goldens()[0];
    let mut engine = CpuEngine::new(None).unwrap();
    let right = paint(golden, &mut engine, Precision::F64);
    let right = leave("right", "cpu", &right);
    assert_eq!(compared(&right, &right).share(), 0.0);
    let picture = image::open(&right).unwrap().to_rgb8();
    let moved =
        RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| *picture.get_pixel((x + 3) % SIZE[0], y));
    assert!(compared(&right, &leave("moved", "cpu", &moved)).share() > golden.wrong);
    let mut budget = goldens().remove(0);
    budget.scene.question.budget.secs = 20.0;
    let other = leave("budget", "cpu", &paint(&budget, &mut engine, Precision::F64));
    assert!(compared(&right, &other).share() > golden.wrong);
}
