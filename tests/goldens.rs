//! Small pictures, compared with ones that were looked at.
//!
//! Two tolerances: how far off a channel may be, and how many pixels may be quite wrong. In
//! chaotic places sound engines differ, so the share is bounded there and the first tolerance is
//! never widened. A failure leaves `expected | difference | actual` in `target/goldens`; a
//! missing golden is written there too and fails. `FLIPMAP_UPDATE_GOLDENS=1` replaces them.

mod common;

use std::path::{Path, PathBuf};

use common::*;
use flipmap::engine::cpu::CpuEngine;
use flipmap::engine::{Engine, Precision};
use flipmap::output::{Painter, RowOrder};
use flipmap::physics::Rule;
use flipmap::scene::{Budget, Build, Kind, PictureTable, Question, Scene, View};
use flipmap::tiles::Work;
use image::{GenericImage, Rgb, RgbImage};

const SIZE: [u32; 2] = [120, 96];
/// A channel may be this far off, of 255.
const CHANNEL: u8 = 6;

struct Golden {
    name: &'static str,
    scene: Scene,
    picture: PictureTable,
    /// Share of the pixels that may be quite wrong.
    wrong: f64,
}

fn goldens() -> Vec<Golden> {
    let question = |rule, secs| Question { rule, budget: Budget::secs(secs) };
    let rods = Build { kind: Kind::Rods, ..Build::default() };
    let uneven = Build { masses: [1.0, 2.0], lengths: [1.0, 0.6], ..Build::default() };
    let turned = View {
        center: ["-2.2".into(), "0.5".into()],
        width: "1.6".into(),
        rotate: 30.0,
        stretch: 2.0,
    };
    let plain = PictureTable::default();
    vec![
        Golden { name: "home", scene: Scene::default(), picture: plain.clone(), wrong: 0.05 },
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
            picture: PictureTable { samples: 2, ..plain },
            wrong: 0.02,
        },
    ]
}

fn paint(golden: &Golden, engine: &mut dyn Engine, precision: Precision) -> RgbImage {
    let along = golden.picture.samples;
    let fine = SIZE.map(|side| side * along);
    let mut work = Work::new(&golden.scene, fine, lesson(precision), 4096);
    let mut painter = Painter::new(&golden.scene, SIZE, &golden.picture).unwrap();
    let (mut rows, mut bytes) = (RowOrder::default(), Vec::new());
    while !work.is_done() {
        for tile in work.work(engine, None).unwrap() {
            bytes.extend(rows.push(tile).iter().flat_map(|samples| painter.paint(samples)));
        }
    }
    RgbImage::from_raw(SIZE[0], SIZE[1], bytes).expect("all rows were painted")
}

/// The share of pixels of which a channel is further off than allowed.
fn quite_wrong(expected: &RgbImage, actual: &RgbImage) -> f64 {
    assert_eq!(expected.dimensions(), actual.dimensions());
    let off =
        |(a, b): &(&Rgb<u8>, &Rgb<u8>)| a.0.iter().zip(b.0).any(|(&a, b)| a.abs_diff(b) > CHANNEL);
    let wrong = expected.pixels().zip(actual.pixels()).filter(off).count();
    wrong as f64 / (expected.width() * expected.height()) as f64
}

fn compare(golden: &Golden, actual: &RgbImage, engine: &str) {
    let path = Path::new("tests/goldens").join(format!("{}.png", golden.name));
    if std::env::var_os("FLIPMAP_UPDATE_GOLDENS").is_some_and(|value| value == "1") {
        actual.save(&path).unwrap();
    }
    let Ok(expected) = image::open(&path) else {
        let kept = leave(golden.name, engine, actual);
        panic!("{} is missing; look at {} first", path.display(), kept.display());
    };
    let expected = expected.to_rgb8();
    let wrong = quite_wrong(&expected, actual);
    if wrong > golden.wrong {
        let kept = leave(golden.name, engine, &beside(&expected, actual));
        panic!(
            "{} {engine}: {wrong} of the pixels are quite wrong; see {}",
            golden.name,
            kept.display()
        );
    }
}

fn leave(name: &str, engine: &str, picture: &RgbImage) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../goldens");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}-{engine}.png"));
    picture.save(&path).unwrap();
    path
}

/// Expected, difference and actual in one picture.
fn beside(expected: &RgbImage, actual: &RgbImage) -> RgbImage {
    let (width, height) = expected.dimensions();
    let difference = RgbImage::from_fn(width, height, |x, y| {
        let (a, b) = (expected.get_pixel(x, y), actual.get_pixel(x, y));
        Rgb([0, 1, 2].map(|i| a.0[i].abs_diff(b.0[i])))
    });
    let mut all = RgbImage::new(3 * width, height);
    for (i, part) in (0..).zip([expected, &difference, actual]) {
        all.copy_from(part, i * width, 0).unwrap();
    }
    all
}

#[test]
fn cpu_pictures_are_as_they_were() {
    for golden in goldens() {
        let mut engine = CpuEngine::new(None).unwrap();
        compare(&golden, &paint(&golden, &mut engine, Precision::F64), "cpu");
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn gpu_pictures_are_as_they_were() {
    let mut engine = gpu_engine();
    for golden in goldens() {
        compare(&golden, &paint(&golden, &mut engine, Precision::F32), "gpu");
    }
}

#[test]
fn a_wrong_picture_is_found_out() {
    let golden = &goldens()[0];
    let mut engine = CpuEngine::new(None).unwrap();
    let right = paint(golden, &mut engine, Precision::F64);
    assert_eq!(quite_wrong(&right, &right), 0.0);
    let moved = RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| *right.get_pixel((x + 3) % SIZE[0], y));
    assert!(quite_wrong(&right, &moved) > golden.wrong);
    let mut budget = goldens().remove(0);
    budget.scene.question.budget.secs = 20.0;
    let other = paint(&budget, &mut engine, Precision::F64);
    assert!(quite_wrong(&right, &other) > golden.wrong);
}
