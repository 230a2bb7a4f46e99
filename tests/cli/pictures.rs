//! Pictures other than PNG: pyramids, images that cannot be written from front to back, formats by
//! name, and light from the side, tested through the command line.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::program::{error_of, flipmap, refused};
use flipmap_render::output::read_document;
use image::ImageFormat;
use tempfile::TempDir;

/// Runs `flipmap render` on the processor, so that these tests need no adapter.
fn render(folder: &TempDir, arguments: &[&str]) -> Output {
    let options = ["render", "--engine", "cpu", "--size", "300x200", "--budget", "10"];
    flipmap(folder, &[&options, arguments].concat())
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn done(folder: &TempDir, arguments: &[&str]) {
    let output = render(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", error_of(&output));
}

/// The pixels of a PNG file.
fn pixels(path: &Path) -> image::RgbImage {
    image::open(path).unwrap().to_rgb8()
}

#[test]
fn a_pyramid_is_the_picture_in_tiles_beside_a_page_and_the_scene() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    done(&folder, &["-o", "map.png", "--pyramid", "map", "--samples", "2", "--raw", "map.npy"]);
    let whole = pixels(&at("map.png"));
    for (column, left, width) in [(0, 0, 256), (1, 256, 44)] {
        let tile = pixels(&at(&format!("map/map_files/9/{column}_0.png")));
        assert_eq!(tile.dimensions(), (width, 200));
        assert!(tile.enumerate_pixels().all(|(x, y, pixel)| whole.get_pixel(left + x, y) == pixel));
    }
    assert_eq!(pixels(&at("map/map_files/0/0_0.png")).dimensions(), (1, 1));
    let page = fs::read_to_string(at("map/index.html")).unwrap();
    assert!(page.contains("300 × 200") && page.contains("[view]"));
    // The scene beside the page gives the same picture. A pyramid needs no other output.
    done(&folder, &["map/map.toml", "-o", "again.png"]);
    assert!(fs::read(at("map.png")).unwrap() == fs::read(at("again.png")).unwrap());
    done(&folder, &["map/map.toml", "--pyramid", "alone"]);
    let tile = |name: &str| fs::read(at(name).join("map_files/9/1_0.png")).unwrap();
    assert!(tile("map") == tile("alone"));
}

#[test]
fn sixteen_bits_a_channel_have_colours_between_those_of_eight() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    done(&folder, &["-o", "plain.png"]);
    done(&folder, &["-o", "deep.png", "--bits", "16", "--pyramid", "tiles"]);
    done(&folder, &["deep.png", "-o", "deep.tiff"]);
    let plain = pixels(&at("plain.png"));
    let [deep, tiff] = ["deep.png", "deep.tiff"].map(|name| image::open(at(name)).unwrap());
    assert_eq!((deep.color(), &deep), (image::ColorType::Rgb16, &tiff), "the scene says so");
    let deep = deep.to_rgb16();
    let near = |(deep, plain): (&u16, &u8)| (f64::from(*deep) / 257.0 - f64::from(*plain)).abs();
    assert!(deep.iter().zip(plain.iter()).map(near).fold(0.0, f64::max) <= 0.51);
    let between = deep.iter().filter(|channel| *channel % 257 != 0).count();
    assert!(between > deep.len() / 10, "{between} channels of {}", deep.len());
    let tile = pixels(&at("tiles/map_files/9/0_0.png"));
    assert_eq!(tile.get_pixel(9, 9), plain.get_pixel(9, 9), "tiles have eight");
    for name in ["map.jpg", "map.webp"] {
        let output = render(&folder, &["-o", name, "--bits", "16"]);
        let ending = &name[3..];
        let words = format!("{ending} has no 16 bits a channel: name a .png or a .tiff");
        assert!(error_of(&output).contains(&words), "{}", error_of(&output));
        assert!(!at(name).exists());
    }
    let odd = refused(&folder, 2, &["render", "-o", "a.png", "--bits", "12"]);
    assert!(odd.contains("--bits is 12; it must be 8 or 16"), "{odd}");
    let film = ["video", "home", "--vary", "time=0..1", "-o", "film", "--bits", "16"];
    assert!(refused(&folder, 2, &film).contains("--bits is for stills: films have 8 bits"));
}

#[test]
fn light_from_the_side_is_in_pictures_and_their_tiles_and_not_in_numbers() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let flat = ["-o", "flat.png", "--raw", "flat.npy"];
    done(&folder, &flat);
    let lit = ["-o", "lit.png", "--raw", "lit.npy", "--pyramid", "lit"];
    done(&folder, &[&lit[..], &["--relief", "0.7", "--light", "90"]].concat());
    assert!(fs::read(at("flat.npy")).unwrap() == fs::read(at("lit.npy")).unwrap());
    let [flat, lit] = ["flat.png", "lit.png"].map(|name| pixels(&at(name)));
    let changed = flat.pixels().zip(lit.pixels()).filter(|(a, b)| a != b).count();
    assert!(changed > 10_000, "{changed} pixels");
    let tile = pixels(&at("lit/map_files/9/0_0.png"));
    assert!(tile.enumerate_pixels().all(|(x, y, pixel)| lit.get_pixel(x, y) == pixel));
    for (option, text) in [("--relief", "2"), ("--relief", "much"), ("--light", "1e9")] {
        let output = render(&folder, &["-o", "a.png", option, text]);
        assert!(error_of(&output).contains(&format!("{option} is ")), "{}", error_of(&output));
    }
}

/// Keys of a film from the whole map to a part of it.
const KEYS: &str = "[[key]]\nsecs = 0\n[[key]]\nsecs = 2\neasing = \"linear\"\n\
                    [key.scene.view]\ncenter = [\"-1.66\", \"0.1\"]\nwidth = \"0.4\"\n";

#[test]
fn films_are_lit_as_stills_are() {
    let folder = folder();
    fs::write(folder.path().join("keys.toml"), KEYS).unwrap();
    let run = |arguments: &[&str]| {
        let fast = ["--engine", "cpu", "--accuracy", "fast"];
        let output = flipmap(&folder, &[arguments, &fast].concat());
        assert!(output.status.success(), "{arguments:?}: {}", error_of(&output));
    };
    let film =
        ["video", "keys.toml", "--frames", "3", "--times", "budget", "--size", "160x120", "-o"];
    run(&[&film[..], &["flat"]].concat());
    let light = ["lit", "--relief", "0.8", "--light", "90", "--cache", "flat.samples"];
    run(&[&film[..], &light].concat());
    // The last frame shows mostly chaos, which is not lit.
    for frame in ["000000.png", "000001.png"] {
        let both = |still: &str, of: &str| {
            let scene = format!("{of}/{frame}");
            run(&["render", &scene, "-o", still]);
            [scene.as_str(), still].map(|name| pixels(&folder.path().join(name)))
        };
        let ([flat_film, flat], [lit_film, lit]) =
            (both("flat.png", "flat"), both("lit.png", "lit"));
        let (mut changed, mut apart) = (0, [0, 0]);
        for (x, y, pixel) in lit.enumerate_pixels() {
            let from_lit = |other: &image::RgbImage| -> u32 {
                let other = other.get_pixel(x, y);
                (0..3).map(|k| u32::from(pixel[k].abs_diff(other[k]))).sum()
            };
            if from_lit(&flat) > 24 {
                changed += 1;
                apart[0] += from_lit(&flat_film);
                apart[1] += from_lit(&lit_film);
            }
        }
        assert!(changed > 1000, "{frame}: {changed} pixels are lit");
        assert!(2 * apart[1] < apart[0], "{frame}: flat and lit films are {apart:?} apart");
    }
}

#[test]
fn a_film_does_not_keep_the_times_of_one_view() {
    let folder = folder();
    let cpu = ["--engine", "cpu", "--accuracy", "fast"];
    let run = |arguments: &[&str]| {
        let output = flipmap(&folder, &[arguments, &cpu].concat());
        assert!(output.status.success(), "{arguments:?}: {}", error_of(&output));
    };
    let narrow = ["render", "filigree", "--size", "48x32", "-o", "map.png"];
    run(&narrow);
    let of = |name: &str| read_document(&folder.path().join(name)).unwrap().picture;
    assert!(of("map.png").of_view && !of("map.png").times.is_empty());
    let film = ["--frames", "3", "--size", "24x16", "--samples", "1", "-o"];
    for (scene, to) in [("map.png", "a"), ("filigree", "b")] {
        run(&[&["video", scene, "--vary", "masses=1,1..1,2"], &film[..], &[to]].concat());
    }
    for frame in ["000000.png", "000001.png", "000002.png"] {
        let [a, b] = ["a", "b"].map(|film| format!("{film}/{frame}"));
        assert!(!of(&a).of_view);
        assert_eq!(of(&a).times, of(&b).times, "{frame}");
    }
}

#[test]
fn a_pyramid_is_replaced_and_nothing_else_is() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    done(&folder, &["--pyramid", "map"]);
    let tile = || fs::read(at("map/map_files/9/0_0.png")).unwrap();
    let before = tile();
    done(&folder, &["--pyramid", "map", "--palette", "magma"]);
    assert!(tile() != before);
    fs::create_dir(at("mine")).unwrap();
    fs::write(at("mine/notes.txt"), "mine").unwrap();
    let cases: [(&[&str], i32, &str); 7] = [
        (&["--pyramid", "mine"], 1, "--pyramid: cannot write mine: holds notes.txt"),
        (&["--pyramid", "mine/notes.txt"], 1, "is a file: name a folder"),
        (&["--pyramid", "no/map"], 1, "the folder no does not exist"),
        (&["--pyramid", "-"], 2, "--pyramid writes a folder"),
        (&["--pyramid", "map", "-o", "map"], 2, "-o and --pyramid name the same file"),
        (&["--pyramid", "map", "-o", "./map/map.png"], 2, "-o lies in the folder of --pyramid"),
        (&["--pyramid", "map", "--state", "map/s"], 2, "--state lies in the folder of --pyramid"),
    ];
    for (arguments, code, words) in cases {
        let output = render(&folder, arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", error_of(&output));
        assert!(error_of(&output).contains(words), "{arguments:?}: {}", error_of(&output));
    }
    assert_eq!(fs::read_to_string(at("mine/notes.txt")).unwrap(), "mine");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "something stray was left");
}

#[test]
fn an_exr_image_is_the_same_in_a_pipe() {
    let folder = folder();
    done(&folder, &["--exr", "map.exr"]);
    let output = render(&folder, &["--exr", "-"]);
    assert!(output.status.success(), "{}", error_of(&output));
    assert!(output.stdout == fs::read(folder.path().join("map.exr")).unwrap());
    if Path::new("/dev/full").exists() {
        let full = render(&folder, &["--exr", "/dev/full"]);
        assert_eq!(full.status.code(), Some(1));
        assert!(error_of(&full).contains("cannot write /dev/full"), "{}", error_of(&full));
    }
}

#[cfg(unix)]
#[test]
fn a_signal_leaves_no_half_pyramid() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let folder = folder();
    let mut child = Command::new(env!("CARGO_BIN_EXE_flipmap"))
        .current_dir(&folder)
        .args(["render", "--engine", "cpu", "--size", "3000x3000", "--pyramid", "map"])
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while fs::read_dir(&folder).unwrap().count() == 0 && begun.elapsed().as_secs() < 20 {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(500));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", "INT", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
fn pictures_have_the_format_of_their_name() {
    let folder = folder();
    done(&folder, &["--accuracy", "exact", "-o", "map.webp", "--trust", "trust.jpg"]);
    done(&folder, &["-o", "map.png"]);
    for arguments in [
        &["lab", "single", "-o", "single.tiff"][..],
        &["compare", "map.png", "map.png", "-o", "same.webp"],
    ] {
        let output = flipmap(&folder, arguments);
        assert!(output.status.success(), "{arguments:?}: {}", error_of(&output));
    }
    for (name, format) in [
        ("map.webp", ImageFormat::WebP),
        ("trust.jpg", ImageFormat::Jpeg),
        ("single.tiff", ImageFormat::Tiff),
        ("same.webp", ImageFormat::WebP),
    ] {
        let bytes = fs::read(folder.path().join(name)).unwrap();
        assert_eq!(image::guess_format(&bytes).unwrap(), format, "{name}");
    }
    for refused in ["map.gif", "map.bmp"] {
        let output = render(&folder, &["-o", refused]);
        assert!(error_of(&output).contains(".png, .jpg, .jpeg, .webp, .tif or .tiff"), "{refused}");
        assert!(!folder.path().join(refused).exists());
    }
}

#[test]
fn gradients_of_others_paint_and_stay_in_the_picture() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("ember.gpl"), "GIMP Palette\n 6 8 15 night\n194 71 28\n255 233 196\n").unwrap();
    let small = ["render", "--engine", "cpu", "--size", "24x24", "--accuracy", "fast"];
    let painted = |palette: &str, name: &str| {
        let output = flipmap(&folder, &[&small[..], &["--palette", palette, "-o", name]].concat());
        assert!(output.status.success(), "{}", error_of(&output));
        fs::read(at(name)).unwrap()
    };
    let listed = painted("#06080f,#c2471c,#ffe9c4", "list.png");
    assert_eq!(painted("ember.gpl", "file.png"), listed, "the picture holds the colours");
    assert_ne!(painted("#06080f,#c2471c,#ffe9c5", "other.png"), listed);
    // The picture is a scene that contains its gradient and needs no gradient file.
    fs::remove_file(at("ember.gpl")).unwrap();
    let again = flipmap(&folder, &["render", "file.png", "--engine", "cpu", "-o", "again.png"]);
    assert!(again.status.success(), "{}", error_of(&again));
    assert_eq!(fs::read(at("again.png")).unwrap(), listed);
    fs::write(at("no.map"), "nothing\n").unwrap();
    for (palette, words) in [
        ("no.map", "--palette: no.map line 1 is 'nothing'; it must be red, green and blue from 0"),
        ("nowhere.ugr", "--palette: cannot read the gradient nowhere.ugr"),
        ("#12,#34", "'#12' in it is not a colour"),
    ] {
        let error =
            refused(&folder, 2, &[&small[..], &["--palette", palette, "-o", "x.png"]].concat());
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn adaptive_sampling_looks_like_full_sampling_and_costs_less() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let counted = |name: &str, samples: &str| {
        // A smooth place with few edges.
        let view = ["--center=1.9,0.6", "--width", "1.2", "--no-curve", "--no-denoise", "--json"];
        let output = render(&folder, &[&view[..], &["-o", name, "--samples", samples]].concat());
        assert!(output.status.success(), "{}", error_of(&output));
        let counts: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (pixels(&at(name)), counts["simulated"].as_u64().unwrap())
    };
    let (one, once) = counted("one.png", "1");
    let (full, most) = counted("full.png", "3");
    let (auto, fewer) = counted("auto.png", "auto");
    let apart = |a: &image::RgbImage, b: &image::RgbImage| {
        let squares = a.iter().zip(b.iter()).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2));
        (squares.sum::<f64>() / a.len() as f64).sqrt()
    };
    let [rough, near] = [&one, &auto].map(|picture| apart(picture, &full));
    assert!(rough > 4.0 && near < rough / 8.0, "{rough} {near}");
    assert!(fewer < most * 6 / 10 && fewer > 2 * once, "{fewer} of {most}, the first run included");
    // The picture opens again as it was sampled.
    done(&folder, &["auto.png", "-o", "again.png"]);
    assert_eq!(pixels(&at("again.png")), auto);
}

#[test]
fn adaptive_sampling_is_for_whole_stills() {
    let folder = folder();
    let most = ["render", "--size", "8192x8192", "--samples", "auto", "-o", "most.png"];
    let most = refused(&folder, 2, &most);
    assert!(most.contains("33554432 pixels"), "{most}");
    let wrong = refused(&folder, 2, &["render", "--samples", "some", "-o", "a.png"]);
    assert!(
        wrong.contains("it must be corners or auto, or a whole number between 1 and 8"),
        "{wrong}"
    );
    let plan = ["plan", "--shards", "2", "-o", "big.toml", "--samples", "auto"];
    assert!(refused(&folder, 2, &plan).contains("--samples auto is for render"));
    let film = ["video", "--vary", "time=0..3", "-o", "film/", "--samples", "auto"];
    assert!(refused(&folder, 2, &film).contains("--samples auto is for render"));
}
