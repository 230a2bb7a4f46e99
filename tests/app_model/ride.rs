//! The ride: descents, flying pendulums, the toolbar, and the notices on the way.

use egui::{Event, Key, Modifiers, Role, pos2};
use egui_kittest::kittest::Queryable;
use flipmap_engine::IntegratorConfig;
use flipmap_scene::{BuiltIn, Sampling, Scene};
use flipmap_screen::camera::Camera;
use flipmap_window::action::{Action, Look};
use flipmap_window::folders::Folders;
use flipmap_window::model::{AppModel, WindowOptions};

use super::*;

/// Runs frames until the target view changes, and returns the share of the previous target that was
/// known by then.
fn share_left(desktop: &mut Desktop) -> f64 {
    let config = desktop.state().compute.config().unwrap();
    let begun = Instant::now();
    // Intermediate views are drawn at half the resolution.
    let target = |model: &AppModel| model.films.descent.passing(model.state.view_target(config));
    loop {
        let before = target(desktop.state());
        let camera = desktop.state().state.target();
        desktop.step();
        let model = desktop.state_mut();
        if model.state.target().width_rad < 0.9 * camera.width_rad {
            let now = target(model);
            model.compute.explorer.target(&before);
            let progress = model.progress();
            model.compute.explorer.target(&now);
            return progress.share;
        }
        assert!(begun.elapsed() < Duration::from_secs(120), "the descent goes nowhere");
        sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_dive_never_halts_is_paused_and_quickened_and_stays_at_escape() {
    let mut desktop = model(Folders::none(), BuiltIn::named("filigree").map(|b| b.document()));
    press(&mut desktop, Modifiers::NONE, Key::D);
    let share = share_left(&mut desktop);
    assert!(share >= 0.5, "only {share} of the first view was known");
    let width = |desktop: &Desktop| desktop.state().state.camera.width_rad;
    let secs = |desktop: &Desktop| desktop.state().state.now_secs;
    // The first step has begun; from now on, an octave takes two seconds at most.
    let (began_secs, from) = (secs(&desktop), width(&desktop));
    while width(&desktop) > from / 32.0 {
        let before = width(&desktop);
        desktop.step();
        assert!(width(&desktop) < before, "it halts at {before}");
        sleep(Duration::from_millis(5));
    }
    let octaves = (from / width(&desktop)).log2();
    let took_secs = secs(&desktop) - began_secs;
    assert!(took_secs <= 2.0 * octaves + 0.5, "{octaves} octaves in {took_secs} s");

    press(&mut desktop, Modifiers::NONE, Key::Space);
    let stands = width(&desktop);
    desktop.run_steps(30);
    assert_eq!(width(&desktop), stands, "paused");
    let pace = |desktop: &Desktop| desktop.state().films.descent.pace;
    let before = pace(&desktop);
    press(&mut desktop, Modifiers::NONE, Key::Plus);
    assert!(pace(&desktop) != before && width(&desktop) == stands, "the pace, not the view");
    press(&mut desktop, Modifiers::NONE, Key::Space);
    desktop.run_steps(10);
    assert!(width(&desktop) < stands, "it goes on");
    press(&mut desktop, Modifiers::NONE, Key::Escape);
    desktop.run_steps(2);
    let model = desktop.state();
    let full = model.state.view_target(model.compute.config().unwrap()).level;
    assert_eq!(model.progress().level, full, "where it stays is drawn in full");
    let there = desktop.state().state.target();
    desktop.run_steps(200);
    assert_eq!(desktop.state().state.target(), there);
}

#[test]
fn notices_go_by_themselves_and_failures_do_not() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::COMMAND, Key::L);
    desktop.event(Event::Paste("nonsense".to_string()));
    desktop.run_steps(2);
    assert!(notices(&desktop).contains("was copied") && notices(&desktop).contains("pasted"));
    let delay =
        |desktop: &Desktop| desktop.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    // Both notices appear within moments; then nothing is drawn until one disappears.
    for _ in 0..60 {
        desktop.step();
        if delay(&desktop) > Duration::from_secs(1) {
            break;
        }
    }
    assert!(notices(&desktop).contains("was copied"));
    let wait = delay(&desktop);
    assert!(wait > Duration::from_secs(1) && wait <= Duration::from_secs(8), "{wait:?}");
    desktop.run_steps(9 * 60);
    assert!(!notices(&desktop).contains("was copied") && notices(&desktop).contains("pasted"));
    assert_eq!(delay(&desktop), Duration::MAX, "nothing is left to wait for");
}

#[test]
fn the_first_start_shows_a_card_once() {
    let folder = tempfile::tempdir().unwrap();
    let shown = |desktop: &Desktop| desktop.query_by_label("Look around").is_some();
    let mut first = model(Folders::under(folder.path()), None);
    assert!(shown(&first));
    first.state_mut().save();
    assert!(shown(&model(Folders::under(folder.path()), None)), "it was not closed yet");
    press(&mut first, Modifiers::NONE, Key::Escape);
    assert!(!shown(&first));
    first.state_mut().save();
    let mut again = model(Folders::under(folder.path()), None);
    assert!(!shown(&again));
    again.state_mut().act(vec![Action::Toggle(flipmap_window::state::Dialog::Greeting)]);
    again.run_steps(2);
    click(&mut again, "Look around");
    assert!(!shown(&again));
    assert!(!shown(&home()), "a window that keeps nothing never shows it");
}

#[test]
fn the_bar_of_tools_does_what_its_names_say_and_goes_with_the_panels() {
    let mut desktop = home();
    let whole = desktop.state().state.camera;
    press(&mut desktop, Modifiers::NONE, Key::Plus);
    settle(&mut desktop);
    let zoomed = desktop.state().state.camera;
    for (tool, there) in [("Go back", whole), ("Go forward", zoomed), ("Show the whole map", whole)]
    {
        click(&mut desktop, tool);
        settle(&mut desktop);
        assert_eq!(desktop.state().state.camera, there, "{tool}");
    }
    for (tool, control) in [("Colours", "Equalise to this view"), ("Picture & film", "Browse…")] {
        assert!(desktop.query_by_label(control).is_none(), "{tool}");
        click(&mut desktop, tool);
        desktop.run_steps(20);
        assert!(desktop.query_by_label(control).is_some(), "{tool}");
    }
    click(&mut desktop, "Laboratory");
    let title = format!("{} (F4)", Figure::Double.title());
    assert_eq!(Figure::all().filter(|f| f.key() == Key::F4).count(), 1);
    click(&mut desktop, &title);
    assert_eq!(desktop.state().figure_shown(), Some(Figure::Double.name()));
    click(&mut desktop, "Leave the lab");
    desktop.run_steps(2);
    click(&mut desktop, "List the keys");
    // Text outside the visible part of a list is not found, so the window is made tall.
    desktop.set_size(egui::vec2(720.0, 2600.0));
    desktop.run_steps(5);
    for ask in flipmap_scene::question::QuestionName::ALL {
        assert!(desktop.query_by_label(ask.kind().about).is_some(), "{}", ask.kind().name);
    }
    press(&mut desktop, Modifiers::NONE, Key::Escape);
    press(&mut desktop, Modifiers::NONE, Key::F9);
    for name in ["Go back", "Colours", "Equalise to this view"] {
        assert!(desktop.query_by_label(name).is_none(), "{name}");
    }
}

#[test]
fn pins_fill_the_window_and_come_back() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::NONE, Key::P);
    press(&mut desktop, Modifiers::NONE, Key::F);
    let stage = desktop.get_by_role_and_label(Role::Slider, "Time").rect();
    assert!(stage.width() > 650.0, "{stage:?}");
    assert!(desktop.query_by_label("Whole window (F)").is_none());
    press(&mut desktop, Modifiers::NONE, Key::Escape);
    assert!(desktop.query_by_label_contains("Map around").is_some());
    click(&mut desktop, "Whole window (F)");
    assert!(desktop.state().state.shown.stage);
}

#[test]
fn an_export_is_as_large_as_the_map_and_its_samples_are_those_shown() {
    let mut desktop = home();
    click(&mut desktop, "Picture & film");
    desktop.run_steps(20);
    let canvas = desktop.state().state.canvas;
    let width = desktop.get_by_role_and_label(Role::SpinButton, "Width").value().unwrap();
    assert_eq!(width, format!("{} px", canvas.x.round()));
    type_over(&mut desktop, Role::SpinButton, "Anti-aliasing", "3");
    assert_eq!(desktop.state().state.picture.samples, Sampling::Square(3));
    let here = std::env::current_dir().unwrap().join("map.png");
    assert!(desktop.query_by_label(here.to_str().unwrap()).is_some(), "the whole path");
}

#[test]
fn the_energy_curve_is_that_of_the_tiles_that_are_drawn() {
    let mut desktop = home();
    let model = desktop.state_mut();
    let before = model.state.build;
    let mut scene: Scene = model.state.scene();
    scene.build.masses[1] = 3.0.into();
    model.act(vec![Action::Scene(Box::new(scene))]);
    let config: IntegratorConfig = model.compute.config().unwrap();
    let target = model.state.view_target(config);
    model.compute.explorer.target(&target);
    let drawn = |model: &AppModel| model.compute.explorer.drawn().unwrap().build;
    assert_eq!(drawn(model), before, "the old tiles stand in");
    settle(&mut desktop);
    let model = desktop.state();
    assert_eq!(drawn(model), model.state.build);
    assert_ne!(model.state.build, before);
}

#[test]
fn a_small_window_is_still_a_window_on_the_map() {
    for size in [[640.0, 480.0], [400.0, 300.0]] {
        let options: WindowOptions = options(Folders::none(), None);
        let model = AppModel::new(&options, Arc::new(|| ()));
        let show = |ui: &mut egui::Ui, model: &mut AppModel| {
            model.show(ui);
        };
        let mut desktop: Desktop = Harness::builder().with_size(size).build_ui_state(show, model);
        desktop.run_steps(5);
        let canvas = desktop.state().state.canvas;
        assert!(canvas.x > 0.5 * f64::from(size[0]), "{canvas} of {size:?}");
        assert!(canvas.y > 0.8 * f64::from(size[1]), "{canvas} of {size:?}");
    }
}

#[test]
fn the_pinned_path_is_drawn_while_the_panels_are_hidden_and_frames_are_asked_for() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::NONE, Key::F9);
    desktop.event(Event::PointerMoved(pos2(700.0, 1.0)));
    desktop.run_steps(100);
    press(&mut desktop, Modifiers::NONE, Key::P);
    let delay =
        |desktop: &Desktop| desktop.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    // The pin opens the panels.
    press(&mut desktop, Modifiers::NONE, Key::F9);
    assert!(delay(&desktop) <= Duration::from_millis(33), "it flies over the map");
    press(&mut desktop, Modifiers::NONE, Key::Space);
    desktop.run_steps(3);
    assert!(delay(&desktop) > Duration::from_secs(1), "paused");
    let at = desktop.state().state.camera;
    desktop.state_mut().act(vec![Action::Look(Look::To(Camera { width_rad: 1.0, ..at }))]);
    settle(&mut desktop);
}
