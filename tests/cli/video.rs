//! Films: the frames they show, and the requests that are refused.

use std::fs;
use std::path::Path;

use crate::program::*;
use tempfile::TempDir;

pub(crate) const CPU: [&str; 4] = ["--engine", "cpu", "--accuracy", "fast"];

pub(crate) fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

pub(crate) fn video(folder: &TempDir, arguments: &[&str]) -> String {
    done(folder, &[&["video"], &CPU[..], arguments].concat())
}

pub(crate) fn pixels(path: &Path) -> image::RgbImage {
    image::open(path).unwrap().to_rgb8()
}

/// The mean difference between two pictures, in levels of 255.
fn difference(a: &image::RgbImage, b: &image::RgbImage) -> f64 {
    let sum: u64 = a.iter().zip(b.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.len() as f64
}

pub(crate) const KEYS: &str = "[[key]]\nsecs = 0\n[[key]]\nsecs = 2\neasing = \"linear\"\n\
                    [key.scene.view]\ncenter = [\"-1.66\", \"0.1\"]\nwidth = \"0.4\"\n";

#[test]
fn frames_are_what_render_draws_there() {
    let folder = folder();
    fs::write(folder.path().join("keys.toml"), KEYS).unwrap();
    video(&folder, &["keys.toml", "--frames", "5", "--size", "64x48", "-o", "f"]);
    for frame in [0, 2, 4] {
        let png = format!("f/00000{frame}.png");
        // A frame is a scene and carries its colours.
        done(&folder, &[&["render", &png, "-o", "r.png"], &CPU[..]].concat());
        let [film, still] = [&png, "r.png"].map(|name| pixels(&folder.path().join(name)));
        let apart = difference(&film, &still);
        let other = pixels(&folder.path().join(format!("f/00000{}.png", (frame + 2) % 5)));
        let others = difference(&film, &other);
        assert!(apart < 20.0 && others > 1.5 * apart, "frame {frame}: {apart} and {others}");
    }
    let manifest = fs::read_to_string(folder.path().join("f/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!((&manifest["frames"], &manifest["fps"]), (&5.into(), &30.0.into()));
    assert_eq!(manifest["pictures"][4]["frame"], 4);
}

#[test]
fn what_others_wrote_is_never_replaced() {
    let how = ["--vary", "time=0..2", "--frames", "3", "--size", "24x16", "-o", "f"];
    for name in ["000003.png", "000001.json", "manifest.json"] {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("f")).unwrap();
        fs::write(at("f").join(name), "{}").unwrap();
        let output = flipmap(&folder, &[&["video"], &CPU[..], &how].concat());
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert!(error_of(&output).contains(name), "{name}: {}", error_of(&output));
        assert!(!at("f.samples").exists(), "refused before anything is computed");
        assert_eq!(fs::read_to_string(at("f").join(name)).unwrap(), "{}");
    }
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("c")).unwrap();
    fs::write(at("c/plan.toml"), "[project]\nname = \"theirs\"").unwrap();
    let cached = [&["video"], &CPU[..], &how, &["--cache", "c"]].concat();
    let output = flipmap(&folder, &cached);
    assert!(error_of(&output).contains("c/plan.toml was not written by flipmap video"));
    fs::remove_file(at("c/plan.toml")).unwrap();
    fs::write(at("c/download.part"), "half a file").unwrap();
    fs::write(at("f.txt"), "no frame").unwrap();
    done(&folder, &cached);
    assert_eq!(fs::read_to_string(at("c/download.part")).unwrap(), "half a file");
    // Frames of a longer film, with somebody else's notes beside them.
    fs::write(at("f/000007.txt"), "mine").unwrap();
    let longer = ["--vary", "time=0..2", "--frames", "5", "--size", "24x16", "-o", "f"];
    video(&folder, &longer);
    video(&folder, &how);
    let mut names: Vec<String> = fs::read_dir(at("f"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let frames = (0..3).flat_map(|k| ["json", "png"].map(|ending| format!("{k:06}.{ending}")));
    let mut expected: Vec<String> =
        frames.chain(["000007.txt", "manifest.json"].map(str::to_string)).collect();
    expected.sort();
    assert_eq!(names, expected);
}

#[test]
fn films_of_other_questions_are_stills_one_after_another() {
    let growth = ["--ask", "growth", "--budget", "2", "--vary", "masses=1,1..1,2"];
    let state = ["--ask", "state", "--at", "2", "--zoom-to", "filigree"];
    let section = ["--plane", "section", "--width", "6", "--budget", "3", "--vary", "energy=0..9"];
    for words in [&growth[..], &state, &section] {
        let folder = folder();
        let how = ["--frames", "3", "--size", "24x16", "--samples", "1", "-o", "f"];
        video(&folder, &[words, &how].concat());
        for frame in [0, 2] {
            let png = format!("f/00000{frame}.png");
            done(&folder, &[&["render", &png, "-o", "r.png"], &CPU[..]].concat());
            let [film, still] = [&png, "r.png"].map(|name| pixels(&folder.path().join(name)));
            assert_eq!(film, still, "{words:?} {frame}");
        }
        let [first, last] = [0, 2].map(|k| pixels(&folder.path().join(format!("f/00000{k}.png"))));
        assert!(difference(&first, &last) > 5.0, "{words:?}: something changes");
        // Existing frames are not made again.
        let made = fs::metadata(folder.path().join("f/000001.png")).unwrap().modified().unwrap();
        video(&folder, &[words, &how].concat());
        let again = fs::metadata(folder.path().join("f/000001.png")).unwrap().modified().unwrap();
        assert_eq!(made, again);
    }
}

#[test]
fn a_legend_covers_its_corner_of_every_frame_of_flips() {
    let folder = folder();
    let what = ["--vary", "time=0..10", "--frames", "2", "--size", "320x200", "--samples", "1"];
    video(&folder, &[&what[..], &["-o", "plain"]].concat());
    // The samples exist already.
    let again = ["--legend", "--cache", "plain.samples", "-o", "with"];
    video(&folder, &[&what[..], &again].concat());
    let frames = |name: &str| {
        ["000000.png", "000001.png"].map(|frame| pixels(&folder.path().join(name).join(frame)))
    };
    let (plain, with) = (frames("plain"), frames("with"));
    assert!(plain[0] != plain[1], "time goes on");
    for (plain, with) in plain.iter().zip(&with) {
        let differs = |x, y| plain.get_pixel(x, y) != with.get_pixel(x, y);
        let at = (0..200).flat_map(|y| (0..320).map(move |x| (x, y)));
        let changed: Vec<_> = at.filter(|(x, y)| differs(*x, *y)).collect();
        assert!(changed.len() > 2000, "{} pixels", changed.len());
        assert!(changed.iter().all(|(x, y)| *x < 270 && *y > 105), "only in its corner");
    }
    let error = refused(
        &folder,
        2,
        &[&["video", "--legend", "-o", "x"], &what[..5], &["200x100"]].concat(),
    );
    assert!(error.contains("--legend is set for a picture of 200x100"), "{error}");
}

#[test]
fn other_colours_and_another_time_compute_nothing() {
    let folder = folder();
    fs::write(folder.path().join("keys.toml"), KEYS).unwrap();
    let film = ["keys.toml", "--size", "48x32", "-o", "f", "--frames", "9"];
    video(&folder, &film);
    let parts = || fs::read_dir(folder.path().join("f.samples/plan.parts")).unwrap().count();
    let before = parts();
    let again = [&["--cache", "f.samples"], &film[..3]].concat();
    let other = ["-o", "g", "--frames", "5", "--palette", "viridis"];
    let output = flipmap(&folder, &[&["video"], &CPU[..], &again[..], &other[..]].concat());
    assert!(error_of(&output).contains("all samples exist already"), "{}", error_of(&output));
    assert_eq!(parts(), before);
    assert!(folder.path().join("g/000004.png").exists());
}

#[test]
fn machines_are_told_of_samples_and_then_of_frames() {
    let folder = folder();
    let film = ["--vary", "time=0..30", "--size", "48x36", "--frames", "4", "-o", "f"];
    let output =
        flipmap(&folder, &[&["video"], &CPU[..], &film[..], &["--progress", "json"]].concat());
    let lines: Vec<serde_json::Value> =
        error_of(&output).lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let last = |rate: &str| lines.iter().rfind(|line| line[rate].is_number()).cloned().unwrap();
    let [samples, frames] = ["samples_per_sec", "frames_per_sec"].map(last);
    assert_eq!(samples["done"], samples["total"]);
    assert_eq!((&frames["done"], &frames["total"]), (&4.into(), &4.into()));
    assert!(frames["secs_left"].is_number());
}

#[test]
fn pixels_light_up_as_they_flip_and_stay() {
    let folder = folder();
    let size = ["--size", "48x36", "--frames", "6"];
    video(&folder, &[&["--vary", "time=0..30", "-o", "t"], &size[..]].concat());
    let frames: Vec<_> =
        (0..6).map(|k| pixels(&folder.path().join(format!("t/00000{k}.png")))).collect();
    let lit =
        |frame: &image::RgbImage| frame.pixels().filter(|p| p.0 != [0x16, 0x18, 0x1d]).count();
    let counts: Vec<usize> = frames.iter().map(lit).collect();
    assert!(counts.windows(2).all(|two| two[0] <= two[1]) && counts[0] < counts[5], "{counts:?}");
    // A shorter film in the same folder removes all frames of the longer one.
    video(&folder, &["--vary", "time=0..40", "--size", "48x36", "--frames", "3", "-o", "t"]);
    assert_eq!(fs::read_dir(folder.path().join("t")).unwrap().count(), 7);
    let last = fs::read_to_string(folder.path().join("t/000002.json")).unwrap();
    assert!(last.contains("budget=40"), "it is as long as time runs: {last}");
    // The last frame of a film with a growing budget is the ordinary map.
    video(&folder, &[&["--vary", "budget=1..30", "-o", "b"], &size[..]].concat());
    let render = ["render", "--size", "48x36", "--samples", "2", "-o", "r.png"];
    done(&folder, &[&render[..], &CPU[..]].concat());
    let [end, still] = ["b/000005.png", "r.png"].map(|name| pixels(&folder.path().join(name)));
    assert!(difference(&end, &still) < 16.0);
}

#[test]
fn a_pendulum_may_change_from_frame_to_frame() {
    let folder = folder();
    let vary = ["--vary", "masses=1,1..1,5", "--size", "40x30", "--frames", "3", "-o", "p"];
    video(&folder, &vary);
    let last = fs::read_to_string(folder.path().join("p/000002.json")).unwrap();
    assert!(last.contains("masses=1,5"), "{last}");
    let [a, b] = [0, 2].map(|k| pixels(&folder.path().join(format!("p/00000{k}.png"))));
    assert!(difference(&a, &b) > 10.0);
}

#[test]
fn a_zoom_ends_where_the_options_say() {
    let folder = folder();
    let zoom = ["--zoom-to", "home", "--center=1,1", "--width", "0.5", "--size", "24x24"];
    video(&folder, &[&zoom[..], &["--frames", "3", "-o", "f"]].concat());
    let line = |frame: u32| {
        let json = fs::read_to_string(folder.path().join(format!("f/00000{frame}.json"))).unwrap();
        let object: serde_json::Value = serde_json::from_str(&json).unwrap();
        object["location"].as_str().unwrap().to_string()
    };
    for (frame, view) in [(0, "width=6.28"), (2, "center=1,1;width=0.5")] {
        assert!(line(frame).contains(view), "{}", line(frame));
    }
}

#[test]
fn what_is_no_film_is_refused_by_name() {
    let folder = folder();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    file("back.toml", "[[key]]\nsecs = 2\n[[key]]\nsecs = 1\n");
    file(
        "sizes.toml",
        "[[key]]\nsecs = 0\n[key.scene.run]\nsize = [64, 48]\n[[key]]\nsecs = 1\n\
                        [key.scene.run]\nsize = [32, 24]\n",
    );
    file("one.toml", "[[key]]\nsecs = 0\n");
    file("none.toml", "format = 1\n");
    let video = |words: &[&str]| refused(&folder, 2, &[&["video"], &CPU[..], words].concat());
    let missing = ["video", "--zoom-to", "deep", "-o", "missing/f.mp4"];
    let missing = refused(&folder, 1, &missing);
    assert!(missing.contains("-o: cannot write missing/f.mp4"), "{missing}");
    for (words, expected) in [
        (&["back.toml", "-o", "f"][..], "back.toml: key 2 is at 1 s; each must be later"),
        (&["sizes.toml", "-o", "f"], "different sizes, 64x48 and 32x24; say which with --size"),
        (&["one.toml", "-o", "f"], "a film needs two keys or more, and this one has 1"),
        (&["-o", "f"], "a film needs a file of keys"),
        (&["none.toml", "-o", "f"], "none.toml: there are no keys in it"),
        (&["nowhere.toml", "-o", "f"], "nowhere.toml: cannot be read"),
        (&["--zoom-to", "deep", "--size", "1x9", "-o", "f.mkv"], "a film needs 2 pixels a side"),
        (&["--zoom-to", "deep", "--size", "90000x90000", "-o", "f"], "too much for a film"),
        (&["--zoom-to", "deep", "--palette", "rainbow", "-o", "f"], "--palette is 'rainbow'"),
        (&["--zoom-to", "deep", "-o", "/"], "a film is an .mp4, an .mkv"),
        (
            &["--zoom-to", "deep", "--frames", "60", "--fps", "30", "--secs", "9", "-o", "f"],
            "60 frames at 30 per second last 2.00 s, and the film 9 s: leave out one of the three",
        ),
        (&["home", "first", "-o", "f"], "key 2 has another rule than the first"),
        (&["home", "moment", "-o", "f"], "key 2 has another question than the first"),
        (&["home", "section", "-o", "f"], "key 2 has another plane than the first"),
        (&["--ask", "growth", "--vary", "time=0..9", "-o", "f"], "key 1 has a clock"),
        (
            &["--ask", "growth", "--vary", "gravity=1..9", "--cache", "c", "-o", "f"],
            "it keeps no samples, only its frames: omit --cache",
        ),
        (&["--zoom-to", "deep", "-o", "f.avi"], "a film is an .mp4, an .mkv"),
        (&["--zoom-to", "deep", "--quality", "50", "-o", "f.gif"], "--quality is 50; only an .mp4"),
        (&["home", "deep", "--width", "1", "-o", "f"], "would give all keys the same view"),
        (&["--zoom-to", "deep", "--fps", "30/0", "-o", "f"], "--fps is '30/0'; it must lie"),
        (
            &["--zoom-to", "deep", "--frames", "0", "-o", "f"],
            "--frames is '0'; it must lie between",
        ),
        (&["--zoom-to", "deep", "--fps", "fast", "-o", "f"], "--fps is 'fast'; it must lie"),
        (&["--vary", "colour=1..2", "-o", "f"], "--vary is 'colour=1..2'; the quantities are time"),
        (
            &["--vary", "masses=1,1..0,1", "-o", "f"],
            "masses is 0,1; it must be two numbers between 1e-9 and 1e9 kg",
        ),
        (
            &["--budget", "30", "--vary", "at=0..50", "-o", "f"],
            "--vary is 'at=0..50': at is 50 s; it must lie within the budget, between 0 and 30 s",
        ),
        (
            &["--vary", "energy=0..9", "-o", "f"],
            "energy is '9'; only the plane section has an energy",
        ),
        (
            &["--rule", "either", "--vary", "at=0..3", "-o", "f"],
            "rule is 'either'; only the question",
        ),
        (&["--ask", "first", "--vary", "at=0..3", "-o", "f"], "only the questions flips, state"),
        (&["--zoom-to", "nowhere", "-o", "f"], "no scene 'nowhere'"),
    ] {
        let error = video(words);
        assert!(error.contains(expected), "{words:?}: {error}");
    }
    assert!(!folder.path().join("f").exists());
}
