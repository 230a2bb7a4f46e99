//! Ways of looking at the map: turned, typed, by a clock, and with a pendulum at the pointer.

use egui::{PointerButton, Pos2, pos2};

use super::*;

fn move_to(desktop: &mut Desktop, at: Pos2) {
    desktop.event(Event::PointerMoved(at));
    desktop.step();
}

fn button(desktop: &mut Desktop, at: Pos2, button: PointerButton, pressed: bool, alt: bool) {
    let modifiers = Modifiers { alt, ..Modifiers::NONE };
    desktop
        .event_modifiers(Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
    desktop.step();
}

#[test]
fn the_map_is_played_paused_scrubbed_and_shown_whole_again() {
    let mut desktop = home();
    let simulated = counts(&desktop).simulated;
    let clock = |desktop: &Desktop| desktop.state().state.shown.timeline;
    assert_eq!(clock(&desktop), None);
    press(&mut desktop, Modifiers::NONE, Key::M);
    until(&mut desktop, "the clock to run", |desktop| {
        clock(desktop).is_some_and(|clock| clock.time_secs() > 0.1)
    });
    assert!(desktop.query_all_by_label("Flipped by").count() > 0);
    // Skips the first frames, in which the clock shows a round number.
    desktop.run_steps(7);
    press(&mut desktop, Modifiers::NONE, Key::Space);
    desktop.run_steps(3);
    assert!(!clock(&desktop).unwrap().is_playing());
    let at_secs = clock(&desktop).unwrap().time_secs();
    assert!(desktop.state().state.shown_until_secs() == at_secs && at_secs < 30.0);
    click(&mut desktop, "Play");
    assert!(clock(&desktop).unwrap().is_playing());
    desktop.run_steps(7);
    press(&mut desktop, Modifiers::NONE, Key::M);
    assert_eq!(clock(&desktop), None, "the key that opens it closes it");
    press(&mut desktop, Modifiers::NONE, Key::M);
    desktop.run_steps(7);
    click(&mut desktop, "Close");
    assert_eq!(clock(&desktop), None);
    assert_eq!(desktop.state().state.shown_until_secs(), 30.0);
    assert_eq!(counts(&desktop).simulated, simulated, "nothing is computed for it");
}

#[test]
fn other_answers_than_times_have_no_clock() {
    let mut document = Document::default();
    document.question.ask = "growth".parse().unwrap();
    document.question.budget = flipmap_scene::Budget::secs(2.0);
    let mut options = options(Folders::none(), Some(document));
    options.run = Some(RunTable { accuracy: Some("balanced".into()), ..RunTable::default() });
    let mut desktop = model_of(&options);
    press(&mut desktop, Modifiers::NONE, Key::M);
    assert_eq!(desktop.state().state.shown.timeline, None);
    assert!(notices(&desktop).contains("Only flip times can be played"));
}

#[test]
fn alt_and_a_drag_turn_the_map_and_the_right_button_does_too() {
    for (which, alt) in [(PointerButton::Primary, true), (PointerButton::Secondary, false)] {
        let mut desktop = home();
        let before = desktop.state().state.camera;
        // The canvas is left of the side panel; its middle is near (205, 210).
        let (from, to) = (pos2(300.0, 210.0), pos2(205.0, 90.0));
        move_to(&mut desktop, from);
        button(&mut desktop, from, which, true, alt);
        for share in [0.25, 0.5, 0.75, 1.0] {
            let at = from + (to - from) * share;
            let modifiers = Modifiers { alt, ..Modifiers::NONE };
            desktop.event_modifiers(Event::PointerMoved(at), modifiers);
            desktop.step();
        }
        button(&mut desktop, to, which, false, alt);
        let after = desktop.state().state.camera;
        assert!((60.0..120.0).contains(&-after.rotate_deg), "{} {which:?}", after.rotate_deg);
        assert_eq!(after.center, before.center, "the middle stays");
        assert!(!desktop.state().state.dragging);
        press(&mut desktop, Modifiers::NONE, Key::Num0);
        until(&mut desktop, "the whole map", |desktop| {
            let state = &desktop.state().state;
            state.moving.is_none() && state.camera.rotate_deg == 0.0
        });
    }
}

#[test]
fn a_view_is_typed_in_degrees_and_gone_to() {
    let mut desktop = home();
    until(&mut desktop, "the panel", |desktop| desktop.query_by_label("Turn, degrees").is_some());
    type_over(&mut desktop, Role::TextInput, "Turn, degrees", "x30");
    assert!(desktop.query_by_label_contains("which is not a number").is_some());
    // The Return key also starts the move.
    for (name, text) in [("Turn, degrees", "30"), ("θ1, rad", "90deg"), ("Width, rad", "0.25")] {
        type_over(&mut desktop, Role::TextInput, name, text);
        until(&mut desktop, "the move", |desktop| desktop.state().state.moving.is_none());
    }
    assert!(desktop.query_by_label("Go there").is_none(), "nothing is left to go to");
    let camera = desktop.state().state.camera;
    assert_eq!((camera.rotate_deg, camera.width_rad), (30.0, 0.25));
    assert!((camera.center[0].to_f64() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
}

#[test]
fn a_pendulum_swings_where_the_pointer_rests_and_the_window_comes_to_rest() {
    let mut desktop = home();
    move_to(&mut desktop, pos2(120.0, 200.0));
    let wants =
        |desktop: &Desktop| desktop.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    desktop.step();
    assert!(wants(&desktop) < Duration::from_secs(1), "it is about to be let go");
    for _ in 0..(15 * 60) {
        desktop.step();
    }
    assert_eq!(wants(&desktop), Duration::MAX, "nothing moves any more");
    press(&mut desktop, Modifiers::NONE, Key::H);
    move_to(&mut desktop, pos2(130.0, 200.0));
    desktop.run_steps(2);
    assert_eq!(wants(&desktop), Duration::MAX, "it is switched off");
}
