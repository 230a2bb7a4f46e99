//! The files of the project as text, for tests of its rules.

use std::fs;
use std::path::{Path, PathBuf};

/// The Rust files below a folder.
pub(crate) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
    found
}

/// The Rust files of the product: the program's and its crates', without folders of tests.
pub(crate) fn product_files() -> Vec<PathBuf> {
    let crates = fs::read_dir("crates").unwrap().map(|entry| entry.unwrap().path().join("src"));
    let others = ["assets", "shaders", "src", "web/src"].map(PathBuf::from);
    let files = crates.chain(others).flat_map(|folder| rust_files(&folder));
    files.filter(|file| !file.components().any(|part| part.as_os_str() == "tests")).collect()
}
