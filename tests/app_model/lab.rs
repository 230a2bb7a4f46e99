//! The laboratory in the window: its keys, its projector mode and its story.

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::{click, home, press};

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
fn the_story_is_told_from_the_first_figure_to_the_map() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::COMMAND, Key::K);
    desktop.event(Event::Text("story".to_string()));
    desktop.run_steps(2);
    press(&mut desktop, Modifiers::NONE, Key::Enter);
    assert_eq!(desktop.state().figure_shown(), Some("single"));
    click(&mut desktop, "Next");
    assert_eq!(desktop.state().figure_shown(), Some("ghost"));
    (0..5).for_each(|_| press(&mut desktop, Modifiers::NONE, Key::PageDown));
    desktop.get_by_label("Why is a third of the map free?");
    click(&mut desktop, "End the story");
    assert!(!desktop.state().lab.story && desktop.state().state.shown.lab);
}
