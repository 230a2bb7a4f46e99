//! Every parser of files and texts that others may have written or damaged, as a function of bytes.
//! None may panic, and a value that one reads must be the same after writing and reading it again.
//! libFuzzer calls them (`fuzz_targets`); a test calls them with the inputs in `corpus`.

use std::io::Cursor;

use flipmap_engine::Accuracy;
use flipmap_engine::profile::Profile;
use flipmap_numbers::{Exact, Scalar};
use flipmap_render::farm::{PartForm, PartForms, Parts, Plan};
use flipmap_render::film::Frames;
use flipmap_render::output::compare::{ResultRows, Yardstick, compare};
use flipmap_render::output::{RenderState, document_in_png};
use flipmap_scene::keys::Keys;
use flipmap_scene::palette::gradient::{list_text, parse_list};
use flipmap_scene::palette::gradient_file::{ENDINGS, parse_file};
use flipmap_scene::{Document, in_rad, location};
use sha2::{Digest, Sha256};

/// A parser of bytes.
pub(crate) type Parser = fn(&[u8]);

/// All parsers, by the names of their corpora.
pub(crate) const PARSERS: [(&str, Parser); 13] = [
    ("scene", scene),
    ("location", place),
    ("coordinate", coordinate),
    ("keys", keys),
    ("plan", plan),
    ("state", state),
    ("png", png),
    ("result", result),
    ("part", part),
    ("gradient", gradient),
    ("settings", settings),
    ("profile", profile),
    ("frame", frame),
];

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap_or_default()
}

/// A scene file.
pub(crate) fn scene(bytes: &[u8]) {
    if let Ok(document) = Document::parse(text(bytes)) {
        let again = Document::parse(&document.text()).expect("what is written is read");
        assert_eq!(document, again);
    }
}

/// A location line.
pub(crate) fn place(bytes: &[u8]) {
    if let Ok(scene) = location::parse(text(bytes)) {
        let line = location::text(&scene);
        let again = location::parse(&line).expect("what is written is read");
        assert_eq!(location::text(&again), line);
    }
}

/// A coordinate, in rad, in degrees or as a part of π.
pub(crate) fn coordinate(bytes: &[u8]) {
    let rad = in_rad(text(bytes));
    if let Some(theta) = Exact::parse(&rad) {
        let again = Exact::parse(&theta.decimal(40)).expect("what is written is read");
        assert!((theta - again).to_f64().abs() < 1e-39);
    }
}

/// The keys of a film.
pub(crate) fn keys(bytes: &[u8]) {
    if let Ok(keys) = Keys::parse(text(bytes)) {
        assert_eq!(Keys::parse(&keys.text()).expect("what is written is read").text(), keys.text());
    }
}

/// The plan of a farm.
pub(crate) fn plan(bytes: &[u8]) {
    if let Ok(plan) = Plan::parse(text(bytes)) {
        assert_eq!(Plan::parse(&plan.text()).expect("what is written is read").text(), plan.text());
    }
}

/// A state file: first as it is, then as the body of a file with the right checksum.
pub(crate) fn state(bytes: &[u8]) {
    let _ = RenderState::parse(bytes);
    let whole = [b"flipmap state 2\n", &Sha256::digest(bytes)[..], bytes].concat();
    if let Ok(state) = RenderState::parse(&whole) {
        let _ = state.check_scene(&Document::default());
    }
}

/// A picture with a scene in it.
pub(crate) fn png(bytes: &[u8]) {
    let _ = document_in_png(Cursor::new(bytes));
}

/// An array or a picture to be compared.
pub(crate) fn result(bytes: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder for the file");
    for name in ["a.npy", "a.png"] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("room for the file");
        let [one, same] = [(); 2].map(|()| ResultRows::open(&path));
        let (Ok(one), Ok(same)) = (one, same) else { continue };
        let mut rows = 0;
        let compared = compare(one, same, (&Yardstick::Plain, 0.0), &mut |_| {
            rows += 1;
            Ok(())
        });
        if let Ok(comparison) = compared {
            assert_eq!(comparison.differing, 0, "it equals itself");
            assert!(rows > 0 && comparison.pixels > 0);
        }
    }
}

/// A part of a plan's samples.
pub(crate) fn part(bytes: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder for the file");
    let path = folder.path().join("rows-00000000-0000000-1.part");
    std::fs::write(path, bytes).expect("room for the file");
    // The digest in the part, with the form of the corpus's plan.
    let of = bytes.get(20..84).map(|of| String::from_utf8_lossy(of).into_owned());
    let form = PartForm::Rows { width: 16, rows: 16, channels: 1 };
    let forms: PartForms = of.into_iter().map(|of| (of, form)).collect();
    let _ = Parts::scan(folder.path(), forms).map(|parts| parts.damaged().len());
}

/// A gradient file; the first byte chooses its kind.
pub(crate) fn gradient(bytes: &[u8]) {
    let Some((kind, rest)) = bytes.split_first() else { return };
    let ending = ENDINGS[usize::from(*kind) % ENDINGS.len()];
    if let Ok(stops) = parse_file(ending, rest, None) {
        let written = list_text(&stops);
        let read = parse_list(&written).expect("what is written is read");
        assert_eq!(list_text(&read), written);
    }
}

/// The settings of the window.
pub(crate) fn settings(bytes: &[u8]) {
    #[cfg(feature = "window")]
    {
        use flipmap_window::folders::Folders;
        use flipmap_window::store::Store;
        let folder = tempfile::tempdir().expect("a folder for the file");
        let folders = Folders::under(folder.path());
        let config = folders.config.clone().expect("a folder of settings");
        std::fs::create_dir_all(&config).expect("a folder of settings");
        std::fs::write(config.join("settings.toml"), bytes).expect("room for the file");
        let mut store = Store::new(&folders);
        let settings = store.load().settings;
        store.save(&settings).expect("sound settings are saved");
        assert_eq!(store.load().settings, settings, "what is written is read");
    }
    #[cfg(not(feature = "window"))]
    let _ = bytes;
}

/// The measured profile of a machine.
pub(crate) fn profile(bytes: &[u8]) {
    if let Ok(profile) = serde_json::from_slice::<Profile>(bytes) {
        for (_, accuracy) in Accuracy::ALL {
            let _ = profile.fastest(accuracy, |_| true).and_then(|row| row.config());
        }
    }
}

/// The JSON file beside a frame, and the manifest of a film.
pub(crate) fn frame(bytes: &[u8]) {
    for name in ["000000.json", "manifest.json"] {
        let folder = tempfile::tempdir().expect("a folder for the file");
        std::fs::write(folder.path().join(name), bytes).expect("room for the file");
        let _ = Frames::check(folder.path());
    }
}
