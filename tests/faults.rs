//! Pipes, signals and files of other programs: nothing hangs, no file of another program is
//! replaced, and every refusal names the file.
#![cfg(unix)]

#[path = "common/program.rs"]
mod program;

use std::fs;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use program::*;
use tempfile::TempDir;

const CPU: [&str; 4] = ["--engine", "cpu", "--size", "8x8"];

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn pipe(path: &Path) -> PathBuf {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
    path.to_path_buf()
}

fn render(folder: &TempDir, arguments: &[&str]) -> std::process::Output {
    flipmap(folder, &[&["render"], &CPU[..], arguments].concat())
}

fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", name, &id]).status().unwrap().success());
}

/// Waits for a process to end; panics if that takes more than a number of seconds.
fn ends_within(child: &mut Child, secs: u64, what: &str) -> ExitStatus {
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if begun.elapsed() > Duration::from_secs(secs) {
            child.kill().unwrap();
            panic!("{what} did not end in {secs} s");
        }
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_named_pipe_carries_what_a_file_would_hold() {
    let folder = folder();
    assert!(render(&folder, &["-o", "map.png", "--raw", "map.npy"]).status.success());
    for (option, file) in [("-o", "map.png"), ("--raw", "map.npy")] {
        let path = pipe(&folder.path().join(format!("{file}.pipe")));
        let reader = std::thread::spawn({
            let path = path.clone();
            move || {
                let mut bytes = Vec::new();
                fs::File::open(path).unwrap().read_to_end(&mut bytes).unwrap();
                bytes
            }
        });
        let output = render(&folder, &[option, path.to_str().unwrap()]);
        assert!(output.status.success(), "{option}: {}", error_of(&output));
        let whole = fs::read(folder.path().join(file)).unwrap();
        assert!(reader.join().unwrap() == whole, "{option}");
    }
}

#[test]
fn a_write_that_waits_for_its_reader_hears_a_signal() {
    for (name, to_pipe) in [("INT", true), ("TERM", true), ("INT", false)] {
        let folder = folder();
        let path = pipe(&folder.path().join("p"));
        // A reader that has the pipe open but reads nothing.
        let held = fs::File::options().read(true).write(true).open(&path).unwrap();
        let output = if to_pipe { "p" } else { "-" };
        let size = ["--engine", "cpu", "--size", "900x900", "--budget", "1", "-o", output];
        let mut command = program(&folder, &[&["render"], &size[..]].concat());
        command.stderr(Stdio::piped());
        command.stdout(if to_pipe { Stdio::null() } else { held.try_clone().unwrap().into() });
        let mut child = command.spawn().unwrap();
        // Waits until the pipe is full, and a while longer.
        sleep(Duration::from_secs(4));
        assert!(child.try_wait().unwrap().is_none(), "it waits for the reader");
        signal(&child, name);
        let status = ends_within(&mut child, 3, name);
        assert_eq!(status.code(), Some(130), "{name} {to_pipe}");
        drop(held);
    }
}

#[test]
fn inputs_that_are_no_plain_files_are_refused_at_once() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    pipe(&at("p.toml"));
    pipe(&at("p.png"));
    pipe(&at("p.map"));
    std::os::unix::fs::symlink("/dev/zero", at("zero.toml")).unwrap();
    fs::create_dir(at("v.samples")).unwrap();
    pipe(&at("v.samples/plan.toml"));
    let film = ["video", "--vary", "time=0..2", "--frames", "3", "-o", "v"];
    let cases: [(&[&str], &str); 8] = [
        (&["render", "--state", "/dev/zero", "-o", "a.png"], "/dev/zero cannot be read"),
        (&["render", "--state", "p.toml", "-o", "a.png"], "p.toml cannot be read"),
        (&["render", "p.toml", "-o", "a.png"], "p.toml: it is not a regular file"),
        (&["render", "p.png", "-o", "a.png"], "p.png: it is not a regular file"),
        (&["render", "--palette", "p.map", "-o", "a.png"], "p.map: it is not a regular file"),
        (&["render", "zero.toml", "-o", "a.png"], "zero.toml: it is not a regular file"),
        (&["video", "p.toml", "-o", "f"], "p.toml"),
        (&film, "v.samples/plan.toml was not written by flipmap video"),
    ];
    for (words, why) in cases {
        let mut command = program(&folder, &[words, &CPU].concat());
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let status = ends_within(&mut child, 20, why);
        let said = error_of(&child.wait_with_output().unwrap());
        assert_eq!(status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains(why), "{words:?}: {said}");
    }
    let verified = refused(&folder, 2, &["verify", "p.toml"]);
    assert!(verified.contains("p.toml cannot be read: it is not a regular file"), "{verified}");
}

#[test]
fn a_damaged_profile_prevents_no_start() {
    let folder = folder();
    let cache = folder.path().join("cache/flipmap");
    fs::create_dir_all(&cache).unwrap();
    let path = pipe(&cache.join("profile.json"));
    let mut command = program(&folder, &["render", "--size", "8x8", "-o", "a.png"]);
    command.env("XDG_CACHE_HOME", folder.path().join("cache"));
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    ends_within(&mut child, 120, "a start");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", error_of(&output));
    assert!(error_of(&output).contains("profile.json is ignored"), "{}", error_of(&output));
    assert!(path.is_file(), "a new one was measured and kept");
}

#[test]
fn signals_are_heard_while_engines_are_measured_and_films_are_planned() {
    let folder = folder();
    let measuring = ["render", "--size", "8x8", "-o", "a.png"];
    let planning = [
        "video",
        "--zoom-to",
        "filigree",
        "--frames",
        "100000",
        "--engine",
        "cpu",
        "--size",
        "1280x720",
        "-o",
        "f",
    ];
    // On a busy machine the signal may be late, and measuring takes only a second.
    let [at_once, begun] = [0, 700].map(Duration::from_millis);
    let at_work = [(&measuring[..], "measuring the engines", at_once), (&planning[..], "", begun)];
    for (words, wait, pause) in at_work {
        let mut command = program(&folder, words);
        command.env("XDG_CACHE_HOME", folder.path().join("cache"));
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let mut said = String::new();
        let mut errors = std::io::BufReader::new(child.stderr.take().unwrap());
        while !wait.is_empty() && !said.contains(wait) {
            assert!(std::io::BufRead::read_line(&mut errors, &mut said).unwrap() > 0, "{said}");
        }
        sleep(pause);
        assert!(child.try_wait().unwrap().is_none(), "{words:?} is at work");
        signal(&child, "INT");
        // The system ends a program that has no handler yet, even while a kernel is compiled. The
        // delay on a busy machine says nothing about the program.
        let status = ends_within(&mut child, 10, "a start");
        assert_eq!(status.signal(), Some(2), "{words:?}: {status:?}");
        assert!(!folder.path().join("a.png").exists());
    }
}

#[test]
fn films_that_take_too_long_to_plan_are_refused() {
    let folder = folder();
    let film = |words: &[&str]| {
        refused(&folder, 2, &[&["video", "-o", "f.mp4"], &CPU[..], words].concat())
    };
    let error = film(&["--vary", "masses=1,1..1,5", "--frames", "1000000"]);
    assert!(error.contains("--frames is '1000000'; it must lie between 1 and 100000"), "{error}");
    let error = film(&["--vary", "time=0..2", "--secs", "100000"]);
    assert!(error.contains("a film of 100000 s needs 3000000 frames at 30 per second"), "{error}");
}

#[test]
fn inputs_of_every_kind_are_never_replaced() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("g.map"), "0 0 0\n255 255 255\n").unwrap();
    fs::write(at("s.toml"), "[view]\nwidth = \"1\"\n").unwrap();
    let plan = ["plan", "s.toml", "--shards", "1", "-o", "p.toml"];
    done(&folder, &[&plan[..], &CPU].concat());
    done(&folder, &["run", "p.toml"]);
    let part = fs::read_dir(at("p.parts")).unwrap().next().unwrap().unwrap().path();
    let part = part.strip_prefix(folder.path()).unwrap().to_str().unwrap().to_string();
    let before = ["g.map", "s.toml", "p.toml", &part].map(|name| fs::read(at(name)).unwrap());
    let painted = [&["render", "--palette", "g.map", "-o", "./g.map"], &CPU[..]].concat();
    for (words, why) in [
        (&painted[..], "--palette and -o name the same file"),
        (&["explore", "--stats", "s.toml", "s.toml"], "the scene and --stats name the same file"),
        (&["merge", "p.toml", "--palette", "g.map", "-o", "g.map"], "name the same file"),
        (&["merge", "p.toml", "-o", &part], "which holds the plan's parts"),
        (&["merge", "p.toml", "-o", "p.parts/../p.parts/new.png"], "which holds the plan's parts"),
    ] {
        let error = refused(&folder, 2, words);
        assert!(error.contains(why), "{words:?}: {error}");
    }
    let after = ["g.map", "s.toml", "p.toml", &part].map(|name| fs::read(at(name)).unwrap());
    assert!(before == after);
}

#[test]
fn files_of_others_survive_runs_and_reports() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let plan = ["plan", "home", "--shards", "1", "-o", "p.toml"];
    done(&folder, &[&plan[..], &CPU].concat());
    fs::create_dir(at("p.parts")).unwrap();
    let theirs = ["p.parts/rows-2024-budget.part", "p.parts/patches-z.part", "r/report.md"];
    fs::create_dir(at("r")).unwrap();
    theirs.iter().for_each(|name| fs::write(at(name), "mine").unwrap());
    fs::write(at("r/hunt.json"), "{\"deer\": 3}").unwrap();
    done(&folder, &["run", "p.toml"]);
    let report = refused(&folder, 1, &["report", "--quick", "--engine", "cpu", "-o", "r"]);
    assert!(
        report.contains("it holds report.md, which is not of a report of flipmap's"),
        "{report}"
    );
    let hunt = refused(&folder, 2, &["report", "--hunt", "0.01", "--engine", "cpu", "-o", "r"]);
    assert!(hunt.contains("hunt.json was not written by flipmap report --hunt"), "{hunt}");
    for name in theirs {
        assert_eq!(fs::read_to_string(at(name)).unwrap(), "mine", "{name}");
    }
    assert_eq!(fs::read_to_string(at("r/hunt.json")).unwrap(), "{\"deer\": 3}");
}

#[test]
fn a_hunt_that_is_stopped_says_so() {
    let folder = folder();
    let words = ["report", "--hunt", "5", "--engine", "cpu", "-o", "h"];
    let mut child = program(&folder, &words).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    while !folder.path().join("h/hunt.json").exists() && begun.elapsed().as_secs() < 60 {
        sleep(Duration::from_millis(50));
    }
    sleep(Duration::from_secs(1));
    signal(&child, "INT");
    let status = ends_within(&mut child, 60, "a hunt");
    let said = error_of(&child.wait_with_output().unwrap());
    assert_eq!(status.code(), Some(130), "{said}");
    assert!(said.contains("stopped; h/hunt.json holds"), "{said}");
    // Another hunt may use the same folder.
    done(&folder, &["report", "--hunt", "0.01", "--engine", "cpu", "-o", "h"]);
}

#[test]
fn a_folder_whose_name_is_too_long_is_refused_before_the_work() {
    let folder = folder();
    let name = "n".repeat(504);
    let words = ["--engine", "cpu", "--size", "3000x3000", "--pyramid", &name];
    let begun = Instant::now();
    let error = refused(&folder, 1, &[&["render"], &words[..]].concat());
    assert!(
        error.contains("--pyramid: cannot write") && error.contains("name too long"),
        "{error}"
    );
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Rewrites a plan's part with another body and a matching checksum.
fn forge(path: &Path, change: impl Fn(&mut Vec<u8>)) {
    let mut bytes = fs::read(path).unwrap();
    let mut body = bytes.split_off(19);
    change(&mut body);
    bytes[15..].copy_from_slice(&crc32fast::hash(&body).to_le_bytes());
    fs::write(path, [bytes, body].concat()).unwrap();
}

#[test]
fn forged_parts_and_plans_are_refused_by_name() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let plan = ["plan", "home", "--shards", "1", "-o", "p.toml"];
    done(&folder, &[&plan[..], &CPU].concat());
    done(&folder, &["run", "p.toml"]);
    let path = fs::read_dir(at("p.parts")).unwrap().next().unwrap().unwrap().path();
    let whole = fs::read(&path).unwrap();
    // The body: a digest of 64 letters, then the kind, width, first row and number of rows.
    for (place, value) in [(66, 7), (66, 0), (68, 0), (68, 9), (67, 100), (65, 1)] {
        forge(&path, |body| body[place] = value);
        let mut command = program(&folder, &["merge", "p.toml", "-o", "map.png"]);
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let status = ends_within(&mut child, 20, "a merge of a forged part");
        let said = error_of(&child.wait_with_output().unwrap());
        assert_eq!(status.code(), Some(4), "byte {place}: {said}");
        assert!(said.contains(".part is cut short or altered ("), "byte {place}: {said}");
        assert!(!at("map.png").exists());
        fs::write(&path, &whole).unwrap();
    }
    done(&folder, &["merge", "p.toml", "-o", "map.png"]);
    let film = ["plan", "--vary", "time=0..2", "--frames", "3", "--shards", "1", "-o", "f.toml"];
    done(&folder, &[&film[..], &CPU].concat());
    let text = fs::read_to_string(at("f.toml")).unwrap();
    let text = text.replace("frames = 3", "frames = 1000000");
    let (head, rest) = text.split_once("sha256 = \"").unwrap();
    let (_, tail) = rest.split_once('"').unwrap();
    let unsigned = format!("{head}sha256 = \"\"{tail}");
    let digest = flipmap_render::output::sha256(unsigned.as_bytes());
    fs::write(at("f.toml"), format!("{head}sha256 = \"{digest}\"{tail}")).unwrap();
    for words in [&["verify", "f.toml"][..], &["merge", "f.toml", "-o", "f"]] {
        let error = refused(&folder, 2, words);
        assert!(error.contains("`frames` is 1000000; it must lie between 1 and 100000"), "{error}");
    }
}

#[test]
fn names_are_never_commands_or_markup() {
    for name in [
        "it's \"quoted\"",
        "$(touch hacked)",
        "`touch hacked`",
        "a\ntouch hacked",
        "<script>alert(1)</script>".replace('/', "∕").as_str(),
        "; touch hacked;",
    ] {
        let folder = folder();
        let at = |end: &str| folder.path().join(format!("{name}{end}"));
        let own = |end: &str| format!("{name}{end}");
        fs::write(at(".toml"), "[view]\nwidth = \"1\"\n# <script>alert(2)</script>\n").unwrap();
        let (scene, plan, map) = (own(".toml"), own(".plan.toml"), own(".png"));
        let words = ["plan", &scene, "--shards", "2", "-o", &plan];
        let planned = flipmap(&folder, &[&words[..], &CPU].concat());
        assert!(planned.status.success(), "{name}: {}", error_of(&planned));
        // A shell runs the suggested command as intended.
        let said = flipmap(&folder, &["verify", &plan]);
        assert_eq!(said.status.code(), Some(4), "{name}");
        let said = error_of(&said);
        let (_, command) = said.split_once("complete each with flipmap ").unwrap();
        let command = command.trim_end().replace("--shard N", "--shard 1");
        let shell = format!("exec \"$FLIPMAP\" {command}");
        let ran = Command::new("bash")
            .args(["-c", &shell])
            .env("FLIPMAP", env!("CARGO_BIN_EXE_flipmap"))
            .current_dir(&folder)
            .output()
            .unwrap();
        assert!(ran.status.success(), "{name}: {shell}: {}", error_of(&ran));
        done(&folder, &["run", &plan]);
        done(&folder, &["verify", &plan]);
        done(&folder, &["merge", &plan, "-o", &map, "--pyramid", &own("")]);
        assert!(at(".png").is_file(), "{name}");
        let page = fs::read_to_string(at("").join("index.html")).unwrap();
        assert!(!page.contains("alert("), "{name}");
        assert!(!page.contains(name), "{name}");
        assert!(!folder.path().join("hacked").exists(), "{name} was run");
    }
}

#[test]
fn the_page_of_a_pyramid_escapes_what_a_scene_says() {
    let folder = folder();
    let hostile = "</pre><script>alert(1)</script>";
    // The words of a scene are checked; free text can only stand in the tables before that check.
    let scene = format!("[run]\nmethod = \"{hostile}\"\n");
    fs::write(folder.path().join("s.toml"), scene).unwrap();
    let words = ["render", "s.toml", "--pyramid", "tiles"];
    let output = flipmap(&folder, &[&words[..], &CPU].concat());
    assert_eq!(output.status.code(), Some(2), "{}", error_of(&output));
    assert!(!folder.path().join("tiles").exists());
    let mut document = flipmap_scene::Document::default();
    document.run.method = Some(hostile.to_string());
    let path = folder.path().join("tiles");
    flipmap_render::output::Pyramid::create(&path, [1, 1], &document)
        .and_then(|mut tiles| {
            tiles.write(&[0; 3]).unwrap();
            tiles.complete().unwrap().finish()
        })
        .unwrap();
    let page = fs::read_to_string(path.join("index.html")).unwrap();
    assert!(!page.contains("<script>alert"), "{page}");
    assert!(page.contains("&lt;script&gt;alert(1)"), "{page}");
}
