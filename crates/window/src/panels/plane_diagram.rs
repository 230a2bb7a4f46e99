//! A small diagram of a plane of starts: a pendulum on which the quantities across and up are
//! marked.

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};

use flipmap_lab::drawing::{CANVAS, FAINT, INK};
use flipmap_scene::{Axis, Plane};

/// Width and height in points.
const SIZE: egui::Vec2 = egui::Vec2::new(170.0, 92.0);
/// Length of a rod in points.
const ROD: f32 = 34.0;
/// Angles at which the rods are drawn, rad.
const SHOWN: [f32; 2] = [0.6, 1.5];
/// Colour of the quantities on the axes.
const MARKED: Color32 = Color32::from_rgb(0xe6, 0x9f, 0x00);

/// Shows the diagram.
pub(super) fn plane_diagram(ui: &mut Ui, plane: &Plane) {
    let (response, painter) = ui.allocate_painter(SIZE, Sense::hover());
    let [across, up] = plane.axes();
    let told = format!(
        "Plane of starts: {} in {} across, {} in {} up",
        across.symbol(),
        across.unit(),
        up.symbol(),
        up.unit()
    );
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, told.as_str()));
    painter.rect_filled(response.rect, 4.0, CANVAS);
    let pivot = response.rect.left_top() + vec2(38.0, 10.0);
    let joint = pivot + ROD * vec2(SHOWN[0].sin(), SHOWN[0].cos());
    let bob = joint + ROD * vec2(SHOWN[1].sin(), SHOWN[1].cos());
    for (from, angle, [theta, omega]) in [
        (pivot, SHOWN[0], [Axis::Theta1, Axis::Omega1]),
        (joint, SHOWN[1], [Axis::Theta2, Axis::Omega2]),
    ] {
        painter.line_segment([from, from + vec2(0.0, ROD)], Stroke::new(1.0, FAINT));
        arc(&painter, from, angle, colour_of(plane, theta));
        spin(&painter, from + ROD * vec2(angle.sin(), angle.cos()), angle, colour_of(plane, omega));
    }
    painter.line_segment([pivot, joint], Stroke::new(2.0, INK));
    painter.line_segment([joint, bob], Stroke::new(2.0, INK));
    painter.circle_filled(joint, 3.5, INK);
    painter.circle_filled(bob, 3.5, INK);
    axes(&painter, response.rect.right_bottom() + vec2(-46.0, -22.0), [across, up]);
}

/// Returns the colour of a quantity, which is marked if it is on an axis. The momentum of a section
/// marks ω2.
fn colour_of(plane: &Plane, quantity: Axis) -> Color32 {
    let marks =
        |axis: Axis| axis == quantity || (axis == Axis::Momentum2 && quantity == Axis::Omega2);
    if plane.axes().into_iter().any(marks) { MARKED } else { FAINT }
}

/// Draws the arc of an angle below its pivot.
fn arc(painter: &Painter, pivot: Pos2, angle: f32, colour: Color32) {
    let point = |k: u8| {
        let along = angle * f32::from(k) / 8.0;
        pivot + 15.0 * vec2(along.sin(), along.cos())
    };
    painter.line((0..=8).map(point).collect(), Stroke::new(1.5, colour));
}

/// Draws the arrow of an angular velocity at the end of a rod, anticlockwise.
fn spin(painter: &Painter, end: Pos2, angle: f32, colour: Color32) {
    painter.arrow(end, 14.0 * vec2(angle.cos(), -angle.sin()), Stroke::new(1.5, colour));
}

/// Draws the two axes with their symbols.
fn axes(painter: &Painter, corner: Pos2, [across, up]: [Axis; 2]) {
    let stroke = Stroke::new(1.0, INK);
    painter.arrow(corner, vec2(28.0, 0.0), stroke);
    painter.arrow(corner, vec2(0.0, -28.0), stroke);
    let font = FontId::proportional(12.0);
    let below = pos2(corner.x + 16.0, corner.y + 2.0);
    painter.text(below, Align2::CENTER_TOP, across.symbol(), font.clone(), MARKED);
    let beside = pos2(corner.x - 4.0, corner.y - 16.0);
    painter.text(beside, Align2::RIGHT_CENTER, up.symbol(), font, MARKED);
}
