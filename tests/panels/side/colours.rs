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

#[test]
fn a_gradient_is_made_of_stops_that_come_and_go() {
    let mut harness = colours(PictureTable::default());
    press(&mut harness, "Edit a copy of the palette");
    let stops = |harness: &Harness<'static, Shown<PictureTable, ColourAction>>| {
        let palette = harness.state().state.palette.clone();
        palette.split(',').map(str::to_string).collect::<Vec<_>>()
    };
    assert_eq!(stops(&harness).len(), 7);
    harness.get_by_role_and_label(Role::ColorWell, "Stop 7");
    press(&mut harness, "Remove stop 2");
    assert_eq!(stops(&harness).len(), 6);
    harness.state_mut().state.palette = "#000000,#ffffff".to_string();
    harness.run_steps(2);
    press(&mut harness, "Remove stop 1");
    assert_eq!(stops(&harness).len(), 2, "there are always two");
    press(&mut harness, "Add after stop 1");
    assert_eq!(stops(&harness), ["#000000", "#7f7f7f", "#ffffff"]);
    press(&mut harness, "iris");
    assert!(harness.query_by_label("Stop 1").is_none());
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
