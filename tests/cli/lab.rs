//! `flipmap lab`: figures as pictures, films and data, and the lesson as a sheet.

use std::fs;

use super::folder;
use super::program::{error_of, flipmap};

#[test]
fn figures_of_the_lesson_are_data_and_a_wrong_name_lists_them() {
    let folder = folder();
    let told = |arguments: &[&str]| flipmap(&folder, &[&["lab"], arguments].concat());
    let output = told(&["triple", "--csv", "a.csv"]);
    assert_eq!(output.status.code(), Some(2));
    let error = error_of(&output);
    assert!(error.contains("no figure called 'triple'") && error.contains("machine, integrators"));
    for bad in [&["ghost"][..], &["ghost", "--at", "-1", "--csv", "-"], &["ghost", "--size", "9x9"]]
    {
        assert_eq!(told(bad).status.code(), Some(2), "{bad:?}");
    }
    let output = told(&["twenty", "--at", "12", "--csv", "-"]);
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let separation = |line: &str| line.split(',').nth(1).unwrap().parse::<f64>().unwrap();
    let all: Vec<f64> = text.lines().skip(1).map(separation).collect();
    assert!(all.len() > 400 && all[0] < 1e-5 && all[all.len() - 1] > 1e-2, "{all:?}");
}

#[test]
fn a_sheet_is_a_page_and_nothing_else() {
    let folder = folder();
    for (bad, words) in [
        (&["lab", "sheet"][..], "give -o SHEET.html"),
        (&["lab", "sheet", "--csv", "a.csv"], "give -o SHEET.html"),
        (&["lab", "sheet", "-o", "a.html", "--at", "3"], "no --csv, --at, --fps or --size"),
        (&["lab", "map", "--csv", "a.csv", "--at", "3"], "--at: the map stands still"),
        (&["lab", "double", "-o", "a.png", "--fps", "30"], "--fps: only films have frames"),
        (&["lab", "double", "-o", "a.webp", "--fps", "0"], "--fps is '0'; it must lie"),
        (&["lab", "double", "-o", "a.gif", "--fps", "60"], "--fps is '60'; it must lie"),
        (&["lab", "sheet", "-o", "a.png"], ".html"),
    ] {
        let output = flipmap(&folder, bad);
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(error_of(&output).contains(words), "{}", error_of(&output));
    }
}

#[test]
fn a_line_sets_up_a_figure() {
    let folder = folder();
    let line = "flipmap:lab=twenty;count=2;nudge=1e-3";
    let output = flipmap(&folder, &["lab", line, "--at", "1", "--csv", "-"]);
    assert!(output.status.success(), "{}", error_of(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let first: f64 = text.lines().nth(1).unwrap().split_once(',').unwrap().1.parse().unwrap();
    assert!((first / 1e-3 - 1.0).abs() < 0.1, "{first}");
    let output = flipmap(&folder, &["lab", "flipmap:lab=twenty;nudge=2", "--csv", "-"]);
    assert_eq!(output.status.code(), Some(2));
    let error = error_of(&output);
    assert!(error.contains("nudge is '2'; it must be one number between"), "{error}");
}

#[test]
fn a_wrong_set_up_opens_no_window() {
    let folder = folder();
    let output = flipmap(&folder, &["explore", "flipmap:lab=double;masses=1"]);
    assert_eq!(output.status.code(), Some(2));
    let error = error_of(&output);
    assert!(error.contains("masses is '1'; it must be two numbers"), "{error}");
}

needs_adapter! {
    lesson:
    the_lesson_is_printed_with_its_figures_and_the_answers_last
}

mod lesson {
    use super::*;

    pub(crate) fn the_lesson_is_printed_with_its_figures_and_the_answers_last() {
        let folder = folder();
        let output = flipmap(&folder, &["lab", "sheet", "-o", "lesson.html"]);
        assert!(output.status.success(), "{}", error_of(&output));
        let page = fs::read_to_string(folder.path().join("lesson.html")).unwrap();
        assert_eq!(page.matches("src=\"data:image/png;base64,iVBOR").count(), 7);
        let (questions, answers) = page.split_once("<h2>Answers</h2>").unwrap();
        assert_eq!(questions.matches("<div>Because</div>").count(), 19);
        let why = "The mass stands on both sides of the equation";
        assert!(!questions.contains(why) && answers.contains(why));
    }
}

#[test]
#[cfg_attr(
    any(no_gpu, no_ffmpeg),
    ignore = "FLIPMAP_NO_GPU=1 or FLIPMAP_NO_FFMPEG=1 declares what is absent"
)]
fn a_figure_moves_in_a_film_and_the_map_does_not() {
    let folder = folder();
    let small = ["--size", "320x320", "-o", "a.gif"];
    let output = flipmap(&folder, &[&["lab", "double", "--at", "0.2"][..], &small].concat());
    assert!(output.status.success(), "{}", error_of(&output));
    let bytes = fs::read(folder.path().join("a.gif")).unwrap();
    assert!(bytes.starts_with(b"GIF89a") && bytes.len() > 10_000, "{}", bytes.len());
    let webp = ["lab", "double", "--at", "0.1", "--size", "320x320", "-o", "a.webp"];
    let frames = |more: &[&str]| {
        let output = flipmap(&folder, &[&webp[..], more].concat());
        assert!(output.status.success(), "{}", error_of(&output));
        let bytes = fs::read(folder.path().join("a.webp")).unwrap();
        bytes.windows(4).filter(|tag| tag == b"ANMF").count()
    };
    assert_eq!(frames(&[]), 0, "a picture");
    assert_eq!(frames(&["--fps", "20"]), 3);
    let output = flipmap(&folder, &[&["lab", "map"][..], &small].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(error_of(&output).contains("the map stands still"), "{}", error_of(&output));
}
