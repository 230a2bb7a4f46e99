//! The laboratory in the window: its keys, its projector mode and its lesson.

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::{AppModel, Arc, Folders, WindowOptions, click, home, options, press};

#[test]
fn keys_pause_slow_and_project_the_figure_and_leave_the_map_alone() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::NONE, Key::P);
    let playing = desktop.state().state.pins.clock().is_playing();
    press(&mut desktop, Modifiers::NONE, Key::F4);
    press(&mut desktop, Modifiers::NONE, Key::Space);
    press(&mut desktop, Modifiers::NONE, Key::Comma);
    let lab = &desktop.state().lab;
    assert!(lab.playing.paused && lab.playing.speed == 0.5);
    let clock = desktop.state().state.pins.clock();
    assert_eq!(clock.is_playing(), playing, "the hidden pin is left alone");
    press(&mut desktop, Modifiers::NONE, Key::F10);
    let scale = desktop.state().ui_scale();
    assert!((scale - 1.6).abs() < 1e-6 && desktop.query_by_label("Mass m1").is_none());
    press(&mut desktop, Modifiers::NONE, Key::Escape);
    assert_eq!(desktop.state().figure_shown(), Some("double"), "Escape leaves the projector first");
    assert_eq!(desktop.state().ui_scale(), 1.0);
    press(&mut desktop, Modifiers::NONE, Key::Escape);
    assert_eq!(desktop.state().figure_shown(), None);
}

#[test]
fn the_lesson_is_given_from_the_first_figure_to_the_map() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::COMMAND, Key::K);
    desktop.event(Event::Text("seven".to_string()));
    desktop.run_steps(2);
    press(&mut desktop, Modifiers::NONE, Key::Enter);
    assert_eq!(desktop.state().figure_shown(), Some("single"));
    press(&mut desktop, Modifiers::NONE, Key::Space);
    assert!(desktop.state().lab.playing.paused, "nothing moves before the class has committed");
    click(&mut desktop, "A  It takes longer.");
    assert!(!desktop.state().lab.playing.paused && desktop.query_by_label("Reveal").is_some());
    press(&mut desktop, Modifiers::NONE, Key::Space);
    desktop.get_by_label_contains("Not so. Gravity pulls four times as hard");
    assert!(!desktop.state().lab.playing.paused, "the first Space reveals");
    press(&mut desktop, Modifiers::NONE, Key::Space);
    assert!(desktop.state().lab.playing.paused, "the next one pauses");
    (0..6).for_each(|_| press(&mut desktop, Modifiers::NONE, Key::PageDown));
    desktop.get_by_label(
        "For which part of all starts does energy alone forbid the second bob to flip?",
    );
    click(&mut desktop, "C  About a third.");
    press(&mut desktop, Modifiers::NONE, Key::Space);
    desktop.get_by_label_contains("Right. To flip");
    click(&mut desktop, "End the lesson");
    assert!(!desktop.state().lab.lesson.is_on && desktop.state().state.shown.lab);
}

#[test]
fn a_pasted_set_up_opens_its_figure_and_a_wrong_one_says_why() {
    let mut desktop = home();
    desktop.event(Event::Paste("flipmap:lab=double;start=2.2,2.5;masses=1,3\n".to_string()));
    desktop.run_steps(2);
    assert_eq!(desktop.state().figure_shown(), Some("double"));
    assert_eq!(desktop.state().lab.set()[..4], [2.2, 2.5, 1.0, 3.0]);
    desktop.event(Event::Paste("flipmap:lab=double;masses=1,-3".to_string()));
    desktop.run_steps(2);
    desktop.run_steps(2);
    desktop.get_by_label_contains("masses is '1,-3'; it must be two numbers between");
    assert_eq!(desktop.state().lab.set()[..4], [2.2, 2.5, 1.0, 3.0], "nothing is lost");
    click(&mut desktop, "Copy set-up");
    desktop.run_steps(2);
    desktop.get_by_label_contains("The set-up was copied");
}

#[test]
fn a_window_opens_with_a_set_up() {
    let set_up = Some("flipmap:lab=twenty;count=5".to_string());
    let options = WindowOptions { set_up, ..options(Folders::none(), None) };
    let model = AppModel::new(&options, Arc::new(|| ()));
    assert_eq!(model.figure_shown(), Some("twenty"));
    assert_eq!(model.lab.set()[2], 5.0);
}
