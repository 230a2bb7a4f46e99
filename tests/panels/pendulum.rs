//! The pendulum panel: its appearance, and its use by control names and keyboard.

use std::time::{Duration, Instant};

use egui::{Key, Role, Theme};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use flipmap_engine::Trust;
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::{Kind, PendulumSpec, Scene};
use flipmap_screen::pin_start::PinStart;
use flipmap_window::panels::pendulum::{FRAME, pendulum_card};
use flipmap_window::pins::{PinAction, PinId, Pins};

/// The panel's state, and all actions it has requested so far.
struct Shown {
    pins: Pins,
    asked: Vec<PinAction>,
}

/// Pins at the given starts, integrated to their ends and paused at their releases.
fn flown(scene: &Scene, starts: &[[f64; 2]]) -> (Pins, Vec<PinId>) {
    let mut pins = Pins::new(scene);
    let pixel = Exact::from_f64(1e-3);
    let ids: Vec<PinId> = starts
        .iter()
        .map(|start| start.map(Exact::from_f64))
        .map(|start| PinStart::at_rest([start, [start[0] + pixel, start[1]]]))
        .map(|start| pins.add(start, None, || ()).unwrap())
        .collect();
    let begun = Instant::now();
    while pins.iter().any(|pin| pin.flight.record().ending.is_none()) {
        assert!(begun.elapsed() < Duration::from_secs(60), "the flights never end");
        pins.advance(0.0);
        std::thread::sleep(Duration::from_millis(1));
    }
    pins.apply(PinAction::Pause);
    pins.apply(PinAction::Scrub(0.0));
    (pins, ids)
}

/// The card in a column of fixed size with its numbers open, without a running clock.
fn harness(pins: Pins, theme: Theme) -> Harness<'static, Shown> {
    let show = |ui: &mut egui::Ui, shown: &mut Shown| {
        let actions = pendulum_card(ui, &shown.pins, &|_| None);
        actions.iter().for_each(|&action| shown.pins.apply(action));
        shown.asked.extend(actions);
    };
    let mut harness = Harness::builder()
        .with_context_setup(flipmap_lab::typeface::install)
        .with_size([340.0, 770.0])
        .with_theme(theme)
        .build_ui_state(show, Shown { pins, asked: Vec::new() });
    harness.run_steps(3);
    harness.get_by_label("Numbers").click();
    // They take a moment to unfold.
    harness.run_steps(20);
    harness
}

/// The panel with two pins, of which the first is shown, and no recorded actions.
fn two() -> (Harness<'static, Shown>, [PinId; 2]) {
    let (mut pins, ids) = flown(&Scene::default(), &[[2.2, 1.4], [3.0, 3.0]]);
    pins.apply(PinAction::Select(ids[0]));
    (harness(pins, Theme::Dark), [ids[0], ids[1]])
}

/// Takes the actions that were requested since the last call.
fn asked(harness: &mut Harness<'static, Shown>) -> Vec<PinAction> {
    std::mem::take(&mut harness.state_mut().asked)
}

#[test]
fn buttons_do_what_their_names_say() {
    let (mut harness, [a, b]) = two();
    for (name, action) in [
        ("Play", PinAction::Play),
        ("Pause", PinAction::Pause),
        ("Restart", PinAction::Restart),
        ("Pin B", PinAction::Select(b)),
        ("Pin A", PinAction::Select(a)),
        ("Remove", PinAction::Remove(a)),
    ] {
        harness.get_by_role_and_label(Role::Button, name).click();
        harness.run_steps(2);
        assert_eq!(asked(&mut harness), [action], "{name}");
    }
    assert!(harness.query_by_label("Pin A").is_none(), "it is gone");
    assert!(harness.get_by_label("Pin B").accesskit_node().toggled().is_some(), "now shown");
    harness.get_by_label("Remove").click();
    harness.run_steps(2);
    assert_eq!(asked(&mut harness), [PinAction::Remove(b)]);
    assert!(harness.query_by_label("Play").is_none(), "nothing is left to play");
}

#[test]
fn a_flip_is_drawn_in_any_size() {
    let (mut pins, _) = flown(&Scene::default(), &[[3.0, 3.0]]);
    pins.apply(PinAction::Scrub(10.0));
    let mut harness = harness(pins, Theme::Dark);
    for size in [[340.0, 704.0], [340.0, 90.0], [60.0, 60.0], [12.0, 12.0], [1.0, 1.0]] {
        harness.set_size(size.into());
        harness.run_steps(3);
    }
}

#[test]
fn the_scrubber_goes_where_it_is_dragged() {
    let (mut harness, _) = two();
    let rail = harness.get_by_role_and_label(Role::Slider, "Time").rect();
    harness.drag_at(rail.left_center());
    harness.run_steps(1);
    harness.hover_at(rail.center());
    harness.run_steps(1);
    harness.drop_at(rail.center());
    harness.run_steps(2);
    let Some(&PinAction::Scrub(secs)) = asked(&mut harness).last() else {
        panic!("nothing was scrubbed")
    };
    assert!((secs - 15.0).abs() < 0.5, "the middle of 30 s, not {secs}");
    assert!(harness.state().pins.iter().all(|pin| pin.shown_secs() == secs), "all fly at once");
    assert!(rail.width() > 310.0, "as wide as the panel: {}", rail.width());
}

#[test]
fn the_keyboard_reaches_every_control() {
    let (mut harness, _) = two();
    let mut reached = Vec::new();
    for _ in 0..8 {
        harness.key_press(Key::Tab);
        harness.run_steps(2);
        let nodes = harness.root().children_recursive();
        let focused = nodes.into_iter().find(|node| node.is_focused()).expect("something");
        reached.push(focused.accesskit_node().label().expect("a name"));
    }
    for name in ["Pin A", "Pin B", "Play", "Restart", "Remove", "Time", "Speed"] {
        assert!(reached.iter().any(|label| label == name), "{name} is not among {reached:?}");
    }
    asked(&mut harness);
    harness.get_by_role_and_label(Role::Slider, "Time").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowRight);
    harness.run_steps(2);
    let actions = asked(&mut harness);
    assert!(matches!(actions[..], [PinAction::Scrub(secs)] if secs > 0.0));
    harness.get_by_role_and_label(Role::Slider, "Speed").set_value_accesskit(2.5);
    harness.run_steps(2);
    assert_eq!(asked(&mut harness), [PinAction::Speed(2.5)]);
}

#[test]
fn frames_are_asked_for_only_while_it_plays() {
    let (mut harness, _) = two();
    let delay = |harness: &Harness<'static, Shown>| {
        harness.output().viewport_output.values().map(|output| output.repaint_delay).min().unwrap()
    };
    assert!(delay(&harness) > Duration::from_secs(1), "idle");
    harness.get_by_label("Play").click();
    harness.run_steps(4);
    let playing = delay(&harness);
    assert!(playing > Duration::from_millis(20) && playing <= FRAME, "as a film: {playing:?}");
    harness.get_by_label("Pause").click();
    harness.run_steps(4);
    assert!(delay(&harness) > Duration::from_secs(1), "idle again");
}

#[test]
fn the_map_is_held_against_the_flight() {
    let (mut pins, ids) = flown(&Scene::default(), &[[2.2, 1.4]]);
    let truth = pins.get(ids[0]).unwrap().flight.outcome().unwrap();
    assert_eq!(truth.status, Status::Answered);
    for (told, words) in [
        (Outcome::flipped(truth.time.hi + 1e-4), "agree within 1 ms"),
        (Outcome::flipped(truth.time.hi + 0.0123), "differ by 12.3 ms!"),
        (Outcome::without_time(Status::Unflipped), "differ!"),
    ] {
        pins.tell(ids[0], (told, Trust::Agreed.into()));
        let shown = harness(pins, Theme::Dark);
        shown.get_by_label(words);
        let warning = format!("Map and gold standard {words}");
        assert_eq!(shown.query_by_label(&warning).is_some(), words.starts_with("differ"));
        pins = shown.into_state().pins;
    }
}

#[test]
fn of_a_forbidden_pixel_only_what_makes_sense_is_said() {
    let (mut pins, ids) = flown(&Scene::default(), &[[0.5, 0.5]]);
    let forbidden = Outcome::without_time(Status::Forbidden);
    pins.tell(ids[0], (forbidden, Trust::Agreed.into()));
    let shown = harness(pins, Theme::Dark);
    shown.get_by_label("forbidden by its energy");
    for row in ["Both", "Flip, one pixel away"] {
        assert!(shown.query_by_label(row).is_none(), "{row}");
    }
    // A note appears if the map has another answer.
    pins = shown.into_state().pins;
    pins.tell(ids[0], (Outcome::flipped(3.0), Trust::Agreed.into()));
    let shown = harness(pins, Theme::Dark);
    shown.get_by_label("differ!");
}

#[test]
fn a_pin_without_news_from_its_flight_is_shown_too() {
    let mut pins = Pins::new(&Scene::default());
    let start = [[2.2, 1.4], [2.3, 1.4]].map(|start| start.map(Exact::from_f64));
    pins.add(PinStart::at_rest(start), None, || ()).unwrap();
    let shown = harness(pins, Theme::Light);
    shown.get_by_label("Pendulum A is being let go");
    assert_eq!(shown.query_all_by_label("flying, 0 s so far").count(), 2, "pendulum and ghost");
    shown.get_by_label("not computed yet");
}

needs_adapter! {
    pictures:
    a_flipped_pendulum_looks_as_it_should
    bars_before_their_flip_look_as_they_should
}

mod pictures {
    use super::*;

    pub(crate) fn a_flipped_pendulum_looks_as_it_should() {
        let (mut pins, ids) = flown(&Scene::default(), &[[2.2, 1.4], [3.0, 3.0], [0.5, 0.5]]);
        pins.apply(PinAction::Select(ids[0]));
        let truth = pins.get(ids[0]).unwrap().flight.outcome().unwrap();
        pins.tell(ids[0], (Outcome::flipped(truth.time.hi), Trust::Confirmed.into()));
        pins.apply(PinAction::Scrub(truth.time.hi + 0.25));
        harness(pins, Theme::Dark).snapshot("pendulum_flipped");
    }

    pub(crate) fn bars_before_their_flip_look_as_they_should() {
        let build = PendulumSpec::new(Kind::Rods, [2.0, 0.5], [1.0, 0.7], 9.81);
        let (mut pins, ids) = flown(&Scene { build, ..Scene::default() }, &[[2.6, -2.0]]);
        pins.tell(ids[0], (Outcome::flipped(20.0), Trust::Uncertain.into()));
        pins.apply(PinAction::Scrub(0.8));
        harness(pins, Theme::Light).snapshot("pendulum_bars");
    }
}
