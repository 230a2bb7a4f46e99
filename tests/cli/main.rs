//! The program on the command line: files, exit codes, and one clear sentence for each mistake.

#[path = "../common/adapter.rs"]
#[macro_use]
mod adapter;
mod compare;
mod encoders;
mod lab;
mod measure;
mod mistakes;
mod pictures;
#[path = "../common/program.rs"]
mod program;
mod report;
mod safety;
mod sampling;
mod shells;
mod state;
mod trace;
mod video;
mod words;

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use tempfile::TempDir;

use program::{error_of, flipmap};

/// A command that runs the program in a folder, with a cache that only tests share.
fn program(folder: &TempDir) -> Command {
    let mut command = Command::cargo_bin("flipmap").unwrap();
    command.current_dir(folder).env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"));
    command
}

/// Runs `flipmap render` on the processor, so that these tests need no adapter.
fn render(folder: &TempDir, arguments: &[&str]) -> Output {
    let small = ["render", "--engine", "cpu", "--size", "32x24"];
    flipmap(folder, &[&small, arguments].concat())
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// The flip times in a `.npy` file.
fn numbers(path: &Path) -> Vec<f64> {
    let bytes = fs::read(path).unwrap();
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[header..].as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

#[test]
fn a_map_and_its_times_are_written() {
    let folder = folder();
    let output = render(&folder, &["-o", "map.png", "--raw", "map.npy", "--json"]);
    assert!(output.status.success(), "{}", error_of(&output));
    let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(object["pixels"], 32 * 24);
    let ran = ["engine", "method", "precision", "setting"].map(|key| object[key].as_str().unwrap());
    assert_eq!(ran, ["cpu", "dop853", "f64", "tolerance 3e-13"]);
    let sum = ["flipped", "unflipped", "forbidden", "failed"]
        .iter()
        .map(|key| object[key].as_u64().unwrap())
        .sum::<u64>();
    assert_eq!(sum, 32 * 24);
    let times = numbers(&folder.path().join("map.npy"));
    assert_eq!(times.len(), 32 * 24);
    let count = |fits: fn(&f64) -> bool| times.iter().filter(|t| fits(t)).count() as u64;
    let made = &object["made"];
    assert_eq!((made["axes"][0]["name"].as_str(), &made["size"][1]), (Some("theta1"), &24.into()));
    let corner = [0, 1].map(|i| made["first_pixel"][i].as_f64().unwrap());
    let step = made["per_column"][0].as_f64().unwrap();
    // Home at 4 : 3 is 8 π / 3 wide, with π in its middle.
    assert!((corner[0] - (std::f64::consts::PI - 15.5 * step)).abs() < 1e-12, "{corner:?}");
    assert!((32.0 * step - 8.0 / 3.0 * std::f64::consts::PI).abs() < 1e-12, "{step}");
    let from_center = made["first_pixel_from_center"][0].as_f64().unwrap();
    assert!((from_center + 15.5 * step).abs() < 1e-12, "{from_center}");
    assert_eq!(object["forbidden"], count(|t| t.is_nan()));
    assert_eq!(object["unflipped"], count(|t| t.is_infinite()));
}

#[test]
fn a_picture_is_a_scene_and_gives_itself_again() {
    let folder = folder();
    let options = ["-o", "a.png", "--center=-1.66,0.1", "--width", "0.4", "--palette", "magma"];
    assert!(render(&folder, &options).status.success());
    let again = flipmap(&folder, &["render", "a.png", "--engine", "cpu", "-o", "b.png"]);
    assert!(again.status.success(), "{}", error_of(&again));
    let [a, b] = ["a.png", "b.png"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(a == b);
}

#[test]
fn samples_change_the_picture_and_not_the_times() {
    let folder = folder();
    assert!(render(&folder, &["-o", "one.png", "--raw", "one.npy"]).status.success());
    let options = ["-o", "four.png", "--raw", "four.npy", "--samples", "2"];
    assert!(render(&folder, &options).status.success());
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("one.npy") == read("four.npy") && read("one.png") != read("four.png"));
}

#[test]
fn threads_do_not_change_the_file() {
    let folder = folder();
    assert!(render(&folder, &["-o", "1.png", "--threads", "1"]).status.success());
    assert!(render(&folder, &["-o", "3.png", "--threads", "3"]).status.success());
    let [one, three] = ["1.png", "3.png"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(one == three);
}

#[test]
fn standard_output_carries_the_picture() {
    let folder = folder();
    let output = render(&folder, &["-o", "-"]);
    assert!(output.status.success());
    assert!(output.stdout.starts_with(b"\x89PNG") && output.stdout.ends_with(b"IEND\xaeB`\x82"));
}

#[test]
fn what_is_read_is_never_replaced() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("s.toml"), "[view]\nwidth = \"1\"").unwrap();
    assert!(render(&folder, &["-o", "a.png", "--raw", "a.npy"]).status.success());
    let copies = [("a.npy", "b.npy"), ("a.png", "b.png")];
    for (from, to) in copies {
        fs::copy(at(from), at(to)).unwrap();
    }
    assert!(
        flipmap(&folder, &["plan", "s.toml", "--shards", "2", "--engine", "cpu", "-o", "p.toml"])
            .status
            .success()
    );
    let before: Vec<Vec<u8>> =
        ["s.toml", "a.png", "a.npy", "p.toml"].map(|name| fs::read(at(name)).unwrap()).into();
    let cases: [&[&str]; 10] = [
        &["render", "s.toml", "-o", "./s.toml"],
        &["render", "a.png", "--raw", "a.png"],
        &["render", "s.toml", "--state", "s.toml", "-o", "c.png"],
        &["render", "--state", "c.png", "-o", "c.png"],
        &["render", "-o", "c.png", "--raw", "./c.png"],
        &["merge", "p.toml", "-o", "p.toml"],
        &["lab", "double", "-o", "L", "--csv", "L"],
        &["compare", "a.npy", "b.npy", "-o", "a.npy"],
        &["trace", "s.toml", "--start", "2,2", "-o", "s.toml"],
        &["deeper", "s.toml", "-o", "s.toml"],
    ];
    for words in cases {
        let output = flipmap(&folder, words);
        let said = error_of(&output);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains("name the same file"), "{words:?}: {said}");
    }
    let plan = flipmap(&folder, &["plan", "s.toml", "--shards", "2", "-o", "a.png"]);
    assert!(error_of(&plan).contains("already exists and is not a plan"), "{}", error_of(&plan));
    let after: Vec<Vec<u8>> =
        ["s.toml", "a.png", "a.npy", "p.toml"].map(|name| fs::read(at(name)).unwrap()).into();
    assert!(before == after && !at("c.png").exists() && !at("L").exists());
}

#[test]
fn outputs_that_cannot_be_written_are_named() {
    let folder = folder();
    for (option, path) in [("-o", "no/such/map.png"), ("--raw", "no/such/map.npy"), ("-o", ".")] {
        let output = render(&folder, &[option, path]);
        assert_eq!(output.status.code(), Some(1), "{path}");
        assert!(
            error_of(&output).contains(&format!("{option}: cannot write {path}")),
            "{}",
            error_of(&output)
        );
    }
    if Path::new("/dev/full").exists() {
        let full = render(&folder, &["-o", "/dev/full"]);
        assert_eq!(full.status.code(), Some(1));
        assert!(error_of(&full).contains("cannot write /dev/full"), "{}", error_of(&full));
    }
    let twice = render(&folder, &["-o", "-", "--raw", "-"]);
    assert_eq!(twice.status.code(), Some(2));
}

#[test]
fn scenes_that_are_none_are_refused_by_name() {
    let folder = folder();
    let put = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    assert!(render(&folder, &["-o", "good.png"]).status.success());
    let good = fs::read(folder.path().join("good.png")).unwrap();
    put("cut.png", &good[..good.len() / 2]);
    put("text.png", b"not a picture");
    put("unknown.toml", b"[pendulum]\ncolour = 1");
    put("ask.toml", b"[question]\nask = \"why\"");
    put("type.toml", b"[question]\nbudget = true");
    put("future.toml", b"format = 2");
    let cases = [
        ("cut.png", "not a complete PNG"),
        ("text.png", "not a complete PNG"),
        ("unknown.toml", "line 2, column 1: unknown key 'colour'; it must be one of"),
        (
            "ask.toml",
            "it must be one of 'flip', 'first', 'flips', 'state', 'growth', 'return', 'speed'",
        ),
        ("type.toml", "line 2, column 10"),
        ("future.toml", "format 2"),
    ];
    for (name, words) in cases {
        let output = render(&folder, &[name, "-o", "x.png"]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        let error = error_of(&output);
        assert!(error.contains(name) && error.contains(words), "{error}");
    }
}

#[test]
fn a_window_opens_only_on_a_scene_and_a_display() {
    let folder = folder();
    fs::write(folder.path().join("broken.png"), "no picture").unwrap();
    let explore = |arguments: &[&str]| {
        let mut command = program(&folder);
        command.args(["explore", "--no-config", "--engine", "cpu"]).args(arguments);
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().unwrap()
    };
    for (file, words) in [("broken.png", "broken.png"), ("no such scene", "no such scene")] {
        let output = explore(&[file]);
        assert_eq!(output.status.code(), Some(2), "{}", error_of(&output));
        assert!(error_of(&output).contains(words), "{}", error_of(&output));
    }
    if cfg!(target_os = "linux") {
        let output = explore(&[]);
        assert_eq!(output.status.code(), Some(1), "{}", error_of(&output));
        assert!(error_of(&output).contains("flipmap render"), "{}", error_of(&output));
    }
}

#[test]
fn no_adapter_and_no_fallback_is_69() {
    let folder = folder();
    let output = program(&folder)
        .env("VK_DRIVER_FILES", "/nowhere.json")
        .env("VK_ICD_FILENAMES", "/nowhere.json")
        .args(["render", "--engine", "gpu", "--size", "8x8", "-o", "a.png"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(69), "{}", error_of(&output));
    assert!(error_of(&output).contains("apt-get install libvulkan1 mesa-vulkan-drivers"));
}

#[test]
fn without_an_adapter_the_processor_steps_in_and_says_so() {
    let folder = folder();
    let output = program(&folder)
        .env("VK_DRIVER_FILES", "/nowhere.json")
        .env("VK_ICD_FILENAMES", "/nowhere.json")
        .args(["render", "--size", "8x8", "-o", "a.png"])
        .output()
        .unwrap();
    assert!(output.status.success());
    assert!(error_of(&output).contains("cpu engine"), "{}", error_of(&output));
}

#[cfg(unix)]
#[test]
fn a_reader_that_leaves_is_no_error_and_costs_no_other_file() {
    use std::io::Read;
    use std::process::Stdio;
    for raw in [&[][..], &["--raw", "kept.npy"]] {
        let folder = folder();
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_flipmap"))
            .current_dir(&folder)
            .args(["render", "--engine", "cpu", "--size", "900x900", "--budget", "3", "-o", "-"])
            .args(raw)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut reader = child.stdout.take().unwrap();
        reader.read_exact(&mut [0; 10]).unwrap();
        drop(reader);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{raw:?}: {}", error_of(&output));
        assert!(!error_of(&output).contains("Broken pipe"), "{}", error_of(&output));
        if !raw.is_empty() {
            assert_eq!(numbers(&folder.path().join("kept.npy")).len(), 900 * 900);
        }
    }
}

#[cfg(unix)]
#[test]
fn a_signal_stops_at_once_and_leaves_no_half_file() {
    use std::process::Stdio;
    use std::time::{Duration, Instant};
    for signal in ["INT", "TERM"] {
        let folder = folder();
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_flipmap"))
            .current_dir(&folder)
            .args(["render", "--engine", "cpu", "--size", "3000x3000", "-o", "map.png"])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while fs::read_dir(folder.path()).unwrap().count() == 0 && begun.elapsed().as_secs() < 20 {
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(Duration::from_millis(300));
        let id = child.id().to_string();
        let killed = std::process::Command::new("kill").args(["-s", signal, &id]).status();
        assert!(killed.unwrap().success());
        let asked = Instant::now();
        let status = child.wait().unwrap();
        assert!(asked.elapsed() < Duration::from_secs(5), "{signal}: {:?}", asked.elapsed());
        assert_eq!(status.code(), Some(130), "{signal}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{signal} left a file");
    }
}

#[test]
fn the_doctor_says_what_would_be_used() {
    let output = flipmap(&folder(), &["doctor"]);
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stdout).contains("Would use: "));
    let output = flipmap(&folder(), &["doctor", "--json"]);
    let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(object["engine"].is_string());
}

#[test]
fn standard_output_takes_one_output() {
    let folder = folder();
    let draw = ["render", "--engine", "cpu", "--size", "16x16", "--budget", "1"];
    let lab = ["lab", "double", "--at", "1"];
    let trace = ["trace", "--start", "2,2", "--until", "1"];
    for words in [
        [&draw[..], &["-o", "-", "--raw", "-"]].concat(),
        [&draw[..], &["-o", "/dev/stdout", "--raw", "-"]].concat(),
        [&draw[..], &["-o", "-", "--raw", "/dev/fd/1"]].concat(),
        [&draw[..], &["-o", "/dev/stdout", "--json"]].concat(),
        [&lab[..], &["-o", "-", "--csv", "-"]].concat(),
        [&lab[..], &["-o", "/dev/stdout", "--csv", "-"]].concat(),
        [&trace[..], &["-o", "/dev/stdout", "--json"]].concat(),
    ] {
        if !cfg!(unix) && words.iter().any(|word| word.starts_with("/dev")) {
            continue;
        }
        let output = flipmap(&folder, &words);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {}", error_of(&output));
        assert!(error_of(&output).contains("standard output"), "{words:?}: {}", error_of(&output));
        assert!(output.stdout.is_empty(), "{words:?}");
    }
}
