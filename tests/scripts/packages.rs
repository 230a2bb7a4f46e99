//! Parts of packages: templates, archives, and the names that must match between them.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use sha2::{Digest, Sha256};
use tempfile::TempDir;

const TARGETS: [(&str, &str); 4] = [
    ("x86_64-unknown-linux-gnu", "tar.gz"),
    ("aarch64-unknown-linux-gnu", "tar.gz"),
    ("aarch64-apple-darwin", "tar.gz"),
    ("x86_64-pc-windows-msvc", "zip"),
];

/// A folder with an archive of version 1.2.3 for each of the targets.
fn archives(targets: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (target, ending) in targets {
        let name = format!("flipmap-1.2.3-{target}.{ending}");
        fs::write(folder.path().join(name), format!("the archive for {target}")).unwrap();
    }
    folder
}

fn filled(folder: &Path) -> Output {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/fill-templates");
    Command::new(script).arg("1.2.3").arg(folder).output().unwrap()
}

#[test]
fn templates_are_filled_with_the_sums_of_their_archives() {
    let folder = archives(&TARGETS);
    let output = filled(folder.path());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let both = [read("flipmap.rb"), read("flipmap.yaml")].concat();
    for (target, ending) in TARGETS {
        let sum = Sha256::digest(format!("the archive for {target}"));
        let sum: String = sum.iter().map(|byte| format!("{byte:02x}")).collect();
        assert!(both.contains(&sum), "{target}");
        assert!(both.contains(&format!("v1.2.3/flipmap-1.2.3-{target}.{ending}")), "{target}");
    }
    assert!(!both.contains('@'), "{both}");
}

#[test]
fn a_missing_archive_is_named() {
    let folder = archives(&TARGETS[1..]);
    let output = filled(folder.path());
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("no archive flipmap-1.2.3-x86_64-unknown-linux-gnu"), "{said}");
    assert!(!folder.path().join("flipmap.rb").exists());
}

#[test]
fn a_release_builds_what_packages_name() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &str| fs::read_to_string(root.join(path)).unwrap();
    let workflow = read(".github/workflows/release.yml");
    for (target, _) in TARGETS {
        assert!(workflow.contains(&format!("target: {target} }}")), "{target}");
    }
    for script in ["scripts/archive", "scripts/fill-templates", "scripts/package"] {
        assert!(workflow.contains(script) && root.join(script).exists(), "{script}");
    }
    assert!(!workflow.contains("target: riscv64gc-unknown-linux-gnu }"), "the test can fail");
}

/// The names of the files that a package holds.
fn packaged(package: &str) -> Vec<String> {
    let listed = Command::new(env!("CARGO"))
        .args(["package", "--list", "--allow-dirty", "--offline", "--package", package])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(listed.status.success(), "{}", String::from_utf8_lossy(&listed.stderr));
    String::from_utf8(listed.stdout).unwrap().lines().map(str::to_string).collect()
}

#[test]
fn packages_hold_what_they_are_built_from_and_no_more() {
    let names = packaged("flipmap");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let bytes = |name: &String| root.join(name).metadata().map_or(0, |found| found.len());
    assert!(names.iter().map(bytes).sum::<u64>() < 6 << 20, "a registry takes 10 MiB, compressed");
    let has = |start: &str| names.iter().any(|name| name.starts_with(start));
    assert!(has("src/main.rs") && has("LICENSE-MIT"));
    for folder in ["fuzz/", "python/", "tests/", "crates/", "packaging/", "scripts/"] {
        assert!(!has(folder), "{folder}");
    }
    assert!(!names.iter().any(|name| name.starts_with("docs/") && name.ends_with(".png")));
    for (package, wanted) in [
        ("flipmap-shaders", &["flip.wgsl"][..]),
        (
            "flipmap-assets",
            &["palettes/LICENSE-crameri.txt", "faces/LICENSE-fira.txt", "scenes/home.toml"],
        ),
        ("flipmap-numbers", &["src/lib.rs"]),
        ("flipmap-pendulum", &["src/lib.rs"]),
        ("flipmap-scene", &["src/lib.rs"]),
        ("flipmap-engine", &["src/lib.rs"]),
        ("flipmap-render", &["src/lib.rs"]),
        ("flipmap-report", &["src/lib.rs", "src/page/style.css"]),
        ("flipmap-lab", &["src/lib.rs"]),
        ("flipmap-screen", &["src/lib.rs"]),
        ("flipmap-window", &["src/lib.rs"]),
    ] {
        let names = packaged(package);
        for wanted in wanted.iter().chain(&["LICENSE-APACHE", "LICENSE-MIT"]) {
            assert!(names.iter().any(|name| name == wanted), "{package}: {wanted}");
        }
    }
}

#[test]
fn the_debian_package_carries_the_notices_of_colour_tables_and_letters() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest: toml::Table =
        fs::read_to_string(root.join("Cargo.toml")).unwrap().parse().unwrap();
    let assets = &manifest["package"]["metadata"]["deb"]["assets"];
    let assets = assets.as_array().unwrap();
    let goes_to = |from: &str| {
        let asset = assets.iter().find(|asset| asset[0].as_str() == Some(from));
        asset.and_then(|asset| asset[1].as_str()).unwrap_or_default().to_string()
    };
    for (folder, notice) in [("palettes", "LICENSE-crameri.txt"), ("faces", "LICENSE-fira.txt")] {
        assert_eq!(goes_to(&format!("assets/{folder}/LICENSE-*")), "usr/share/doc/flipmap/");
        assert!(root.join("assets").join(folder).join(notice).exists());
    }
    let types = fs::read_to_string(root.join("assets/package/flipmap.xml")).unwrap();
    let desktop = fs::read_to_string(root.join("assets/package/flipmap.desktop")).unwrap();
    for (name, glob) in
        [("application/x-flipmap-scene", "*.flipmap.toml"), ("image/x-flipmap", "*.flipmap.png")]
    {
        assert!(types.contains(&format!("type=\"{name}\"")) && types.contains(glob), "{name}");
        assert!(desktop.contains(name), "{name}");
    }
}

#[test]
#[cfg_attr(not(package), ignore = "builds for minutes and needs root: scripts/test --package")]
fn the_debian_package_leaves_no_trace() {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/package");
    let status = Command::new(script).arg("--try").status().unwrap();
    assert!(status.success(), "{status}");
}
