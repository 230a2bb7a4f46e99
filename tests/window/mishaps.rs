//! Displays on which no window can be opened as usual, or that go away, and what never answers.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use super::display::{Display, wait_for};
use super::session::{Session, alone};

/// Opens the program in a home folder; it writes its messages to the file `log` there.
fn explore(home: &Path, environment: &[(&str, &str)]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_flipmap"))
        .args(["explore", "--engine", "cpu", "--accuracy", "fast", "--no-config"])
        .current_dir(home)
        .env("HOME", home)
        .env("XDG_RUNTIME_DIR", home)
        .env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"))
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("DISPLAY")
        .env_remove("RUST_LOG")
        .envs(environment.iter().copied())
        .stderr(File::create(home.join("log")).unwrap())
        .spawn()
        .unwrap()
}

/// Returns the exit code of a program that ends by itself, and its only sentence.
fn refusal(environment: &[(&str, &str)]) -> (Option<i32>, String) {
    let home = tempfile::tempdir().unwrap();
    let mut child = explore(home.path(), environment);
    let status = wait_for("the end", 60, || child.try_wait().unwrap());
    let log = fs::read_to_string(home.path().join("log")).unwrap();
    // Drivers may have warned before.
    assert_eq!(log.lines().filter(|line| line.starts_with("flipmap: ")).count(), 1, "{log}");
    assert!(!log.contains(".rs"), "places in a source help nobody: {log}");
    (status.code(), log)
}

/// Opens a window and closes it again; returns what it said.
fn opened(display: &Display, environment: &[(&str, &str)]) -> String {
    let home = tempfile::tempdir().unwrap();
    let all = [&[("DISPLAY", display.name.as_str())], environment].concat();
    let mut child = explore(home.path(), &all);
    let window = wait_for("the window", 60, || {
        let log = || fs::read_to_string(home.path().join("log")).unwrap();
        assert!(child.try_wait().unwrap().is_none(), "{environment:?}: {}", log());
        display.window("flipmap")
    });
    display.ask_to_close(window);
    let status = wait_for("the end", 60, || child.try_wait().unwrap());
    let log = fs::read_to_string(home.path().join("log")).unwrap();
    assert_eq!(status.code(), Some(0), "{log}");
    log
}

pub(crate) fn any_scale_opens_a_window() {
    let _alone = alone();
    let display = Display::open();
    for scale in ["8", "2.5", "randr", ""] {
        assert_eq!(opened(&display, &[("WINIT_X11_SCALE_FACTOR", scale)]), "", "{scale}");
    }
    for scale in ["0", "-1", "NaN", "1000", "wide"] {
        let log = opened(&display, &[("WINIT_X11_SCALE_FACTOR", scale)]);
        assert!(log.contains(&format!("'{scale}'; it must be randr or a number")), "{log}");
    }
    for dpi in ["0", "-96", "nan", "1e9"] {
        display.set_resource(&format!("Xft.dpi:\t{dpi}\n"));
        let log = opened(&display, &[]);
        assert!(log.contains("the display's scale is"), "{dpi}: {log}");
    }
    display.set_resource("Xft.dpi:\twide\n");
    assert_eq!(opened(&display, &[]), "", "no number at all");
}

pub(crate) fn a_display_of_other_colours_is_said_to_be_one() {
    let _alone = alone();
    for bits in [8, 16, 30] {
        let display = Display::of_depth(bits);
        let (code, said) = refusal(&[("DISPLAY", &display.name)]);
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains(&format!("the display has {bits} bits a pixel")), "{said}");
    }
}

pub(crate) fn where_no_compositor_answers_x11_is_used() {
    let _alone = alone();
    let display = Display::open();
    let log = opened(&display, &[("WAYLAND_DISPLAY", "wayland-9")]);
    assert!(log.contains("no compositor answers at WAYLAND_DISPLAY=wayland-9"), "{log}");
    for environment in [&[][..], &[("WAYLAND_DISPLAY", "wayland-9")], &[("DISPLAY", ":987")]] {
        let (code, said) = refusal(environment);
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains("no window can be opened here"), "{said}");
    }
}

pub(crate) fn a_display_that_goes_away_costs_nothing() {
    let mut session = Session::open("gone", &[]);
    session.after("a zoom", |display| display.key("plus"), |told| told.width_rad() < 5.0);
    // The settings are saved a moment after the window has come to rest.
    let settings = session.path(".config/flipmap/settings.toml");
    wait_for("the settings", 10, || {
        fs::read_to_string(&settings).is_ok_and(|text| text.contains("last_scene")).then_some(())
    });
    session.display.end();
    let ended = session.ended();
    assert_eq!(ended.code, Some(1), "{}", ended.log);
    assert!(ended.log.contains("the settings and the keys of the film are kept"), "{}", ended.log);
    for place in [".cargo", ".rs", "panicked"] {
        assert!(!ended.log.contains(place), "{}", ended.log);
    }
}

pub(crate) fn a_clipboard_that_does_not_answer_freezes_nothing() {
    let session = Session::open("clipboard", &[]);
    session.display.hold_clipboard();
    let begun = Instant::now();
    session.after(
        "a zoom",
        |display| {
            display.key("ctrl+v");
            display.key("plus");
        },
        |told| told.width_rad() < 5.0,
    );
    // The owner of a clipboard is awaited for four seconds.
    assert!(begun.elapsed() < Duration::from_secs(3), "{:?}", begun.elapsed());
    session.rest("a notice", |told| {
        told.notices().iter().any(|notice| notice.starts_with("Nothing was pasted"))
    });
    session.quit();
}
