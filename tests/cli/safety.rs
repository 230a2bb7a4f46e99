//! Files that flipmap did not write: films, plans and runs never replace or remove them.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};

use crate::program::*;
use tempfile::TempDir;

const SMALL: [&str; 6] = ["--engine", "cpu", "--size", "16x16", "--budget", "1"];
const FILM: [&str; 4] = ["--vary", "time=0..1", "--frames", "3"];

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn film(output: &str) -> Vec<&str> {
    [&["video", "-o", output], &SMALL[..], &FILM].concat()
}

#[test]
fn a_frame_that_is_a_link_is_refused_and_its_target_stays() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    done(&folder, &film("shots"));
    // A picture by flipmap that lies outside the film's folder does not belong to the film.
    fs::rename(at("shots/000001.png"), at("precious.png")).unwrap();
    symlink("../precious.png", at("shots/000001.png")).unwrap();
    let precious = fs::read(at("precious.png")).unwrap();
    let other = [&film("shots")[..], &["--palette", "viridis"]].concat();
    let error = refused(&folder, 1, &other);
    assert!(error.contains("it holds 000001.png, which is not a frame of a film"), "{error}");
    assert!(fs::read(at("precious.png")).unwrap() == precious);
    assert!(at("shots/000001.png").is_symlink());
}

#[test]
fn pictures_of_others_under_the_names_of_frames_are_refused_and_stay() {
    let foreign = image::RgbImage::new(2, 2);
    for (frames, name) in [("3", "000001.png"), ("2", "000002.png")] {
        let folder = folder();
        let path = folder.path().join("shots").join(name);
        done(&folder, &film("shots"));
        foreign.save(&path).unwrap();
        let before = fs::read(&path).unwrap();
        let words = ["video", "-o", "shots", "--vary", "time=0..1", "--frames", frames];
        let error = refused(&folder, 1, &[&words[..], &SMALL].concat());
        assert!(
            error.contains(&format!("it holds {name}, which is not a frame of a film")),
            "{error}"
        );
        assert!(fs::read(&path).unwrap() == before);
    }
    // A film that was killed between writing the two files of a frame can be continued.
    let folder = folder();
    done(&folder, &film("shots"));
    fs::remove_file(folder.path().join("shots/manifest.json")).unwrap();
    fs::remove_file(folder.path().join("shots/000002.png")).unwrap();
    done(&folder, &film("shots"));
    assert!(folder.path().join("shots/000002.png").is_file());
}

#[test]
fn write_protected_frames_are_refused_before_the_work() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    done(&folder, &film("shots"));
    fs::remove_dir_all(at("shots.samples")).unwrap();
    let manifest = fs::read(at("shots/manifest.json")).unwrap();
    fs::set_permissions(at("shots/000001.png"), fs::Permissions::from_mode(0o444)).unwrap();
    let other = [&film("shots")[..], &["--palette", "viridis"]].concat();
    let error = refused(&folder, 1, &other);
    assert!(error.contains("it holds 000001.png, which is write-protected"), "{error}");
    assert!(fs::read(at("shots/manifest.json")).unwrap() == manifest);
    assert!(!at("shots.samples").exists(), "nothing was computed");
}

#[test]
fn a_film_never_replaces_a_scene_that_it_is_made_from() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    done(&folder, &film("sh2"));
    fs::copy(at("sh2/000002.png"), at("elsewhere.png")).unwrap();
    symlink("sh2/000002.png", at("link.png")).unwrap();
    let before = fs::read(at("sh2/000002.png")).unwrap();
    let made_from = |scenes: [&str; 2]| {
        let words = ["video", scenes[0], scenes[1], "--frames", "3", "-o", "sh2"];
        flipmap(&folder, &[&words[..], &SMALL].concat())
    };
    for scenes in
        [["sh2/000002.png", "lesson"], ["lesson", "./sh2/000002.png"], ["link.png", "lesson"]]
    {
        let output = made_from(scenes);
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(2), "{scenes:?}: {error}");
        assert!(error.contains("is a frame in the folder of -o"), "{scenes:?}: {error}");
        assert!(fs::read(at("sh2/000002.png")).unwrap() == before);
    }
    assert!(made_from(["elsewhere.png", "lesson"]).status.success());
}

#[test]
fn the_samples_of_a_film_replace_no_plan_but_their_own() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("pj")).unwrap();
    let plan = ["plan", "--shards", "2", "-o", "pj/plan.toml"];
    for what in [&[][..], &FILM] {
        done(&folder, &[&plan[..], &SMALL, what].concat());
        let before = fs::read(at("pj/plan.toml")).unwrap();
        let error = refused(&folder, 2, &[&film("f")[..], &["--cache", "pj"]].concat());
        assert!(
            error.contains("--cache: pj/plan.toml was not written by flipmap video"),
            "{error}"
        );
        assert!(fs::read(at("pj/plan.toml")).unwrap() == before);
    }
    for palette in ["iris", "viridis"] {
        done(&folder, &[&film("f")[..], &["--cache", "own", "--palette", palette]].concat());
    }
}

#[test]
fn a_descent_into_a_pipe_that_nobody_reads_is_refused_before_the_work() {
    let folder = folder();
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status();
    assert!(made.unwrap().success());
    let words = ["deeper", "--to", "1e-2", "-o", "pipe", "--engine", "cpu"];
    let error = refused(&folder, 1, &words);
    assert!(error.contains("-o: cannot write pipe: no program reads this pipe"), "{error}");
    assert!(!error.contains("budget"), "no step of the way was computed: {error}");
}

#[test]
fn a_run_removes_only_parts_of_its_plan_and_refuses_what_stands_in_their_place() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    done(&folder, &[&["plan", "--shards", "1", "-o", "p.toml"], &SMALL[..]].concat());
    done(&folder, &["run", "p.toml"]);
    fs::write(at("p.parts/rows-00000000-0000000-5.part"), "mine").unwrap();
    done(&folder, &["run", "p.toml"]);
    let kept = fs::read_to_string(at("p.parts/rows-00000000-0000000-5.part")).unwrap();
    assert_eq!(kept, "mine");
    fs::remove_file(at("p.parts/rows-00000000-0000000-5.part")).unwrap();
    let part = fs::read_dir(at("p.parts")).unwrap().next().unwrap().unwrap().path();
    let name = part.file_name().unwrap().to_str().unwrap();
    fs::write(&part, "mine").unwrap();
    for words in
        [&["run", "p.toml"][..], &["verify", "p.toml"], &["merge", "p.toml", "-o", "a.png"]]
    {
        let error = refused(&folder, 1, words);
        assert!(error.contains(name) && error.contains("is none: move it elsewhere"), "{error}");
    }
    assert_eq!(fs::read_to_string(&part).unwrap(), "mine");
}

#[test]
fn a_run_does_not_write_its_parts_to_devices() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    done(&folder, &[&["plan", "--shards", "1", "-o", "p.toml"], &SMALL[..]].concat());
    done(&folder, &["run", "p.toml"]);
    let part = fs::read_dir(at("p.parts")).unwrap().next().unwrap().unwrap().path();
    for device in ["/dev/null", "/dev/zero"] {
        fs::remove_file(&part).unwrap();
        symlink(device, &part).unwrap();
        let error = refused(&folder, 1, &["run", "p.toml"]);
        assert!(error.contains("is none: move it elsewhere"), "{device}: {error}");
    }
    fs::remove_file(&part).unwrap();
    done(&folder, &["run", "p.toml"]);
    done(&folder, &["verify", "p.toml"]);
}

#[test]
fn samples_that_cannot_be_kept_are_refused_in_a_sentence() {
    let folder = folder();
    fs::write(folder.path().join("file"), "mine").unwrap();
    let file = "--cache: cannot keep samples in file: it is a file, not a folder";
    for (cache, why) in [
        ("file", file),
        ("file/inside", "--cache: cannot keep samples in file/inside: "),
        ("/proc/samples", "--cache: cannot keep samples in /proc/samples: "),
    ] {
        let error = refused(&folder, 1, &[&film("f")[..], &["--cache", cache]].concat());
        assert!(error.contains(why), "{cache}: {error}");
    }
    let long = format!("{}.mp4", "n".repeat(251));
    // Checked only if the program gets as far as the folder of the samples.
    if let (Some(1), error) = coded(&folder, &film(&long)) {
        assert!(error.contains("-o: the name nnn") && error.contains("no room for .samples"));
        done(&folder, &[&film(&long)[..], &["--cache", "kept"]].concat());
    }
}

/// The exit code and the message of a run.
fn coded(folder: &TempDir, arguments: &[&str]) -> (Option<i32>, String) {
    let output = flipmap(folder, arguments);
    (output.status.code(), error_of(&output))
}

#[test]
fn a_descent_that_is_stopped_keeps_the_way_and_says_so() {
    use std::io::BufRead;
    let folder = folder();
    let words = ["deeper", "--to", "1e-60", "-o", "way.toml", "--engine", "cpu"];
    let mut command = program(&folder, &words);
    let mut child = command.stderr(std::process::Stdio::piped()).spawn().unwrap();
    let mut errors = std::io::BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    while !said.contains(" rad, budget ") {
        assert!(errors.read_line(&mut said).unwrap() > 0, "{said}");
    }
    let id = child.id().to_string();
    let killed = std::process::Command::new("kill").args(["-s", "INT", &id]).status();
    assert!(killed.unwrap().success());
    errors.lines().map_while(Result::ok).for_each(|line| said += &line);
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
    assert!(said.contains("stopped; way.toml holds the views found so far"), "{said}");
    let keys = fs::read_to_string(folder.path().join("way.toml")).unwrap();
    assert!(keys.matches("[[key]]").count() >= 2, "{keys}");
}
