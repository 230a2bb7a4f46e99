//! How right the map is, and what computes it.

use egui::{RichText, Ui};

use crate::app::action::Action;
use crate::engine::choice::{Demand, Kind};
use crate::engine::{Accuracy, Recipe};

/// What the panel tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Computing {
    /// A level or a recipe.
    pub demand: Demand,
    /// The kind of engine wanted.
    pub kind: Kind,
    /// What runs now.
    pub recipe: Option<Recipe>,
    /// The engine: its name, adapter and why it was chosen.
    pub engine: Option<(String, String, String)>,
    /// Whether there is no engine and none is coming.
    pub failed: bool,
    /// Microseconds an integrated pixel of each level took lately, where it was measured.
    pub cost_us: Vec<(Accuracy, f64)>,
}

/// What a level promises.
fn promise(accuracy: Accuracy) -> &'static str {
    match accuracy {
        Accuracy::Lesson => "RK4 at 120 steps a second: nine pixels of ten are right",
        Accuracy::Fast => "the best of single precision: 93 of 100 are right",
        Accuracy::Balanced => "all but one pixel in a thousand are right within 1 ms",
        Accuracy::Exact => "every pixel is checked, and hatched where the checks disagree",
    }
}

/// Shows levels and engines.
pub fn accuracy_panel(ui: &mut Ui, computing: &Computing) -> Vec<Action> {
    let mut actions = Vec::new();
    for (word, accuracy) in Accuracy::ALL {
        let chosen = computing.demand == Demand::Level(accuracy);
        if ui.radio(chosen, word).on_hover_text(promise(accuracy)).clicked() && !chosen {
            actions.push(Action::Accuracy(accuracy));
        }
        let cost = computing.cost_us.iter().find(|(level, _)| *level == accuracy);
        if let (true, Some((_, us))) = (chosen, cost) {
            ui.label(
                RichText::new(format!("{us:.1} µs a pixel now; {}", promise(accuracy))).weak(),
            );
        } else if chosen {
            ui.label(RichText::new(promise(accuracy)).weak());
        }
    }
    if let Demand::Recipe(recipe) = computing.demand {
        ui.label(format!("As the scene asks: {}", words(&recipe)));
    }
    ui.separator();
    ui.horizontal(|ui| {
        ui.label("Engine");
        for (kind, word) in
            [(Kind::Auto, "fastest"), (Kind::Gpu, "graphics"), (Kind::Cpu, "processor")]
        {
            let chosen = computing.kind == kind;
            if ui.selectable_label(chosen, word).clicked() && !chosen {
                actions.push(Action::Engine(kind));
            }
        }
    });
    match (&computing.engine, &computing.recipe) {
        (Some((name, adapter, why)), Some(recipe)) => {
            let text = format!("{name}: {adapter}; {}", words(recipe));
            ui.label(RichText::new(text).weak()).on_hover_text(why);
        }
        _ if computing.failed => {
            ui.label("No engine.");
            if ui.button("Try again").clicked() {
                actions.push(Action::TryAgain);
            }
        }
        _ => {
            ui.label("Opening the engine…");
        }
    }
    actions
}

/// A recipe in words.
pub fn words(recipe: &Recipe) -> String {
    format!("{} {} in {}", recipe.method.name(), recipe.method.setting(), recipe.precision)
}
