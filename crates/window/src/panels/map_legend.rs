//! The legend as a layer over the map.

use egui::{Align2, Area, Context, Frame, Id, Rect, vec2};

use super::colour_strip::legend;
use flipmap_scene::palette::AnswerColours;
use flipmap_scene::question::QuestionName;

/// Width of the legend in points, where there is room.
const WIDTH_POINTS: f32 = 300.0;
/// Distance from the map's corner, in points.
const MARGIN_POINTS: f32 = 10.0;

/// Shows what the colours of a map mean in the lower left corner of `map`. The legend ignores the
/// pointer.
pub(crate) fn map_legend(
    ctx: &Context,
    map: Rect,
    colours: &AnswerColours,
    of: (QuestionName, &str),
    has_failed: bool,
) {
    let width = WIDTH_POINTS.min(map.width() - 4.0 * MARGIN_POINTS);
    if width <= 0.0 {
        return;
    }
    let corner = map.left_bottom() + vec2(MARGIN_POINTS, -MARGIN_POINTS);
    let area = Area::new(Id::unique("map legend")).pivot(Align2::LEFT_BOTTOM).fixed_pos(corner);
    area.interactable(false).constrain_to(map).show(ctx, |ui| {
        let fill = ui.visuals().window_fill.gamma_multiply(0.85);
        Frame::popup(ui.style()).fill(fill).show(ui, |ui| {
            ui.set_width(width);
            legend(ui, colours, of, has_failed);
        });
    });
}
