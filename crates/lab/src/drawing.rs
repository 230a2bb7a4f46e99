//! Pendulums, arrows and words on a canvas.

use std::f32::consts::FRAC_PI_2;

use egui::{
    Color32, FontId, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2,
    WidgetInfo, vec2,
};

use super::formula::Formula;
use super::labels::{LabelPlace, Taken};
use super::polyline::simplified;

/// Background colour of a dark canvas.
pub const CANVAS: Color32 = Color32::from_gray(24);
/// Colour of lines and words on a dark canvas.
pub const INK: Color32 = Color32::from_gray(225);
/// Colour of guides and other background details on a dark canvas.
pub const FAINT: Color32 = Color32::from_gray(130);

/// The colours of a canvas, which follow the theme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint {
    /// Background of the canvas.
    pub ground: Color32,
    /// Lines and words.
    pub ink: Color32,
    /// Guides and other background details.
    pub faint: Color32,
    /// Okabe and Ito's colours, which colour-blind people can tell apart: orange, blue, green,
    /// yellow.
    pub parts: [Color32; 4],
    /// True if the canvas is dark.
    pub dark: bool,
}

impl Tint {
    /// The colours of a dark canvas.
    pub(crate) const DARK: Tint = Tint {
        ground: CANVAS,
        ink: INK,
        faint: FAINT,
        parts: [
            Color32::from_rgb(0xe6, 0x9f, 0x00),
            Color32::from_rgb(0x56, 0xb4, 0xe9),
            Color32::from_rgb(0x00, 0xb8, 0x86),
            Color32::from_rgb(0xf0, 0xe4, 0x42),
        ],
        dark: true,
    };
    /// The colours of a light canvas: the same hues, darker.
    pub(crate) const LIGHT: Tint = Tint {
        ground: Color32::from_gray(250),
        ink: Color32::from_gray(30),
        faint: Color32::from_gray(115),
        parts: [
            Color32::from_rgb(0xb0, 0x62, 0x00),
            Color32::from_rgb(0x00, 0x72, 0xb2),
            Color32::from_rgb(0x00, 0x7a, 0x58),
            Color32::from_rgb(0x80, 0x70, 0x00),
        ],
        dark: false,
    };

    /// Fills an area with the ground. The dark theme needs no fill, and filling is slow with a software
    /// renderer.
    pub(crate) fn fill(&self, painter: &Painter, area: Rect) {
        if !self.dark {
            painter.rect_filled(area, 4.0, self.ground);
        }
    }

    /// Returns the colours that suit the theme.
    pub fn of(ui: &Ui) -> Self {
        if ui.visuals().dark_mode { Tint::DARK } else { Tint::LIGHT }
    }
}

/// A canvas with coordinates in metres from a pivot, y up.
pub(crate) struct FigureCanvas {
    /// The painter of the canvas.
    pub painter: Painter,
    /// The area of the canvas, in points.
    pub rect: Rect,
    /// The colours of the canvas.
    pub tint: Tint,
    pivot: Pos2,
    points_per_m: f32,
    taken: Taken,
}

/// Size of labels and equations in points.
pub(crate) const LETTER: f32 = 14.0;
/// Size of notes and of the words of charts in points.
pub(crate) const SMALL: f32 = 12.0;
/// Least height of a canvas in points.
const LEAST_HEIGHT: f32 = 200.0;
/// Margin in points around the reach of a pendulum, for its bobs.
const RIM: f32 = 12.0;
/// Width of the halo of labels in points.
const HALO: f32 = 1.2;

/// What a canvas has to show, in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StageReach {
    /// Distance of the farthest bob from the pivot.
    pub rods_m: f64,
    /// Length of what hangs from the farthest bob, such as an arrow.
    pub below_m: f64,
}

impl StageReach {
    /// The reach of rods with nothing below them.
    pub(crate) fn of_rods(rods_m: f64) -> Self {
        StageReach { rods_m, below_m: 0.0 }
    }
}

impl FigureCanvas {
    /// Creates a canvas of `size` points, or of the least height, that shows what is in `reach`;
    /// `told` is its description for a screen reader. The canvas senses clicks and drags.
    pub(crate) fn new(
        ui: &mut Ui,
        size: Vec2,
        reach: StageReach,
        told: String,
    ) -> (FigureCanvas, Response) {
        FigureCanvas::sensing(ui, size, reach, told, Sense::click_and_drag())
    }

    /// Creates a canvas that senses no clicks or drags.
    pub(crate) fn seen(ui: &mut Ui, size: Vec2, reach: StageReach, told: String) -> FigureCanvas {
        FigureCanvas::sensing(ui, size, reach, told, Sense::hover()).0
    }

    fn sensing(
        ui: &mut Ui,
        size: Vec2,
        reach: StageReach,
        told: String,
        sense: Sense,
    ) -> (FigureCanvas, Response) {
        let size = vec2(size.x, size.y.max(LEAST_HEIGHT));
        let (response, painter) = ui.allocate_painter(size, sense);
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &told));
        let (rect, tint) = (response.rect, Tint::of(ui));
        tint.fill(&painter, rect);
        let [rods, below] = [reach.rods_m, reach.below_m].map(|m| m as f32);
        let room = (size - Vec2::splat(2.0 * RIM)).max(0.6 * size);
        let points_per_m = (room.x / (2.0 * rods)).min(room.y / (2.0 * rods + below));
        let pivot = rect.center() - vec2(0.0, 0.5 * below * points_per_m);
        let taken = Taken::default();
        (FigureCanvas { painter, rect, tint, pivot, points_per_m, taken }, response)
    }

    /// Returns the screen point of a place in metres.
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> Pos2 {
        self.pivot + vec2(x as f32, -y as f32) * self.points_per_m
    }

    /// Returns the place under a screen point, in metres.
    pub(crate) fn place(&self, at: Pos2) -> [f64; 2] {
        let by = (at - self.pivot) / self.points_per_m;
        [f64::from(by.x), -f64::from(by.y)]
    }

    /// Returns a velocity in points per second in m/s.
    pub(crate) fn velocity(&self, by: Vec2) -> [f64; 2] {
        [by.x, -by.y].map(|points| f64::from(points / self.points_per_m))
    }

    /// Draws a rod from one place to another.
    pub(crate) fn rod(&self, from: [f64; 2], to: [f64; 2], colour: Color32) {
        let ends = [self.at(from), self.at(to)];
        self.taken.line(ends);
        self.painter.line_segment(ends, Stroke::new(2.0, colour));
    }

    /// Draws a level line to a place, from the left edge or from the words that are in its way.
    pub(crate) fn level(&self, to: [f64; 2], colour: Color32) {
        let to = self.at(to);
        let ends = [Pos2::new(self.taken.right_of_words(to.y, self.rect.left()), to.y), to];
        self.taken.line(ends);
        self.painter.line_segment(ends, Stroke::new(1.0, colour));
    }

    /// Draws a dashed line from one place to another.
    pub(crate) fn dashed(&self, from: [f64; 2], to: [f64; 2], colour: Color32) {
        let (ends, stroke) = ([self.at(from), self.at(to)], Stroke::new(1.0, colour));
        self.taken.line(ends);
        self.painter.extend(Shape::dashed_line(&ends, stroke, 5.0, 4.0));
    }

    /// Draws a bob whose area is proportional to its mass in kg, within limits.
    pub(crate) fn bob(&self, at: [f64; 2], mass: f64, colour: Color32) {
        let (at, radius) = (self.at(at), width_of(mass));
        self.taken.shape(Rect::from_center_size(at, Vec2::splat(2.0 * radius)));
        self.painter.circle(at, radius, colour, Stroke::new(1.0, self.tint.ink));
    }

    /// Draws a uniform bar whose width grows as the square root of its mass in kg, within limits.
    pub(crate) fn bar(&self, from: [f64; 2], to: [f64; 2], mass: f64, colour: Color32) {
        let stroke = Stroke::new(width_of(mass), colour.gamma_multiply(0.8));
        let ends = [self.at(from), self.at(to)];
        self.taken.line(ends);
        self.painter.line_segment(ends, stroke);
        self.painter.circle_filled(self.at(from), 3.0, self.tint.ink);
    }

    /// Draws the pivot.
    pub(crate) fn pivot(&self) {
        self.taken.shape(Rect::from_center_size(self.pivot, Vec2::splat(8.0)));
        self.painter.circle_filled(self.pivot, 4.0, self.tint.ink);
    }

    /// Draws a ring at a place, as a handle to drag.
    pub(crate) fn handle(&self, at: [f64; 2], colour: Color32) {
        let at = self.at(at);
        self.taken.shape(Rect::from_center_size(at, Vec2::splat(12.0)));
        self.painter.circle(at, 5.0, self.tint.ground, Stroke::new(2.0, colour));
    }

    /// Draws an arrow from a place along a displacement in metres.
    pub(crate) fn arrow(&self, from: [f64; 2], by: [f64; 2], colour: Color32) {
        let tip = self.at([from[0] + by[0], from[1] + by[1]]);
        let start = self.at(from);
        self.taken.line([start, tip]);
        self.painter.arrow(start, tip - start, Stroke::new(2.0, colour));
    }

    /// Draws the arc of an angle, measured from the downward vertical, at a place.
    pub(crate) fn arc(&self, at: [f64; 2], angle: f64, radius_m: f64, colour: Color32) {
        let angle = wrapped(angle);
        let (center, radius) = (self.at(at), radius_m as f32 * self.points_per_m);
        let point = |k: u32| {
            let along = angle as f32 * k as f32 / 24.0;
            center + radius * vec2((FRAC_PI_2 - along).cos(), (FRAC_PI_2 - along).sin())
        };
        let points: Vec<Pos2> = (0..=24).map(point).collect();
        points.windows(7).step_by(6).for_each(|piece| self.taken.line([piece[0], piece[6]]));
        self.painter.add(Shape::line(points, Stroke::new(1.5, colour)));
    }

    /// Writes words beside a place, to its right if that is free, with a halo, and with a line that
    /// leads to the place where they are far from it. Call it after drawing everything that the words
    /// should not cover.
    pub(crate) fn label(&self, at: [f64; 2], words: &str, colour: Color32) {
        let font = FontId::proportional(LETTER);
        let galley = self.painter.layout_no_wrap(words.to_string(), font, colour);
        let LabelPlace { area, leader } =
            self.taken.beside(self.at(at), galley.size(), self.rect.shrink(8.0));
        if let Some(leader) = leader {
            self.painter.line_segment(leader, Stroke::new(1.0, colour.gamma_multiply(0.6)));
        }
        for (x, y) in [(1, 1), (-1, 1), (1, -1), (-1, -1)] {
            let corner = area.min + HALO * vec2(x as f32, y as f32);
            let ground = self.tint.ground;
            self.painter.galley_with_override_text_color(corner, galley.clone(), ground);
        }
        self.painter.galley(area.min, galley, colour);
    }

    /// Writes a formula, and words below it, in the upper left corner.
    pub(crate) fn note(&self, formula: Option<Formula>, words: &str) {
        let mut corner = self.rect.left_top() + vec2(8.0, 8.0);
        let width = self.rect.width() - 16.0;
        if let Some(formula) = formula {
            let laid = formula.fitted(&self.painter, width, 1.2 * LETTER, self.tint.ink);
            laid.draw(&self.painter, corner);
            let size = vec2(laid.width, laid.height());
            self.taken.words(Rect::from_min_size(corner, size));
            corner.y += laid.height() + 8.0;
        }
        let font = FontId::proportional(SMALL);
        let galley = self.painter.layout(words.to_string(), font, self.tint.faint, width);
        self.taken.words(Rect::from_min_size(corner, galley.size()));
        self.painter.galley(corner, galley, self.tint.faint);
    }

    /// Draws a line through places, fainter towards the first.
    pub(crate) fn trail(&self, places: &[[f64; 2]], colour: Color32) {
        const BAND: usize = 24;
        for first in (0..places.len().saturating_sub(1)).step_by(BAND) {
            let last = (first + BAND).min(places.len() - 1);
            let points: Vec<Pos2> = places[first..=last].iter().map(|at| self.at(*at)).collect();
            let youth = last as f32 / places.len() as f32;
            let stroke = Stroke::new(1.5, colour.gamma_multiply(youth));
            self.painter.add(Shape::line(simplified(&points), stroke));
        }
    }
}

/// Returns the radius of a bob, or the width of a bar, of a mass in kg, in points.
fn width_of(mass: f64) -> f32 {
    (9.0 * mass.sqrt() as f32).clamp(3.0, 26.0)
}

/// Returns the ends of both rods in metres, for angles measured anticlockwise from the downward
/// vertical.
pub(crate) fn ends(lengths: [f64; 2], angle: [f64; 2]) -> [[f64; 2]; 2] {
    let [x1, y1] = end([0.0; 2], lengths[0], angle[0]);
    [[x1, y1], end([x1, y1], lengths[1], angle[1])]
}

/// Returns the end of a rod that hangs from a place.
pub(crate) fn end(from: [f64; 2], length: f64, angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [from[0] + length * sin, from[1] - length * cos]
}

/// Returns the upper left corner of a box of a `size`, moved from `corner` into an `area`. If the
/// box does not fit into the area, its upper left part is visible.
pub fn corner_inside(area: Rect, size: Vec2, corner: Pos2) -> Pos2 {
    corner.min(area.max - size).max(area.min)
}

/// Returns the angle of a rod from one place towards another, in rad.
pub(crate) fn angle_of(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]).atan2(from[1] - to[1])
}

/// Speed in m/s below which a bob that is let go is at rest.
const LEAST_THROW: f64 = 0.3;

/// Returns the speed in rad/s with which a velocity in m/s of its end turns a rod, or `None` if that is
/// slower than a throw.
pub(crate) fn turning(velocity: [f64; 2], angle: f64, length: f64) -> Option<f64> {
    let (sin, cos) = angle.sin_cos();
    let across = velocity[0] * cos + velocity[1] * sin;
    (across.abs() >= LEAST_THROW).then(|| across / length)
}

/// Wraps an angle to (−π, π].
pub(crate) fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_box_stays_inside_and_an_area_too_small_shows_its_beginning() {
        let area = Rect::from_min_max(pos2(10.0, 10.0), pos2(110.0, 60.0));
        let size = vec2(40.0, 20.0);
        assert_eq!(corner_inside(area, size, pos2(50.0, 30.0)), pos2(50.0, 30.0));
        assert_eq!(corner_inside(area, size, pos2(-5.0, 90.0)), pos2(10.0, 40.0));
        assert_eq!(corner_inside(area, size, pos2(105.0, 0.0)), pos2(70.0, 10.0));
        let sliver = Rect::from_min_max(pos2(10.0, 10.0), pos2(12.0, 5.0));
        assert_eq!(corner_inside(sliver, size, pos2(50.0, 30.0)), pos2(10.0, 10.0));
    }

    #[test]
    fn a_rod_points_where_its_angle_says() {
        for angle in [-3.0, -1.0, 0.0, 0.5, 2.5] {
            let to = end([1.0, 2.0], 0.7, angle);
            assert!((angle_of([1.0, 2.0], to) - angle).abs() < 1e-12);
        }
        let [first, second] = ends([1.0, 0.5], [0.0, std::f64::consts::FRAC_PI_2]);
        assert!((first[1] + 1.0).abs() < 1e-12 && (second[0] - 0.5).abs() < 1e-12);
    }
}
