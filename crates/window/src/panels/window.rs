//! The window's own settings: theme, scale, animation, restoring the view, and cache size.

use egui::{Slider, Ui};

use crate::action::Action;
use crate::settings::{EdgeSamples, Settings, Theme};
use crate::state::{AppState, Dialog};

/// Shows the settings; returns the user's actions.
pub(crate) fn window_panel(ui: &mut Ui, state: &AppState, settings: &mut Settings) -> Vec<Action> {
    let mut actions = Vec::new();
    ui.horizontal(|ui| {
        for (theme, word) in
            [(Theme::System, "follow the system"), (Theme::Dark, "dark"), (Theme::Light, "light")]
        {
            if ui.radio(state.look.theme == theme, word).clicked() {
                actions.push(Action::Theme(theme));
            }
        }
    });
    ui.horizontal(|ui| {
        ui.label(format!("Scale {:.0} %", 100.0 * state.look.ui_scale));
        for (word, factor) in [("Smaller", 1.0 / 1.1), ("Larger", 1.1)] {
            if ui.button(word).clicked() {
                actions.push(Action::UiScale(state.look.ui_scale * factor));
            }
        }
    });
    let mut animate = state.look.animate;
    if ui.checkbox(&mut animate, "Animate").changed() {
        actions.push(Action::Animate(animate));
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("Smoothing when idle").on_hover_text(
            "Samples of a pixel where the map has edges, computed once all of it is known: they \
             smooth what is finer than a pixel",
        );
        for (edges, word) in EdgeSamples::ALL {
            if ui.radio(state.look.edges == edges, word).clicked() {
                actions.push(Action::Edges(edges));
            }
        }
    });
    ui.checkbox(&mut settings.magnet, "The wheel finds structure").on_hover_text(
        "Over a smooth part of the map, the wheel zooms about the edge next to the pointer",
    );
    ui.checkbox(&mut settings.restore, "Open where the window was left");
    let label = ui.label("Memory for places seen before, MiB (from the next start)");
    let slider = Slider::new(&mut settings.cache_mib, Settings::CACHE_MIB).logarithmic(true);
    ui.add(slider).labelled_by(label.id);
    ui.horizontal_wrapped(|ui| {
        for (word, action) in [
            ("Keys (F1)", Action::Toggle(Dialog::Help)),
            ("Full screen (F11)", Action::FullScreen),
            ("Copy the location", Action::CopyLocation),
            ("Copy the link", Action::CopyLink),
        ] {
            if ui.button(word).clicked() {
                actions.push(action);
            }
        }
    });
    actions
}
