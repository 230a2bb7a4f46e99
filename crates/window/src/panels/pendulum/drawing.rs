//! The stage: the pendulums of all pins with the trails of their second bobs; of the selected pin
//! also the ghost and the flip.

use egui::epaint::TextShape;
use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, vec2,
};

use super::{CANVAS, FAINT, INK, TimeColour};
use crate::overlay::disc_beside;
use crate::pins::{Pin, Pins};
use flipmap_lab::drawing::corner_inside;
use flipmap_numbers::number_text::fixed;
use flipmap_pendulum::State;
use flipmap_scene::{Kind, PendulumSpec};

/// Number of points per band of equal opacity. Long bands have few joints, which show as beads.
const BAND_POINTS: usize = 16;
/// Length of the outstretched pendulum as a fraction of half the canvas.
const FILLED: f32 = 0.88;
/// Radius of the heavier bob, or width of the heavier bar, as a fraction of half the canvas.
const HEAVIEST: f32 = 0.075;

/// Draws the pendulums of all pins at the moment of their clock, `pin`'s in front.
pub(super) fn stage(ui: &mut Ui, pins: &Pins, pin: &Pin, size: egui::Vec2, colour_at: TimeColour) {
    let (response, painter) = ui.allocate_painter(size, Sense::hover());
    let state = state_of(pin);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, told(pin, state.as_ref())));
    painter.rect_filled(response.rect, 4.0, CANVAS);
    let half_side = size.min_elem() / 2.0;
    let stage = PendulumCanvas::new(response.rect.center(), half_side, pins.build());
    for other in pins.iter().filter(|other| other.id != pin.id) {
        stage.trail(&painter, other, 0.5, colour_at);
        if let Some(state) = state_of(other) {
            stage.pendulum(&painter, &state, other.badge.colour());
        }
    }
    let Some(state) = state else { return };
    stage.trail(&painter, pin, 1.0, colour_at);
    if let Some(ghost) = pin.flight.record().ghost.motion.state_at(pin.shown_secs()) {
        stage.ghost(&painter, &ghost);
    }
    stage.pendulum(&painter, &state, pin.badge.colour());
    stage.flip(&painter, pin, pin.shown_secs());
    let corner = response.rect.left_bottom() + vec2(6.0, -4.0);
    let legend = format!("dashed: one pixel away from {}", pin.badge.letter());
    painter.text(corner, Align2::LEFT_BOTTOM, legend, FontId::proportional(10.0), FAINT);
}

fn state_of(pin: &Pin) -> Option<State<f64>> {
    pin.flight.record().own.motion.state_at(pin.shown_secs())
}

/// Radius of a miniature in points.
const MINIATURE: f32 = 44.0;

/// Draws a small pendulum on a disc beside the pointer and its caption, with its angles in rad from
/// the downward vertical.
pub(crate) fn miniature(
    painter: &Painter,
    (pointer, caption): (Pos2, Rect),
    build: &PendulumSpec,
    angle: [f64; 2],
) {
    let map = painter.clip_rect().shrink(4.0);
    let middle = disc_beside(map, pointer, caption, 2.0 * MINIATURE).center();
    painter.circle(middle, MINIATURE, CANVAS.gamma_multiply(0.9), Stroke::new(1.0, FAINT));
    let stage = PendulumCanvas::new(middle, MINIATURE, build);
    let state = State { angle, speed: [0.0; 2] };
    stage.pendulum(painter, &state, Color32::from_rgb(230, 85, 60));
}

/// Describes the drawing for a screen reader.
fn told(pin: &Pin, state: Option<&State<f64>>) -> String {
    let letter = pin.badge.letter();
    match state {
        Some(State { angle: [theta1, theta2], .. }) => format!(
            "Pendulum {letter} at {} s: θ1 is {} rad, θ2 is {} rad",
            fixed(pin.shown_secs(), 2),
            fixed(*theta1, 3),
            fixed(*theta2, 3)
        ),
        None => format!("Pendulum {letter} is being let go"),
    }
}

/// The mapping from a pendulum's metres and kilograms to points on the canvas.
struct PendulumCanvas<'a> {
    pivot: Pos2,
    half_side: f32,
    build: &'a PendulumSpec,
}

impl<'a> PendulumCanvas<'a> {
    fn new(pivot: Pos2, half_side: f32, build: &'a PendulumSpec) -> Self {
        PendulumCanvas { pivot, half_side, build }
    }

    /// Returns the ends of both rods, for angles from the downward vertical, anticlockwise.
    fn ends(&self, angle: [f64; 2]) -> [Pos2; 2] {
        let lengths = self.build.lengths_m();
        let reach = lengths[0] + lengths[1];
        let rod = |i: usize| {
            let length = (lengths[i] / reach) as f32 * self.half_side * FILLED;
            let (sin, cos) = angle[i].sin_cos();
            vec2(sin as f32, cos as f32) * length
        };
        let first = self.pivot + rod(0);
        [first, first + rod(1)]
    }

    /// Returns the bobs' radii in points, at least 3; above that, areas are proportional to the
    /// masses.
    fn radii(&self) -> [f32; 2] {
        let [m1, m2] = self.build.masses_kg();
        let heaviest = m1.max(m2);
        [m1, m2].map(|mass| (self.half_side * HEAVIEST * (mass / heaviest).sqrt() as f32).max(3.0))
    }

    fn pendulum(&self, painter: &Painter, state: &State<f64>, colour: Color32) {
        let [first, second] = self.ends(state.angle);
        let rods = [[self.pivot, first], [first, second]];
        match self.build.kind {
            Kind::Points => {
                for rod in rods {
                    painter.line_segment(rod, Stroke::new(2.0, INK));
                }
                let [r1, r2] = self.radii();
                painter.circle_filled(first, r1, INK);
                painter.circle(second, r2, colour, Stroke::new(1.0, INK));
            }
            Kind::Rods => {
                for ((rod, radius), ink) in rods.into_iter().zip(self.radii()).zip([INK, colour]) {
                    painter.line_segment(rod, Stroke::new(radius, ink));
                }
                painter.circle_filled(first, 3.0, INK);
            }
        }
        painter.circle_filled(self.pivot, 4.0, INK);
    }

    /// Draws the ghost with dashed rods and hollow bobs.
    fn ghost(&self, painter: &Painter, state: &State<f64>) {
        let [first, second] = self.ends(state.angle);
        let stroke = Stroke::new(1.0, FAINT);
        painter.extend(Shape::dashed_line(&[self.pivot, first, second], stroke, 5.0, 4.0));
        if self.build.kind == Kind::Points {
            let [r1, r2] = self.radii();
            painter.circle_stroke(first, r1, stroke);
            painter.circle_stroke(second, r2, stroke);
        }
    }

    /// Draws the past path of the second bob, fading with age, in the colours of the map at the
    /// times when the bob was there.
    fn trail(&self, painter: &Painter, pin: &Pin, strength: f32, colour_at: TimeColour) {
        let ends: Vec<(Pos2, f32)> =
            pin.trail.points().map(|(angle, youth)| (self.ends(angle)[1], youth)).collect();
        for first in (0..ends.len()).step_by(BAND_POINTS) {
            // Bands share a point, so that there are no gaps.
            let band = &ends[first..ends.len().min(first + BAND_POINTS + 1)];
            let youth = band.last().map_or(0.0, |(_, youth)| *youth);
            let colour = colour_at(pin.trail.secs_at(youth)).unwrap_or(pin.badge.colour());
            let stroke = Stroke::new(1.5, colour.gamma_multiply(youth * strength));
            painter.add(Shape::line(band.iter().map(|(at, _)| *at).collect(), stroke));
        }
    }

    /// Draws a past flip: a ring at the bob's position at that moment, and a caption.
    fn flip(&self, painter: &Painter, pin: &Pin, secs: f64) {
        let track = &pin.flight.record().own;
        let Some(flip) = track.flip.filter(|flip| flip.secs.hi <= secs) else { return };
        let Some(state) = track.motion.state_at(flip.secs.hi) else { return };
        let place = self.ends(state.angle)[flip.bob];
        let radius = self.radii()[flip.bob] + 5.0;
        painter.circle_stroke(place, radius, Stroke::new(2.0, INK));
        let late = flip.secs.hi > pin.flight.question().budget_secs;
        let note = if late { ", after the budget" } else { "" };
        let text = format!("flip at {} s{note}", fixed(flip.secs.hi, 3));
        let galley = painter.layout_no_wrap(text, FontId::proportional(12.0), INK);
        // Above the ring, but inside the canvas.
        let above = place - vec2(galley.size().x / 2.0, radius + galley.size().y + 2.0);
        let corner = corner_inside(painter.clip_rect().shrink(4.0), galley.size(), above);
        painter.add(TextShape::new(corner, galley, INK));
    }
}
