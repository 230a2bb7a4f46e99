//! The whole user interface on the CPU engine, without a window: driven by control names and the
//! keyboard, as by a user without a mouse or a screen.

mod commands;
mod films;
mod lab;
mod look;
mod planes;
mod reach;
mod ride;
mod undo;
mod view;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use egui::{Event, Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use flipmap_engine::choice::{EngineRequest, IntegrationSetting};
use flipmap_engine::{Accuracy, EngineKind};
use flipmap_lab::Figure;
use flipmap_numbers::Scalar;
use flipmap_render::tiles::Counts;
use flipmap_scene::{BuiltIn, Document, RunTable, location};
use flipmap_window::folders::Folders;
use flipmap_window::model::{AppModel, WindowOptions};
use flipmap_window::settings::{EdgeSamples, Theme};

type Desktop = Harness<'static, AppModel>;

fn options(folders: Folders, document: Option<Document>) -> WindowOptions {
    let setting = IntegrationSetting::Accuracy(Accuracy::Fast);
    let request =
        EngineRequest { kind: Some(EngineKind::Cpu), setting, ..EngineRequest::default() };
    let run = RunTable { accuracy: Some("fast".to_string()), ..RunTable::default() };
    WindowOptions {
        document,
        run: Some(run),
        request,
        folders,
        set_up: None,
        stats: None,
        film_command: None,
    }
}

/// Returns an app model of fixed size with a complete map.
fn model(folders: Folders, document: Option<Document>) -> Desktop {
    model_of(&options(folders, document))
}

fn model_of(options: &WindowOptions) -> Desktop {
    let mut model = AppModel::new(options, Arc::new(|| ()));
    // Tests of other features would keep computing finer samples.
    if model.state.look.edges == EdgeSamples::default() {
        model.state.look.edges = EdgeSamples::One;
    }
    let show = |ui: &mut egui::Ui, model: &mut AppModel| {
        model.state.tick(ui.input(|input| input.time));
        model.work();
        model.show(ui);
    };
    let mut desktop = Harness::builder()
        .with_context_setup(flipmap_lab::typeface::install)
        .with_size([720.0, 440.0])
        .build_ui_state(show, model);
    settle(&mut desktop);
    desktop
}

fn home() -> Desktop {
    model(Folders::none(), None)
}

/// Runs frames until a condition holds.
fn until(desktop: &mut Desktop, what: &str, holds: impl Fn(&Desktop) -> bool) {
    let begun = Instant::now();
    desktop.run_steps(2);
    while !holds(desktop) {
        assert!(begun.elapsed() < Duration::from_secs(300), "waited five minutes for {what}");
        sleep(Duration::from_millis(2));
        desktop.step();
    }
}

/// Runs frames until nothing moves and nothing is left to compute.
fn settle(desktop: &mut Desktop) {
    until(desktop, "the whole map", |desktop| {
        let (state, progress) = (&desktop.state().state, desktop.state().progress());
        state.moving.is_none() && progress.idle && progress.done == progress.wanted
    });
}

fn press(desktop: &mut Desktop, modifiers: Modifiers, key: Key) {
    desktop.key_press_modifiers(modifiers, key);
    desktop.run_steps(2);
}

fn click(desktop: &mut Desktop, name: &str) {
    desktop.get_by_label(name).click_accesskit();
    desktop.run_steps(2);
}

/// Types over the contents of the field with this role and name.
fn type_over(desktop: &mut Desktop, role: Role, name: &str, text: &str) {
    desktop.get_by_role_and_label(role, name).focus();
    desktop.run_steps(2);
    press(desktop, Modifiers::COMMAND, Key::A);
    desktop.event(Event::Text(text.to_string()));
    desktop.run_steps(1);
    press(desktop, Modifiers::NONE, Key::Enter);
}

fn counts(desktop: &Desktop) -> Counts {
    desktop.state().compute.explorer.counts()
}

fn place(desktop: &Desktop) -> String {
    location::text(&desktop.state().state.document().scene())
}

fn notices(desktop: &Desktop) -> String {
    let texts: Vec<_> = desktop.state().state.notices.iter().map(|n| n.text.clone()).collect();
    texts.join("\n")
}

/// A file dropped on the window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        fs::read(&self.0).map_err(|error| error.to_string())
    }
}

fn drop_file(desktop: &mut Desktop, path: &Path) {
    desktop.input_mut().dropped_files.push(Arc::new(Dropped(path.to_path_buf())));
    desktop.run_steps(2);
}

#[test]
fn a_dropped_scene_is_shown_and_anything_else_leaves_the_view() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let shore = BuiltIn::named("shore").unwrap().document();
    let good = file("shore.toml", &shore.text());
    let mut desktop = home();
    drop_file(&mut desktop, &good);
    settle(&mut desktop);
    let there = place(&desktop);
    assert_eq!(there, location::text(&shore.scene()));
    let bad = [
        (file("diary.toml", "dear = \"diary\""), "diary.toml"),
        (file("cat.png", "meow"), "cat.png"),
        (file("flat.toml", "[view]\nwidth = \"0\"\n"), "flat.toml"),
        (folder.path().join("gone.toml"), "gone.toml"),
    ];
    for (path, name) in bad {
        drop_file(&mut desktop, &path);
        assert!(notices(&desktop).contains(name), "{name}: {}", notices(&desktop));
        assert_eq!(place(&desktop), there);
    }
}

#[test]
fn a_pasted_location_is_gone_to_and_anything_else_leaves_the_view() {
    let mut desktop = home();
    desktop.event(Event::Paste("flipmap:center=1,2;width=0.5;rule=either".to_string()));
    settle(&mut desktop);
    let there = "flipmap:center=1,2;width=0.5;budget=auto;rule=either";
    assert_eq!(place(&desktop), there);
    for text in ["Dear diary", "flipmap:center=1,2;width=-1", "flipmap:center=1,2;colour=red"] {
        let before = notices(&desktop);
        desktop.event(Event::Paste(text.to_string()));
        desktop.run_steps(2);
        assert!(notices(&desktop) != before, "{text:?} is told of");
        assert_eq!(place(&desktop), there);
    }
}

#[test]
fn colours_and_layers_compute_nothing() {
    let mut desktop = home();
    let before = counts(&desktop);
    click(&mut desktop, "Colours");
    click(&mut desktop, "magma");
    assert_eq!(desktop.state().state.picture.palette, "magma");
    let layers = desktop.state().state.layers;
    for name in ["Energy curve", "Doubts", "Grid of angles", "Borders of tiles"] {
        click(&mut desktop, name);
    }
    let changed = desktop.state().state.layers;
    assert!(changed.curve != layers.curve && changed.borders != layers.borders);
    settle(&mut desktop);
    assert_eq!(counts(&desktop), before);
}

#[test]
fn places_seen_before_are_not_computed_again() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::NONE, Key::Plus);
    settle(&mut desktop);
    press(&mut desktop, Modifiers::NONE, Key::ArrowRight);
    settle(&mut desktop);
    let seen = counts(&desktop);
    let there = place(&desktop);
    for key in [Key::ArrowLeft, Key::Minus, Key::Plus, Key::ArrowRight] {
        press(&mut desktop, Modifiers::NONE, key);
        settle(&mut desktop);
    }
    assert_eq!(place(&desktop), there);
    assert_eq!(counts(&desktop), seen, "the way back and forth again");
}

#[test]
fn a_larger_budget_goes_on_from_what_is_known() {
    let evaluations = |budgets: &[&str]| {
        let mut desktop = model(Folders::none(), None);
        click(&mut desktop, "Pendulum & question");
        budgets.iter().for_each(|budget| {
            type_over(&mut desktop, Role::SpinButton, "Budget", budget);
            settle(&mut desktop);
        });
        assert_eq!(
            format!("{}", desktop.state().state.question.budget.secs),
            *budgets[budgets.len() - 1]
        );
        counts(&desktop).effort.rhs_evaluations
    };
    let (known, raised) = (evaluations(&["30"]), evaluations(&["60"]));
    let anew = {
        let mut document = Document::default();
        document.question.budget.secs = 60.0;
        counts(&model(Folders::none(), Some(document))).effort.rhs_evaluations
    };
    assert!(raised > known, "there was more to compute");
    assert!(raised - known < anew / 2, "{raised} for both, {known} at first, {anew} at once");
    assert!(raised < anew + anew / 10, "{raised} in two steps, {anew} at once");
}

#[test]
fn an_export_to_a_full_disk_says_so_and_leaves_the_view() {
    let mut desktop = home();
    let there = place(&desktop);
    click(&mut desktop, "Picture & film");
    type_over(&mut desktop, Role::TextInput, "File", "/dev/full");
    type_over(&mut desktop, Role::SpinButton, "Width", "64");
    type_over(&mut desktop, Role::SpinButton, "Height", "48");
    let start = |desktop: &Desktop| {
        desktop.get_by_role_and_label(Role::Button, "Export").click_accesskit();
    };
    start(&desktop);
    until(&mut desktop, "the export to fail", |desktop| {
        desktop.query_by_label_contains("Not exported: cannot write /dev/full").is_some()
    });
    assert_eq!(place(&desktop), there);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.png");
    type_over(&mut desktop, Role::TextInput, "File", path.to_str().unwrap());
    start(&desktop);
    until(&mut desktop, "the export", |desktop| {
        desktop.query_by_label_contains("Done in").is_some()
    });
    assert_eq!(image::open(path).unwrap().into_rgb8().dimensions(), (64, 48));
}

#[test]
fn what_was_chosen_is_there_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = model(Folders::under(folder.path()), None);
    press(&mut first, Modifiers::NONE, Key::G);
    press(&mut first, Modifiers::NONE, Key::Plus);
    click(&mut first, "Settings");
    click(&mut first, "light");
    click(&mut first, "Larger");
    click(&mut first, "Animate");
    click(&mut first, "4 samples");
    settle(&mut first);
    let there = place(&first);
    first.state_mut().save();
    let again = model(Folders::under(folder.path()), None);
    let state = &again.state().state;
    assert_eq!(place(&again), there);
    assert!(state.layers.grid && !state.look.animate && state.look.theme == Theme::Light);
    assert!(state.look.ui_scale > 1.0 && state.look.edges == EdgeSamples::Four);
    // A requested scene takes precedence over the saved view.
    let shore = BuiltIn::named("shore").unwrap().document();
    let asked = model(Folders::under(folder.path()), Some(shore.clone()));
    assert_eq!(place(&asked), location::text(&shore.scene()));
}

#[test]
fn figures_are_a_key_away_and_the_map_rests_behind_them() {
    let mut desktop = home();
    let before = (counts(&desktop), place(&desktop));
    let keys = [Key::F2, Key::F3, Key::F4, Key::F5, Key::F6, Key::F7];
    for (key, figure) in keys.into_iter().zip(Figure::all()) {
        press(&mut desktop, Modifiers::NONE, key);
        assert_eq!(desktop.state().lab.figure, figure);
        assert_eq!(desktop.state().figure_shown(), Some(figure.name()));
        // Keys for the map have no effect here.
        press(&mut desktop, Modifiers::NONE, Key::ArrowLeft);
        desktop.run_steps(20);
    }
    assert_eq!((counts(&desktop), place(&desktop)), before);
    press(&mut desktop, Modifiers::NONE, Key::F8);
    assert_eq!(desktop.state().figure_shown(), None, "the seventh figure is the map");
    desktop.get_by_label_contains("2 cos θ1 + cos θ2 > 1");
    press(&mut desktop, Modifiers::NONE, Key::Escape);
    assert!(!desktop.state().state.shown.lab);
}

#[test]
fn a_pinned_pixel_opens_in_the_lab_and_a_start_aimed_there_on_the_map() {
    let mut desktop = home();
    press(&mut desktop, Modifiers::NONE, Key::ArrowLeft);
    settle(&mut desktop);
    press(&mut desktop, Modifiers::NONE, Key::P);
    let pin =
        desktop.state().state.pins.selected().unwrap().start.angle.map(|theta| theta.to_f64());
    until(&mut desktop, "the flight", |desktop| {
        desktop.state().state.pins.iter().all(|pin| pin.flight.record().ending.is_some())
    });
    click(&mut desktop, "In the lab");
    click(&mut desktop, Figure::Twenty.title());
    assert_eq!(desktop.state().figure_shown(), Some("twenty"));
    assert_eq!(desktop.state().lab.set()[..2], pin);
    click(&mut desktop, "Show this start on the map");
    settle(&mut desktop);
    let state = &desktop.state().state;
    assert_eq!((desktop.state().figure_shown(), state.pins.iter().count()), (None, 2));
    let there = state.camera.center.map(|theta| theta.to_f64());
    assert!((there[0] - pin[0]).abs() < 1e-12 && (there[1] - pin[1]).abs() < 1e-12);
    let pinned = state.pins.selected().unwrap().start.angle.map(|theta| theta.to_f64());
    assert!((pinned[0] - pin[0]).abs() < 0.01, "{pinned:?} for {pin:?}");
}
