//! The examples run, write what they promise and stay short.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Each example with some of the words that it prints, and the file that it writes.
const EXAMPLES: [(&str, &str, &str); 5] = [
    ("map_to_array", "pixels flip within the budget", "map.npy"),
    ("one_pendulum", "the second bob flips after", ""),
    ("custom_palette", "wrote rainbow.png", "rainbow.png"),
    ("custom_integrator", "Bogacki-Shampine: 64 of 64 right", ""),
    ("compare_arrays", "of 2304 pixels of the lesson's map are wrong", ""),
];

#[test]
fn every_example_does_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    // The folder of the test binaries lies beside the folder of the examples.
    let tests = std::env::current_exe().unwrap();
    let examples = tests.ancestors().nth(2).unwrap().join("examples");
    for (name, told, file) in EXAMPLES {
        let output = Command::new(examples.join(name)).current_dir(&folder).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(text.contains(told), "{name}: {text}");
        assert!(folder.path().join(file).exists(), "{name} wrote no {file}");
    }
    let picture = image::open(folder.path().join("rainbow.png")).unwrap().into_rgb8();
    let colours: std::collections::HashSet<_> = picture.pixels().collect();
    assert!(colours.len() > 100, "{} colours", colours.len());
}

#[test]
fn examples_are_short_and_all_here() {
    let mut names: Vec<String> = fs::read_dir("examples")
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .inspect(|path| {
            let lines = fs::read_to_string(path).unwrap().lines().count();
            assert!(lines < 60, "{} has {lines} lines", path.display());
        })
        .map(|path| Path::new(path.file_stem().unwrap()).display().to_string())
        .collect();
    let mut known = EXAMPLES.map(|(name, ..)| name.to_string());
    names.sort();
    known.sort();
    assert_eq!(names, known);
}
