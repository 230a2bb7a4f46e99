//! Where the view is: a small map of the torus, a ruler of depth, and the views seen last.

use std::sync::LazyLock;

use egui::{
    Align2, Image, Pos2, Rect, Role, Sense, Stroke, TextureId, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use crate::action::{Action, Look};
use crate::small_pictures::ASPECT;
use flipmap_numbers::number_text::significant;
use flipmap_numbers::{Exact, Scalar};
use flipmap_scene::{BUILT_IN, Plane};
use flipmap_screen::camera::Camera;

/// Side of the small map in points.
const SIDE: f32 = 128.0;
/// Share of the small map's picture on each side that lies beyond the torus: the picture is as high
/// as the torus.
const BEYOND: f32 = (1.0 - ASPECT) / 2.0;
/// Side in points below which the view's frame on the small map is drawn as a cross.
const LEAST_FRAME: f32 = 6.0;
/// Least distance of two names on the ruler, in points.
const APART: f32 = 14.0;

/// Names and depths (−log10 of the width in rad) of built-in places on the torus.
static LANDMARKS: LazyLock<Vec<(&'static str, f32)>> = LazyLock::new(|| {
    let depth = |place: &flipmap_scene::BuiltIn| {
        let document = place.document();
        let width = document.scene().view.width_rad().hi;
        (document.plane == Plane::default() && width < 1.0)
            .then(|| (place.name, -width.log10() as f32))
    };
    let mut all: Vec<_> = BUILT_IN.iter().filter_map(depth).collect();
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    all
});

/// Shows the small map, once its picture is known, and the ruler; returns a move to where the user
/// clicks.
pub(crate) fn whereabouts(
    ui: &mut Ui,
    camera: &Camera,
    size: Vec2,
    picture: Option<TextureId>,
) -> Option<Action> {
    ui.horizontal(|ui| {
        let clicked = small_map(ui, camera, size, picture);
        ui.add_space(8.0);
        ruler(ui, camera);
        clicked
    })
    .inner
}

/// Shows the torus with the frame of the view; returns a move to where the user clicks.
fn small_map(
    ui: &mut Ui,
    camera: &Camera,
    size: Vec2,
    picture: Option<TextureId>,
) -> Option<Action> {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Small map of the torus"));
    ui.painter().rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    if let Some(picture) = picture {
        let inside = Rect::from_min_max(pos2(BEYOND, 0.0), pos2(1.0 - BEYOND, 1.0));
        Image::new((picture, rect.size())).uv(inside).paint_at(ui, rect);
    }
    let points_a_rad = SIDE / std::f32::consts::TAU;
    let center = camera.center.map(|theta| theta.wrapped().to_f64() as f32);
    let at = rect.center() + vec2(center[0], -center[1]) * points_a_rad;
    let width = camera.width_rad as f32 * points_a_rad;
    let frame = vec2(width, width * size.y / size.x.max(1.0));
    draw_frame(ui, rect, at, frame);
    let point = response.interact_pointer_pos().filter(|_| response.clicked())?;
    let by = (point - rect.center()) / points_a_rad;
    let center = [by.x, -by.y].map(|theta| Exact::from_f64(f64::from(theta)));
    Some(Action::Look(Look::To(Camera { center, ..*camera })))
}

/// Draws the frame of the view, or a cross if it is too small to be seen.
fn draw_frame(ui: &Ui, rect: Rect, at: Pos2, frame: Vec2) {
    let painter = ui.painter_at(rect);
    for (width, ink) in [(3.0, egui::Color32::BLACK), (1.0, egui::Color32::WHITE)] {
        let stroke = Stroke::new(width, ink);
        if frame.x >= LEAST_FRAME {
            let shown = Rect::from_center_size(at, frame);
            painter.rect_stroke(shown, 0.0, stroke, egui::StrokeKind::Middle);
        } else {
            painter.hline(at.x - 6.0..=at.x + 6.0, at.y, stroke);
            painter.vline(at.x, at.y - 6.0..=at.y + 6.0, stroke);
        }
    }
}

/// Shows how deep the view is beside places of known depth.
fn ruler(ui: &mut Ui, camera: &Camera) {
    let (rect, response) = ui.allocate_exact_size(vec2(112.0, SIDE), Sense::hover());
    let depth = -camera.width().log10() as f32;
    let told = format!("{} rad wide", significant(camera.width(), 2));
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Depth: {told}")));
    let deepest = LANDMARKS.last().map_or(20.0, |(_, depth)| *depth).max(depth);
    let shallowest = -1.0_f32;
    let height = |depth: f32| {
        let share = (depth - shallowest) / (deepest - shallowest);
        // The first decades, where most time is spent, have more room than the last ones.
        rect.top() + 6.0 + share.clamp(0.0, 1.0).sqrt() * (rect.height() - 12.0)
    };
    let (weak, strong) = (ui.visuals().weak_text_color(), ui.visuals().strong_text_color());
    let font = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter();
    painter.vline(rect.left() + 6.0, height(shallowest)..=height(deepest), Stroke::new(1.0, weak));
    let mut last = f32::NEG_INFINITY;
    for (name, place) in LANDMARKS.iter() {
        let y = height(*place);
        painter.hline(rect.left() + 3.0..=rect.left() + 9.0, y, Stroke::new(1.0, weak));
        let hides_depth = (y - height(depth)).abs() < APART;
        if y - last >= APART && !hides_depth {
            painter.text(
                pos2(rect.left() + 16.0, y),
                Align2::LEFT_CENTER,
                name,
                font.clone(),
                weak,
            );
            last = y;
        }
    }
    let y = height(depth);
    painter.circle_filled(pos2(rect.left() + 6.0, y), 4.0, strong);
    painter.text(pos2(rect.left() + 16.0, y), Align2::LEFT_CENTER, told, font, strong);
}
