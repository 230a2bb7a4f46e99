//! `flipmap report` on the command line: interrupted runs, wrong folders, and refusals.

use std::fs;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::program::error_of;

/// Arguments for a report on the processor with few starts, which needs no adapter and little time.
const SMALL: [&str; 6] = ["report", "--quick", "--engine", "cpu", "--sample", "64"];

fn flipmap(folder: &TempDir, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_flipmap"))
        .current_dir(folder)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn finished(folder: &TempDir, arguments: &[&str]) -> Output {
    flipmap(folder, arguments).wait_with_output().unwrap()
}

#[cfg(unix)]
#[test]
fn an_interrupted_report_keeps_its_rows_and_says_what_is_missing() {
    for (signal, code) in [("INT", Some(130)), ("KILL", None)] {
        let folder = tempfile::tempdir().unwrap();
        let child = flipmap(&folder, &[&SMALL[..], &["-o", "out"]].concat());
        let out = folder.path().join("out");
        let begun = Instant::now();
        while !out.join("report.html").exists() && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(5));
        }
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
        let asked = Instant::now();
        let output = child.wait_with_output().unwrap();
        assert!(asked.elapsed() < Duration::from_secs(5), "{signal}: {:?}", asked.elapsed());
        assert_eq!(output.status.code(), code, "{signal}: {}", error_of(&output));

        let read = |name: &str| fs::read_to_string(out.join(name)).unwrap();
        let object: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
        assert_eq!(object["complete"], false);
        let rows = object["rows"].as_array().unwrap();
        let missing = object["missing"].as_array().unwrap();
        assert!(!rows.is_empty() && !missing.is_empty());
        assert!(rows[0]["us_per_pixel"].as_f64().unwrap() > 0.0);
        assert!(rows[0]["right_1ms"].as_f64().unwrap() > 0.5);
        let last = missing[missing.len() - 1].as_str().unwrap();
        for name in ["report.md", "report.html"] {
            let text = read(name);
            assert!(text.contains("INCOMPLETE") && text.contains(last), "{name}");
        }
        if code == Some(130) {
            assert!(error_of(&output).contains("says what is missing"), "{}", error_of(&output));
            assert_eq!(fs::read_dir(&out).unwrap().count(), 3, "a stray file was left");
        }
    }
}

#[test]
fn mistakes_are_named_before_anything_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("taken"), "mine").unwrap();
    let cases: [(&[&str], i32, &[&str]); 9] = [
        (&["-o", "taken"], 1, &["-o: cannot write taken: it is a file"]),
        (&["-o", "taken/below"], 1, &["-o: cannot write taken/below"]),
        (&["-o", "fine", "--adapter", "geforce"], 2, &["adapter", "engine cpu"]),
        (&["--sample", "0"], 2, &["--sample"]),
        (&["--threads", "0"], 2, &["--threads"]),
        (&["--slow"], 2, &["--slow"]),
        (&["--only", "depth,abysses"], 2, &["--only", "abysses", "films"]),
        (&["--only", "films"], 2, &["--quick does not measure", "--only", "films"]),
        (&["--only", "hard,films"], 2, &["--quick does not measure", "--only", "films"]),
    ];
    for (arguments, code, words) in cases {
        let small = if arguments[0] == "--sample" { &SMALL[..4] } else { &SMALL[..] };
        let output = finished(&folder, &[small, arguments].concat());
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
        for word in words {
            assert!(error.contains(word), "{arguments:?}: {error}");
        }
        assert!(error.lines().filter(|line| line.starts_with("flipmap")).count() <= 1, "{error}");
    }
    assert_eq!(fs::read_to_string(folder.path().join("taken")).unwrap(), "mine");
}

#[test]
fn a_report_of_one_chapter_has_no_other_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let output = finished(&folder, &[&SMALL[..], &["--only", "hard", "-o", "out"]].concat());
    assert!(output.status.success(), "{}", error_of(&output));
    let text = fs::read_to_string(folder.path().join("out/report.json")).unwrap();
    let object: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&object["complete"], &object["only"][0]), (&true.into(), &"hard".into()));
    assert!(!object["hard"].as_array().unwrap().is_empty());
    for other in ["rows", "windows", "late", "depth", "questions", "zooms"] {
        assert_eq!(object[other].as_array().map(Vec::len), Some(0), "{other}");
    }
    let page = fs::read_to_string(folder.path().join("out/report.md")).unwrap();
    assert!(page.contains("of nothing but hard."), "{page}");
}

#[test]
fn no_adapter_is_69_when_one_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_flipmap"))
        .current_dir(&folder)
        .env("VK_DRIVER_FILES", "/nowhere.json")
        .env("VK_ICD_FILENAMES", "/nowhere.json")
        .args(["report", "--quick", "--engine", "gpu"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(69), "{}", error_of(&output));
    assert!(error_of(&output).contains("apt-get install libvulkan1"));
}
