//! The descent panel: the views found by descending, with links to them and a button to film them.

use egui::Ui;

use flipmap_numbers::number_text::significant;
use flipmap_scene::Scene;

/// The state shown in the panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DescentView<'a> {
    /// True if the descent is still running.
    pub going: bool,
    /// The views so far, the widest first.
    pub scenes: &'a [Scene],
}

/// An action of the user in the panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum DescentAction {
    /// Starts a descent at the middle of the view, or stops it.
    Toggle,
    /// Opens the view with this index.
    Open(usize),
    /// Makes a film of the views.
    Film,
}

/// Shows the descent; returns the user's actions.
pub(crate) fn descent_panel(ui: &mut Ui, way: &DescentView) -> Vec<DescentAction> {
    let mut actions = Vec::new();
    ui.label(
        "Follows the filament nearest to the middle of the view, or with D to the pointer, to \
         ever smaller views that still have structure. Any other action stops it.",
    );
    let button = if way.going { "Stop" } else { "Go deeper here" };
    if ui.button(button).clicked() {
        actions.push(DescentAction::Toggle);
    }
    if way.scenes.is_empty() {
        return actions;
    }
    ui.horizontal_wrapped(|ui| {
        for (k, scene) in way.scenes.iter().enumerate() {
            let width = scene.view.width_rad().hi;
            if ui.link(significant(width, 1)).on_hover_text("rad wide; go there").clicked() {
                actions.push(DescentAction::Open(k));
            }
        }
    });
    if way.scenes.len() > 1 && ui.button("Make a film of the descent").clicked() {
        actions.push(DescentAction::Film);
    }
    actions
}
