//! The accuracy of the map, and the engine that computes it.

use egui::{RichText, Ui};

use crate::action::Action;
use flipmap_engine::choice::IntegrationSetting;
use flipmap_engine::{Accuracy, EngineKind, IntegratorConfig};

/// The state shown in the panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Computing {
    /// The integration setting: an accuracy level, or an explicit integrator config.
    pub setting: IntegrationSetting,
    /// The requested kind of engine.
    pub kind: Option<EngineKind>,
    /// The integrator config in use.
    pub config: Option<IntegratorConfig>,
    /// Name of the engine, its adapter, and the reason why it was chosen.
    pub engine: Option<(String, String, String)>,
    /// True if there is no engine and none is being opened.
    pub failed: bool,
    /// Recent microseconds per integrated pixel of the levels that were measured.
    pub cost_us: Vec<(Accuracy, f64)>,
}

/// Returns the promise of a level, in words.
fn promise(accuracy: Accuracy) -> &'static str {
    match accuracy {
        Accuracy::Lesson => "RK4 at 120 steps a second: nine pixels of ten are right",
        Accuracy::Fast => "the best of single precision: 93 of 100 are right",
        Accuracy::Balanced => "all but one pixel in a thousand are right within 1 ms",
        Accuracy::Exact => "every pixel is checked, and hatched where the checks disagree",
    }
}

/// Returns how sure the answers of a setting are: in a few words, and in a sentence.
pub(crate) fn sure_words(setting: IntegrationSetting) -> (String, String) {
    match setting {
        IntegrationSetting::Accuracy(level) => {
            let short = match level {
                Accuracy::Lesson => "9 of 10 pixels right",
                Accuracy::Fast => "93 of 100 pixels right",
                Accuracy::Balanced => "999 of 1000 pixels right",
                Accuracy::Exact => "every pixel checked",
            };
            (short.to_string(), format!("Accuracy {level}: {}.", promise(level)))
        }
        IntegrationSetting::Explicit(_) => {
            ("a method of your own".to_string(), "The scene asks for this method.".to_string())
        }
    }
}

/// Shows the levels and the engines; returns the user's actions.
pub(crate) fn accuracy_panel(ui: &mut Ui, computing: &Computing) -> Vec<Action> {
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
            (None, "fastest"),
            (Some(EngineKind::Gpu), "graphics"),
            (Some(EngineKind::Cpu), "processor"),
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

/// Returns an integrator config in words.
pub(crate) fn words(config: &IntegratorConfig) -> String {
    format!("{} {} in {}", config.method.name(), config.method.setting(), config.precision)
}
