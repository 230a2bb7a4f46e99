//! The card of the pinned pendulums over the map's upper right corner, and their stage in place of
//! the map.

use egui::{Align2, Area, Color32, Frame, Id, Rect, ScrollArea, Ui, vec2};

use super::action::Action;
use super::model::AppModel;
use super::panels::pendulum::{pendulum_card, stage};
use super::state::Dialog;
use flipmap_lab::Figure;
use flipmap_numbers::Scalar;
use flipmap_pendulum::{Outcome, State};
use flipmap_scene::palette::AnswerColours;

/// Width of the card in points, where there is room.
const CARD_POINTS: f32 = 260.0;
/// Largest share of the map's width that the card covers.
const CARD_SHARE: f32 = 0.45;
/// Distance from the map's edges in points.
const MARGIN_POINTS: f32 = 8.0;

impl AppModel {
    /// Shows the card of the pinned pendulums; returns the user's actions.
    pub(super) fn pendulum_card(&mut self, ui: &Ui, map: Rect) -> Vec<Action> {
        if self.state.pins.is_empty() {
            return Vec::new();
        }
        let corner = map.right_top() + vec2(-MARGIN_POINTS, MARGIN_POINTS);
        let width = CARD_POINTS.min(CARD_SHARE * map.width()).max(0.0);
        let most = (map.height() - 4.0 * MARGIN_POINTS).max(1.0);
        let area = Area::new(Id::unique("pendulum card")).pivot(Align2::RIGHT_TOP);
        let shown = area.fixed_pos(corner).constrain_to(map).show(ui.ctx(), |ui| {
            let fill = ui.visuals().window_fill.gamma_multiply(0.92);
            let frame = Frame::popup(ui.style()).fill(fill).inner_margin(8);
            frame.show(ui, |ui| {
                ui.set_width(width);
                // The area would offer no more height than it had in the frame before.
                ui.set_max_height(most);
                let scroll = ScrollArea::vertical().max_height(most);
                scroll.show(ui, |ui| self.card_contents(ui)).inner
            })
        });
        shown.inner.inner
    }

    fn card_contents(&self, ui: &mut Ui) -> Vec<Action> {
        let pins = &self.state.pins;
        let done = self.with_time_colours(|colour_at| pendulum_card(ui, pins, colour_at));
        let mut actions: Vec<_> = done.into_iter().map(Action::Pins).collect();
        self.leading_elsewhere(ui, &mut actions);
        actions
    }

    /// Shows the pinned pendulums in all of the window; without pins, says how to get one.
    pub(super) fn whole_stage(&self, ui: &mut Ui) -> Vec<Action> {
        let pins = &self.state.pins;
        if !pins.is_empty() {
            let done = self.with_time_colours(|colour_at| stage(ui, pins, colour_at));
            return done.into_iter().map(Action::Pins).collect();
        }
        let mut actions = Vec::new();
        ui.vertical_centered(|ui| {
            ui.add_space(0.4 * ui.available_height());
            ui.heading("No pendulum is pinned yet");
            ui.label("Click a point of the map to let its pendulum go, or take the middle one.");
            ui.add_space(8.0);
            if ui.button("Pin the middle of the map").clicked() {
                actions.push(Action::Pin(glam::DVec2::ZERO));
            }
            if ui.button("Back to the map (Esc)").clicked() {
                actions.push(Action::Escape);
            }
        });
        actions
    }

    /// Calls `draw` with the colours that the map gives to times.
    fn with_time_colours<T>(&self, draw: impl FnOnce(&dyn Fn(f64) -> Option<Color32>) -> T) -> T {
        let colours = AnswerColours::new(&self.state.scene(), &self.state.picture).ok();
        let tones = colours.as_ref().and_then(AnswerColours::times).map(|(_, tones)| tones);
        draw(&|secs| {
            let [r, g, b] = tones?.colour(&Outcome::flipped(secs.max(0.0)));
            Some(Color32::from_rgb(r, g, b))
        })
    }

    /// Shows buttons that open the pins in the whole window, and the selected one in a figure of
    /// the laboratory.
    fn leading_elsewhere(&self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let Some(pin) = self.state.pins.selected() else { return };
        let angle = pin.start.angle.map(|theta| theta.wrapped().to_f64());
        let start = State { angle, speed: pin.start.launches[0].speed.map(|speed| speed.hi) };
        ui.horizontal_wrapped(|ui| {
            if ui.button("Whole window (F)").clicked() {
                actions.push(Action::Toggle(Dialog::Stage));
            }
            ui.menu_button("In the lab", |ui| {
                for figure in [Figure::Machine, Figure::Integrators, Figure::Twenty] {
                    if ui.button(figure.title()).clicked() {
                        actions.push(Action::OpenInLab(figure, start));
                    }
                }
            });
        });
    }
}
