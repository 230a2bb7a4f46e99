//! Samples in the middle and in the corners of pixels: their colours, their cost, and the numbers
//! that they do not change, compared on the command line with samples that the library computes one
//! by one.

use std::fs;
use std::path::Path;

use crate::program::{done, refused};
use flipmap_engine::choice::{EngineRequest, IntegrationSetting};
use flipmap_engine::{Accuracy, EngineKind};
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::palette::{AnswerColours, Tint, encoded, light, rounded};
use flipmap_scene::{BuiltIn, Document, Scene};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn pixels(path: &Path) -> image::RgbImage {
    image::open(path).unwrap().to_rgb8()
}

/// Renders a scene on the processor, and returns the counts.
fn render(folder: &TempDir, arguments: &[&str]) -> serde_json::Value {
    let options = ["render", "--engine", "cpu", "--budget", "10", "--json"];
    serde_json::from_str(&done(folder, &[&options, arguments].concat())).unwrap()
}

/// The samples of a view of `size` pixels that are `pixel_rad` wide.
fn samples(pixel_rad: f64, size: [u32; 2]) -> (Scene, Samples) {
    let mut scene = BuiltIn::home().document().scene();
    scene.view.center = ["1.9".to_string(), "0.6".to_string()];
    (scene.view.width, scene.view.fit) = (format!("{:.2}", pixel_rad * f64::from(size[0])), false);
    scene.question.budget = "10".parse().unwrap();
    let request = EngineRequest {
        kind: Some(EngineKind::Cpu),
        setting: IntegrationSetting::Accuracy(Accuracy::Balanced),
        ..EngineRequest::default()
    };
    let samples = Renderer::new(&request).unwrap().render(&scene, size).unwrap();
    (scene, samples)
}

/// Colours of the samples on a scale of 255.
fn tints((scene, samples): &(Scene, Samples)) -> Vec<Tint> {
    let colours = AnswerColours::new(scene, &Document::default().picture).unwrap();
    (0..samples.len()).map(|k| colours.tint(samples.get(k).status, samples.values(k))).collect()
}

const SIZE: [u32; 2] = [63, 47];

/// The colours of a pixel's middle and of its corners; a flag tells if a corner is sampled.
struct Around {
    middle: Tint,
    corners: [(Tint, bool); 4],
}

/// Returns the expected colours of the picture, pixel by pixel.
fn around() -> Vec<Around> {
    let [width, height] = SIZE.map(|side| side as usize);
    let middles = tints(&samples(0.02, SIZE));
    let corners = tints(&samples(0.02, SIZE.map(|side| side + 1)));
    let pixel = |x: usize, y: usize| middles[y * width + x];
    let near = |x: usize, end: usize| x.saturating_sub(1)..(x + 2).min(end);
    let is_plain = |x: usize, y: usize| {
        let mut others = near(y, height).flat_map(|b| near(x, width).map(move |a| (a, b)));
        others.all(|(a, b)| (0..3).all(|i| (pixel(a, b)[i] - pixel(x, y)[i]).abs() <= 6.0))
    };
    let has_sample = |x: usize, y: usize| {
        let beside = |x: usize, end: usize| x.saturating_sub(1)..=x.min(end - 1);
        beside(y, height).any(|b| beside(x, width).any(|a| !is_plain(a, b)))
    };
    let corner = |x: usize, y: usize| (corners[y * (width + 1) + x], has_sample(x, y));
    let around = |k: usize| {
        let (x, y) = (k % width, k / width);
        let corners = [corner(x, y), corner(x + 1, y), corner(x, y + 1), corner(x + 1, y + 1)];
        Around { middle: pixel(x, y), corners }
    };
    (0..width * height).map(around).collect()
}

#[test]
fn a_pixel_is_half_its_middle_and_an_eighth_of_each_corner_where_colours_change() {
    let folder = folder();
    let view = ["--center=1.9,0.6", "--width", "1.26", "--no-curve", "--no-denoise"];
    let how = ["--times", "budget", "--size", "63x47", "-o", "map.png"];
    render(&folder, &[&view[..], &how].concat());
    let picture = pixels(&folder.path().join("map.png"));
    let (mut plain, mut mixed) = (0, 0);
    for (pixel, around) in picture.pixels().zip(around()) {
        let own = rounded(around.middle);
        if around.corners.iter().all(|(_, is_sampled)| !is_sampled) {
            assert_eq!(pixel.0, own);
            plain += 1;
            continue;
        }
        let light_of = |tint: Tint, channel: usize| light(rounded(tint)[channel]);
        let expected = [0, 1, 2].map(|channel| {
            let corner = |(tint, is_sampled)| if is_sampled { tint } else { around.middle };
            let corners = around.corners.map(|pair| light_of(corner(pair), channel));
            encoded(light_of(around.middle, channel) / 2.0 + corners.iter().sum::<f64>() / 8.0)
        });
        // The test rounds colours before it mixes them, so they may differ by 2.
        assert!(pixel.0.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 2), "{pixel:?}");
        mixed += usize::from(pixel.0.iter().zip(own).any(|(a, b)| a.abs_diff(b) > 20));
    }
    assert!(plain > 1000 && mixed > 300, "{plain} {mixed}");
}

#[test]
fn a_picture_has_at_most_two_samples_a_pixel_and_its_numbers_are_those_of_one() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let render = |name: &str, samples: &[&str]| {
        let [png, npy, exr] = ["png", "npy", "exr"].map(|ending| format!("{name}.{ending}"));
        let files = ["-o", &png, "--raw", &npy, "--exr", &exr, "--size", "200x150"];
        render(&folder, &[&["filigree"], &files[..], samples].concat())
    };
    let (one, corners) = (render("one", &["--samples", "1"]), render("corners", &[]));
    for count in ["pixels", "flipped", "unflipped", "forbidden", "failed", "trust"] {
        assert_eq!(one[count], corners[count], "{count}");
    }
    let [once, most] = [&one, &corners].map(|counts| counts["simulated"].as_u64().unwrap());
    assert!(most > once * 5 / 4 && most <= 2 * once + 351, "{most} after {once}");
    assert!(fs::read(at("one.npy")).unwrap() == fs::read(at("corners.npy")).unwrap());
    // The images differ only in the scenes at their beginning, not in the numbers that follow.
    let [a, b] = ["one.exr", "corners.exr"].map(|name| fs::read(at(name)).unwrap());
    let numbers = a.len() * 9 / 10;
    assert!(a[a.len() - numbers..] == b[b.len() - numbers..]);
    assert_ne!(pixels(&at("one.png")), pixels(&at("corners.png")));
    // An array alone needs no corners, and a picture opens again with its own sampling.
    let raw = self::render(&folder, &["filigree", "--size", "200x150", "--raw", "raw.npy"]);
    assert_eq!(raw["simulated"], one["simulated"]);
    for name in ["one", "corners"] {
        let again = [&format!("{name}.png"), "-o", "again.png", "--size", "200x150"];
        self::render(&folder, &again);
        assert_eq!(pixels(&at("again.png")), pixels(&at(&format!("{name}.png"))));
    }
}

#[test]
fn a_symmetric_picture_stays_symmetric_and_other_questions_have_corners_too() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for size in ["90x60", "91x61"] {
        render(&folder, &["--size", size, "--no-curve", "-o", "home.png"]);
        let home = pixels(&at("home.png"));
        assert_eq!(image::imageops::rotate180(&home), home, "{size}");
    }
    for ask in [&["--ask", "state", "--at", "5"], &["--ask", "growth", "--samples", "corners"]] {
        let of = |name, samples| {
            let asked: Vec<&str> = ask.iter().copied().filter(|word| *word != "corners").collect();
            let asked: Vec<&str> = asked.into_iter().filter(|word| *word != "--samples").collect();
            render(&folder, &[&asked[..], &["--size", "60x40", "-o", name], samples].concat())
        };
        let (one, corners) = (of("one.png", &["--samples", "1"]), of("corners.png", &[]));
        assert_eq!(one["flipped"], corners["flipped"]);
        assert!(corners["simulated"].as_u64() > one["simulated"].as_u64());
        assert_ne!(pixels(&at("one.png")), pixels(&at("corners.png")));
    }
}

#[test]
fn light_and_pyramids_have_corners_and_states_have_one_sample() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let lit = ["--size", "120x90", "--relief", "0.8", "-o", "lit.png", "--pyramid", "lit"];
    render(&folder, &lit);
    assert_eq!(pixels(&at("lit.png")), pixels(&at("lit/map_files/7/0_0.png")));
    render(&folder, &["--size", "120x90", "-o", "flat.png"]);
    assert_ne!(pixels(&at("lit.png")), pixels(&at("flat.png")));

    let kept = ["--size", "40x30", "--state", "map.state", "-o"];
    let one = render(&folder, &[&kept[..], &["kept.png"]].concat());
    assert!(one["simulated"].as_u64() <= one["pixels"].as_u64());
    render(&folder, &["kept.png", "--size", "40x30", "-o", "again.png"]);
    assert_eq!(pixels(&at("kept.png")), pixels(&at("again.png")));
    let asked = ["render", "--state", "map.state", "-o", "a.png", "--samples", "corners"];
    assert!(refused(&folder, 2, &asked).contains("--samples 1"));
    let film = ["video", "--vary", "time=0..3", "-o", "film/", "--samples", "corners"];
    assert!(refused(&folder, 2, &film).contains("--samples corners is for stills"));
    let wrong = refused(&folder, 2, &["render", "--samples", "edges", "-o", "a.png"]);
    assert!(
        wrong.contains("it must be corners or auto, or a whole number between 1 and 8"),
        "{wrong}"
    );
    fs::write(at("many.toml"), "[picture]\nsamples = 9\n").unwrap();
    let wrong = refused(&folder, 2, &["render", "many.toml", "-o", "a.png"]);
    assert!(
        wrong.contains(
            "many.toml: line 2: `samples` is 9; it must be corners or lie between 1 and 8"
        ),
        "{wrong}"
    );
}

#[test]
fn shards_have_the_corners_of_the_whole_picture() {
    let folder = folder();
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    for (samples, shards) in [("corners", "3"), ("1", "1")] {
        let scene = ["filigree", "--size", "80x61", "--budget", "10", "--samples", samples];
        let plan = ["--engine", "cpu", "--shards", shards, "-o", "plan.toml"];
        done(&folder, &[&["plan"], &scene[..], &plan].concat());
        done(&folder, &["run", "plan.toml", "--engine", "cpu"]);
        done(&folder, &["merge", "plan.toml", "-o", "merged.png", "--raw", "merged.npy"]);
        let still = ["--engine", "cpu", "-o", "still.png", "--raw", "still.npy"];
        done(&folder, &[&["render"], &scene[..], &still].concat());
        assert!(bytes("merged.png") == bytes("still.png"), "{samples}");
        assert!(bytes("merged.npy") == bytes("still.npy"), "{samples}");
        let other = refused(&folder, 2, &["merge", "plan.toml", "-o", "x.png", "--samples", "2"]);
        assert!(other.contains(&format!("--samples is {samples} in the plan")), "{other}");
    }
}
