//! Notices shown over the map.

use std::time::Duration;

use egui::{Align2, Area, Color32, Frame, RichText, Vec2, vec2};

use super::sentence::sentence;
use crate::action::Action;
use crate::notices::Notices;

/// Distance from the corner in points, which leaves room for the toolbar.
const BELOW_TOOLS: Vec2 = vec2(12.0, 46.0);

/// Shows the notices over the upper left corner of the map, and asks for another frame when the
/// next one disappears. The pointer holds them.
pub(crate) fn notices(ctx: &egui::Context, notices: &Notices, now_secs: f64) -> Vec<Action> {
    let mut actions = Vec::new();
    if notices.iter().len() == 0 {
        return actions;
    }
    if let Some(ends_secs) = notices.next_end_secs() {
        let secs = (ends_secs - now_secs).max(0.0);
        ctx.request_repaint_after(Duration::from_secs_f64(secs));
    }
    let area = Area::new(egui::Id::unique("notices")).anchor(Align2::LEFT_TOP, BELOW_TOOLS);
    let shown = area.show(ctx, |ui| {
        for notice in notices.iter() {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(420.0);
                ui.horizontal_wrapped(|ui| {
                    if notice.failure {
                        ui.label(
                            RichText::new("Problem:")
                                .strong()
                                .color(Color32::from_rgb(230, 120, 60)),
                        );
                    }
                    let colour = ui.visuals().text_color();
                    ui.label(sentence(ui, &notice.text, colour));
                    if ui.small_button("Close").clicked() {
                        actions.push(Action::Dismiss(notice.id));
                    }
                });
            });
        }
    });
    let on_them = |at| shown.response.rect.contains(at);
    if ctx.pointer_latest_pos().is_some_and(on_them) {
        actions.push(Action::HoldNotices);
    }
    actions
}
