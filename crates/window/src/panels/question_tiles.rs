//! The questions as pictures of the present view, each under what it asks.

use egui::{Color32, Image, Rect, Role, Sense, TextureId, Ui, WidgetInfo, vec2};

use crate::small_pictures::ASPECT;
use flipmap_scene::QuestionSettings;
use flipmap_scene::question::QuestionName;

/// Time in s of the states that are shown first: later ones are noise over most of the map.
const FIRST_STATE_SECS: f64 = 5.0;
/// Number of tiles in a row.
const COLUMNS: usize = 2;
/// Height of a title in points.
const TITLE_POINTS: f32 = 20.0;

/// Shows a tile for each question, with its picture once `texture` knows it; a click asks it.
pub(super) fn question_tiles(
    ui: &mut Ui,
    question: &mut QuestionSettings,
    mut texture: impl FnMut(usize) -> Option<TextureId>,
) {
    let gap = 8.0;
    let width = (ui.available_width() - gap).max(0.0) / COLUMNS as f32;
    let size = vec2(width, width * ASPECT + TITLE_POINTS);
    for (row, asks) in QuestionName::ALL.chunks(COLUMNS).enumerate() {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = gap;
            for (column, ask) in asks.iter().enumerate() {
                let picture = texture(row * COLUMNS + column);
                if tile(ui, size, *ask, *ask == question.ask, picture) {
                    choose(question, *ask);
                }
            }
        });
        ui.add_space(4.0);
    }
}

/// Asks another question; what only the question before had is dropped later.
pub(crate) fn choose(question: &mut QuestionSettings, ask: QuestionName) {
    if ask == QuestionName::State && question.ask != QuestionName::State {
        question.at = Some(FIRST_STATE_SECS).filter(|secs| *secs < question.budget.secs);
    }
    question.ask = ask;
}

/// Shows a tile; returns true if it was clicked.
fn tile(
    ui: &mut Ui,
    size: egui::Vec2,
    ask: QuestionName,
    is_asked: bool,
    picture: Option<TextureId>,
) -> bool {
    let kind = ask.kind();
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_asked, kind.asks));
    let shown = Rect::from_min_size(rect.min, vec2(size.x, size.y - TITLE_POINTS));
    ui.painter().rect_filled(shown, 4.0, ui.visuals().extreme_bg_color);
    if let Some(picture) = picture {
        let image = Image::new((picture, shown.size())).corner_radius(4);
        image.paint_at(ui, shown);
    }
    let visuals = ui.style().interact_selectable(&response, is_asked);
    if is_asked || response.hovered() || response.has_focus() {
        let rim = match is_asked {
            true => egui::Stroke::new(2.0, ui.visuals().selection.bg_fill),
            false => visuals.bg_stroke,
        };
        ui.painter().rect_stroke(shown, 4.0, rim, egui::StrokeKind::Outside);
    }
    let ink = if is_asked { ui.visuals().strong_text_color() } else { ui.visuals().text_color() };
    let font = egui::TextStyle::Body.resolve(ui.style());
    let title = ui.painter().layout(kind.asks.to_string(), font, ink, size.x);
    ui.painter().with_clip_rect(rect).galley(
        shown.left_bottom() + vec2(0.0, 2.0),
        title,
        Color32::PLACEHOLDER,
    );
    response.on_hover_text(kind.about).clicked()
}
