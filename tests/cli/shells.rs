//! What other programs do to this one: shells, limits, closed streams, and readers of its lines.

use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use super::*;
use crate::program::{done, refused};

/// Runs a line of a shell in which `flipmap` is the program.
fn shell(folder: &TempDir, line: &str) -> Output {
    let line = line.replace("flipmap", env!("CARGO_BIN_EXE_flipmap"));
    let mut command = Command::new("sh");
    command.current_dir(folder).env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"));
    command.args(["-c", &line]).output().unwrap()
}

const SMALL: &str = "render --engine cpu --size 64x64";

fn names_in(folder: &TempDir) -> Vec<String> {
    let files = fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<String> =
        files.map(|file| file.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[cfg(target_os = "linux")]
#[test]
fn signals_that_were_ignored_from_the_beginning_stay_ignored() {
    let folder = folder();
    let program = env!("CARGO_BIN_EXE_flipmap");
    let line = format!(
        "trap '' HUP INT; exec {program} render --engine cpu --accuracy lesson --size 900x900 \
         -o map.png"
    );
    let mut child = Command::new("sh")
        .current_dir(&folder)
        .args(["-c", &line])
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while names_in(&folder).is_empty() && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(5));
    }
    for signal in ["HUP", "INT"] {
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
    }
    assert!(child.wait().unwrap().success());
    assert_eq!(names_in(&folder), ["map.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_over_the_limit_of_the_shell_is_an_error_of_the_file() {
    let folder = folder();
    let output = shell(&folder, &format!("ulimit -f 2; flipmap {SMALL} -o map.png"));
    assert_eq!(output.status.code(), Some(1), "{}", error_of(&output));
    assert!(error_of(&output).contains("map.png: File too large"), "{}", error_of(&output));
    assert!(names_in(&folder).is_empty());
}

#[cfg(target_os = "linux")]
#[test]
fn a_picture_that_no_one_takes_is_an_error() {
    let folder = folder();
    let output = shell(&folder, &format!("flipmap {SMALL} -o - >&-"));
    assert_eq!(output.status.code(), Some(1), "{}", error_of(&output));
    assert!(error_of(&output).contains("cannot write standard output: it is closed"));
    assert!(shell(&folder, &format!("flipmap {SMALL} -o - >/dev/null")).status.success());
    let small = |options: &str| format!("{SMALL} -o a.png {options}");
    let trace = "trace --start 1,2 --until 1".to_string();
    for command in [small("--json"), small("--dry-run"), trace] {
        let output = shell(&folder, &format!("flipmap {command} >&-"));
        let error = error_of(&output);
        assert!(output.status.code() == Some(1) && error.contains("it is closed"), "{error}");
    }
}

#[test]
fn unknown_endings_are_refused_before_the_work() {
    let folder = folder();
    for (options, list) in [
        ("-o map.mp4", ".png, .jpg, .jpeg, .webp, .tif or .tiff"),
        ("-o map.npy", ".png, .jpg"),
        ("--raw times.txt", "as .npy, .npz or .csv"),
        ("--exr map.png", "as .exr"),
        ("--verify --trust doubt.pdf -o a.png", ".png, .jpg"),
    ] {
        let output = flipmap(
            &folder,
            &[&SMALL.split(' ').collect::<Vec<_>>()[..], &options.split(' ').collect::<Vec<_>>()]
                .concat(),
        );
        let error = error_of(&output);
        assert!(output.status.code() == Some(2) && error.contains(list), "{options}: {error}");
    }
    let trace = flipmap(&folder, &["trace", "--start", "1,2", "-o", "d.json"]);
    assert!(error_of(&trace).contains("ends in .json, and it is written as .csv"));
    let lab = flipmap(&folder, &["lab", "twenty", "--csv", "a.png"]);
    assert!(error_of(&lab).contains("--csv: cannot write a.png: its name ends in .png"));
    assert!(names_in(&folder).is_empty());
}

#[test]
fn a_map_without_a_name_is_called_home() {
    let folder = folder();
    let small = &SMALL.split(' ').collect::<Vec<_>>()[..];
    assert!(flipmap(&folder, small).status.success());
    assert_eq!(names_in(&folder), ["home.png"]);
    let location = flipmap(&folder, &[small, &["flipmap:center=1,2;width=0.5"]].concat());
    assert!(location.status.success(), "{}", error_of(&location));
    assert_eq!(names_in(&folder), ["home.png", "map.png"]);
    let again = flipmap(&folder, small);
    assert!(error_of(&again).contains("home.png is there already"), "{}", error_of(&again));
    let wrong = flipmap(&folder, &[small, &["--accuracy", "exac"]].concat());
    assert!(error_of(&wrong).contains("exac"), "{}", error_of(&wrong));
}

#[test]
fn quiet_runs_say_nothing_and_json_runs_nothing_else() {
    let folder = folder();
    let small = &SMALL.split(' ').collect::<Vec<_>>()[..];
    let quiet = flipmap(&folder, &[small, &["--quiet", "-o", "a.png"]].concat());
    assert_eq!((quiet.status.code(), error_of(&quiet).as_str()), (Some(0), ""));
    let json = flipmap(&folder, &[small, &["--progress", "json", "-o", "b.png"]].concat());
    let error = error_of(&json);
    let keys: Vec<String> = error
        .lines()
        .map(|line| {
            let object: serde_json::Value = serde_json::from_str(line).expect(line);
            object.as_object().unwrap().keys().next().unwrap().clone()
        })
        .collect();
    assert!(keys.contains(&"done".to_string()) && keys.contains(&"message".to_string()), "{error}");
    let failed = flipmap(&folder, &[small, &["--progress", "json", "-o", "no/b.png"]].concat());
    let object: serde_json::Value = serde_json::from_str(error_of(&failed).trim()).unwrap();
    assert!(object["error"].as_str().unwrap().contains("the folder no does not exist"));
}

#[test]
fn plans_leave_the_engine_open_unless_one_is_named_and_shards_count_from_0_where_told() {
    let folder = folder();
    let plan = |more: &[&str]| {
        let words =
            ["plan", "--size", "24x24", "--accuracy", "fast", "--shards", "3", "-o", "p.toml"];
        done(&folder, &[&words[..], more].concat());
        fs::read_to_string(folder.path().join("p.toml")).unwrap()
    };
    assert!(plan(&[]).contains("any_engine = true"));
    assert!(!plan(&["--engine", "cpu"]).contains("any_engine"));
    done(&folder, &["run", "p.toml", "--shard", "0-1", "--from", "0"]);
    let missing = flipmap(&folder, &["verify", "p.toml", "--from", "0"]);
    assert_eq!(missing.stdout, b"2\n");
    assert!(
        error_of(&missing)
            .contains("complete (2): complete each with flipmap run p.toml --shard N --from 0")
    );
    let beyond = refused(&folder, 2, &["run", "p.toml", "--shard", "3", "--from", "0"]);
    assert!(
        beyond.contains("a number from 0 to 2, or a range of two such numbers, as in 0-2"),
        "{beyond}"
    );
}

#[test]
fn a_dry_run_says_what_would_be_done_and_does_nothing() {
    let folder = folder();
    let output = flipmap(
        &folder,
        &[
            "render",
            "--size",
            "200x100",
            "--samples",
            "2",
            "-o",
            "a.tiff",
            "--raw",
            "a.npz",
            "--dry-run",
        ],
    );
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.starts_with("80,000 samples at most; at the "), "{said}");
    assert!(said.contains("-o a.tiff: at most 186.69 KiB\n--raw a.npz: at most "), "{said}");
    assert!(said.contains("\nmemory: up to about 3"), "{said}");
    let film = ["--zoom-to", "filigree", "--secs", "2", "--fps", "10", "--size", "64x48"];
    let told = done(&folder, &[&["video", "-o", "z", "--dry-run"], &film[..]].concat());
    assert!(told.starts_with("20 frames of 64x48 at 10 per second: 2.0 s\n"), "{told}");
    assert!(told.contains(" samples at most; ") && told.contains("\n--cache: about "), "{told}");
    let plan =
        ["plan", "filigree", "--size", "64x48", "--samples", "1", "--shards", "4", "-o", "p.toml"];
    let told = done(&folder, &[&plan[..], &["--dry-run"]].concat());
    assert!(told.starts_with("each of 4 shards: 768 samples at most; "), "{told}");
    assert!(told.ends_with("parts: about 30.00 KiB of samples\n"), "{told}");
    assert!(names_in(&folder).is_empty());

    done(&folder, &plan);
    done(&folder, &["run", "p.toml", "--shard", "1", "--engine", "cpu"]);
    let told = done(&folder, &["run", "p.toml", "--dry-run"]);
    assert!(told.starts_with("2,304 samples at most; at the "), "{told}");
}

/// The size in bytes that a dry run tells of an option's output.
fn told_bytes(said: &str, option: &str) -> f64 {
    let line = said.lines().find(|line| line.starts_with(option)).unwrap();
    let size: Vec<&str> = line.rsplit("at most ").next().unwrap().split(' ').collect();
    let unit = ["B", "KiB", "MiB"].iter().position(|unit| *unit == size[1]).unwrap();
    size[0].parse::<f64>().unwrap() * 1024f64.powi(unit as i32)
}

#[test]
fn no_file_is_larger_than_a_dry_run_says() {
    let folder = folder();
    let small =
        ["render", "--size", "300x200", "--budget", "2", "--engine", "cpu", "--samples", "1"];
    for (words, option, file) in [
        (&["--raw", "a.csv"][..], "--raw", "a.csv"),
        (&["--raw", "b.csv", "--ask", "state", "--at", "1", "--rotate", "30"], "--raw", "b.csv"),
        (&["--raw", "a.npz", "--rotate", "30"], "--raw", "a.npz"),
        (&["--raw", "c"], "--raw", "c"),
        (&["--ask", "state", "--at", "1", "--state", "s", "-o", "s.png"], "--state", "s"),
        (&["--ask", "growth", "--state", "g", "-o", "g.png"], "--state", "g"),
        (&["--exr", "a.exr"], "--exr", "a.exr"),
        (&["--bits", "16", "-o", "a.tiff"], "-o", "a.tiff"),
        (&["--bits", "16", "--palette", "random-3", "-o", "a.png"], "-o", "a.png"),
    ] {
        let said = done(&folder, &[&small[..], words, &["--dry-run"]].concat());
        done(&folder, &[&small[..], words].concat());
        let bytes = fs::metadata(folder.path().join(file)).unwrap().len() as f64;
        let told = told_bytes(&said, option);
        // Compressed files can be much smaller.
        let is_packed = [".exr", ".png"].iter().any(|ending| file.ends_with(ending));
        let is_near = is_packed || told < 2.0 * bytes + 2e5;
        assert!(bytes <= 1.01 * told && is_near, "{file}: {bytes} and {told}");
    }
}

#[test]
fn a_dry_run_refuses_what_the_run_would_refuse() {
    let folder = folder();
    for words in [
        &["render", "--size", "70000x10", "-o", "x.jpg"][..],
        &["render", "--size", "4x4", "-o", "nowhere/x.png"],
        &["render", "trench", "--size", "16x12", "--state", "x.st", "-o", "x.png"],
        &["video", "--zoom-to", "filigree", "-o", "nowhere/f.mp4"],
        &["video", "--zoom-to", "filigree", "--quality", "50", "-o", "folder"],
    ] {
        let refused = |words: &[&str]| {
            let output = flipmap(&folder, words);
            assert!(!output.status.success(), "{words:?}");
            error_of(&output)
        };
        let said = refused(&[words, &["--engine", "cpu", "--dry-run"]].concat());
        let why = said.lines().last().unwrap();
        let run = refused(&[words, &["--engine", "cpu"]].concat());
        assert!(run.lines().last() == Some(why), "{words:?}: {said} {run}");
        assert!(names_in(&folder).is_empty(), "{words:?}");
    }
    fs::write(folder.path().join("taken"), "mine").unwrap();
    let film = ["video", "home", "filigree", "--size", "16x12", "--engine", "cpu"];
    let cached = [&film[..], &["-o", "f", "--cache", "taken", "--dry-run"]].concat();
    let said = error_of(&flipmap(&folder, &cached));
    assert!(said.contains("cannot keep samples in taken: it is a file, not a folder"), "{said}");
    let json = flipmap(&folder, &["render", "--json", "--dry-run", "-o", "a.png"]);
    assert!(json.status.code() == Some(2) && json.stdout.is_empty(), "{}", error_of(&json));
}

#[test]
fn errors_of_the_command_line_are_json_too() {
    let folder = folder();
    for words in [
        &["render", "--progress", "json", "--threads", "x", "-o", "a.png"][..],
        &["video", "--progress=json", "--wdth", "3"],
    ] {
        let error = error_of(&flipmap(&folder, words));
        let object: serde_json::Value = serde_json::from_str(error.trim()).unwrap();
        assert!(object["error"].as_str().is_some_and(|why| why.contains("--")), "{error}");
    }
    let error = error_of(&flipmap(&folder, &["render", "--threads", "1,5", "-o", "a.png"]));
    assert!(error.contains("it must be a whole number"), "{error}");
}

#[test]
fn help_that_is_not_read_to_its_end_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_flipmap"))
        .args(["render", "--help"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The pipe is closed before the program has begun to write.
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", error_of(&output));
}

#[test]
fn what_nobody_takes_from_standard_output_is_an_error_of_every_verb() {
    let folder = folder();
    let program = env!("CARGO_BIN_EXE_flipmap");
    for words in [
        "lab ghost --at 1 -o - >&-",
        "lab ghost --at 1 --csv - >&-",
        "plan --size 32x24 --shards 2 --engine cpu -o - >&-",
        "--help > /dev/full",
        "man > /dev/full",
    ] {
        let command = format!("'{program}' {words}");
        let output =
            Command::new("sh").args(["-c", &command]).current_dir(&folder).output().unwrap();
        let error = error_of(&output);
        assert!(!output.status.success() && !error.is_empty(), "{words}: {error}");
    }
}
