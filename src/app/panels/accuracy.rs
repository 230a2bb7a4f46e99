//! How right the map is, and what computes it.

use egui::{RichText, Ui};

use crate::app::action::Action;
use crate::engine::choice::{EngineKind, IntegrationSetting};
use crate::engine::{Accuracy, IntegratorConfig};

/// What the panel tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Computing {
    /// A level or a config.
    pub setting: IntegrationSetting,
    /// The kind of engine wanted.
    pub kind: EngineKind,
    /// What runs now.
    pub config: Option<IntegratorConfig>,
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
        let chosen = computing.setting == IntegrationSetting::Accuracy(accuracy);
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
    if let IntegrationSetting::Explicit(config) = computing.setting {
        ui.label(format!("As the scene asks: {}", words(&config)));
    }
    ui.separator();
    ui.horizontal(|ui| {
        ui.label("Engine");
        for (kind, word) in [
            (EngineKind::Auto, "fastest"),
            (EngineKind::Gpu, "graphics"),
            (EngineKind::Cpu, "processor"),
        ] {
            let chosen = computing.kind == kind;
            if ui.selectable_label(chosen, word).clicked() && !chosen {
                actions.push(Action::Engine(kind));
            }
        }
    });
    match (&computing.engine, &computing.config) {
        (Some((name, adapter, why)), Some(config)) => {
            let text = format!("{name}: {adapter}; {}", words(config));
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

/// A config in words.
pub fn words(config: &IntegratorConfig) -> String {
    format!("{} {} in {}", config.method.name(), config.method.setting(), config.precision)
}
