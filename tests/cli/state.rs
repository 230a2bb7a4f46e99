//! Continuing a saved run with a larger budget.

use std::fs;
use std::path::Path;
use std::process::Output;

use tempfile::TempDir;

use crate::error_of;
use crate::program::flipmap;

fn render(folder: &TempDir, arguments: &[&str]) -> Output {
    let view = ["--size", "40x40", "--center", "1.2,0.7", "--width", "3"];
    render_view(folder, &[&view[..], arguments].concat())
}

fn render_view(folder: &TempDir, arguments: &[&str]) -> Output {
    flipmap(folder, &[&["render", "--json"], arguments].concat())
}

fn object(output: &Output) -> serde_json::Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn same(folder: &TempDir, one: &str, other: &str) -> bool {
    let read = |name: &str| fs::read(Path::new(folder.path()).join(name)).unwrap();
    read(one) == read(other)
}

/// Returns true if two arrays of f64 agree to a thousandth.
fn nearly_same(folder: &TempDir, one: &str, other: &str) -> bool {
    let read = |name: &str| {
        let bytes = fs::read(Path::new(folder.path()).join(name)).unwrap();
        let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        let numbers = bytes[header..].as_chunks::<8>().0.iter();
        numbers.map(|bytes| f64::from_le_bytes(*bytes)).collect::<Vec<f64>>()
    };
    let (a, b) = (read(one), read(other));
    let near = |(a, b): (&f64, &f64)| a == b || (a - b).abs() <= 1e-3 * a.abs().max(1e-3);
    a.len() == b.len() && a.iter().zip(&b).all(near)
}

fn going_on_is_one_run(engine: &str, accuracy: &str) {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let how = ["--engine", engine, "--accuracy", accuracy];
        object(&render(&folder, &[&how, arguments].concat()))
    };
    let first = run(&["--budget", "12", "--raw", "a.npy", "--state", "s"]);
    let second = run(&["--budget", "25", "--raw", "b.npy", "-o", "b.png", "--state", "s"]);
    let whole = run(&["--budget", "25", "--raw", "c.npy", "-o", "c.png", "--samples", "1"]);
    assert!(same(&folder, "b.npy", "c.npy") && same(&folder, "b.png", "c.png"));
    assert_eq!(second["simulated"], first["unflipped"]);
    let evaluations = |object: &serde_json::Value| object["rhs_evaluations"].as_u64().unwrap();
    let (parts, whole) = (evaluations(&first) + evaluations(&second), evaluations(&whole));
    // Only steps that found a flip beyond the first budget may be done twice.
    let most = whole + 100 * first["unflipped"].as_u64().unwrap();
    assert!((whole..=most).contains(&parts), "{parts} {whole}");
    // Running again to the same budget resumes only the unflipped pixels, and costs nothing.
    assert_eq!(
        run(&["--budget", "25", "--raw", "d.npy", "--state", "s"])["simulated"],
        second["unflipped"]
    );
    assert!(same(&folder, "d.npy", "c.npy"));
}

#[test]
fn on_the_processor_going_on_is_one_run() {
    for accuracy in ["lesson", "fast", "balanced"] {
        going_on_is_one_run("cpu", accuracy);
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn on_an_adapter_going_on_is_one_run() {
    for accuracy in ["lesson", "fast", "balanced"] {
        going_on_is_one_run("gpu", accuracy);
    }
}

/// Options of each question, of its first run, and of its later run.
const QUESTIONS: [(&[&str], &[&str], &[&str]); 6] = [
    (&["--ask", "state"], &["--at", "3"], &["--at", "8"]),
    (&["--ask", "first"], &["--budget", "3"], &["--budget", "8"]),
    (&["--ask", "flips"], &["--budget", "3"], &["--budget", "8"]),
    (&["--count", "2"], &["--budget", "3"], &["--budget", "8"]),
    (&["--ask", "growth"], &["--budget", "3"], &["--budget", "8"]),
    (&["--ask", "return"], &["--budget", "3"], &["--budget", "8"]),
];

fn every_question_goes_on(engine: &str, accuracy: &str, questions: &[usize]) {
    for (question, first, later) in questions.iter().map(|k| QUESTIONS[*k]) {
        let folder = tempfile::tempdir().unwrap();
        let run = |arguments: &[&str]| {
            let how = ["--engine", engine, "--accuracy", accuracy];
            object(&render(&folder, &[&how, question, arguments].concat()))
        };
        run(&[first, &["--raw", "a.npy", "--state", "s"]].concat());
        let second = run(&[later, &["--raw", "b.npy", "--state", "s"]].concat());
        let whole = run(&[later, &["--raw", "c.npy"]].concat());
        if engine == "gpu" && (question.contains(&"growth") || question.contains(&"return")) {
            // On the card, the step that was cut at the first budget stays cut.
            assert!(nearly_same(&folder, "b.npy", "c.npy"), "{question:?} {accuracy}");
        } else {
            assert!(same(&folder, "b.npy", "c.npy"), "{question:?} {engine} {accuracy}");
        }
        let evaluations = |object: &serde_json::Value| object["rhs_evaluations"].as_u64().unwrap();
        assert!(evaluations(&second) < evaluations(&whole), "{question:?}");
    }
}

#[test]
fn on_the_processor_every_question_goes_on() {
    every_question_goes_on("cpu", "balanced", &[0, 1, 2, 3, 4, 5]);
    every_question_goes_on("cpu", "lesson", &[0, 1, 2, 3, 4]);
}

/// Compares a view that is continued with `later` options after `first` ones with a single run.
fn the_view_goes_on(view: &[&str], first: [&str; 2], later: [&str; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        object(&render_view(&folder, &[&["--engine", "cpu"], view, arguments].concat()))
    };
    run(&[&first[..], &["--raw", "a.npy", "--state", "s"]].concat());
    run(&[&later[..], &["--raw", "b.npy", "--state", "s"]].concat());
    run(&[&later[..], &["--raw", "c.npy"]].concat());
    assert!(same(&folder, "b.npy", "c.npy"), "{view:?}");
    assert!(!same(&folder, "a.npy", "c.npy"), "{view:?}: the budget changes nothing");
}

#[test]
fn thrown_pendulums_go_on() {
    for scene in ["thrown", "section"] {
        for accuracy in ["lesson", "balanced"] {
            let view = [scene, "--size", "32x32", "--accuracy", accuracy];
            let asked = |ask| [&view[..], &["--ask", ask]].concat();
            the_view_goes_on(&asked("state"), ["--at", "2"], ["--at", "6"]);
            the_view_goes_on(&asked("flip"), ["--budget", "2"], ["--budget", "6"]);
        }
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn on_an_adapter_every_question_goes_on() {
    every_question_goes_on("gpu", "balanced", &[0, 1, 2, 3, 4, 5]);
    every_question_goes_on("gpu", "fast", &[0, 2]);
}

#[test]
fn what_cannot_go_on_is_refused_by_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let cpu = ["--engine", "cpu", "--raw", "a.npy", "--state", "s"];
    object(&render(&folder, &[&cpu[..], &["--budget", "5"]].concat()));
    let kept = fs::read(folder.path().join("s")).unwrap();
    for (arguments, words) in [
        (&["--budget", "4"][..], &["5 s already", "the budget must be at least that"][..]),
        (&["--budget", "9", "--gravity", "5"], &["another pendulum"]),
        (&["--budget", "9", "--rule", "first"], &["another rule", "second", "first"]),
        (&["--budget", "9", "--ask", "first"], &["another question", "flip", "first"]),
        (&["--budget", "9", "--count", "2"], &["another number of flips"]),
        (&["--budget", "9", "--rotate", "2"], &["another view"]),
        (&["--budget", "9", "--accuracy", "lesson"], &["another configuration", "rk4", "dop853"]),
    ] {
        let output = render(&folder, &[&cpu[..], arguments].concat());
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(words.iter().all(|word| error.contains(word)), "{arguments:?}: {error}");
        assert_eq!(fs::read(folder.path().join("s")).unwrap(), kept, "{arguments:?}");
    }
    let mut altered = kept.clone();
    altered[40] ^= 1;
    for (bytes, why) in [
        (altered, "the checksum in bytes 16 to 47 is not that of the bytes after it"),
        (b"flipmap state 1\nbody".to_vec(), "is of the first format, which has no checksum"),
    ] {
        fs::write(folder.path().join("s"), &bytes).unwrap();
        let output = render(&folder, &cpu);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(why), "{error}");
        assert_eq!(fs::read(folder.path().join("s")).unwrap(), bytes, "it is left as it is");
    }
    fs::write(folder.path().join("s"), "something else").unwrap();
    let output = render(&folder, &cpu);
    assert!(String::from_utf8_lossy(&output.stderr).contains("is not a state"));
    assert_eq!(fs::read_to_string(folder.path().join("s")).unwrap(), "something else");
}

#[cfg(unix)]
#[test]
fn a_render_that_is_stopped_keeps_what_it_has() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let folder = tempfile::tempdir().unwrap();
    let words =
        "render --engine cpu --size 700x700 --center 1.2,0.7 --width 3 --raw a.npy --state s";
    let words: Vec<&str> = words.split(' ').collect();
    let mut child = Command::new(env!("CARGO_BIN_EXE_flipmap"))
        .current_dir(&folder)
        .args(&words)
        .args(["--progress", "json"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let stderr = child.stderr.take().unwrap();
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(stderr));
    // The first line of progress comes after a second of work.
    let begun = Instant::now();
    let has_begun = lines.any(|line| line.is_ok_and(|line| line.contains("\"done\"")));
    assert!(has_begun && begun.elapsed() < Duration::from_secs(60));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", "TERM", &id]).status().unwrap().success());
    std::thread::spawn(move || lines.for_each(drop));
    assert_eq!(child.wait().unwrap().code(), Some(75));
    let files: Vec<_> =
        fs::read_dir(&folder).unwrap().map(|file| file.unwrap().file_name()).collect();
    assert_eq!(files, ["s"], "no file is half written");
    let rest = object(&flipmap(&folder, &[&words[..], &["--json"]].concat()));
    let plain =
        "render --engine cpu --size 700x700 --center 1.2,0.7 --width 3 --raw b.npy --samples 1";
    let whole = object(&flipmap(
        &folder,
        &[&plain.split(' ').collect::<Vec<_>>()[..], &["--json"]].concat(),
    ));
    assert!(same(&folder, "a.npy", "b.npy"));
    let spent = |object: &serde_json::Value| object["rhs_evaluations"].as_u64().unwrap();
    assert!(spent(&rest) < spent(&whole), "{} of {}", spent(&rest), spent(&whole));
}

#[test]
fn pixels_that_have_no_states_are_no_state() {
    let folder = tempfile::tempdir().unwrap();
    let words =
        ["render", "deep", "--size", "40x30", "--engine", "cpu", "--state", "s", "-o", "a.png"];
    let output = flipmap(&folder, &words);
    let error = error_of(&output);
    assert!(output.status.code() == Some(2) && error.contains("flipmap plan splits"), "{error}");
    assert!(!folder.path().join("s").exists());
}
