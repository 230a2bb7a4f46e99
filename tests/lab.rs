//! The laboratory's figures: their appearance at a fixed time, and their use by a person.

#[macro_use]
#[path = "common/adapter.rs"]
mod adapter;

use egui::{Event, Key, Modifiers, PointerButton, Role, Theme, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, SnapshotOptions};
use flipmap::lab::home::home_map;
use flipmap::lab::{Figure, FigureRequest, Lab, flips};
use flipmap::physics::State;
use flipmap::scene::{Build, Kind};

const SIZE: [f32; 2] = [1100.0, 680.0];

struct Shown {
    lab: Lab,
    asked: Vec<FigureRequest>,
}

/// A figure `secs` after its start, which does not advance by itself.
fn figure(figure: Figure, secs: f64) -> Harness<'static, Shown> {
    let mut lab = Lab::new(figure);
    if let Some(live) = lab.live() {
        (0..(secs * 60.0) as u32).for_each(|_| live.advance(1.0 / 60.0));
    }
    let show = |ui: &mut egui::Ui, shown: &mut Shown| {
        let asked = shown.lab.show(ui);
        shown.asked.extend(asked);
    };
    let mut harness = Harness::builder()
        .with_size(SIZE)
        .with_theme(Theme::Dark)
        .build_ui_state(show, Shown { lab, asked: Vec::new() });
    harness.run_steps(3);
    harness
}

fn drag(harness: &mut Harness<'_, Shown>, from: egui::Pos2, by: egui::Vec2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(Event::PointerMoved(from));
    harness.event(button(from, true));
    harness.run_steps(2);
    for step in 1..=4 {
        harness.event(Event::PointerMoved(from + by * (step as f32 / 4.0)));
        harness.run_steps(1);
    }
    harness.event(button(from + by, false));
    harness.run_steps(2);
}

#[test]
fn a_dragged_bob_is_let_go_where_it_is_left() {
    for which in [Figure::Single, Figure::Ghost, Figure::Double, Figure::Machine] {
        let mut harness = figure(which, 0.0);
        let before = harness.state().lab.set();
        drag(&mut harness, pos2(400.0, 400.0), vec2(-220.0, -60.0));
        let after = harness.state().lab.set();
        assert!(after[0] != before[0] || after[1] != before[1], "{which:?}: {after:?}");
        // The released bob moves again.
        let live = harness.state_mut().lab.live().unwrap();
        let data = live.csv(1.0);
        assert!(data.lines().nth(1) != data.lines().nth(90), "{which:?}");
    }
}

#[test]
fn a_start_goes_to_the_map_and_comes_from_it() {
    for which in [Figure::Machine, Figure::Integrators, Figure::Twenty] {
        let mut harness = figure(Figure::Single, 0.0);
        let start = State { angle: [1.25, -0.5], speed: [0.5, 2.0] };
        harness.state_mut().lab.open(which, start);
        harness.run_steps(3);
        assert_eq!(harness.state().lab.set()[..2], [1.25, -0.5]);
        harness.get_by_label("Show this start on the map").click();
        harness.run_steps(2);
        assert_eq!(harness.state().asked, [FigureRequest::ToMap(start)], "{which:?}");
    }
}

#[test]
fn the_map_is_explained_and_its_pendulum_switched() {
    let show = |ui: &mut egui::Ui, kind: &mut Kind| {
        let build = Build { kind: *kind, ..Build::default() };
        *kind = flips::explain(ui, &build, &flips::Seen::default()).unwrap_or(*kind);
    };
    let mut harness =
        Harness::builder().with_size([340.0, 500.0]).build_ui_state(show, Kind::Points);
    harness.run_steps(2);
    harness.get_by_label_contains("2 cos θ1 + cos θ2 > 1");
    harness.get_by_label("uniform bars").click();
    harness.run_steps(3);
    assert_eq!(*harness.state(), Kind::Rods);
    harness.get_by_label_contains("3 cos θ1 + cos θ2 > 2");
    harness.get_by_label_contains("24.39 %");
}

#[test]
fn the_keyboard_reaches_the_controls() {
    let mut harness = figure(Figure::Integrators, 1.0);
    let before = harness.state().lab.set();
    // One cycle of the Tab key reaches every control.
    for _ in 0..20 {
        harness.key_press(Key::Tab);
        harness.run_steps(3);
        let focused = harness.root().children_recursive().find(|node| node.is_focused());
        let is_slider = focused.is_some_and(|n| n.accesskit_node().role() == Role::Slider);
        if !is_slider {
            continue;
        }
        harness.key_press(Key::ArrowRight);
        harness.run_steps(2);
    }
    let after = harness.state().lab.set();
    assert!(before.iter().zip(&after).all(|(before, after)| before != after), "{after:?}");
}

#[test]
fn a_step_that_is_too_long_says_so() {
    let mut harness = figure(Figure::Integrators, 0.0);
    harness.state_mut().lab.open(Figure::Integrators, State::rest([2.9, 2.9]));
    assert!(harness.query_all_by_label("Step Δt").count() > 0);
    let lab = &mut harness.state_mut().lab;
    for _ in 0..400 {
        lab.live().unwrap().advance(0.2);
    }
    // With steps of 10 ms no integrator diverges within 80 s: every number stays finite.
    assert!(lab.live().unwrap().csv(2.0).lines().all(|line| !line.contains("NaN")));
}

needs_adapter! {
    goldens:
    single
    ghost
    double
    machine
    integrators
    twenty
    map
}

mod goldens {
    use super::*;

    pub(crate) fn single() {
        figure(Figure::Single, 0.7).snapshot("lab_single");
    }

    pub(crate) fn ghost() {
        figure(Figure::Ghost, 6.0).snapshot("lab_ghost");
    }

    pub(crate) fn double() {
        figure(Figure::Double, 1.5).snapshot("lab_double");
    }

    pub(crate) fn machine() {
        figure(Figure::Machine, 3.0).snapshot("lab_machine");
    }

    pub(crate) fn integrators() {
        figure(Figure::Integrators, 5.0).snapshot("lab_integrators");
    }

    pub(crate) fn twenty() {
        figure(Figure::Twenty, 14.0).snapshot("lab_twenty");
    }

    pub(crate) fn map() {
        let map = home_map(200).unwrap();
        let mut texture = None;
        let show = move |ui: &mut egui::Ui| {
            let texture = texture.get_or_insert_with(|| map.texture(ui.ctx()));
            flips::show(ui, texture, &Build::default(), &map.seen);
        };
        let builder = Harness::builder().with_size(SIZE).with_theme(Theme::Dark);
        let mut harness = builder.build_ui(show);
        harness.run_steps(3);
        // Where neighbours flip at unrelated times, other last bits of a processor change colours.
        let options = SnapshotOptions::new().max_failed_pixels(4000);
        harness.snapshot_options("lab_map", &options);
    }
}
