//! Pictures of places that open them, in rows.

use egui::{Image, Rect, Role, Sense, TextureId, Ui, Vec2, WidgetInfo, vec2};

/// A picture of a place, with a caption that may be empty.
pub(crate) struct PlaceTile {
    /// Name for screen readers.
    pub name: String,
    /// Texts below the picture.
    pub captions: Vec<String>,
    /// The picture, once it is known.
    pub picture: Option<TextureId>,
}

/// Shows tiles of equal size in rows of `columns`; returns the index of the one that was clicked.
pub(crate) fn place_tiles(ui: &mut Ui, tiles: &[PlaceTile], columns: usize) -> Option<usize> {
    let gap = 8.0;
    let width = (ui.available_width() - gap * (columns - 1) as f32) / columns as f32;
    let mut clicked = None;
    for (row, some) in tiles.chunks(columns).enumerate() {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = gap;
            for (column, tile) in some.iter().enumerate() {
                ui.allocate_ui(vec2(width, 0.0), |ui| {
                    ui.vertical(|ui| {
                        ui.set_width(width);
                        if picture(ui, tile, vec2(width, (0.625 * width).round())) {
                            clicked = Some(row * columns + column);
                        }
                        for caption in &tile.captions {
                            ui.small(caption);
                        }
                    });
                });
            }
        });
    }
    clicked
}

fn picture(ui: &mut Ui, tile: &PlaceTile, size: Vec2) -> bool {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &tile.name));
    ui.painter().rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    if let Some(picture) = tile.picture {
        // The middle of the picture, in the shape of the tile.
        let uv = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
        Image::new((picture, rect.size())).uv(uv).paint_at(ui, rect);
    }
    if response.hovered() || response.has_focus() {
        let rim = ui.style().interact(&response).bg_stroke;
        ui.painter().rect_stroke(rect, 2.0, rim, egui::StrokeKind::Outside);
    }
    response.on_hover_text(&tile.name).clicked()
}
