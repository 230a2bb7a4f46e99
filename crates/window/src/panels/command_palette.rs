//! The command palette, which makes all commands searchable.

use egui::{Align2, Button, Key, Modal, Rect, ScrollArea, TextEdit, Ui, Vec2, pos2, vec2};

use super::colour_strip::paint_strip;
use super::help::keys;
use crate::action::Action;
use crate::commands::Command;
use crate::settings::Settings;
use crate::state::Dialog;
use flipmap_scene::palette::Palette;

/// Width of the palette in points.
const WIDTH: f32 = 360.0;
/// Share of the window's height above the palette, which stays where it is as its list changes.
const TOP_SHARE: f32 = 0.15;
/// Size in points of the colours beside a palette's name.
const SWATCH: Vec2 = vec2(72.0, 10.0);

/// Returns the commands whose names or other names contain every word of a query: those with most of
/// the words in their names first, among equals those used last, otherwise in their original order.
pub(crate) fn found<'a>(
    commands: &'a [Command],
    query: &str,
    recent: &[String],
) -> Vec<&'a Command> {
    let words: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
    let missing = |command: &Command| {
        let name = command.name.to_lowercase();
        words.iter().filter(|word| !name.contains(&***word)).count()
    };
    let fits = |command: &&Command| {
        let name = command.name.to_lowercase();
        words.iter().all(|word| name.contains(word) || command.also.contains(&**word))
    };
    let uses = |command: &Command| {
        recent.iter().position(|name| *name == command.name).unwrap_or(usize::MAX)
    };
    let mut found: Vec<&Command> = commands.iter().filter(fits).collect();
    found.sort_by_key(|command| (missing(command), uses(command)));
    found
}

impl Settings {
    /// Largest number of commands that are remembered.
    const MAX_RECENT_COMMANDS: usize = 5;

    /// Remembers a command as the one used last, unless it only serves tests.
    fn used(&mut self, command: &Command) {
        #[cfg(feature = "rigs")]
        if command.action == Action::LoseDevice {
            return;
        }
        self.recent_commands.retain(|name| *name != command.name);
        self.recent_commands.insert(0, command.name.to_string());
        self.recent_commands.truncate(Self::MAX_RECENT_COMMANDS);
    }
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
pub(crate) fn close(ctx: &egui::Context) {
    ctx.data_mut(|data| data.remove::<CommandSearch>(memory()));
}

/// Shows the command palette; returns the user's actions.
pub(crate) fn palette(
    ctx: &egui::Context,
    commands: &[Command],
    settings: &mut Settings,
) -> Vec<Action> {
    let height = ctx.content_rect().height();
    let area =
        Modal::default_area(memory()).anchor(Align2::CENTER_TOP, vec2(0.0, TOP_SHARE * height));
    let modal = Modal::new(memory()).area(area).show(ctx, |ui| {
        ui.set_width(WIDTH);
        search(ui, commands, &settings.recent_commands, (0.6 * height).min(360.0))
    });
    let chosen = modal.inner;
    let mut actions = Vec::new();
    if modal.should_close() || chosen.is_some() {
        actions.push(Action::Toggle(Dialog::Commands));
    }
    if let Some(command) = chosen {
        settings.used(command);
        actions.push(command.action.clone());
    }
    actions
}

/// Shows the search field and the commands found; returns the one that was chosen.
fn search<'a>(
    ui: &mut Ui,
    commands: &'a [Command],
    recent: &[String],
    max_height: f32,
) -> Option<&'a Command> {
    let mut search: CommandSearch = ui.data(|data| data.get_temp(memory())).unwrap_or_default();
    let step = ui.input_mut(|input| {
        let mut count = |key| input.count_and_consume_key(egui::Modifiers::NONE, key) as isize;
        count(Key::ArrowDown) - count(Key::ArrowUp)
    });
    let heading = ui.label("What would you like to do?");
    let field = ui.add(TextEdit::singleline(&mut search.query).desired_width(f32::INFINITY));
    field.labelled_by(heading.id).request_focus();
    let entered = ui.input(|input| input.key_pressed(Key::Enter));
    let found = found(commands, &search.query, recent);
    search.chosen = search.chosen.saturating_add_signed(step).min(found.len().saturating_sub(1));
    let mut done = None;
    ScrollArea::vertical().max_height(max_height).show(ui, |ui| {
        for (place, command) in found.iter().enumerate() {
            let chosen = place == search.chosen;
            let button = Button::new(&*command.name).shortcut_text(keys(command));
            let width = ui.available_width();
            let response = ui.add(button.min_size(vec2(width, 0.0)).selected(chosen));
            swatch(ui, response.rect, command);
            if chosen && step != 0 {
                response.scroll_to_me(None);
            }
            if response.clicked() || (entered && chosen) {
                done = Some(*command);
            }
        }
        if found.is_empty() {
            ui.label("Nothing found.");
        }
    });
    ui.data_mut(|data| data.insert_temp(memory(), search));
    done
}

/// Shows the colours of the palette that a command is about at the right of its row.
fn swatch(ui: &Ui, row: Rect, command: &Command) {
    let palette = command.swatch.as_ref().and_then(|text| Palette::named(text).ok());
    if let Some(palette) = palette {
        let corner = pos2(row.right() - SWATCH.x - 6.0, row.center().y - 0.5 * SWATCH.y);
        paint_strip(ui, Rect::from_min_size(corner, SWATCH), |share| palette.colour(share));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::commands;
    use crate::state::tests::state;

    #[test]
    fn commands_used_last_come_first() {
        let commands = commands(&state());
        let mut settings = Settings::default();
        let first = |settings: &Settings, query: &str| {
            found(&commands, query, &settings.recent_commands)[0].name.to_string()
        };
        let used = |name: &str| commands.iter().find(|command| command.name == name).unwrap();
        let before = first(&settings, "");
        for name in ["Move left", "Quit", "Move up"] {
            settings.used(used(name));
        }
        assert_eq!(
            (first(&settings, ""), first(&settings, "quit")),
            ("Move up".into(), "Quit".into())
        );
        assert_eq!(first(&settings, "move"), "Move up");
        settings.used(used("Quit"));
        assert_eq!(settings.recent_commands, ["Quit", "Move up", "Move left"]);
        (0..9).for_each(|k| settings.used(&commands[k]));
        assert_eq!(settings.recent_commands.len(), Settings::MAX_RECENT_COMMANDS);
        assert_eq!(first(&Settings::default(), ""), before);
    }
}
