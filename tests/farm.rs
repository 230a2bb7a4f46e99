//! Work that is split, killed, damaged or repeated gives the same result.

#[path = "common/program.rs"]
mod program;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use program::*;
use tempfile::TempDir;

const CPU: [&str; 4] = ["--engine", "cpu", "--accuracy", "fast"];

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn plan(folder: &TempDir, name: &str, shards: &str, what: &[&str]) {
    done(folder, &[&["plan", "-o", name, "--shards", shards], &CPU[..], what].concat());
}

fn start(folder: &TempDir, arguments: &[&str]) -> Child {
    let mut command = program(folder, arguments);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Starts the program ten times and kills it after varying delays; returns how often it was still
/// running.
fn kill_ten_times(folder: &TempDir, arguments: &dyn Fn(u32) -> Vec<String>) -> u32 {
    let mut killed = 0;
    for k in 0..10u32 {
        let arguments = arguments(k);
        let mut child = start(folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
        // A time between the first job and a few finished parts.
        sleep(Duration::from_millis(200 + u64::from(k * 7919 % 10) * 110));
        killed += u32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
    }
    killed
}

fn bytes(folder: &TempDir, name: &str) -> Vec<u8> {
    fs::read(folder.path().join(name)).unwrap()
}

fn parts(folder: &TempDir, name: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder.path().join(name)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "part"));
    paths.sort();
    paths
}

/// Names and contents of all files in a folder.
fn all(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .map(|path| {
            (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(path).unwrap())
        })
        .collect()
}

#[test]
fn one_shard_is_eight_shards_is_eight_shards_run_twice_at_once() {
    let folder = folder();
    let what = ["filigree", "--size", "90x70", "--samples", "2", "--numbers"];
    plan(&folder, "one.toml", "1", &what);
    plan(&folder, "eight.toml", "8", &what);
    plan(&folder, "twice.toml", "8", &what);
    done(&folder, &["run", "one.toml"]);
    for shard in ["3", "1-2", "4-8"] {
        done(&folder, &["run", "eight.toml", "--shard", shard]);
    }
    let both = [0, 1].map(|_| start(&folder, &["run", "twice.toml"]));
    for mut child in both {
        assert!(child.wait().unwrap().success());
    }
    for name in ["one", "eight", "twice"] {
        let [png, npy, exr] = ["png", "npy", "exr"].map(|ending| format!("{name}.{ending}"));
        let files = ["-o", &png, "--raw", &npy, "--exr", &exr];
        done(&folder, &[&["merge", &format!("{name}.toml")], &files[..]].concat());
    }
    let render = ["render", "filigree", "--size", "90x70", "--samples", "2", "-o", "r.png"];
    done(&folder, &[&render[..], &["--raw", "r.npy"], &CPU[..]].concat());
    for ending in ["png", "npy", "exr"] {
        let one = bytes(&folder, &format!("one.{ending}"));
        assert!(one == bytes(&folder, &format!("eight.{ending}")), "{ending}");
        assert!(one == bytes(&folder, &format!("twice.{ending}")), "{ending}");
        assert!(ending == "exr" || one == bytes(&folder, &format!("r.{ending}")), "{ending}");
    }
}

#[test]
fn a_mirrored_still_is_that_of_render() {
    let folder = folder();
    // An odd number of rows: the middle row is its own mirror image.
    plan(&folder, "home.toml", "3", &["home", "--size", "40x31"]);
    done(&folder, &["run", "home.toml"]);
    done(&folder, &["merge", "home.toml", "-o", "merged.png"]);
    done(&folder, &[&["render", "--size", "40x31", "-o", "r.png"], &CPU[..]].concat());
    assert!(bytes(&folder, "merged.png") == bytes(&folder, "r.png"));
}

#[test]
fn a_deep_still_has_the_colours_of_render() {
    let folder = folder();
    plan(&folder, "deep.toml", "2", &["abyss", "--size", "40x30"]);
    done(&folder, &["run", "deep.toml"]);
    done(&folder, &["merge", "deep.toml", "-o", "merged.png"]);
    done(&folder, &[&["render", "abyss", "--size", "40x30", "-o", "r.png"], &CPU[..]].concat());
    assert!(bytes(&folder, "merged.png") == bytes(&folder, "r.png"));
}

#[test]
fn a_still_killed_ten_times_is_the_same() {
    let folder = folder();
    let what = ["filigree", "--size", "640x480", "--budget", "60"];
    plan(&folder, "calm.toml", "8", &what);
    plan(&folder, "killed.toml", "8", &what);
    done(&folder, &["run", "calm.toml"]);
    let killed = kill_ten_times(&folder, &|k| {
        let shards = format!("{}-8", 1 + k % 8);
        ["run", "killed.toml", "--shard", &shards].map(str::to_string).to_vec()
    });
    assert!(killed >= 3, "it was at work only {killed} times");
    done(&folder, &["run", "killed.toml"]);
    for name in ["calm", "killed"] {
        done(&folder, &["merge", &format!("{name}.toml"), "-o", &format!("{name}.png")]);
    }
    assert!(bytes(&folder, "calm.png") == bytes(&folder, "killed.png"));
}

#[test]
fn a_film_killed_ten_times_is_the_same() {
    let folder = folder();
    let what = ["--zoom-to", "threads", "--size", "80x60", "--frames", "120"];
    let video = |output: &str| {
        let all = [&["video", "-o", output], &CPU[..], &what[..]].concat();
        all.into_iter().map(str::to_string).collect::<Vec<_>>()
    };
    let run = |output| done(&folder, &video(output).iter().map(String::as_str).collect::<Vec<_>>());
    run("calm");
    let killed = kill_ten_times(&folder, &|_| video("killed"));
    assert!(killed >= 3, "it was at work only {killed} times");
    run("killed");
    let [calm, again] = ["calm", "killed"].map(|name| all(&folder.path().join(name)));
    assert_eq!(calm.len(), 241, "120 pictures, as many JSON files, and a manifest");
    assert!(calm == again);
}

#[cfg(unix)]
#[test]
fn a_stop_keeps_what_is_done_and_says_so() {
    let folder = folder();
    plan(&folder, "p.toml", "2", &["filigree", "--size", "640x480", "--budget", "60"]);
    let mut command = program(&folder, &["run", "p.toml"]);
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    // The first part takes long on a busy machine.
    let begun = Instant::now();
    let is_there =
        || folder.path().join("p.parts").exists() && !parts(&folder, "p.parts").is_empty();
    while !is_there() && begun.elapsed() < Duration::from_secs(300) {
        sleep(Duration::from_millis(20));
    }
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(75), "{}", error_of(&output));
    assert!(error_of(&output).contains("run the same command again"), "{}", error_of(&output));
    assert!(!parts(&folder, "p.parts").is_empty());
    let output = flipmap(&folder, &["verify", "p.toml"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&output.stdout).lines().any(|line| line == "2"));
}

#[test]
fn a_damaged_part_is_found_and_computed_anew() {
    let folder = folder();
    plan(&folder, "p.toml", "4", &["filigree", "--size", "48x40"]);
    done(&folder, &["run", "p.toml"]);
    done(&folder, &["merge", "p.toml", "-o", "whole.png"]);
    let all = parts(&folder, "p.parts");
    let mut flipped = fs::read(&all[0]).unwrap();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    fs::write(&all[0], flipped).unwrap();
    let half = fs::read(&all[2]).unwrap();
    fs::write(&all[2], &half[..half.len() / 2]).unwrap();
    let output = flipmap(&folder, &["verify", "p.toml"]);
    assert_eq!(output.status.code(), Some(4));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "1\n3\n");
    assert_eq!(error_of(&output).matches("is cut short or altered").count(), 2);
    let error = refused(&folder, 4, &["merge", "p.toml", "-o", "never.png"]);
    assert!(error.contains("2 of 4 shards are not complete (1, 3)"), "{error}");
    assert!(!folder.path().join("never.png").exists());
    done(&folder, &["run", "p.toml"]);
    done(&folder, &["verify", "p.toml"]);
    done(&folder, &["merge", "p.toml", "-o", "again.png"]);
    assert!(bytes(&folder, "whole.png") == bytes(&folder, "again.png"));
}

#[cfg(unix)]
#[test]
fn a_full_disk_loses_nothing_that_was_finished() {
    let folder = folder();
    plan(&folder, "p.toml", "2", &["filigree", "--size", "160x120"]);
    done(&folder, &["run", "p.toml", "--shard", "1"]);
    // No file may grow beyond 16 KiB; a write that tries fails instead of killing the process.
    let text =
        format!("ulimit -f 16; trap '' XFSZ; exec {} run p.toml", env!("CARGO_BIN_EXE_flipmap"));
    let output = std::process::Command::new("bash")
        .args(["-c", &text])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let error = error_of(&output);
    assert!(
        error.contains("cannot write") && error.contains("what was finished is kept"),
        "{error}"
    );
    let output = flipmap(&folder, &["verify", "p.toml"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout), "2\n");
    let rubbish = fs::read_dir(folder.path().join("p.parts")).unwrap().count();
    assert_eq!(rubbish, parts(&folder, "p.parts").len(), "nothing half-written is left");
    done(&folder, &["run", "p.toml"]);
    done(&folder, &["merge", "p.toml", "-o", "map.png"]);
}

#[test]
fn shards_of_a_film_are_the_film() {
    let folder = folder();
    let what = ["--zoom-to", "filigree", "--size", "48x36", "--frames", "12"];
    plan(&folder, "f.toml", "3", &what);
    for shard in ["3", "1", "2"] {
        done(&folder, &["run", "f.toml", "--shard", shard]);
    }
    done(&folder, &["merge", "f.toml", "-o", "merged"]);
    done(&folder, &[&["video", "-o", "whole"], &CPU[..], &what[..]].concat());
    let [merged, whole] = ["merged", "whole"].map(|name| all(&folder.path().join(name)));
    assert!(merged.len() == 25 && merged == whole);
    // Different colours may be chosen when merging.
    done(&folder, &["merge", "f.toml", "-o", "other", "--palette", "magma"]);
    assert!(all(&folder.path().join("other")) != whole);
    let error = refused(&folder, 2, &["merge", "f.toml", "-o", "f.png"]);
    assert!(error.contains("a film is an .mp4"), "{error}");
}

#[test]
fn shards_of_films_of_other_answers_are_those_films() {
    let folder = folder();
    let plane = ["home", "--size", "16x12", "--frames", "5"];
    let films: [(&str, &[&str]); 3] = [
        // Trajectories continue from frame to frame; every frame is its own mirror image.
        ("state", &["--ask", "state", "--budget", "6", "--vary", "at=0..6"]),
        // Each frame has pendulums of its own, and several samples per pixel.
        (
            "flips",
            &["--ask", "flips", "--budget", "4", "--vary", "gravity=5..12", "--samples", "2"],
        ),
        // Checked samples are computed anew for each frame.
        ("growth", &["--ask", "growth", "--budget", "3", "--vary", "at=1..3", "--verify"]),
    ];
    for (name, what) in films {
        let what = [&plane[..], what].concat();
        let file = format!("{name}.toml");
        plan(&folder, &file, "3", &what);
        for shard in ["3", "1", "2"] {
            done(&folder, &["run", &file, "--shard", shard]);
        }
        let merged = format!("{name}-merged");
        done(&folder, &["merge", &file, "-o", &merged]);
        done(&folder, &[&["video", "-o", name], &CPU[..], &what[..]].concat());
        let [found, whole] = [&merged, name].map(|name| all(&folder.path().join(name)));
        assert!(found.len() == 11 && found == whole, "{name}: {:?}", found.keys());
        let (first, last) = (whole.get("000000.png"), whole.get("000004.png"));
        assert!(first.is_some() && first != last, "{name} shows something");
    }
    // Some parts are lost: their shards are named, and the result of computing them again is the
    // same.
    let lost = parts(&folder, "state.parts");
    assert_eq!(lost.len(), 15, "a part for every shard and frame");
    lost.iter().step_by(4).for_each(|part| fs::remove_file(part).unwrap());
    refused(&folder, 4, &["verify", "state.toml"]);
    refused(&folder, 4, &["merge", "state.toml", "-o", "again"]);
    done(&folder, &["run", "state.toml"]);
    done(&folder, &["merge", "state.toml", "-o", "again"]);
    let [again, whole] = ["again", "state"].map(|name| all(&folder.path().join(name)));
    assert!(again == whole);
    let error = refused(&folder, 2, &["merge", "flips.toml", "-o", "x", "--samples", "3"]);
    assert!(error.contains("--samples is 2 in the plan"), "{error}");
}

/// Path of a job file of `docs/farm`.
fn job_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/farm").join(name)
}

#[cfg(unix)]
#[test]
fn a_plain_shell_runs_a_plan_to_its_end() {
    let folder = folder();
    let what = ["home", "--size", "90x70", "--shards", "5"];
    let output = std::process::Command::new(job_file("shell"))
        .args(["p.toml", "out.png"].iter().chain(&what).chain(&CPU))
        .env("FLIPMAP", env!("CARGO_BIN_EXE_flipmap"))
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", error_of(&output));
    done(&folder, &[&["render", "home", "--size", "90x70", "-o", "r.png"], &CPU[..]].concat());
    assert!(bytes(&folder, "out.png") == bytes(&folder, "r.png"));
}

#[cfg(unix)]
#[test]
#[cfg_attr(
    not(farm),
    ignore = "Slurm and GNU parallel: scripts/test --farm installs and runs them"
)]
fn slurm_and_gnu_parallel_run_plans_to_their_ends() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/farm");
    let farm = std::process::Command::new(script)
        .env("FLIPMAP", env!("CARGO_BIN_EXE_flipmap"))
        .status()
        .unwrap();
    assert!(farm.success());
}

#[test]
fn plans_that_cannot_be_followed_are_refused() {
    let folder = folder();
    plan(&folder, "p.toml", "4", &["filigree", "--size", "48x40"]);
    let text = fs::read_to_string(folder.path().join("p.toml")).unwrap();
    let changed = |name: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{text}");
        fs::write(folder.path().join(name), text.replace(from, to)).unwrap();
        refused(&folder, 2, &["run", name])
    };
    let error = changed("scene.toml", "width = \"0.4\"", "width = \"0.5\"");
    assert!(error.contains("scene.toml was changed after it was planned"), "{error}");
    let version = format!("version = \"{}\"", env!("CARGO_PKG_VERSION"));
    let error = changed("old.toml", &version, "version = \"0.0.9\"");
    assert!(
        error.contains("was made by flipmap 0.0.9") && error.contains("plan it again"),
        "{error}"
    );
    let error = refused(&folder, 2, &["run", "p.toml", "--shard", "5"]);
    assert!(error.contains("--shard is '5'; it must be a number from 1 to 4"), "{error}");
    fs::write(folder.path().join("scene.toml"), "[view]\nwidth = \"1\"\n").unwrap();
    let over = ["plan", "scene.toml", "--shards", "2", "-o", "scene.toml"];
    let error = refused(&folder, 2, &[&over[..], &CPU[..]].concat());
    assert!(error.contains("scene.toml already exists and is not a plan"), "{error}");
    let error = refused(&folder, 2, &["run", "missing.toml"]);
    assert!(error.contains("missing.toml cannot be read"), "{error}");
    let error = refused(&folder, 2, &["merge", "p.toml"]);
    assert!(error.contains("nothing to write"), "{error}");
}
