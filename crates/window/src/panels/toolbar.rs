//! The toolbar over the upper edge of the map: the most frequent actions, each with a painted icon.

use egui::{
    Align2, Area, Color32, Frame, Id, Painter, Popup, Pos2, Rect, Response, Role, Sense, Shape,
    Stroke, Ui, WidgetInfo, pos2, vec2,
};

use crate::action::{Action, Look};
use crate::commands::{Command, shortcut_text};
use crate::state::Dialog;
use flipmap_lab::Figure;

/// Side of a button in points.
const SIDE: f32 = 26.0;

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
        tool("Choose colours", Icon::colours, Action::Panel("Colours")),
        tool("Dive, or stop", Icon::deeper, Action::GoDeeper),
        tool("Export a picture", Icon::export, Action::Panel("Export")),
        tool("List the keys", Icon::help, Action::Toggle(Dialog::Help)),
    ];
    let mut actions = Vec::new();
    let area = Area::new(Id::unique("toolbar")).pivot(Align2::CENTER_TOP);
    area.fixed_pos(map.center_top() + vec2(0.0, 6.0)).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(2).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 1.0;
                for tool in tools {
                    let is_last = tool.name == "List the keys";
                    if is_last {
                        actions.extend(lab_menu(ui, commands));
                    }
                    if button(ui, &tool, keys_of(commands, &tool.action)).clicked() {
                        actions.push(tool.action);
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

fn button(ui: &mut Ui, tool: &Tool, keys: String) -> Response {
    let sense = if tool.enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), sense);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, tool.enabled, tool.name));
    let visuals = if tool.enabled {
        *ui.style().interact(&response)
    } else {
        ui.visuals().widgets.noninteractive
    };
    let faint = if tool.enabled { 1.0 } else { 0.4 };
    if response.hovered() || response.has_focus() {
        let (fill, rim) = (visuals.weak_bg_fill, visuals.bg_stroke);
        ui.painter().rect(rect, 4.0, fill, rim, egui::StrokeKind::Inside);
    }
    let ink = visuals.fg_stroke.color.gamma_multiply(faint);
    (tool.icon)(&Icon { painter: ui.painter().clone(), middle: rect.center(), ink });
    response.on_hover_text(format!("{}{keys}", tool.name))
}

/// Shows the button of the laboratory with the menu of its figures.
fn lab_menu(ui: &mut Ui, commands: &[Command]) -> Option<Action> {
    let lab = Tool {
        name: "Figures of the laboratory",
        icon: Icon::lab,
        enabled: true,
        action: Action::Lab(None),
    };
    let response = button(ui, &lab, " (F2 to F8)".to_string());
    let mut chosen = None;
    Popup::menu(&response).show(|ui| {
        for figure in Figure::all() {
            let action = Action::Lab(Some(figure));
            let keys = keys_of(commands, &action);
            if ui.button(format!("{}{keys}", figure.title())).clicked() {
                chosen = Some(action);
                ui.close();
            }
        }
    });
    chosen
}

/// The painter and the place of an icon, which reaches 7 points from its middle.
struct Icon {
    painter: Painter,
    middle: Pos2,
    ink: Color32,
}

impl Icon {
    fn at(&self, x: f32, y: f32) -> Pos2 {
        self.middle + vec2(x, y)
    }

    fn line(&self, points: &[(f32, f32)]) {
        let points = points.iter().map(|(x, y)| self.at(*x, *y)).collect();
        self.painter.add(Shape::line(points, self.stroke()));
    }

    fn stroke(&self) -> Stroke {
        Stroke::new(1.6, self.ink)
    }

    fn home(&self) {
        self.line(&[(-7.0, 0.0), (0.0, -6.5), (7.0, 0.0)]);
        self.line(&[(-5.0, -1.0), (-5.0, 6.0), (5.0, 6.0), (5.0, -1.0)]);
    }

    fn back(&self) {
        self.line(&[(7.0, 0.0), (-6.0, 0.0)]);
        self.line(&[(-1.5, -5.0), (-6.5, 0.0), (-1.5, 5.0)]);
    }

    fn forward(&self) {
        self.line(&[(-7.0, 0.0), (6.0, 0.0)]);
        self.line(&[(1.5, -5.0), (6.5, 0.0), (1.5, 5.0)]);
    }

    /// Draws four bands, from dark to light.
    fn colours(&self) {
        let bands =
            [(0x3b, 0x1c, 0x70), (0xb0, 0x3a, 0x6e), (0xf0, 0x8a, 0x4b), (0xf6, 0xe0, 0x9a)];
        for (band, (r, g, b)) in bands.into_iter().enumerate() {
            let left = self.middle.x - 7.0 + 3.5 * band as f32;
            let band = Rect::from_min_size(pos2(left, self.middle.y - 6.0), vec2(3.5, 12.0));
            self.painter.rect_filled(band, 0.0, Color32::from_rgb(r, g, b));
        }
    }

    /// Draws frames within frames.
    fn deeper(&self) {
        for half in [7.0, 4.2, 1.6] {
            self.line(&[
                (-half, -half),
                (half, -half),
                (half, half),
                (-half, half),
                (-half, -half),
            ]);
        }
    }

    /// Draws a double pendulum.
    fn lab(&self) {
        self.line(&[(-2.0, -7.0), (2.5, -1.0), (-1.5, 5.0)]);
        self.painter.circle_filled(self.at(2.5, -1.0), 2.2, self.ink);
        self.painter.circle_filled(self.at(-1.5, 5.0), 2.6, self.ink);
    }

    fn export(&self) {
        self.line(&[(0.0, -7.0), (0.0, 3.0)]);
        self.line(&[(-4.0, -0.5), (0.0, 3.5), (4.0, -0.5)]);
        self.line(&[(-7.0, 2.0), (-7.0, 6.5), (7.0, 6.5), (7.0, 2.0)]);
    }

    fn help(&self) {
        let font = egui::FontId::proportional(17.0);
        self.painter.text(self.middle, Align2::CENTER_CENTER, "?", font, self.ink);
    }
}
