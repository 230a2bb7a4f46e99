//! `flipmap compare`: its report on two results, and its exit code.

use std::fs;
use std::process::Stdio;

use crate::program::*;

#[test]
fn an_npz_is_compared_as_the_array_of_its_channels() {
    let folder = tempfile::tempdir().unwrap();
    for (ask, more) in [("flip", &[][..]), ("flip", &["--rotate", "30"]), ("growth", &[])] {
        let small = ["render", "--budget", "2", "--size", "16x12", "--engine", "cpu", "--ask", ask];
        for name in ["f.npz", "f.npy"] {
            done(&folder, &[&small[..], more, &["--raw", name]].concat());
        }
        let said = done(&folder, &["compare", "f.npz", "f.npy", "--ask", ask]);
        assert!(said.starts_with("0 of 192 pixels differ"), "{said}");
    }
    let map = |names: [&str; 2], at: &str| {
        for name in names {
            let question = ["render", "--ask", "state", "--at", at, "--size", "16x12"];
            done(&folder, &[&question[..], &["--engine", "cpu", "--raw", name]].concat());
        }
    };
    map(["a.npz", "a.npy"], "1");
    map(["b.npz", "b.npy"], "1.1");
    let told = |a: &str, b: &str| {
        let words = ["compare", a, b, "--ask", "state", "--json", "--share", "1"];
        let output = flipmap(&folder, &words);
        assert!(output.status.success(), "{}", error_of(&output));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    assert_eq!(told("a.npz", "a.npy")["max"], 0.0);
    let apart = told("a.npz", "b.npz");
    assert_eq!(apart, told("a.npy", "b.npy"));
    assert!(apart["max"].as_f64().unwrap() > 1.0, "{apart}");
    let whole = fs::read(folder.path().join("a.npz")).unwrap();
    fs::write(folder.path().join("cut.npz"), &whole[..whole.len() / 2]).unwrap();
    let cut = refused(&folder, 1, &["compare", "cut.npz", "a.npz"]);
    assert!(cut.contains("cut.npz is no .npz"), "{cut}");
}

#[test]
fn results_are_compared_and_too_much_difference_is_code_3() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let map = |name: &str, method: &[&str], size: &str| {
        let files = ["-o", &at(&format!("{name}.png")), "--raw", &at(&format!("{name}.npy"))]
            .map(str::to_string);
        let files: Vec<&str> = files.iter().map(String::as_str).collect();
        let cpu = ["render", "--engine", "cpu", "--no-denoise", "--size", size];
        let output = flipmap(&folder, &[&cpu[..], &files[..], method].concat());
        assert!(output.status.success(), "{output:?}");
    };
    map("fine", &["--accuracy", "balanced"], "48x48");
    map("coarse", &["--accuracy", "lesson"], "48x48");
    map("small", &["--accuracy", "lesson"], "40x48");
    map("grown", &["--ask", "growth", "--budget", "1"], "48x48");
    let compared = |arguments: &[&str]| flipmap(&folder, &[&["compare"], arguments].concat());
    let questions = compared(&[&at("fine.png"), &at("grown.png")]);
    assert_eq!(questions.status.code(), Some(2), "{questions:?}");
    assert!(error_of(&questions).contains("answers the question flip on"), "{questions:?}");
    // Arrays do not record the question that they answer.
    let arrays = compared(&[&at("fine.npy"), &at("grown.npy")]);
    assert!(
        error_of(&arrays).contains("more than 0.001 in the unit of the channel;"),
        "{arrays:?}"
    );
    let flips = compared(&[&at("fine.npy"), &at("coarse.npy"), "--ask", "flip"]);
    assert!(error_of(&flips).contains("more than 0.001 s;"), "{flips:?}");
    map("third", &["--count", "3"], "48x48");
    map("thrown", &["--plane", "speeds", "--width", "20"], "48x48");
    for other in ["third.png", "thrown.png"] {
        assert_eq!(compared(&[&at("fine.png"), &at(other)]).status.code(), Some(2), "{other}");
    }
    map("soon", &["--ask", "state", "--at", "1"], "48x48");
    map("later", &["--ask", "state", "--at", "1.00001"], "48x48");
    let states = compared(&[&at("soon.npy"), &at("later.npy"), "--ask", "state", "--json"]);
    let told: serde_json::Value = serde_json::from_slice(&states.stdout).unwrap();
    assert!(told["differing"] == 0 && told["max"].as_f64().unwrap() > 0.0, "{told}");
    assert_eq!(told["unit"], "times what counts as right");
    let other = compared(&[&at("soon.npy"), &at("later.npy"), "--ask", "growth"]);
    assert!(error_of(&other).contains("has 6 channels, and the question growth 1"), "{other:?}");
    for ending in ["npy", "png"] {
        let [fine, coarse, small] =
            ["fine", "coarse", "small"].map(|name| at(&format!("{name}.{ending}")));
        let same = compared(&[&fine, &fine]);
        assert!(same.status.success(), "{same:?}");
        let picture = at(&format!("difference-{ending}.png"));
        let differs = compared(&[&fine, &coarse, "-o", &picture, "--json"]);
        assert_eq!(differs.status.code(), Some(3), "{differs:?}");
        let told: serde_json::Value = serde_json::from_slice(&differs.stdout).unwrap();
        let share = told["share"].as_f64().unwrap();
        assert!(told["pixels"] == 2304 && (0.001..0.3).contains(&share), "{told}");
        assert_eq!(image::open(&picture).unwrap().width(), 48);
        assert!(compared(&[&fine, &coarse, "--share", "0.3"]).status.success());
        let sizes = compared(&[&fine, &small]);
        assert_eq!(sizes.status.code(), Some(1));
        assert!(error_of(&sizes).contains("48 × 48 and"), "{}", error_of(&sizes));
    }
    let cut = at("cut.npy");
    let whole = fs::read(at("fine.npy")).unwrap();
    fs::write(&cut, &whole[..whole.len() - 8]).unwrap();
    let header = |text: &str| {
        let length = (text.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes(), &[0; 64]].concat()
    };
    let [huge, structured] = ["huge.npy", "structured.npy"].map(at);
    let of = |descr: &str, shape: &str| {
        header(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n"))
    };
    fs::write(&huge, of("'<f8'", "(2147483648, 2147483648, 4)")).unwrap();
    fs::write(&structured, of("[(\"'descr': '<f8'\", '<i8')]", "(2, 4)")).unwrap();
    let [fine, picture] = ["fine.npy", "fine.png"].map(at);
    let interlaced = at("interlaced.png");
    fs::write(&interlaced, with_interlaced_header(&fs::read(at("fine.png")).unwrap())).unwrap();
    for (other, words) in [
        (&cut, "bytes, and its header says"),
        (&picture, "like with like"),
        (&interlaced, "is not a PNG"),
        (&huge, "its shape is not that of a picture of up to a million pixels"),
        (&structured, "is not such an array"),
    ] {
        let output = compared(&[&fine, other, "-o", &at("never.png")]);
        assert_eq!(output.status.code(), Some(1), "{other}");
        assert!(error_of(&output).contains(words), "{}", error_of(&output));
        assert!(!folder.path().join("never.png").exists());
    }
    // The exit code is the same if the reader of the output has gone.
    let [a, b] = ["fine.npy", "coarse.npy"].map(at);
    let mut command = program(&folder, &["compare", &a, &b]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(3));
    for wrong in [["--tolerance", "-1"], ["--share", "2"]] {
        let output = compared(&[&fine, &fine, wrong[0], wrong[1]]);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
    }
}

/// A PNG whose header says that its rows are interlaced.
fn with_interlaced_header(png: &[u8]) -> Vec<u8> {
    let mut bytes = png.to_vec();
    bytes[28] = 1;
    let sum = crc32fast::hash(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
    bytes
}

/// A PNG whose pixels lack their last bytes, with a length and a checksum that fit.
fn with_shorter_pixels(png: &[u8]) -> Vec<u8> {
    let name = png.windows(4).rposition(|name| name == b"IDAT").unwrap();
    let length = u32::from_be_bytes(png[name - 4..name].try_into().unwrap()) - 5;
    let end = name + 4 + length as usize;
    let sum = crc32fast::hash(&png[name..end]);
    let head = [&png[..name - 4], &length.to_be_bytes(), &png[name..end], &sum.to_be_bytes()];
    [&head.concat()[..], &png[end + 5 + 4..]].concat()
}

#[test]
fn damaged_pictures_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let words = ["render", "--engine", "cpu", "--size", "32x32", "--budget", "2", "-o", "a.png"];
    done(&folder, &words);
    let whole = fs::read(at("a.png")).unwrap();
    let length = whole.len();
    let find = |name: &[u8]| whole.windows(4).position(|four| four == name).unwrap();
    let altered = |byte: usize| {
        let mut bytes = whole.clone();
        bytes[byte] ^= 1;
        bytes
    };
    done(&folder, &["compare", "a.png", "a.png"]);
    for (what, bytes) in [
        ("no end", whole[..length - 12].to_vec()),
        ("pixels cut short", whole[..length - 18].to_vec()),
        ("pixels without their end", with_shorter_pixels(&whole)),
        ("a checksum of the pixels", altered(length - 13)),
        ("a checksum of the end", altered(length - 1)),
        ("a text", altered(find(b"iTXt") + 40)),
    ] {
        fs::write(at("cut.png"), bytes).unwrap();
        for words in [["cut.png", "a.png"], ["a.png", "cut.png"]] {
            let words = [&["compare"], &words[..], &["-o", "never.png"]].concat();
            let error = refused(&folder, 1, &words);
            assert!(error.contains("cut.png"), "{what}: {error}");
            assert!(!at("never.png").exists(), "{what}");
        }
    }
}

#[cfg(unix)]
#[test]
fn pipes_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["render", "--engine", "cpu", "--size", "16x16", "--budget", "1"];
    done(&folder, &[&words[..], &["--raw", "n.npy"]].concat());
    for name in ["p.npy", "p.png"] {
        let made = std::process::Command::new("mkfifo").arg(folder.path().join(name)).status();
        assert!(made.unwrap().success());
        for words in [["compare", name, "n.npy"], ["compare", "n.npy", name]] {
            let error = refused(&folder, 1, &words);
            assert!(
                error.contains(&format!("cannot read {name}: it is not a regular file")),
                "{error}"
            );
        }
    }
    let piped = format!("{} compare <(cat n.npy) n.npy", env!("CARGO_BIN_EXE_flipmap"));
    let mut shell = std::process::Command::new("bash");
    let output = shell.args(["-c", &piped]).current_dir(&folder).output().unwrap();
    assert!(error_of(&output).contains("it is not a regular file"), "{}", error_of(&output));
}
