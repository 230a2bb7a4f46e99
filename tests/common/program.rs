//! The built program, run as its users run it.

use std::process::{Command, Output};

use tempfile::TempDir;

/// A command that runs the program in a folder, with a cache that only tests share.
pub(crate) fn program(folder: &TempDir, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flipmap"));
    command.current_dir(folder).env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"));
    command.args(arguments);
    command
}

pub(crate) fn flipmap(folder: &TempDir, arguments: &[&str]) -> Output {
    program(folder, arguments).output().unwrap()
}

pub(crate) fn error_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs the program, asserts that it succeeds, and returns its standard output.
#[allow(dead_code, reason = "not every test needs it")]
pub(crate) fn done(folder: &TempDir, arguments: &[&str]) -> String {
    let output = flipmap(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", error_of(&output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs the program, asserts that it fails with an exit code, and returns its error message.
#[allow(dead_code, reason = "not every test needs it")]
pub(crate) fn refused(folder: &TempDir, code: i32, arguments: &[&str]) -> String {
    let output = flipmap(folder, arguments);
    let error = error_of(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
    assert!(error.lines().filter(|line| line.starts_with("flipmap: ")).count() >= 1, "{error}");
    error
}
