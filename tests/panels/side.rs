//! The panels for the scene, colours, exports and places: their appearance, and their use by
//! control names and keyboard.

#[path = "side/colours.rs"]
mod colour_tests;
#[path = "side/film.rs"]
mod film_tests;

use std::collections::BTreeMap;

use egui::{Key, Role, Theme, Ui};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use flipmap_pendulum::Rule;
use flipmap_render::output::Picture;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{
    Budget, BuiltIn, Document, Kind, PendulumSpec, PictureTable, QuestionSettings, Sampling, Scale,
    Scene,
};
use flipmap_window::colour_cycle::ColourCycle;
use flipmap_window::export::ExportStage;
use flipmap_window::folders::Folders;
use flipmap_window::panels::colours::{ColourAction, ColoursView, colours_panel};
use flipmap_window::panels::export::{ExportAction, ExportForm, ExportStatus, export_panel};
use flipmap_window::panels::places::{PlaceAction, PlaceForm, Thumbnails, places_panel};
use flipmap_window::panels::scene::scene_panel;
use flipmap_window::places::Places;

/// A panel's state, and all actions it has requested so far.
struct Shown<S, A> {
    state: S,
    asked: Vec<A>,
}

/// A panel in a column of fixed size, without a running clock; `apply` performs its actions.
fn harness<S: 'static, A: Clone + 'static>(
    size: [f32; 2],
    state: S,
    mut panel: impl FnMut(&mut Ui, &S) -> Vec<A> + 'static,
    apply: impl Fn(&mut S, A) + 'static,
) -> Harness<'static, Shown<S, A>> {
    let show = move |ui: &mut Ui, shown: &mut Shown<S, A>| {
        for action in panel(ui, &shown.state) {
            apply(&mut shown.state, action.clone());
            shown.asked.push(action);
        }
    };
    let mut harness = Harness::builder()
        .with_context_setup(flipmap_lab::typeface::install)
        .with_size(size)
        .with_theme(Theme::Dark)
        .build_ui_state(show, Shown { state, asked: Vec::new() });
    harness.run_steps(3);
    harness
}

fn scene() -> Harness<'static, Shown<Scene, Scene>> {
    harness(
        [310.0, 960.0],
        Scene::default(),
        |ui, scene| scene_panel(ui, scene, |_| None).into_iter().collect(),
        |state, asked| *state = asked,
    )
}

fn colours(picture: PictureTable) -> Harness<'static, Shown<PictureTable, ColourAction>> {
    harness(
        [320.0, 840.0],
        picture,
        |ui, picture| {
            let cycle = ColourCycle::default();
            let view = ColoursView {
                picture,
                scene: &Scene::default(),
                has_samples: true,
                cycle: &cycle,
                times_secs: &[0.5, 1.0, 1.1, 1.2, 20.0],
                kept: &BTreeMap::from([("fire".into(), "#000000,#ff0000".into())]),
            };
            colours_panel(ui, &view).into_iter().collect()
        },
        |state, action| {
            if let ColourAction::Paint(picture) = action {
                *state = picture;
            }
        },
    )
}

fn export(exports: Vec<ExportStatus>) -> Harness<'static, Shown<ExportForm, ExportAction>> {
    harness(
        [340.0, 380.0],
        ExportForm {
            path: "/no/such/folder/map.png".to_string(),
            as_window: false,
            ..ExportForm::default()
        },
        move |ui, form| export_panel(ui, form, &exports),
        |state, action| {
            if let ExportAction::Change(form) = action {
                *state = form;
            }
        },
    )
}

fn places() -> Harness<'static, Shown<(Places, PlaceForm), PlaceAction>> {
    let mut places = Places::load(&Folders::none());
    let rgb = (0..32 * 24u32).flat_map(|k| [(k % 32 * 8) as u8, (k / 32 * 10) as u8, 90]).collect();
    let document = BuiltIn::named("tip").unwrap().document();
    places.add("a gap", Picture { document, size: [32, 24], rgb }).unwrap();
    let mut thumbnails = Thumbnails::default();
    harness(
        [340.0, 1060.0],
        (places, PlaceForm::default()),
        move |ui, (places, form)| places_panel(ui, places, form, &mut thumbnails),
        |(places, form), action| match action {
            PlaceAction::Change(new) => *form = new,
            PlaceAction::Rename(old, new) => places.rename(&old, &new).unwrap(),
            PlaceAction::Delete(name) => places.delete(&name).unwrap(),
            PlaceAction::Open(_) | PlaceAction::Visit(_) | PlaceAction::Add(_) => {}
        },
    )
}

/// Presses the control called `name`.
fn press<S>(harness: &mut Harness<'_, S>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(2);
}

/// Types over the number called `name`, as a user with a keyboard does.
fn type_over<S>(harness: &mut Harness<'_, S>, name: &str, text: &str) {
    type_into(harness, (Role::SpinButton, name), text);
}

/// Types a text in place of that in a control.
fn type_into<S>(harness: &mut Harness<'_, S>, (role, name): (Role, &str), text: &str) {
    harness.get_by_role_and_label(role, name).focus();
    harness.run_steps(2);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    harness.run_steps(1);
    harness.event(egui::Event::Text(text.to_string()));
    harness.run_steps(1);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
}

#[test]
fn the_scene_follows_what_is_pressed_and_typed() {
    let mut harness = scene();
    press(&mut harness, "rods");
    press(&mut harness, "either");
    type_over(&mut harness, "Mass m2", "2.5");
    type_over(&mut harness, "Gravity g", "1.62");
    type_over(&mut harness, "Budget", "60");
    let Scene { build, question, .. } = harness.state().state;
    assert_eq!(build, PendulumSpec::new(Kind::Rods, [1.0, 2.5], build.lengths_m(), 1.62));
    assert_eq!(
        question,
        QuestionSettings {
            rule: Rule::Either,
            budget: Budget::secs(60.0),
            ..QuestionSettings::default()
        }
    );
    assert_eq!(harness.state().asked.len(), 5, "one answer a change");
    press(&mut harness, "Back to the home pendulum");
    assert_eq!(harness.state().state, Scene::default());
}

#[test]
fn only_what_can_be_computed_comes_out_of_the_scene() {
    let mut harness = scene();
    for (name, text) in [
        ("Mass m1", "-1"),
        ("Length l2", "0"),
        ("Length l1", "nan"),
        ("Gravity g", "-9.81"),
        ("Gravity g", "1e-12"),
        ("Budget", "1e99"),
        ("Budget", "soon"),
    ] {
        type_over(&mut harness, name, text);
    }
    let asked = &harness.state().asked;
    assert!(!asked.is_empty());
    for scene in asked {
        scene.clone().checked().unwrap();
    }
    assert_eq!(harness.state().state.build.gravity, 0.0);
}

/// Chooses an entry of the box called `name`.
fn choose<S>(harness: &mut Harness<'_, S>, name: &str, entry: &str) {
    harness.get_by_role_and_label(Role::ComboBox, name).click();
    harness.run_steps(3);
    // The entries are the newest controls; a rule has the name of a plane.
    harness.get_all_by_label(entry).last().unwrap().click();
    harness.run_steps(4);
}

#[test]
fn question_and_plane_are_chosen_with_what_belongs_to_them() {
    let mut harness = scene();
    assert!(harness.query_by_role_and_label(Role::SpinButton, "At").is_none());
    press(&mut harness, "Where is it at time t?");
    assert_eq!(harness.state().state.question.at, Some(5.0), "later states are noise");
    type_over(&mut harness, "At", "12.5");
    let question = harness.state().state.question;
    assert_eq!((question.ask, question.at), (QuestionName::State, Some(12.5)));
    type_over(&mut harness, "Budget", "10");
    assert_eq!(harness.state().state.question.at, Some(10.0), "never beyond the budget");
    press(&mut harness, "When does it flip?");
    type_over(&mut harness, "Flip number", "3");
    let question = harness.state().state.question;
    assert_eq!((question.ask, question.at, question.count), (QuestionName::Flip, None, 3));
    choose(&mut harness, "Plane", "first");
    type_over(&mut harness, "Fixed θ2", "2.5");
    type_over(&mut harness, "Fixed ω2", "-1");
    let plane = harness.state().state.plane.clone();
    assert_eq!(plane.kind.to_string(), "first");
    assert_eq!(plane.origin, ["0", "2.5", "0", "-1"]);
    choose(&mut harness, "Plane", "section");
    type_over(&mut harness, "Energy", "-99");
    assert_eq!(harness.state().state.plane.energy, 0.0, "less than a hanging pendulum's");
    type_over(&mut harness, "Energy", "7");
    assert_eq!(harness.state().state.plane.energy, 7.0);
    type_over(&mut harness, "Friction b2", "0.25");
    assert_eq!(harness.state().state.build.friction[1], 0.25);
    press(&mut harness, "Back to the home pendulum");
    assert_eq!(harness.state().state, Scene::default());
}

#[test]
fn colours_follow_what_is_pressed_and_typed() {
    let mut harness = colours(PictureTable::default());
    press(&mut harness, "magma");
    press(&mut harness, "linear");
    press(&mut harness, "Reverse the palette");
    type_over(&mut harness, "From", "2");
    type_over(&mut harness, "To", "8");
    type_over(&mut harness, "Cycles", "3");
    let expected = PictureTable {
        palette: "magma".to_string(),
        reverse: true,
        cycles: 3.0,
        mirror: true,
        scale: Scale::Linear,
        times: vec![2.0, 8.0],
        ..PictureTable::default()
    };
    assert_eq!(harness.state().state, expected);
    // A range cannot end before it begins.
    type_over(&mut harness, "From", "9");
    harness.state().state.check().unwrap();
    assert!(harness.state().state.times[0] < 8.0);
    press(&mut harness, "Equalise to this view");
    assert_eq!(harness.state().asked.last(), Some(&ColourAction::Equalise));
    press(&mut harness, "Reset");
    assert_eq!(harness.state().state, PictureTable::default());
}

#[test]
fn exports_begin_and_stop_by_name() {
    let running = ExportStage::Running { share: 0.5, pace: "1 pixels/s".to_string() };
    let of = |name: &str, stage| ExportStatus { name: name.to_string(), stage, is_film: false };
    let exports = vec![of("a.png", running), of("b.png", ExportStage::Done { secs: 2.0 })];
    let mut harness = export(exports);
    press(&mut harness, "raw numbers");
    assert_eq!(harness.state().state.path, "/no/such/folder/map.npy");
    type_over(&mut harness, "Width", "640");
    type_over(&mut harness, "Height", "0");
    assert_eq!(harness.state().state.size, [640, 1]);
    choose(&mut harness, "Size", "as the window");
    assert!(harness.state().state.as_window);
    choose(&mut harness, "Size", "1024 × 1024");
    let form = &harness.state().state;
    assert_eq!((form.as_window, form.size), (false, [1024, 1024]));
    assert!(harness.query_by_label("Anti-aliasing").is_none(), "numbers have one sample each");
    press(&mut harness, "picture");
    for samples in [Sampling::SINGLE, Sampling::Corners] {
        press(&mut harness, "smart: finer where colours change");
        assert_eq!(harness.state().state.samples, samples);
    }
    type_over(&mut harness, "Anti-aliasing", "99");
    assert_eq!(harness.state().state.samples, Sampling::Square(8));
    press(&mut harness, "raw numbers");
    for name in ["Browse…", "Export", "Stop a.png", "Dismiss b.png"] {
        press(&mut harness, name);
    }
    let asked = &harness.state().asked;
    let last = &asked[asked.len() - 4..];
    use ExportAction::{Browse, Cancel, Dismiss, Start};
    assert_eq!(last, [Browse, Start, Cancel(0), Dismiss(1)]);
}

#[test]
fn an_export_without_a_name_cannot_begin() {
    let mut harness = export(Vec::new());
    harness.state_mut().state.path.clear();
    harness.run_steps(2);
    harness.get_by_label("Name the file to write.");
    press(&mut harness, "Export");
    assert!(harness.state().asked.is_empty());
}

#[test]
fn places_are_opened_kept_renamed_and_deleted() {
    let mut harness = places();
    press(&mut harness, "Open a gap");
    press(&mut harness, "Open island");
    let [tip, island] = ["tip", "island"].map(|name| BuiltIn::named(name).unwrap().document());
    let open = |document: Document| PlaceAction::Open(Box::new(document));
    let visit = PlaceAction::Visit(Box::new(island));
    assert_eq!(harness.state().asked, [open(tip), visit]);

    harness.get_by_role_and_label(Role::TextInput, "Name").focus();
    harness.run_steps(2);
    harness.event(egui::Event::Text(" here ".to_string()));
    harness.run_steps(2);
    press(&mut harness, "Keep this view");
    assert!(harness.state().asked.contains(&PlaceAction::Add("here".to_string())));

    press(&mut harness, "Rename a gap…");
    harness.get_by_role_and_label(Role::TextInput, "New name of a gap").focus();
    harness.run_steps(2);
    harness.key_press(Key::End);
    harness.event(egui::Event::Text("e".to_string()));
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(2);
    assert_eq!(harness.state().state.0.bookmarks()[0].name, "a gape");

    press(&mut harness, "Delete a gape…");
    press(&mut harness, "Keep a gape");
    assert_eq!(harness.state().state.0.bookmarks().len(), 1);
    press(&mut harness, "Delete a gape…");
    press(&mut harness, "Delete a gape for good");
    assert!(harness.state().state.0.bookmarks().is_empty());
}

#[test]
fn the_keyboard_reaches_every_button_of_an_export() {
    let mut harness = export(Vec::new());
    let mut reached = Vec::new();
    for _ in 0..20 {
        harness.key_press(Key::Tab);
        harness.run_steps(1);
        let focused = harness.root().children_recursive().find(|node| node.is_focused());
        reached.extend(focused.and_then(|node| node.accesskit_node().label()));
    }
    for name in ["picture", "raw numbers", "File", "Browse…", "Size", "Width", "Height", "Export"]
    {
        assert!(reached.iter().any(|label| label == name), "{name} is not in {reached:?}");
    }
}

needs_adapter! {
    pictures:
    the_scene_looks_as_it_should
    the_colours_look_as_they_should
    exports_look_as_they_should
    places_look_as_they_should
    films_look_as_they_should
}

mod pictures {
    use super::*;

    pub(crate) fn the_scene_looks_as_it_should() {
        scene().snapshot("side_scene");
    }

    pub(crate) fn the_colours_look_as_they_should() {
        let times = vec![0.5, 2.0, 3.0, 20.0];
        colours(PictureTable { cycles: 2.0, times, ..PictureTable::default() })
            .snapshot("side_colours");
    }

    pub(crate) fn exports_look_as_they_should() {
        let of = |name: &str, stage| ExportStatus { name: name.to_string(), stage, is_film: false };
        let running =
            ExportStage::Running { share: 0.42, pace: "1\u{a0}234\u{a0}567 pixels/s".to_string() };
        let why = "cannot write late.png: no storage space".to_string();
        export(vec![of("map.png", running), of("late.png", ExportStage::Failed(why))])
            .snapshot("side_export");
    }

    pub(crate) fn films_look_as_they_should() {
        film_tests::panel(&["6.3", "0.2", "1e-5"]).snapshot("side_film");
    }

    pub(crate) fn places_look_as_they_should() {
        places().snapshot("side_places");
    }
}
