//! The question: which pendulum, which bob is watched, and for how long.

use egui::{Grid, Ui};

use super::field::number;
use crate::physics::{Decimal, Rule};
use crate::scene::{Budget, Build, Kind, QuestionTable, Scene};

/// Range of a mass in kg or a length in m.
const WIDE: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Shows the pendulum and the question; returns both if one has changed. Returns only what can be
/// computed.
pub fn scene_panel(
    ui: &mut Ui,
    build: &Build,
    question: &QuestionTable,
) -> Option<(Build, QuestionTable)> {
    let (mut new_build, mut new_question) = (*build, *question);
    Grid::new("scene").num_columns(2).show(ui, |ui| {
        built(ui, &mut new_build);
        asked(ui, &mut new_question);
    });
    let home = Scene::default();
    let changed = (*build, *question) != (home.build, home.question);
    let reset = egui::Button::new("Back to the home pendulum");
    if ui.add_enabled(changed, reset).clicked() {
        (new_build, new_question) = (home.build, home.question);
    }
    if (new_build, new_question) == (*build, *question) {
        return None;
    }
    let scene = Scene { build: new_build, question: new_question, ..home };
    scene.checked().ok().map(|scene| (scene.build, scene.question))
}

fn built(ui: &mut Ui, build: &mut Build) {
    ui.label("Kind");
    ui.horizontal(|ui| {
        let points = ui.radio_value(&mut build.kind, Kind::Points, "points");
        points.on_hover_text("Bobs on massless rods");
        let rods = ui.radio_value(&mut build.kind, Kind::Rods, "rods");
        rods.on_hover_text("Uniform bars");
    });
    ui.end_row();
    pair(ui, ["Mass m1", "Mass m2"], " kg", &mut build.masses);
    pair(ui, ["Length l1", "Length l2"], " m", &mut build.lengths);
    if let Some(gravity) = number(ui, "Gravity g", " m/s²", build.gravity.value(), 0.0..=1e9) {
        // Gravity below the smallest allowed positive value becomes none.
        build.gravity = if gravity < 1e-9 { 0.0 } else { gravity }.into();
    }
    ui.end_row();
}

fn pair(ui: &mut Ui, names: [&str; 2], unit: &str, values: &mut [Decimal; 2]) {
    for (name, value) in names.into_iter().zip(values) {
        if let Some(new) = number(ui, name, unit, value.value(), WIDE) {
            *value = new.into();
        }
        ui.end_row();
    }
}

const FOLLOWS: &str = "The deeper the view, the longer its pendulums stay together: the budget ends \
                       when neighbouring pixels of the middle have come a turn apart, in steps of 5 s \
                       (of the default pendulum)";

fn asked(ui: &mut Ui, question: &mut QuestionTable) {
    ui.label("Rule").on_hover_text("Which bob must flip over the top");
    ui.horizontal(|ui| {
        for (word, rule) in Rule::ALL {
            let told = match rule {
                Rule::Second => "The second bob is watched",
                Rule::First => "The first bob is watched",
                Rule::Either | Rule::Neither => {
                    "Both bobs are watched; whichever flips first counts"
                }
            };
            ui.radio_value(&mut question.rule, rule, word).on_hover_text(told);
        }
    });
    ui.end_row();
    if let Some(secs) = number(ui, "Budget", " s", question.budget.secs, 1e-9..=1e6) {
        question.budget = Budget::secs(secs);
    }
    ui.end_row();
    ui.label("");
    ui.checkbox(&mut question.budget.auto, "Follow the depth").on_hover_text(FOLLOWS);
    ui.end_row();
}
