//! Pictures of places that open them, in rows.

use egui::load::SizedTexture;
use egui::{Image, Rect, Role, Sense, Ui, Vec2, WidgetInfo, pos2, vec2};

use crate::small_pictures::ASPECT;

/// A picture of a place, with a caption that may be empty.
pub(crate) struct PlaceTile {
    /// Name for screen readers.
    pub name: String,
    /// Texts below the picture.
    pub captions: Vec<String>,
    /// The picture, once it is known.
    pub picture: Option<SizedTexture>,
}

/// Shows tiles of equal size in rows of `columns`; returns the index of the one that was clicked.
pub(crate) fn place_tiles(ui: &mut Ui, tiles: &[PlaceTile], columns: usize) -> Option<usize> {
    let gap = 8.0;
    let room = (ui.available_width() - gap * (columns - 1) as f32).max(0.0);
    let width = room / columns as f32;
    let mut clicked = None;
    for (row, some) in tiles.chunks(columns).enumerate() {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = gap;
            for (column, tile) in some.iter().enumerate() {
                ui.allocate_ui(vec2(width, 0.0), |ui| {
                    ui.vertical(|ui| {
                        ui.set_width(width);
                        if picture(ui, tile, vec2(width, (ASPECT * width).round())) {
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
        let uv = middle(picture.size, size);
        Image::new((picture.id, rect.size())).uv(uv).paint_at(ui, rect);
    }
    if response.hovered() || response.has_focus() {
        let rim = ui.style().interact(&response).bg_stroke;
        ui.painter().rect_stroke(rect, 2.0, rim, egui::StrokeKind::Outside);
    }
    response.on_hover_text(&tile.name).clicked()
}

/// Returns the middle part of a picture that has the shape of a tile.
fn middle(picture: Vec2, tile: Vec2) -> Rect {
    let scale = (picture / tile).min_elem();
    Rect::from_center_size(pos2(0.5, 0.5), tile * scale / picture)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_another_shape_are_cut_and_not_stretched() {
        let tile = vec2(80.0, 50.0);
        for picture in [vec2(192.0, 144.0), vec2(96.0, 60.0), vec2(50.0, 10.0)] {
            let shown = middle(picture, tile).size() * picture;
            assert!((shown.x / shown.y - 1.6).abs() < 1e-5, "{picture:?}: {shown:?}");
            assert!((middle(picture, tile).size().max_elem() - 1.0).abs() < 1e-6, "{picture:?}");
        }
    }
}
