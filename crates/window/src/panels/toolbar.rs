//! The toolbar over the upper edge of the map: the most frequent actions, each with a painted icon.

use egui::{Align2, Area, Frame, Id, Rect, Ui, vec2};

use super::icon::{Icon, IconButton};
use crate::action::{Action, Look};
use crate::commands::{Command, shortcut_text};
use crate::state::Dialog;

/// Side of a button in points.
const SIDE: f32 = 28.0;

/// A button of the bar.
struct Tool {
    name: &'static str,
    icon: fn(&Icon),
    /// True if the button has an effect now.
    enabled: bool,
    action: Action,
}

/// Shows the bar in the middle of the map's upper edge; returns the user's actions. The keys shown
/// are those of `commands`; `back` and `forward` say whether there are views to go to.
pub(crate) fn toolbar(
    ui: &Ui,
    map: Rect,
    commands: &[Command],
    [back, forward]: [bool; 2],
) -> Vec<Action> {
    let tool = |name, icon, action| Tool { name, icon, enabled: true, action };
    let tools = [
        tool("Show the whole map", Icon::home, Action::Look(Look::Home)),
        Tool { enabled: back, ..tool("Go back", Icon::back, Action::Look(Look::Back)) },
        Tool { enabled: forward, ..tool("Go forward", Icon::forward, Action::Look(Look::Forward)) },
        tool("Dive, or stop", Icon::deeper, Action::GoDeeper),
        tool("Save the picture on the screen", Icon::export, Action::SavePicture),
        tool("List the keys", Icon::help, Action::Toggle(Dialog::Help)),
    ];
    let mut actions = Vec::new();
    let area = Area::new(Id::unique("toolbar")).pivot(Align2::CENTER_TOP);
    area.fixed_pos(map.center_top() + vec2(0.0, 6.0)).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(2).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 1.0;
                for tool in tools {
                    let Tool { name, icon, enabled, action } = tool;
                    let hint = format!("{name}{}", keys_of(commands, &action));
                    let button = IconButton { name, icon, side: SIDE, enabled, is_chosen: None };
                    if button.show(ui).on_hover_text(hint).clicked() {
                        actions.push(action);
                    }
                }
            });
        });
    });
    actions
}

/// Returns the first key that triggers an action, as text in parentheses; empty if there is none.
fn keys_of(commands: &[Command], action: &Action) -> String {
    let command = commands.iter().find(|command| command.action == *action);
    let key = command.and_then(|command| command.keys.first());
    key.map(|key| format!(" ({})", shortcut_text(key))).unwrap_or_default()
}
