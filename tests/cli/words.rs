//! Typed words: names of sizes and scenes, angles, help, the manual, and names of outputs.

use std::fs;

use super::{error_of, flipmap, folder, render};
use crate::program::refused;

#[test]
fn a_scene_gives_its_picture_a_name_once() {
    let folder = folder();
    let draw = || flipmap(&folder, &["render", "shore", "--engine", "cpu", "--size", "24X16"]);
    assert!(draw().status.success());
    let bytes = fs::read(folder.path().join("shore.png")).unwrap();
    let again = draw();
    assert_eq!(again.status.code(), Some(2));
    assert!(error_of(&again).contains("shore.png is there already"), "{}", error_of(&again));
    assert_eq!(fs::read(folder.path().join("shore.png")).unwrap(), bytes);
}

#[test]
fn impossible_sizes_are_refused() {
    let folder = folder();
    for size in ["0x5", "5x0", "1000001x1", "x", "5", "-1x5", "99999999999x2"] {
        let output = flipmap(&folder, &["render", "-o", "a.png", "--size", size]);
        assert_eq!(output.status.code(), Some(2), "{size}");
        assert!(error_of(&output).contains("--size"), "{size}: {}", error_of(&output));
    }
}

#[test]
fn mistyped_scenes_are_guessed() {
    let folder = folder();
    let guessed = error_of(&render(&folder, &["filigre", "-o", "a.png"]));
    assert!(guessed.contains("did you mean filigree?"), "{guessed}");
    let unknown = error_of(&render(&folder, &["elsewhere", "-o", "a.png"]));
    assert!(unknown.contains("no scene 'elsewhere'") && !unknown.contains("mean"), "{unknown}");
}

#[test]
fn degrees_and_parts_of_pi_are_angles() {
    let folder = folder();
    let drawn = |name: &str, center: &str, width: &str| {
        let output = render(&folder, &["--center", center, "--width", width, "--raw", name]);
        assert!(output.status.success(), "{}", error_of(&output));
        fs::read(folder.path().join(name)).unwrap()
    };
    let rad = drawn("rad.npy", "1.5707963267948966192313216916398,-0.6", "0.5");
    assert!(rad == drawn("deg.npy", "90deg,-0.6", "0.5"));
    assert!(rad == drawn("pi.npy", "0.5pi,-0.6", "0.5"));
    assert!(rad != drawn("other.npy", "91deg,-0.6", "0.5"));
    let wrong = error_of(&render(&folder, &["--center", "90dag,1", "-o", "a.png"]));
    assert!(wrong.contains("--center") && wrong.contains("90dag"), "{wrong}");
}

#[test]
fn the_manual_and_completions_know_every_subcommand() {
    let folder = folder();
    let said = |words: &[&str]| {
        let output = flipmap(&folder, words);
        assert!(output.status.success(), "{}", error_of(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let page = said(&["man"]);
    for shell in ["bash", "zsh", "fish"] {
        let words = said(&["completions", shell]);
        for verb in ["render", "trace", "completions"] {
            assert!(page.contains(&format!("flipmap\\-{verb}(1)")), "{verb}");
            assert!(words.contains(verb), "{shell} {verb}");
        }
    }
    let words = said(&["completions", "bash"]);
    for values in [
        "auto never always",
        "flip first flips state",
        "bob distance energy",
        "--help explore render",
    ] {
        assert!(words.contains(values), "{values}");
    }
    let page = said(&["man", "render"]);
    assert!(page.contains("\\-\\-palette") && page.contains(".SH EXAMPLES"));
    assert!(page.contains("Save pixels that can go on"), "help that -h leaves out");
    let guessed = error_of(&flipmap(&folder, &["filigree"]));
    assert!(guessed.contains("'filigree' is a scene: flipmap render filigree"), "{guessed}");
    let odd = error_of(&flipmap(&folder, &["a\u{1b}[31m b.toml"]));
    assert!(odd.contains("flipmap render 'a") && !odd.contains('\u{1b}'), "{odd}");
    let none = refused(&folder, 2, &["lab"]);
    assert!(none.contains("name a figure; the figures are single"), "{none}");
    assert_eq!(flipmap(&folder, &["man", "rendr"]).status.code(), Some(2));
}

#[test]
fn short_help_fits_a_screen_and_long_help_has_examples() {
    let folder = folder();
    let lines =
        |words: &[&str]| String::from_utf8(flipmap(&folder, words).stdout).unwrap().lines().count();
    for verb in ["render", "video", "explore", "trace", "deeper", "plan"] {
        assert!(lines(&[verb, "-h"]) <= 60, "{verb}: {} lines", lines(&[verb, "-h"]));
        assert!(lines(&[verb, "--help"]) > lines(&[verb, "-h"]), "{verb}");
    }
    let help = String::from_utf8(flipmap(&folder, &["render", "--help"]).stdout).unwrap();
    assert!(help.contains("Examples:\n  flipmap render"), "{help}");
}

#[test]
fn outputs_that_cannot_be_are_refused_before_the_work() {
    let folder = folder();
    let long = format!("{}.png", "n".repeat(300));
    for (words, why) in [
        (vec!["render", "--engine", "cpu", "-o", &long], "-o"),
        (vec!["deeper", "--engine", "cpu", "-o", "none/keys.toml"], "does not exist"),
        (vec!["plan", "--engine", "cpu", "--shards", "2", "-o", "big.parts"], "name a .toml"),
    ] {
        let output = flipmap(&folder, &words);
        assert!(!output.status.success());
        assert!(error_of(&output).contains(why), "{}", error_of(&output));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn what_is_quoted_reaches_no_terminal_as_a_command() {
    let folder = folder();
    let said = error_of(&render(&folder, &["\u{1b}[31mred", "-o", "a.png"]));
    assert!(said.contains("\\u{1b}[31mred") && !said.contains('\u{1b}'), "{said}");
    let endless = error_of(&render(&folder, &["--width", &"x".repeat(100_000), "-o", "a.png"]));
    assert!(endless.len() < 10_000, "{}", endless.len());
}

#[test]
fn the_version_is_told_and_whose_the_colour_tables_are() {
    let folder = folder();
    let said = |arguments: &[&str]| {
        let output = flipmap(&folder, arguments);
        assert!(output.status.success(), "{}", error_of(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let line = concat!("flipmap ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!((said(&["--version"]), said(&["-V"])), (line.to_string(), line.to_string()));
    let more = said(&["--version", "--verbose"]);
    for words in [
        line,
        "licence: MIT OR Apache-2.0",
        "batlow",
        "Scientific colour maps 8.0",
        "matplotlib 3.10",
        "(CC0)",
    ] {
        assert!(more.contains(words), "{words}: {more}");
    }
    let alone = flipmap(&folder, &["--verbose"]);
    assert_eq!(alone.status.code(), Some(2));
    assert!(error_of(&alone).contains("--version"), "{}", error_of(&alone));
}

#[test]
fn mistakes_that_the_parser_finds_are_quoted_safely() {
    let folder = folder();
    let long = "9".repeat(100_000);
    let hostile = "x\u{9b}31m\r\u{202e}\u{1b}[31m\u{2066}y";
    let unknown = format!("--{hostile}");
    for words in [
        &["render", "--threads", &long][..],
        &["render", "--threads", hostile],
        &[&long],
        &[hostile],
        &["render", &unknown],
        &["plan", "--shards", hostile, "-o", "p.toml"],
        &["render", "--progress", &long],
    ] {
        let output = flipmap(&folder, words);
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.starts_with("error: ") && error.contains("--help"), "{error}");
        assert!(error.chars().count() < 2100, "{} characters", error.chars().count());
        let obeyed = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..'\u{206a}').contains(&c);
        assert!(!error.contains(obeyed), "{error:?}");
    }
    let help = flipmap(&folder, &["render", "--help"]);
    assert!(help.status.success() && help.stderr.is_empty());
}
