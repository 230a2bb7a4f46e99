//! scripts/speed, which compares two builds, tested on fake builds that only report times.
#![cfg(unix)]

use std::process::{Command, Output};

use tempfile::TempDir;

use crate::script;

fn error_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Writes a fake build that reports 200 pixels in `small_secs` and 1,200 pixels in `large_secs`.
fn pretended_build(folder: &TempDir, name: &str, [small_secs, large_secs]: [f64; 2]) -> String {
    let told = |secs: f64, pixels: u32| {
        let evaluations = 10 * pixels;
        format!(
            r#"{{"seconds": {{"compute": {secs}}}, "simulated": {pixels}, "rhs_evaluations": {evaluations}}}"#
        )
    };
    let (small, large) = (told(small_secs, 200), told(large_secs, 1200));
    let text = format!(
        "#!/bin/sh\ncase \"$*\" in *256x256*) echo '{small}' ;; *) echo '{large}' ;; esac\n"
    );
    script(folder, name, &text).to_str().unwrap().to_string()
}

#[test]
fn builds_are_compared_by_the_cost_of_a_pixel_and_a_slower_one_is_told() {
    let folder = tempfile::tempdir().unwrap();
    // Both take 1 s to begin; a pixel costs 2 ms in the old build, 3 ms in the new one.
    let old = pretended_build(&folder, "old", [1.4, 3.4]);
    let new = pretended_build(&folder, "new", [1.6, 4.6]);
    let compare = |arguments: &[&str]| {
        Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/speed"))
            .args(["--rounds", "1", "--levels", "fast"])
            .args(arguments)
            .output()
            .unwrap()
    };
    let slower = compare(&["--limit", "1.02", &old, &new]);
    let table = String::from_utf8_lossy(&slower.stdout).into_owned();
    assert!(table.contains("2000.000  3000.000    1.50"), "{table}");
    assert_eq!(slower.status.code(), Some(3), "{}", error_of(&slower));
    let faster = compare(&["--limit", "1.02", &new, &old]);
    assert_eq!(faster.status.code(), Some(0), "{}", error_of(&faster));
    let missing = compare(&["no-such-build", &new]);
    let error = error_of(&missing);
    assert!(error.contains("there is no program and no commit no-such-build"), "{error}");
    assert_eq!(missing.status.code(), Some(1));
}
