//! The laboratory's figures: their appearance at a fixed time, and their use by a person.

use egui::{Event, Key, Modifiers, PointerButton, Role, Theme, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, SnapshotOptions};
use flipmap_lab::home::home_map;
use flipmap_lab::{Figure, FigureRequest, Lab, flips};
use flipmap_pendulum::{Rule, State};
use flipmap_scene::{BuiltIn, Document, Kind};

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
        .with_context_setup(flipmap_lab::typeface::install)
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
        drag(&mut harness, pos2(400.0, 300.0), vec2(-220.0, -60.0));
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
    let mut harness = explanation(BuiltIn::home().document());
    harness.get_by_label_contains("2 cos θ1 + cos θ2 > 1");
    harness.get_by_label("uniform bars").click();
    harness.run_steps(3);
    assert_eq!(harness.state().pendulum.kind, Kind::Rods);
    harness.get_by_label_contains("3 cos θ1 + cos θ2 > 2");
    harness.get_by_label_contains("24.39 %");
}

/// Returns the panel that explains the map of a document.
fn explanation(document: Document) -> Harness<'static, Document> {
    let show = |ui: &mut egui::Ui, document: &mut Document| {
        let kind = flips::explain(ui, document, &flips::Seen::default());
        document.pendulum.kind = kind.unwrap_or(document.pendulum.kind);
    };
    let mut harness = Harness::builder()
        .with_context_setup(flipmap_lab::typeface::install)
        .with_size([340.0, 640.0])
        .build_ui_state(show, document);
    harness.run_steps(2);
    harness
}

#[test]
fn the_explanation_is_true_for_the_palette_the_rule_and_the_plane() {
    let home = BuiltIn::home().document();
    let harness = explanation(home.clone());
    // The default palette runs from dark blue to light yellow over a dark ground.
    harness.get_by_label_contains("dark blue: after 0.");
    harness.get_by_label("nearly black: not within 30 s");
    harness.get_by_label("dark grey: too little energy ever to flip");
    harness.get_by_label_contains("The light grey line");
    harness.get_by_label_contains("the second bob takes");
    let mut other = home;
    other.picture.palette = "batlow".to_string();
    other.question.rule = Rule::First;
    let harness = explanation(other.clone());
    harness.get_by_label("white: not within 30 s");
    harness.get_by_label_contains("The black line");
    harness.get_by_label_contains("the first bob takes");
    harness.get_by_label_contains("the first rod upright and the second hanging");
    // A map of thrown pendulums has no curve, and other questions have no flips.
    other.plane = BuiltIn::named("thrown").unwrap().document().plane;
    let harness = explanation(other);
    harness.get_by_label_contains("its own (ω1, ω2)");
    assert!(harness.query_by_label_contains("The black line").is_none());
    let harness = explanation(BuiltIn::named("moment").unwrap().document());
    assert!(harness.query_by_label_contains("flip over the top").is_none());
    assert!(harness.query_by_label_contains("forbidden:").is_none());
}

#[test]
fn the_map_of_the_lab_is_that_of_the_window() {
    let map = home_map(24).unwrap();
    let csv = map.csv();
    let first: Vec<f64> =
        csv.lines().nth(1).unwrap().split(',').take(2).map(|x| x.parse().unwrap()).collect();
    // The upper left pixel: θ1 just above 0, θ2 just below π.
    let pixel = std::f64::consts::TAU / 24.0;
    assert!((first[0] - 0.5 * pixel).abs() < 1e-9, "{first:?}");
    assert!((first[1] - (std::f64::consts::PI - 0.5 * pixel)).abs() < 1e-9, "{first:?}");
    assert_eq!(map.document, BuiltIn::home().document());
    let simulated = map.seen.simulated.expect("it is counted");
    assert!(simulated < map.seen.pixels / 2, "half are mirror images: {:?}", map.seen);
}

#[test]
fn the_keyboard_reaches_the_controls() {
    let mut harness = figure(Figure::Integrators, 1.0);
    let before = harness.state().lab.set();
    // One cycle of the Tab key reaches every control.
    for _ in 0..40 {
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
    // The speeds of a throw have no sliders.
    let mut sliders = before.iter().zip(&after).take(3);
    assert!(sliders.all(|(before, after)| before != after), "{after:?}");
}

#[test]
fn the_ring_of_an_arc_turns_its_rod() {
    let mut harness = figure(Figure::Double, 0.0);
    harness.state_mut().lab.playing.paused = true;
    let canvas = harness.get_by_label_contains("θ1 is 0.800 rad").rect();
    // The ring of the first arc is nearer to the pivot than to any bob: at 0.3 of the first rod,
    // whose length is half of the reach.
    let reach = 0.5 * canvas.size().min_elem() - 12.0;
    let ring = |theta: f32| canvas.center() + 0.15 * reach * vec2(theta.sin(), theta.cos());
    drag(&mut harness, ring(0.8), ring(-0.5) - ring(0.8));
    let set = harness.state().lab.set();
    assert!((set[0] + 0.5).abs() < 0.02 && (set[1] - 1.4).abs() < 1e-9, "{set:?}");
}

#[test]
fn the_height_of_zero_energy_is_dragged_and_moves_no_pendulum() {
    let mut harness = figure(Figure::Double, 0.0);
    harness.state_mut().lab.playing.paused = true;
    let before = harness.state().lab.set();
    let potential = |harness: &Harness<'_, Shown>| {
        let bar = harness.get_by_label_contains("energy: potential ").accesskit_node().label();
        bar.unwrap().split(' ').nth(2).unwrap().replace('−', "-").parse::<f64>().unwrap()
    };
    let above_hanging = potential(&harness);
    let canvas = harness.get_by_label_contains("θ1 is 0.800 rad").rect();
    let reach = 0.5 * canvas.size().min_elem() - 12.0;
    // The reach is that of both rods of 1 m, and the centre of equal masses hangs 1.5 m below the pivot.
    let handle = pos2(canvas.right() - 10.0, canvas.center().y + 0.75 * reach);
    drag(&mut harness, handle, vec2(0.0, -0.5 * reach));
    let after = harness.state().lab.set();
    let zero = after[11];
    assert!((zero - 1.0).abs() < 0.02, "{after:?}");
    assert_eq!(after[..11], before[..11], "nothing else moved");
    let less = above_hanging - potential(&harness);
    assert!((less - 2.0 * 9.81 * zero).abs() < 0.02, "two masses of 1 kg: {less} J");
}

#[test]
fn time_is_paused_slowed_and_scrubbed_by_name() {
    let mut harness = figure(Figure::Ghost, 3.0);
    harness.get_by_label("1/10").click();
    harness.get_by_label("Pause").click();
    harness.run_steps(2);
    let playing = &harness.state().lab.playing;
    assert!(playing.paused && playing.speed == 0.1);
    harness.get_by_label("Play").click();
    harness.get_by_role_and_label(Role::Slider, "Time").focus();
    harness.run_steps(2);
    (0..3).for_each(|_| harness.key_press(Key::ArrowRight));
    harness.run_steps(2);
    let lab = &mut harness.state_mut().lab;
    let before = lab.live().unwrap().secs();
    (0..20).for_each(|_| lab.advance(0.0));
    assert!(lab.live().unwrap().secs() > before, "the slider sought a later moment");
    harness.get_by_label("Restart").click();
    harness.run_steps(2);
    assert_eq!(harness.state_mut().lab.live().unwrap().secs(), 0.0);
}

#[test]
fn the_lesson_goes_through_the_questions_of_a_figure_and_on() {
    let mut harness = figure(Figure::Single, 3.0);
    harness.state_mut().lab.set_lesson(true);
    harness.run_steps(2);
    let secs = |harness: &mut Harness<'_, Shown>| {
        harness.state_mut().lab.advance(0.1);
        harness.state_mut().lab.live().unwrap().secs()
    };
    harness.get_by_label(
        "The bob is made four times as heavy. How long does a swing to and fro take?",
    );
    harness.get_by_label("Figure 1 of 7, question 1 of 3");
    assert!(harness.query_by_label("Back").is_none() && harness.query_by_label("Reveal").is_none());
    assert_eq!(secs(&mut harness), 0.0, "nothing moves before the class has committed");
    harness.get_by_label("A  It takes longer.").click();
    harness.run_steps(2);
    assert!(secs(&mut harness) > 0.0, "then it moves");
    assert!(harness.query_by_label_contains("The mass stands").is_none(), "the answer is hidden");
    harness.get_by_label("Reveal").click();
    harness.run_steps(2);
    harness.get_by_label_contains("Not so. Gravity pulls four times as hard");
    harness.get_by_label_contains("B  It takes as long as before. (right)");
    for question in [2, 3] {
        harness.get_by_label("Next").click();
        harness.run_steps(2);
        harness.get_by_label(&format!("Figure 1 of 7, question {question} of 3"));
        assert_eq!(secs(&mut harness), 0.0);
    }
    harness.get_by_label("Next").click();
    harness.run_steps(2);
    assert_eq!(harness.state().asked.last(), Some(&FigureRequest::Show(Figure::Ghost)));
    harness.state_mut().lab.show_figure(Figure::Ghost);
    harness.run_steps(2);
    harness.get_by_label("Figure 2 of 7, question 1 of 3");
    harness.get_by_label("End the lesson").click();
    harness.run_steps(2);
    assert!(!harness.state().lab.lesson.is_on && harness.query_by_label("Next").is_none());
}

#[test]
fn time_is_reversed_and_a_twin_has_one_difference() {
    let mut harness = figure(Figure::Double, 0.0);
    let lab = &mut harness.state_mut().lab;
    lab.playing.paused = true;
    lab.open(Figure::Double, State::rest([2.2, 2.5]));
    (0..200).for_each(|_| lab.live().unwrap().advance(0.1));
    harness.run_steps(2);
    harness.get_by_label("Turn all speeds round").click();
    harness.run_steps(2);
    harness.get_by_label("RK4 in steps of 1/120 s is on its way back.");
    let lab = &mut harness.state_mut().lab;
    (0..300).for_each(|_| lab.live().unwrap().advance(0.1));
    assert!((lab.live().unwrap().secs() - 40.0).abs() < 0.1, "it ends where it began");
    assert!(lab.live().unwrap().told().contains("20.00 s after the turn"));
    harness.run_steps(2);
    harness.get_by_label_contains("RK4 in steps of 1/120 s was lost");
    harness.get_by_label_contains("In double-double it is back");
    harness.get_by_label("Forward again").click();
    harness.run_steps(2);
    harness.get_by_label("A twin beside it").click();
    harness.run_steps(2);
    let lab = &mut harness.state_mut().lab;
    (0..20).for_each(|_| lab.live().unwrap().advance(0.1));
    harness.run_steps(2);
    let told = |harness: &Harness<'_, Shown>| {
        harness.query_all_by_label_contains("θ1 is").map(|node| format!("{node:?}")).count()
    };
    assert_eq!(told(&harness), 2, "two pendulums are drawn");
    harness.get_by_label("A twin beside it").click();
    harness.run_steps(2);
    assert_eq!(told(&harness), 1);
}

#[test]
fn a_chart_shows_any_quantity_against_any() {
    let mut harness = figure(Figure::Double, 3.0);
    harness.get_by_label("Chart of angle θ2, rad against angle θ1, rad");
    harness.get_by_role_and_label(Role::ComboBox, "Up").click();
    harness.run_steps(2);
    harness.get_by_label("tension of rod 1, N").click();
    harness.run_steps(2);
    harness.get_by_label("Chart of tension of rod 1, N against angle θ1, rad");
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
            flips::show(ui, texture, &map.document, &map.seen);
        };
        let builder = Harness::builder()
            .with_context_setup(flipmap_lab::typeface::install)
            .with_size(SIZE)
            .with_theme(Theme::Dark);
        let mut harness = builder.build_ui(show);
        harness.run_steps(3);
        // In chaotic parts, last bits that differ between processors change colours.
        let options = SnapshotOptions::new().max_failed_pixels(4000);
        harness.snapshot_options("lab_map", &options);
    }
}
