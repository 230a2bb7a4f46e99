//! The list of keys and questions, and the command palette, which makes the same commands
//! searchable.

use egui::{Align2, Key, Label, Modal, RichText, ScrollArea, TextEdit, Ui};

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
fn keys(command: &Command) -> String {
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

/// Returns the commands whose names or other names contain every word of a query: those with most of
/// the words in their names first, otherwise in their original order.
pub(crate) fn found<'a>(commands: &'a [Command], query: &str) -> Vec<&'a Command> {
    let words: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
    let missing = |command: &Command| {
        let name = command.name.to_lowercase();
        words.iter().filter(|word| !name.contains(&***word)).count()
    };
    let fits = |command: &&Command| {
        let name = command.name.to_lowercase();
        words.iter().all(|word| name.contains(word) || command.also.contains(&**word))
    };
    let mut found: Vec<&Command> = commands.iter().filter(fits).collect();
    found.sort_by_key(|command| missing(command));
    found
}

/// The text typed into the palette, and the index of the chosen command among those found. Kept in
/// egui's memory while the palette is open.
#[derive(Clone, Debug, Default, PartialEq)]
struct CommandSearch {
    query: String,
    chosen: usize,
}

fn memory() -> egui::Id {
    egui::Id::unique("command palette")
}

/// Discards the typed text of a palette that has been closed.
pub(crate) fn close_palette(ctx: &egui::Context) {
    ctx.data_mut(|data| data.remove::<CommandSearch>(memory()));
}

/// Shows the command palette; returns the user's actions.
pub(crate) fn palette(ctx: &egui::Context, commands: &[Command]) -> Vec<Action> {
    let mut actions = Vec::new();
    let modal = Modal::new(memory()).show(ctx, |ui| {
        ui.set_width(360.0);
        let mut search: CommandSearch = ui.data(|data| data.get_temp(memory())).unwrap_or_default();
        let step = ui.input_mut(|input| {
            let mut count = |key| input.count_and_consume_key(egui::Modifiers::NONE, key) as isize;
            count(Key::ArrowDown) - count(Key::ArrowUp)
        });
        let heading = ui.label("What would you like to do?");
        let field = ui.add(TextEdit::singleline(&mut search.query).desired_width(f32::INFINITY));
        field.labelled_by(heading.id).request_focus();
        let entered = ui.input(|input| input.key_pressed(Key::Enter));
        let found = found(commands, &search.query);
        search.chosen =
            search.chosen.saturating_add_signed(step).min(found.len().saturating_sub(1));
        ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
            for (place, command) in found.iter().enumerate() {
                let chosen = place == search.chosen;
                let button = egui::Button::new(&*command.name).shortcut_text(keys(command));
                let button =
                    button.min_size(egui::vec2(ui.available_width(), 0.0)).selected(chosen);
                let response = ui.add(button);
                if chosen && step != 0 {
                    response.scroll_to_me(None);
                }
                if response.clicked() || (entered && chosen) {
                    actions.push(command.action.clone());
                }
            }
            if found.is_empty() {
                ui.label("Nothing found.");
            }
        });
        ui.data_mut(|data| data.insert_temp(memory(), search));
    });
    if modal.should_close() || !actions.is_empty() {
        actions.insert(0, Action::Toggle(Dialog::Commands));
    }
    actions
}
