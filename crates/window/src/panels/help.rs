//! The list of keys and questions.

use egui::{Align2, Label, RichText, ScrollArea, Ui};

use crate::action::Action;
use crate::commands::{Command, shortcut_text};
use crate::state::Dialog;
use flipmap_scene::question::QuestionName;

/// Actions of the pointer and of groups of keys, for the list of keys.
pub(crate) const POINTER: [(&str, &str); 12] = [
    ("Drag", "Move the map"),
    ("Wheel, pinch, Ctrl+wheel", "Zoom about the pointer"),
    ("Click", "Pin the pixel and fly its pendulum"),
    ("Double click", "Zoom in; with Shift out"),
    ("Shift+drag", "Zoom to a rectangle"),
    ("Alt+drag, drag with the right button", "Turn the map"),
    ("Alt+wheel", "Stretch the map"),
    ("Ctrl+drag", "Move the light of the relief"),
    ("Drop a picture or scene", "Show it"),
    ("1 to 9", "Favourite colours; with Ctrl, save the current ones"),
    ("Ctrl+V", "Go to a location that was copied"),
    ("Tab, Shift+Tab", "Go through all controls"),
];

/// Returns the keys of a command as text.
pub(super) fn keys(command: &Command) -> String {
    command.keys.iter().map(shortcut_text).collect::<Vec<_>>().join(", ")
}

/// Shows the list of keys; returns an action if it is closed.
pub(crate) fn help(ctx: &egui::Context, commands: &[Command]) -> Option<Action> {
    let mut open = true;
    egui::Window::new("Keys and questions")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .show(ctx, |ui| {
            ScrollArea::vertical().max_height(0.75 * ui.ctx().content_rect().height()).show(
                ui,
                |ui| {
                    egui::Grid::new("keys").num_columns(2).striped(true).show(ui, |ui| {
                        for (what, does) in POINTER {
                            row(ui, what, does);
                        }
                        for command in commands.iter().filter(|command| !command.keys.is_empty()) {
                            row(ui, &keys(command), &command.name);
                        }
                    });
                    questions(ui);
                },
            );
        });
    (!open).then_some(Action::Toggle(Dialog::Help))
}

/// Shows the questions, each with its description.
fn questions(ui: &mut Ui) {
    ui.add_space(8.0);
    ui.heading("Questions, to be chosen under Scene");
    egui::Grid::new("questions").num_columns(2).striped(true).show(ui, |ui| {
        for ask in QuestionName::ALL {
            ui.label(RichText::new(ask.kind().name).strong());
            ui.add(Label::new(ask.kind().about).wrap());
            ui.end_row();
        }
    });
}

fn row(ui: &mut Ui, keys: &str, does: &str) {
    ui.label(RichText::new(keys).strong());
    ui.label(does);
    ui.end_row();
}
