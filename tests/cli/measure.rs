//! `flipmap measure`: numbers with intervals, kept samples, and refusals.

use crate::program::*;

const SMALL: [&str; 7] = ["measure", "--engine", "cpu", "--budget", "2", "--samples", "1600"];

fn small(more: &[&'static str]) -> Vec<&'static str> {
    [&SMALL[..], more].concat()
}

#[test]
fn a_table_and_json_tell_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let text = done(&folder, &small(&["--of", "areas"]));
    let told = text.lines().find(|line| line.contains("forbidden")).unwrap();
    assert!(told.contains("0.30643"), "{text}");
    let json = done(&folder, &small(&["--of", "areas,areas", "--json"]));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let share = json["areas"]["classes"][2][1]["value"].as_f64().unwrap();
    assert!((share - 0.30643564).abs() < 1e-7 && json["edges"].is_null(), "{json}");
}

#[test]
fn a_folder_keeps_samples_for_more_statistics() {
    let folder = tempfile::tempdir().unwrap();
    done(&folder, &small(&["--of", "areas", "-o", "found"]));
    let kept = || std::fs::read_dir(folder.path().join("found/samples")).unwrap().count();
    assert_eq!(kept(), 16);
    // The same starts again, and nothing to compute.
    done(&folder, &small(&["--of", "areas,survival", "-o", "found"]));
    assert_eq!(kept(), 16);
    for name in ["measure.json", "measure.html", "survival.csv", "survival.svg"] {
        assert!(folder.path().join("found").join(name).is_file(), "{name}");
    }
    done(&folder, &small(&["--of", "areas", "--seed", "2", "-o", "found"]));
    assert_eq!(kept(), 32);
}

#[test]
fn what_cannot_be_measured_is_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let refusal = |code, more: &[&'static str]| refused(&folder, code, &small(more));
    assert!(
        refusal(2, &["--ask", "speed", "--of", "edges"]).contains("needs a question with classes")
    );
    assert!(refusal(2, &["--of", "wada"]).contains("three classes"));
    assert!(refusal(2, &["--of", "colours"]).contains("colours"));
    let few = flipmap(&folder, &["measure", "--samples", "10"]);
    assert!(few.status.code() == Some(2) && error_of(&few).contains("1600"), "{few:?}");
    assert!(refusal(2, &["--apart", "soon"]).contains("--apart"));
    assert!(refusal(2, &["--width", "1e-13"]).contains("--width"));
    let still = ["--center", "0.1,0.1", "--width", "0.01", "--of", "edges"];
    assert!(refusal(1, &still).contains("same class"));
    std::fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    assert!(refusal(1, &["--of", "areas", "-o", "."]).contains("it holds files"));
    assert!(refusal(1, &["--of", "areas", "-o", "notes.txt"]).contains("notes.txt"));
}
