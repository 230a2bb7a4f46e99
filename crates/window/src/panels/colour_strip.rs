//! Bands of colours, and the legend of a map.

use egui::{Align2, Color32, Mesh, Rect, Response, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::field::plain;
use flipmap_scene::palette::{AnswerColours, BarLabels, FAILED, Ground, Rgb};
use flipmap_scene::question::QuestionName;

/// Shows all colours with a title above and values under them, and those of pixels without an
/// answer; that of failed pixels only if the view `has_failed` ones.
pub(super) fn legend(
    ui: &mut Ui,
    colours: &AnswerColours,
    (ask, palette): (QuestionName, &str),
    has_failed: bool,
) {
    let unit = colours.title(ask).unit;
    let in_unit = if unit.is_empty() { String::new() } else { format!("  ({unit})") };
    ui.label(format!("{}{in_unit}", ask.kind().asks));
    if colours.is_square() {
        square(ui, colours);
    } else {
        let [from, to] = [0.0, 1.0].map(|share| plain(colours.value_along(share)));
        let response = strip(ui, 22.0, |share| colours.colour_along(share));
        let told = format!("Legend: {palette} from {from} {unit} to {to} {unit}");
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, told.as_str()));
        ticks(ui, response.rect, colours, unit);
    }
    let [_, without] = ask.kind().counted;
    let without = if ask.is_time() { "not within the budget" } else { without };
    ui.horizontal_wrapped(|ui| {
        let Ground { unflipped, forbidden, .. } = colours.ground();
        let failed = has_failed.then_some((FAILED, "failed"));
        for (colour, what) in
            [(unflipped, without), (forbidden, "forbidden")].into_iter().chain(failed)
        {
            let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, Color32::GRAY);
            ui.painter().rect_filled(rect.shrink(1.0), 2.0, rgb(colour));
            ui.label(what);
        }
    });
}

/// Number of colours along a side of the square of two angles.
const SQUARE_STEPS: u32 = 48;

/// Shows the colours of two angles, θ1 across and θ2 up, from −π to π.
fn square(ui: &mut Ui, colours: &AnswerColours) {
    let (rect, response) = ui.allocate_exact_size(vec2(120.0, 120.0), Sense::hover());
    let told = "Legend: θ1 across and θ2 up, from −π to π rad";
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, told));
    let mut mesh = Mesh::default();
    let side = rect.width() / SQUARE_STEPS as f32;
    for (x, y) in (0..SQUARE_STEPS).flat_map(|x| (0..SQUARE_STEPS).map(move |y| (x, y))) {
        let corner = pos2(rect.left() + side * x as f32, rect.bottom() - side * (y + 1) as f32);
        let place = [x, y].map(|k| (f64::from(k) + 0.5) / f64::from(SQUARE_STEPS));
        let cell = Rect::from_min_size(corner, vec2(side, side));
        mesh.add_colored_rect(cell, rgb(colours.colour_in_square(place)));
    }
    ui.painter().add(mesh);
    ui.label("θ1 across, θ2 up, −π to π");
}

/// Shows round values along the strip, or those of its steps.
fn ticks(ui: &mut Ui, strip: Rect, colours: &AnswerColours, unit: &str) {
    let (rect, _) = ui.allocate_exact_size(vec2(strip.width(), 16.0), Sense::hover());
    let font = egui::TextStyle::Small.resolve(ui.style());
    let ink = ui.visuals().text_color();
    if let Some(labels) = colours.step_labels(f64::from(rect.width() / LETTER_POINTS)) {
        for (place, label) in labels {
            let x = rect.left() + rect.width() * place as f32;
            ui.painter().vline(x, rect.top() - 3.0..=rect.top(), (1.0, ink));
            let middle = pos2(x, rect.top() + 1.0);
            ui.painter().text(middle, Align2::CENTER_TOP, label, font.clone(), ink);
        }
        return;
    }
    let BarLabels { from, ticks } = colours.bar_labels();
    for (place, label) in ticks {
        let share = f32::from(place) / 1000.0;
        // The first and the last label stay over the bar.
        let align = match share {
            s if s < 0.04 => Align2::LEFT_TOP,
            s if s > 0.96 => Align2::RIGHT_TOP,
            _ => Align2::CENTER_TOP,
        };
        let x = rect.left() + rect.width() * share;
        ui.painter().vline(x, rect.top() - 3.0..=rect.top(), (1.0, ink));
        ui.painter().text(pos2(x, rect.top() + 1.0), align, label, font.clone(), ink);
    }
    if let Some(from) = from {
        ui.small(format!("later than {from} {unit}"));
    }
}

/// Width of a small letter in points.
const LETTER_POINTS: f32 = 6.0;

/// Shows a band of colours from left to right.
pub(super) fn strip(ui: &mut Ui, height: f32, colour: impl Fn(f64) -> Rgb) -> Response {
    let width = ui.available_width().min(360.0);
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    paint_strip(ui, rect, colour);
    response
}

/// Draws a band of colours from left to right over a rectangle.
pub(super) fn paint_strip(ui: &Ui, rect: Rect, colour: impl Fn(f64) -> Rgb) {
    const STEPS: u32 = 256;
    let mut mesh = Mesh::default();
    for step in 0..STEPS {
        let edge = |step: u32| rect.left() + rect.width() * step as f32 / STEPS as f32;
        let part = Rect::from_x_y_ranges(edge(step)..=edge(step + 1), rect.y_range());
        let share = (f64::from(step) + 0.5) / f64::from(STEPS);
        mesh.add_colored_rect(part, rgb(colour(share)));
    }
    ui.painter().add(mesh);
}

/// Returns a colour of a palette as one of the interface.
pub(super) fn rgb([r, g, b]: Rgb) -> Color32 {
    Color32::from_rgb(r, g, b)
}
