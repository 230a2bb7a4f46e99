//! Colours in the side panel: repeats, light, gradients, the legend, and the ground.

use super::*;

#[test]
fn repeats_and_light_follow_the_sliders() {
    let mut harness = colours(PictureTable::default());
    press(&mut harness, "romao");
    type_over(&mut harness, "Cycles", "2");
    assert!(!harness.state().state.mirror, "it ends as it begins");
    press(&mut harness, "Mirrored");
    type_over(&mut harness, "Offset", "0.25");
    type_over(&mut harness, "Relief", "0.5");
    type_over(&mut harness, "Light from", "90");
    let picture = &harness.state().state;
    assert!(picture.mirror);
    assert_eq!((picture.offset, picture.relief, picture.light), (0.25, 0.5, 90.0));
    press(&mut harness, "Cycle colours");
    let runs = ColourCycle { runs: true, ..ColourCycle::default() };
    assert_eq!(harness.state().asked.last(), Some(&ColourAction::Cycle(runs)));
}

type Panel = Harness<'static, Shown<PictureTable, ColourAction>>;

fn stops(harness: &Panel) -> Vec<String> {
    let palette = harness.state().state.palette.clone();
    palette.split(',').map(str::to_string).collect()
}

#[test]
fn a_gradient_is_made_of_stops_that_come_and_go() {
    let mut harness = colours(PictureTable::default());
    press(&mut harness, "Edit a copy of the palette");
    assert_eq!(stops(&harness).len(), 7);
    harness.get_by_role_and_label(Role::ColorWell, "Stop 1");
    press(&mut harness, "Remove");
    assert_eq!(stops(&harness).len(), 6);
    harness.state_mut().state.palette = "#000000,#ffffff".to_string();
    harness.run_steps(2);
    assert!(harness.get_by_label("Remove").accesskit_node().is_disabled(), "there are always two");
    press(&mut harness, "Add");
    assert_eq!(stops(&harness), ["#000000", "#808080", "#ffffff"]);
    press(&mut harness, "iris");
    assert!(harness.query_by_label("Stop 1").is_none());
}

#[test]
fn stops_are_dragged_and_moved_by_keys() {
    let palette = "#000000,#ff0000,#ffffff".to_string();
    let mut harness = colours(PictureTable { palette, ..PictureTable::default() });
    let handle = harness.get_by_label("Stop 2 of 3 at 50.0 %").rect();
    let width = harness.get_by_label_contains("Gradient: a click").rect().width();
    let to = handle.center() + egui::vec2(0.25 * width, 0.0);
    harness.drag_at(handle.center());
    harness.run_steps(2);
    harness.hover_at(to);
    harness.run_steps(2);
    harness.drop_at(to);
    harness.run_steps(2);
    assert_eq!(stops(&harness), ["#000000 0%", "#ff0000 75%", "#ffffff 100%"]);
    harness.get_by_label("Stop 2 of 3 at 75.0 %").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowLeft);
    harness.run_steps(2);
    assert_eq!(stops(&harness)[1], "#ff0000 74%");
    harness.key_press(Key::Delete);
    harness.run_steps(2);
    assert_eq!(stops(&harness), ["#000000", "#ffffff"]);
}

#[test]
fn a_click_on_the_gradient_adds_a_stop_and_the_wheel_shifts_it() {
    let mut harness =
        colours(PictureTable { palette: "#000,#fff".into(), ..PictureTable::default() });
    let strip = harness.get_by_label_contains("Gradient: a click").rect();
    harness.hover_at(strip.center());
    harness.run_steps(2);
    let scroll = egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 75.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    };
    harness.event(scroll);
    harness.run_steps(30);
    let offset = harness.state().state.offset;
    assert!((offset - 0.05).abs() < 0.01, "{offset}");
    harness.drag_at(strip.center());
    harness.drop_at(strip.center());
    harness.run_steps(2);
    assert_eq!(stops(&harness), ["#000000", "#808080", "#ffffff"]);
}

#[test]
fn a_palette_is_kept_under_a_name() {
    let mut harness =
        colours(PictureTable { palette: "#000000,#00ff00".into(), ..PictureTable::default() });
    let save = |harness: &Panel| harness.get_by_label("Save").accesskit_node().is_disabled();
    assert!(save(&harness), "it has no name yet");
    for (name, taken) in [("iris", true), ("fire", true), ("moss", false)] {
        type_into(&mut harness, (Role::TextInput, "Save as"), name);
        assert_eq!(save(&harness), taken, "{name}");
    }
    press(&mut harness, "Save");
    assert_eq!(harness.state().asked.last(), Some(&ColourAction::KeepPalette("moss".into())));
    press(&mut harness, "fire");
    assert_eq!(harness.state().state.palette, "#000000,#ff0000");
    press(&mut harness, "Remove fire from the list");
    assert_eq!(harness.state().asked.last(), Some(&ColourAction::ForgetPalette("fire".into())));
}

#[test]
fn the_legend_is_told_in_words() {
    let picture = PictureTable { times: vec![0.5, 2.0, 20.0], ..PictureTable::default() };
    let harness = colours(picture);
    harness.get_by_label("Legend: iris from 0.5 s to 20 s");
    harness.get_by_label("Stretched over 2 intervals of time");
    harness.get_by_label("not within the budget");
}

#[test]
fn colours_beside_the_palette_are_picked() {
    let mut harness = colours(PictureTable::default());
    for name in ["Unflipped", "Forbidden", "Curve"] {
        harness.get_by_role_and_label(Role::ColorWell, name);
    }
    harness.state_mut().state.colours.curve = Some("#ff0000".to_string());
    harness.run_steps(2);
    press(&mut harness, "Reset");
    assert_eq!(harness.state().state, PictureTable::default());
}
