//! Commands, panels, places and palettes, found by their names.

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::{Desktop, home, model, place, press, until};
use flipmap_scene::BuiltIn;
use flipmap_window::folders::Folders;

#[test]
fn commands_are_found_and_run_by_the_keyboard() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::COMMAND, Key::K);
    desktop.event(Event::Text("grid".to_string()));
    desktop.run_steps(2);
    assert!(desktop.query_by_label_contains("Grid of angles").is_some());
    assert!(desktop.query_by_label_contains("Zoom in").is_none());
    press(&mut desktop, Modifiers::NONE, Key::Enter);
    assert!(desktop.state().state.layers.grid && !desktop.state().state.shown.commands);
    // Once the list is closed, keys control the map again.
    press(&mut desktop, Modifiers::NONE, Key::G);
    assert!(!desktop.state().state.layers.grid);
}

/// Finds a command by a word, and runs it.
fn run(desktop: &mut Desktop, word: &str) {
    press(desktop, Modifiers::COMMAND, Key::K);
    desktop.event(Event::Text(word.to_string()));
    desktop.run_steps(2);
    press(desktop, Modifiers::NONE, Key::Enter);
    desktop.run_steps(20);
}

#[test]
fn panels_places_and_palettes_are_found_by_name() {
    let mut desktop = home();
    // Each panel with one of its controls, which is visible only while the panel is open.
    for (panel, control) in [
        ("› scene", "How chaotic is it?"),
        ("colours ›", "Equalise to this view"),
        ("› export", "Browse…"),
    ] {
        assert!(desktop.query_by_label(control).is_none(), "{panel}");
        run(&mut desktop, panel);
        assert!(desktop.query_by_label(control).is_some(), "{panel}");
    }
    run(&mut desktop, "magma");
    assert_eq!(desktop.state().state.picture.palette, "magma");
    run(&mut desktop, "threads");
    assert!(place(&desktop).contains("width=0.0"), "{}", place(&desktop));
    press(&mut desktop, Modifiers::NONE, Key::F9);
    assert!(!desktop.state().state.shown.side);
    press(&mut desktop, Modifiers::NONE, Key::F12);
    assert!(desktop.query_by_label("Measured").is_some(), "it shows itself");
}

#[test]
fn the_colours_of_a_view_survive_another_palette_undo_and_reset() {
    let tip = BuiltIn::named("tip").unwrap().document();
    let mut desktop = model(Folders::none(), Some(tip));
    let picture = |desktop: &Desktop| desktop.state().state.picture.clone();
    until(&mut desktop, "colours", |desktop| picture(desktop).of_view);
    let own = picture(&desktop);
    run(&mut desktop, "random");
    assert!(picture(&desktop).palette.starts_with("random-"));
    press(&mut desktop, Modifiers::COMMAND, Key::Z);
    until(&mut desktop, "the palette of before", |desktop| picture(desktop) == own);
    run(&mut desktop, "spread");
    until(&mut desktop, "the colours of before", |desktop| picture(desktop) == own);
}
