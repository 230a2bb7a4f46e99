//! The scene panel: the pendulum, the question about it, and the plane of starts.

use egui::{ComboBox, Grid, TextureId, Ui};

use super::field::number;
use super::plane_diagram::plane_diagram;
use super::question_tiles::question_tiles;
use flipmap_numbers::Decimal;
use flipmap_pendulum::Rule;
use flipmap_scene::question::{QuestionName, Watches};
use flipmap_scene::{Axis, Budget, Kind, PendulumSpec, Plane, PlaneKind, QuestionSettings, Scene};
use flipmap_screen::meant;

/// Shows the question, the pendulum and the plane; returns the scene if it has changed and can be
/// computed. `texture` returns the picture of a question, by its place among all, if it is known.
pub fn scene_panel(
    ui: &mut Ui,
    scene: &Scene,
    texture: impl FnMut(usize) -> Option<TextureId>,
) -> Option<Scene> {
    let mut new = scene.clone();
    question_tiles(ui, &mut new.question, texture);
    ui.label(new.question.ask.kind().about);
    Grid::new("question").num_columns(2).show(ui, |ui| asked(ui, &mut new.question));
    ui.separator();
    Grid::new("pendulum").num_columns(2).show(ui, |ui| built(ui, &mut new.build));
    ui.separator();
    Grid::new("plane").num_columns(2).show(ui, |ui| plane(ui, &mut new.plane));
    plane_diagram(ui, &new.plane);
    let home = Scene { view: scene.view.clone(), ..Scene::default() };
    let reset = egui::Button::new("Back to the home pendulum");
    if ui.add_enabled(*scene != home, reset).clicked() {
        new = home;
    }
    if new == *scene {
        return None;
    }
    new.without_unused().checked().ok()
}

fn built(ui: &mut Ui, build: &mut PendulumSpec) {
    ui.label("Kind");
    ui.horizontal(|ui| {
        let points = ui.radio_value(&mut build.kind, Kind::Points, "points");
        points.on_hover_text("Bobs on massless rods");
        let rods = ui.radio_value(&mut build.kind, Kind::Rods, "rods");
        rods.on_hover_text("Uniform bars");
    });
    ui.end_row();
    pair(ui, ["Mass m1", "Mass m2"], " kg", &mut build.masses, PendulumSpec::MASSES_KG);
    pair(ui, ["Length l1", "Length l2"], " m", &mut build.lengths, PendulumSpec::LENGTHS_M);
    let (least, most) = PendulumSpec::GRAVITIES.into_inner();
    if let Some(gravity) = number(ui, "Gravity g", " m/s²", build.gravity.value(), 0.0..=most) {
        // Gravity below the smallest allowed positive value becomes 0.
        build.gravity = if gravity < least { 0.0 } else { gravity }.into();
    }
    ui.end_row();
    let friction = PendulumSpec::FRICTIONS;
    pair(ui, ["Friction b1", "Friction b2"], " N m s", &mut build.friction, friction);
}

fn pair(
    ui: &mut Ui,
    names: [&str; 2],
    unit: &str,
    values: &mut [Decimal; 2],
    range: std::ops::RangeInclusive<f64>,
) {
    for (name, value) in names.into_iter().zip(values) {
        if let Some(new) = number(ui, name, unit, value.value(), range.clone()) {
            *value = new.into();
        }
        ui.end_row();
    }
}

const FOLLOWS: &str = "The deeper the view, the longer its pendulums stay together: the budget ends \
                       when neighbouring pixels of the middle have come a turn apart, in steps of 5 s \
                       (of the default pendulum)";

fn asked(ui: &mut Ui, question: &mut QuestionSettings) {
    let kind = question.ask.kind();
    if kind.watches == Watches::TheRule {
        rule(ui, &mut question.rule);
    }
    if kind.has_count {
        let most = f64::from(QuestionSettings::MAX_COUNT);
        if let Some(count) = number(ui, "Flip number", "", f64::from(question.count), 1.0..=most) {
            question.count = count.round() as u32;
        }
        ui.end_row();
    } else {
        question.count = 1;
    }
    if let Some(secs) = number(ui, "Budget", " s", question.budget.secs, Budget::SECS) {
        question.budget = Budget::secs(secs);
    }
    ui.end_row();
    if kind.at_a_time {
        moment(ui, question);
    } else {
        question.at = None;
    }
    if question.ask == QuestionName::Flip && question.count == 1 {
        ui.label("");
        ui.checkbox(&mut question.budget.auto, "Follow the depth").on_hover_text(FOLLOWS);
        ui.end_row();
    }
}

/// Shows the moment of the answer, which is the end of the budget by default.
fn moment(ui: &mut Ui, question: &mut QuestionSettings) {
    let budget_secs = question.budget.secs;
    question.at = question.at.map(|secs| secs.min(budget_secs));
    let shown = question.at.unwrap_or(budget_secs);
    if let Some(secs) = number(ui, "At", " s", shown, 0.0..=budget_secs) {
        question.at = (secs < budget_secs).then_some(secs);
    }
    ui.end_row();
}

fn rule(ui: &mut Ui, rule: &mut Rule) {
    ui.label("Rule").on_hover_text("Which bob must flip over the top");
    ui.horizontal(|ui| {
        for (word, each) in Rule::ALL {
            let told = match each {
                Rule::Second => "The second bob is watched",
                Rule::First => "The first bob is watched",
                Rule::Either | Rule::Neither => {
                    "Both bobs are watched; whichever flips first counts"
                }
            };
            ui.radio_value(rule, each, word).on_hover_text(told);
        }
    });
    ui.end_row();
}

/// Largest fixed angle in rad or fixed speed in rad/s.
const FAR: f64 = 1e3;

fn plane(ui: &mut Ui, plane: &mut Plane) {
    let label = ui.label("Plane");
    let combo = ComboBox::from_id_salt("plane").selected_text(plane.kind.to_string());
    let combo = combo.show_ui(ui, |ui| {
        for (name, kind) in PlaneKind::NAMED {
            ui.selectable_value(&mut plane.kind, kind, name);
        }
    });
    combo.response.labelled_by(label.id);
    ui.end_row();
    if plane.kind == PlaneKind::Section {
        if let Some(energy) = number(ui, "Energy", " J", plane.energy, Plane::ENERGIES_J) {
            plane.energy = energy;
        }
        ui.end_row();
        return;
    }
    let axes = plane.axes();
    for (place, axis) in Axis::OF_STARTS.into_iter().enumerate() {
        if axes.contains(&axis) || (axes.map(Axis::wraps) == [true; 2] && plane.is_at_rest()) {
            continue;
        }
        let value = plane.origin[place].parse().unwrap_or(0.0);
        let name = format!("Fixed {}", axis.symbol());
        if let Some(value) = number(ui, &name, &format!(" {}", axis.unit()), value, -FAR..=FAR) {
            plane.origin[place] = meant(value).to_string();
        }
        ui.end_row();
    }
}
