//! Mistakes on the command line, each with its sentence.

use std::fs;

use crate::program::refused;
use crate::{error_of, flipmap, folder, render};

/// Arguments, their exit code, and the words that the error sentence must contain.
const MISTAKES: &[(&[&str], i32, &[&str])] = &[
    (&["--masses", "0,1"], 2, &["--masses", "1e-9"]),
    (&["--masses", "1"], 2, &["--masses", "two numbers"]),
    (&["--masses", "1,-1"], 2, &["--masses"]),
    (&["--masses", "nan,1"], 2, &["--masses"]),
    (&["--lengths", "inf,1"], 2, &["--lengths", "1e-9"]),
    (&["--lengths", "1,0"], 2, &["--lengths"]),
    (&["--gravity", "-9.81"], 2, &["--gravity", "it must be 0 or"]),
    (&["--gravity", "nan"], 2, &["--gravity"]),
    (
        &["--gravity", "0", "--plane", "speeds", "--ask", "state"],
        2,
        &["--gravity is '0'", "for this question and plane", "1e9 m/s²"],
    ),
    (&["--width", "0"], 2, &["--width", "between"]),
    (&["--width", "-1"], 2, &["--width"]),
    (&["--width", "inf"], 2, &["--width"]),
    (&["--budget", "0"], 2, &["--budget", "between"]),
    (&["--budget", "-3"], 2, &["--budget"]),
    (&["--budget", "inf"], 2, &["--budget"]),
    (&["--budget", "soon"], 2, &["--budget", "a number of seconds between 1e-9 and 1e6"]),
    (&["--step", "0"], 2, &["--step", "between 1e-9 and 1"]),
    (&["--step", "nan"], 2, &["--step"]),
    (&["--step", "1e-9", "--budget", "1e6"], 2, &["a longer step or a shorter budget"]),
    (&["--center", "1"], 2, &["--center", "comma"]),
    (&["--center", "1,x"], 2, &["--center", "decimal"]),
    (&["--rule", "third"], 2, &["--rule", "second, first, either"]),
    (&["--kind", "springs"], 2, &["--kind is 'springs'", "points, rods"]),
    (&["--palette", "rainbow"], 2, &["--palette", "iris"]),
    (&["--colours", "unflipped=black"], 2, &["--colours", "unflipped=#101018"]),
    (&["--colours", "sky=#000000"], 2, &["--colours", "unflipped, forbidden or curve"]),
    (&["--rotate", "1,5°"], 2, &["--rotate is '1,5°'", "a number of degrees"]),
    (&["--tolerance", "1,5"], 2, &["--tolerance is '1,5'", "with a point, as in 1.5"]),
    (&["--cycles", "1,5"], 2, &["--cycles is '1,5'", "with a point, as in 1.5"]),
    (
        &["--accuracy", "fast", "--step", "0.01"],
        2,
        &["--accuracy", "cannot be used with", "--step"],
    ),
    (&["--method", "leapfrog"], 2, &["--method", "rk4"]),
    (&["--precision", "f16"], 2, &["--precision", "f32, df32, f64, dd"]),
    (&["--samples", "9"], 2, &["--samples"]),
    (&["--threads", "0"], 2, &["--threads"]),
    (&["nowhere.toml"], 2, &["nowhere.toml"]),
    (&["elsewhere"], 2, &["elsewhere", "home"]),
    (&["--stretch", "0"], 2, &["--stretch"]),
    (&["--rotate", "nan"], 2, &["--rotate"]),
    (&["--adapter", "geforce"], 2, &["adapter", "engine cpu"]),
    (&["--accuracy", "perfect"], 2, &["--accuracy", "lesson, fast, balanced, exact"]),
    (&["--cells", "never", "--width", "1e-13"], 2, &["--cells is never", "f64"]),
    (&["--tolerance", "1e-16"], 2, &["--tolerance", "between 1e-15 and 1e-2"]),
    (&["--tolerance", "1e-12", "--precision", "f32"], 2, &["--tolerance", "1e-8"]),
    (&["--tolerance", "nan"], 2, &["--tolerance", "between"]),
    (&["--method", "rk4", "--tolerance", "1e-9"], 2, &["--tolerance is '1e-9'", "takes a step"]),
    (&["--method", "dop853", "--step", "0.01"], 2, &["--step is '0.01'", "by a tolerance"]),
    (&["--method", "taylor", "--precision", "f32"], 2, &["--precision", "f64, dd"]),
    (&["--precision", "df32"], 2, &["df32", "processor"]),
    (&["--trust", "t.png"], 2, &["--trust", "--verify"]),
    (&["--state", "s", "--verify"], 2, &["--state", "--verify"]),
    (&["--state", "s", "--samples", "2"], 2, &["--state", "--samples"]),
    (&["--ask", "state", "--rule", "either"], 2, &["--rule is 'either'", "only the question flip"]),
    (&["--exr", "map.png"], 2, &["-o", "--exr", "same file"]),
    (&["--ask", "why"], 2, &["--ask is 'why'", "flip, first, flips, state"]),
    (&["--plane", "flat"], 2, &["--plane is 'flat'", "section"]),
    (&["--plane", "omega1,omega1"], 2, &["--plane is 'omega1,omega1'", "two"]),
    (&["--count", "0"], 2, &["--count", "between 1 and 1000000"]),
    (&["--count", "2", "--ask", "growth"], 2, &["--count", "only the question flip"]),
    (&["--ask", "state", "--at", "31"], 2, &["--at", "within the budget"]),
    (&["--at", "3"], 2, &["--at", "flips, state, growth, return and speed"]),
    (&["--ask", "growth", "--at", "0"], 2, &["--at", "above 0"]),
    (&["--plane", "section", "--energy", "-40"], 2, &["--energy", "least", "-29.43 J"]),
    (&["--plane", "speeds", "--center", "1e9,0"], 2, &["--center", "coordinate", "1e6 rad/s"]),
    (&["--plane", "second", "--center", "0,1e9"], 2, &["--center", "1e6 rad/s"]),
    (&["--plane", "section", "--center", "0,1e9"], 2, &["--center", "1e6 kg m²/s"]),
    (&["--plane", "speeds", "--width", "1e9"], 2, &["--width", "1000 rad/s"]),
    (&["--width", "10deg", "--plane", "speeds"], 2, &["--width is '10deg'", "rad/s"]),
    (&["--center", "1,0.5pi", "--plane", "first"], 2, &["--center is '1,0.5pi'", "rad/s"]),
    (&["--plane", "speeds", "--origin", "1deg,0,1deg,0"], 2, &["--origin is '1deg,"]),
    (
        &["--plane", "speeds", "--ask", "flips", "--width", "1e-14"],
        2,
        &["--width is too small", "rad/s apart"],
    ),
    (&["--ask", "state", "--at", "3", "--budget", "2"], 2, &["--at is '3'", "between 0 and 2 s"]),
    (&["--plane", "section", "--origin", "0,0,1,1"], 2, &["--origin is '0,0,1,1'", "no origin"]),
    (&["--plane", "section", "--origin", "0,0,0,0"], 2, &["--origin is '0,0,0,0'", "no origin"]),
    (&["--ask", "state", "--times", "1,2"], 2, &["--times is for colours of times", "--ask flip"]),
    (&["--ask", "first", "--times", "view"], 2, &["--times is for colours of times"]),
    (&["--ask", "flips", "--scale", "log"], 2, &["--scale is for colours of times"]),
    (&["--ask", "state", "--relief", "0.5"], 2, &["--relief is for colours of times"]),
    (&["--ask", "growth", "--reverse"], 2, &["--reverse is for colours of times"]),
    (&["--plane", "speeds", "--budget", "auto"], 2, &["--budget is 'auto'", "released from rest"]),
    (&["--ask", "growth", "--budget", "auto"], 2, &["--budget is 'auto'", "1e-9 and 1e6"]),
    (&["--energy", "3"], 2, &["--energy is '3'", "use the plane section"]),
    (&["--friction", "-1,0"], 2, &["--friction", "between 0 and"]),
    (&["--origin", "1,2,3"], 2, &["--origin", "four numbers"]),
    (&["--rule", "secnod"], 2, &["--rule is 'secnod'", "did you mean 'second'?"]),
    (&["--kind", "rod"], 2, &["did you mean 'rods'?"]),
    (&["--ask", "grwoth"], 2, &["did you mean 'growth'?"]),
    (&["--plane", "sectoin"], 2, &["did you mean 'section'?"]),
    (&["--palette", "virids"], 2, &["did you mean 'viridis'?"]),
    (&["--accuracy", "exakt"], 2, &["--accuracy is 'exakt'", "did you mean 'exact'?"]),
    (&["--method", "dop835"], 2, &["--method is 'dop835'", "did you mean 'dop853'?"]),
    (&["--precision", "df23"], 2, &["--precision is 'df23'", "did you mean 'df32'?"]),
    (&["--light", "1,5°"], 2, &["--light is '1,5°'"]),
    (&["--scale", "liner"], 2, &["--scale is 'liner'", "did you mean 'linear'?"]),
    (&["--samples", "corner"], 2, &["--samples is 'corner'", "did you mean 'corners'?"]),
    (&["--cells", "alway"], 2, &["'alway'", "'always'"]),
];

#[test]
fn every_mistake_gets_a_sentence_a_code_and_leaves_files_alone() {
    let folder = folder();
    fs::write(folder.path().join("map.png"), "mine").unwrap();
    for (arguments, code, words) in MISTAKES {
        let output = render(&folder, &[*arguments, &["-o", "map.png"]].concat());
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(*code), "{arguments:?}: {error}");
        for word in *words {
            assert!(error.contains(word), "{arguments:?}: {error}");
        }
        assert_eq!(fs::read_to_string(folder.path().join("map.png")).unwrap(), "mine");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "a stray file was left");
}

#[test]
fn run_settings_of_files_are_refused_in_the_files_words() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("n.toml", "[run]\naccuracy = \"exac\"\n");
    let error = refused(&folder, 2, &["render", "n.toml", "-o", "a.png"]);
    assert!(error.contains("n.toml: in [run], `accuracy` is 'exac'"), "{error}");
    write("k.toml", "[[key]]\nsecs = 0\n[[key]]\nsecs = 1\n[key.scene.run]\nmethod = \"euler\"\n");
    let error = refused(&folder, 2, &["video", "k.toml", "-o", "f"]);
    assert!(error.contains("k.toml: key 2: in [run], `method` is 'euler'"), "{error}");
    for (text, says) in [
        ("plane = \"speeds\"", "it must be a table"),
        ("view = 3", "it must be a table"),
        ("[pendulum]\nkind = 3", "it must be a text in quotes"),
        ("[view]\ncenter = [1]", "it has 1 value, not 2"),
        ("[view]\ncenter = [\u{2212}2, 1]", "a minus sign is '-'"),
        ("[view]\ncenter = [.5, 1]", "a point must lie between digits"),
        ("[view]\nwidth = 1979-05-27", "it is a table or a date; it must be a number"),
    ] {
        write("w.toml", text);
        let error = refused(&folder, 2, &["render", "w.toml", "-o", "a.png"]);
        assert!(error.contains(says) && !error.contains("struct"), "{text}: {error}");
    }
}

#[test]
fn a_comma_in_place_of_a_point_is_named_wherever_numbers_are_read() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("w.toml", "[view]\nwidth = \"1,5\"\n");
    write("c.toml", "[view]\ncenter = [\"1,5\", \"2\"]\n");
    write("o.toml", "[plane]\norigin = [\"1,5\", \"0\", \"0\", \"0\"]\n");
    for words in [
        &["render", "w.toml", "-o", "a.png"][..],
        &["render", "c.toml", "-o", "a.png"],
        &["render", "o.toml", "-o", "a.png"],
        &["render", "flipmap:center=0,0;width=1,5", "-o", "a.png"],
        &["render", "flipmap:center=1,5,2,5;width=1", "-o", "a.png"],
        &["trace", "--start", "1,1", "--until", "1,5"],
        &["deeper", "--to", "1,5"],
        &["video", "--vary", "time=0..1,5", "-o", "f"],
        &["compare", "a.npy", "b.npy", "--tolerance", "1,5"],
        &["compare", "a.npy", "b.npy", "--share", "1,5"],
        &["report", "--hunt", "1,5"],
    ] {
        let error = error_of(&flipmap(&folder, words));
        assert!(error.contains("with a point, as in 1.5"), "{words:?}: {error}");
    }
}

#[test]
fn names_that_were_nearly_right_are_guessed_everywhere() {
    let folder = folder();
    fs::write(folder.path().join("p.toml"), "[plane]\nkind = \"anglse\"\n").unwrap();
    for (words, meant) in [
        (&["man", "rendr"][..], "render"),
        (&["video", "--vary", "massess=1,1..2,2", "-o", "f"], "masses"),
        (&["render", "p.toml", "-o", "a.png"], "angles"),
        (&["compare", "a.npy", "b.npy", "--ask", "flps"], "flips"),
    ] {
        let error = refused(&folder, 2, words);
        assert!(error.contains(&format!("did you mean '{meant}'?")), "{words:?}: {error}");
    }
}

#[test]
fn a_film_says_what_cannot_be_together() {
    let folder = folder();
    fs::write(folder.path().join("k.toml"), "[[key]]\nsecs = 0\n").unwrap();
    fs::write(folder.path().join("taken"), "mine").unwrap();
    for (words, why) in [
        (&["home", "filigree", "--vary", "time=0..2", "-o", "f"][..], "begin with one scene"),
        (&["home", "filigree", "--zoom-to", "deep", "-o", "f"], "begin with one scene"),
        (&["k.toml", "--vary", "time=0..2", "-o", "f"], "a file of keys says itself what changes"),
        (&["home", "filigree", "-o", "f", "--cache", "f"], "-o and --cache name the same file"),
        (&["home", "filigree", "-o", "f", "--cache", "./f"], "-o and --cache name the same file"),
        (&["home", "filigree", "-o", "dotted.folder"], "with / at the end if its name has a dot"),
        (&["home", "filigree", "-o", "taken"], "-o taken: a film is an .mp4"),
    ] {
        let error = refused(&folder, 2, &[&["video", "--size", "8x6"], words].concat());
        assert!(error.contains(why), "{words:?}: {error}");
    }
    let pasted = ["--vary", "gravity=1e\u{2212}1..2", "-o", "dotted.folder/", "--dry-run"];
    let said =
        flipmap(&folder, &[&["video", "--size", "8x6", "--engine", "cpu"], &pasted[..]].concat());
    assert!(said.status.success(), "{}", error_of(&said));
}

#[test]
fn films_in_which_nothing_changes_are_refused() {
    let folder = folder();
    for words in [
        &["home", "home"][..],
        &["filigree", "--zoom-to", "filigree"],
        &["--vary", "gravity=9.81..9.81"],
        &["--vary", "time=3..3"],
    ] {
        let error =
            refused(&folder, 2, &[&["video"], words, &["--size", "8x6", "-o", "f"]].concat());
        assert!(error.contains("nothing changes from the first key to the last"), "{error}");
    }
}
