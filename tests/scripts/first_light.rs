//! scripts/first-light, which measures a machine with a card: a reduced run with this program, and
//! runs with fake programs that give wrong results.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::script;

needs_adapter! {
    checks:
    a_reduced_run_measures_everything
}

/// Runs the script in a folder with a program.
fn first_light(folder: &TempDir, program: &Path) -> Output {
    Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/first-light"))
        .args(["--reduced", "out"])
        .current_dir(folder)
        .env("FLIPMAP", program)
        .output()
        .unwrap()
}

fn page(folder: &TempDir) -> String {
    fs::read_to_string(folder.path().join("out/first-light.md")).unwrap()
}

/// Returns the cells of a table's rows, without its header.
fn rows<'a>(page: &'a str, chapter: &str) -> Vec<Vec<&'a str>> {
    let chapter = page.split("\n## ").find(|text| text.starts_with(chapter)).unwrap();
    let lines = chapter.lines().filter(|line| line.starts_with("| ")).skip(1);
    lines.map(|line| line.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

mod checks {
    use super::*;

    pub(crate) fn a_reduced_run_measures_everything() {
        let folder = tempfile::tempdir().unwrap();
        let output = first_light(&folder, Path::new(env!("CARGO_BIN_EXE_flipmap")));
        let page = page(&folder);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}{page}");
        let number = |text: &str| text.parse::<f64>().unwrap();
        for row in rows(&page, "Compile times") {
            assert!(number(row[1]) > 0.0 && number(row[2]) > 0.0, "{row:?}");
        }
        let right = rows(&page, "Correctness");
        let names: Vec<&str> = right.iter().map(|row| row[0]).collect();
        assert_eq!(names, ["lesson", "fast", "balanced", "exact"]);
        assert!(right.iter().all(|row| number(row[1]) >= number(row[2])), "{right:?}");
        let (sizes, levels) = (2, 3);
        let speeds = rows(&page, "Throughput");
        // A second table has the slopes.
        assert_eq!(speeds.len(), sizes * levels + 1 + levels, "{speeds:?}");
        assert!(speeds[..sizes * levels].iter().all(|row| number(row[5]) > 0.0), "{speeds:?}");
        assert_eq!(rows(&page, "Exact").len(), 1);
        for name in ["doctor", "reference", "correct-exact", "right-exact", "size-fast-64"] {
            let text = fs::read_to_string(folder.path().join(format!("out/json/{name}.json")));
            serde_json::from_str::<serde_json::Value>(&text.unwrap()).unwrap();
        }
    }
}

/// Runs the script with a fake program that reports `differing` wrong pixels of 1000 and a
/// self-check `word`.
fn pretender(folder: &TempDir, differing: u32, word: &str) -> Output {
    let text = format!(
        r#"#!/bin/sh
case $1 in
--version) echo pretender ;;
doctor) echo "Adapter: none"; echo "  {word} f64 sums" ;;
compare) echo '{{"differing": {differing}, "median": 1e-9, "max": 1.5}}' ;;
render) echo '{{"flipped": 900, "unflipped": 100, "simulated": 500, "seconds": {{"compute": 0.5}}}}' ;;
esac
"#
    );
    let _ = fs::remove_dir_all(folder.path().join("out"));
    first_light(folder, &script(folder, "pretender", &text))
}

#[test]
fn wrong_pixels_and_failed_checks_are_told() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(pretender(&folder, 1, "passed").status.code(), Some(0));
    assert_eq!(pretender(&folder, 90, "passed").status.code(), Some(1));
    let page_of_wrong = page(&folder);
    assert!(page_of_wrong.contains("**Wrong: fast: 0.9100"), "{page_of_wrong}");
    assert!(!page_of_wrong.contains("**Wrong: lesson"), "{page_of_wrong}");
    assert_eq!(pretender(&folder, 1, "FAILED").status.code(), Some(1));
    assert!(page(&folder).contains("a self-check failed"));
}

#[test]
fn a_program_that_is_not_there_and_a_folder_that_is_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = first_light(&folder, Path::new("nowhere"));
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no program at nowhere"));
    fs::create_dir(folder.path().join("out")).unwrap();
    let output = first_light(&folder, Path::new("/bin/true"));
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("must be a new folder"));
}
