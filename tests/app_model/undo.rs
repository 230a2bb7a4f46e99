//! One history for all that is shown, pins among it.

use egui::{Key, Modifiers};
use flipmap_window::action::{Action, Look};
use glam::DVec2;

use super::*;

/// Lets more time pass than changes of one step have between them.
fn pause(desktop: &mut Desktop) {
    let from_secs = desktop.state().state.now_secs;
    while desktop.state().state.now_secs < from_secs + 1.5 {
        desktop.step();
    }
}

fn act(desktop: &mut Desktop, action: Action) {
    desktop.state_mut().act(vec![action]);
    desktop.run_steps(2);
    pause(desktop);
}

fn pins(desktop: &Desktop) -> usize {
    desktop.state().state.pins.iter().len()
}

#[test]
fn pins_are_undone_and_redone_and_come_back_onto_their_plane() {
    let mut desktop = home();
    settle(&mut desktop);
    let undo = |desktop: &mut Desktop| press(desktop, Modifiers::COMMAND, Key::Z);
    act(&mut desktop, Action::Pin(DVec2::new(200.0, 150.0)));
    act(&mut desktop, Action::Pin(DVec2::new(260.0, 180.0)));
    let start = desktop.state().state.pins.selected().unwrap().start;
    assert_eq!(pins(&desktop), 2);
    undo(&mut desktop);
    assert_eq!(pins(&desktop), 1);
    undo(&mut desktop);
    assert_eq!(pins(&desktop), 0);
    let redo = Modifiers::COMMAND | Modifiers::SHIFT;
    press(&mut desktop, redo, Key::Z);
    press(&mut desktop, redo, Key::Z);
    assert_eq!(pins(&desktop), 2);
    assert_eq!(desktop.state().state.pins.iter().last().unwrap().start, start);

    let mut scene = desktop.state().state.scene();
    scene.plane.kind = "speeds".parse().unwrap();
    act(&mut desktop, Action::Scene(Box::new(scene)));
    let places = |desktop: &Desktop| {
        desktop.state().state.pins.iter().filter(|pin| pin.start.place.is_some()).count()
    };
    assert_eq!((pins(&desktop), places(&desktop)), (2, 0), "off the map");
    undo(&mut desktop);
    assert_eq!((pins(&desktop), places(&desktop)), (2, 2), "and on it again");
}

#[test]
fn a_double_click_pins_nothing_and_is_one_step() {
    let mut desktop = home();
    settle(&mut desktop);
    let about = DVec2::new(200.0, 150.0);
    desktop.state_mut().act(vec![Action::Pin(about)]);
    desktop.run_steps(3);
    assert_eq!(pins(&desktop), 1);
    let zoom = Look::Zoom { factor: 2.0, about };
    desktop.state_mut().act(vec![Action::Unpin, Action::Look(zoom)]);
    settle(&mut desktop);
    pause(&mut desktop);
    press(&mut desktop, Modifiers::COMMAND, Key::Z);
    settle(&mut desktop);
    assert_eq!(pins(&desktop), 0, "no step holds the pin that the second click took back");
    let home = desktop.state().state.camera;
    press(&mut desktop, Modifiers::COMMAND, Key::Z);
    settle(&mut desktop);
    assert_eq!(desktop.state().state.camera, home, "there is nothing else to go back to");
}
