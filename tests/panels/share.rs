//! Files that leave the program and are read back: exports equal the output of `render`, and
//! colours never affect the numbers.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use flipmap_engine::EngineKind;
use flipmap_engine::choice::EngineRequest;
use flipmap_render::output::document_in_png;
use flipmap_scene::{BUILT_IN, BuiltIn, Document, Sampling, Scale};
use flipmap_window::export::{Export, ExportKind, ExportRequest, ExportStage};

/// Runs `flipmap render` on the processor for a small, fast picture.
fn render(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::cargo_bin("flipmap").unwrap();
    command.current_dir(folder).env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"));
    let small = ["render", "--engine", "cpu", "--size", "48x32", "--accuracy", "fast"];
    let output = command.args(small).args(arguments).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {told}");
    told
}

fn export(mut document: Document, path: &Path, kind: ExportKind) {
    document.run.accuracy = Some("fast".to_string());
    let request = ExportRequest { document, size: [48, 32], path: path.to_path_buf(), kind };
    let engine_request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
    let stage = Export::start(request, engine_request, || ()).wait();
    assert!(matches!(stage, ExportStage::Done { .. }), "{stage:?}");
}

fn document(path: &Path) -> Document {
    document_in_png(std::io::BufReader::new(fs::File::open(path).unwrap())).unwrap()
}

#[test]
fn an_export_is_the_file_that_render_writes() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["home", "threads"] {
        render(folder.path(), &[name, "--samples", "2", "-o", "a.png", "--raw", "a.npy"]);
        let mut scene = BuiltIn::named(name).unwrap().document();
        scene.picture.samples = Sampling::Square(2);
        export(scene.clone(), &at("b.png"), ExportKind::Png);
        export(scene, &at("b.npy"), ExportKind::Raw);
        assert!(fs::read(at("a.png")).unwrap() == fs::read(at("b.png")).unwrap(), "{name}");
        assert!(fs::read(at("a.npy")).unwrap() == fs::read(at("b.npy")).unwrap(), "{name}");
    }
}

#[test]
fn an_exported_picture_exports_as_itself() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a.png", "b.png"].map(|name| folder.path().join(name));
    export(BuiltIn::named("shore").unwrap().document(), &a, ExportKind::Png);
    export(document(&a), &b, ExportKind::Png);
    assert!(fs::read(a).unwrap() == fs::read(b).unwrap());
}

#[test]
fn colours_change_the_picture_and_not_the_times() {
    let folder = tempfile::tempdir().unwrap();
    let plain = ["filigree", "-o", "plain.png", "--raw", "plain.npy"];
    render(folder.path(), &plain);
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    for options in [
        &["--reverse"][..],
        &["--cycles", "3"],
        &["--scale", "linear"],
        &["--times", "5,30"],
        &["--times", "5,9,10,30"],
    ] {
        let files = ["filigree", "-o", "other.png", "--raw", "other.npy"];
        render(folder.path(), &[&files, options].concat());
        assert!(bytes("plain.npy") == bytes("other.npy"), "{options:?}");
        assert!(bytes("plain.png") != bytes("other.png"), "{options:?}");
    }
    // The options are stored in the picture and restored when it is opened.
    let all = ["--reverse", "--cycles", "1.5", "--scale", "linear", "--times", "5,9.5,30"];
    render(folder.path(), &[&["filigree", "-o", "c.png"], &all[..]].concat());
    let picture = document(&folder.path().join("c.png")).picture;
    assert_eq!((picture.cycles, picture.scale), (1.5, Scale::Linear));
    assert_eq!((picture.reverse, picture.times), (true, vec![5.0, 9.5, 30.0]));
    render(folder.path(), &["c.png", "-o", "d.png"]);
    assert!(bytes("c.png") == bytes("d.png"));
}

#[test]
fn the_help_lists_every_built_in_scene() {
    let output = Command::cargo_bin("flipmap").unwrap().args(["render", "--help"]).output();
    let help = String::from_utf8(output.unwrap().stdout).unwrap();
    let words: Vec<&str> = help.split([' ', ',', '\n']).collect();
    for scene in BUILT_IN {
        assert!(words.contains(&scene.name), "{}", scene.name);
    }
}
