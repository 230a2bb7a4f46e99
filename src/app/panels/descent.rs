//! Going deeper: the views found on the way down, and what becomes of them.

use egui::{Button, TextEdit, Ui};

use crate::scene::Scene;

/// What the panel shows.
#[derive(Clone, Debug, PartialEq)]
pub struct DescentView<'a> {
    /// Whether it still goes down.
    pub going: bool,
    /// The views so far, the widest first.
    pub scenes: &'a [Scene],
    /// The file for film keys.
    pub path: &'a str,
}

/// What the person wants.
#[derive(Clone, Debug, PartialEq)]
pub enum DescentAction {
    /// Begin at the middle of the view, or stop.
    Toggle,
    /// Go to this view, counted from 0.
    Open(usize),
    /// The file is now called so.
    Path(String),
    /// Add all views to it as film keys.
    Keep,
}

/// Shows the way down; answers with what the person does.
pub fn descent_panel(ui: &mut Ui, way: &DescentView) -> Vec<DescentAction> {
    let mut actions = Vec::new();
    ui.label(
        "Follows the filament nearest to the middle of the view, or with D to the pointer, to \
         ever smaller views that still have structure. Whatever you do then stops it.",
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
            if ui.link(format!("{width:.0e}")).on_hover_text("rad wide; go there").clicked() {
                actions.push(DescentAction::Open(k));
            }
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("File");
        let mut path = way.path.to_string();
        let field = TextEdit::singleline(&mut path).desired_width(120.0);
        if ui.add(field).labelled_by(label.id).changed() {
            actions.push(DescentAction::Path(path));
        }
        let ready = !way.path.trim().is_empty();
        if ui.add_enabled(ready, Button::new("Keep as film keys")).clicked() {
            actions.push(DescentAction::Keep);
        }
    });
    actions
}
