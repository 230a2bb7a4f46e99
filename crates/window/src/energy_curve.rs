//! The energy curve on the map: the border of the starts that can never flip.

use egui::{Color32, Painter, Rect, Shape, Stroke};
use glam::DVec2;

use super::overlay::position;
use flipmap_numbers::{Angle, Exact, Scalar};
use flipmap_pendulum::Rule;
use flipmap_scene::PendulumSpec;
use flipmap_scene::palette::Rgb;
use flipmap_screen::camera::Screen;

/// Distance in points between the nodes at which the energy is evaluated.
const CURVE_NODE: f64 = 8.0;
/// Side in points below which a square is not divided where the curve crosses itself.
const CURVE_LEAST: f64 = 0.6;

/// The depth (the negated potential energy) of starts near a centre, minus the bound above which
/// they can never flip. Differences from the centre are computed apart from its depth, so that no
/// digits are lost in small views.
struct EnergyDepth {
    /// Value at the centre in J.
    center: f64,
    /// P and Q in J, and sine and cosine of the centre's angles.
    weights: [f64; 2],
    sines: [[f64; 2]; 2],
}

impl EnergyDepth {
    fn new(build: &PendulumSpec, rule: Rule, center: [Exact; 2]) -> Self {
        let pendulum = build.pendulum_in::<Exact>();
        let sines = center.map(|theta| theta.sin_cos());
        let depth = pendulum.depth(sines.map(|(_, cos)| cos)) - pendulum.least_depth(rule);
        let weights = [pendulum.p, pendulum.q].map(Exact::to_f64);
        let sines = sines.map(|(sin, cos)| [sin.to_f64(), cos.to_f64()]);
        EnergyDepth { center: depth.to_f64(), weights, sines }
    }

    /// Returns the value at an offset from the centre, in J.
    fn at(&self, offset: DVec2) -> f64 {
        let rise = |i: usize, by: f64| {
            let half = (by / 2.0).sin();
            let [sin, cos] = self.sines[i];
            self.weights[i] * (-2.0 * cos * half * half - sin * by.sin())
        };
        self.center + rise(0, offset.x) + rise(1, offset.y)
    }
}

/// Returns the energy curve as short lines, in points from the middle of the canvas.
pub(crate) fn energy_curve(screen: &Screen, build: &PendulumSpec, rule: Rule) -> Vec<[DVec2; 2]> {
    let depth = EnergyDepth::new(build, rule, screen.camera.center);
    let columns = (screen.size.x / CURVE_NODE).ceil() as usize;
    let rows = (screen.size.y / CURVE_NODE).ceil() as usize;
    let node = |column: usize, row: usize| {
        DVec2::new(column as f64, row as f64) * CURVE_NODE - screen.size / 2.0
    };
    let row_of = |row: usize| -> Vec<f64> {
        (0..=columns).map(|column| depth.at(screen.offset_at(node(column, row)))).collect()
    };
    let diagonal = screen.offset_at(node(1, 1)) - screen.offset_at(node(0, 0));
    let flat = depth.weights.iter().sum::<f64>() * diagonal.length_squared();
    let mut lines = Vec::new();
    let mut above = row_of(0);
    for row in 0..rows {
        let below = row_of(row + 1);
        for column in 0..columns {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| {
                let depths = if y == 0 { &above } else { &below };
                (node(column + x, row + y), depths[column + x])
            });
            cross(corners, flat, &|point| depth.at(screen.offset_at(point)), &mut lines);
        }
        above = below;
    }
    lines
}

/// A point in the canvas, and the depth of its start.
type Corner = (DVec2, f64);

/// Adds the curve's lines in a square (marching squares). Where the curve crosses itself, the depth
/// is flat and the corners are ambiguous: a square with depths of less than `flat` at all corners,
/// or that is crossed twice, is divided until errors are too small to see.
fn cross(
    corners: [Corner; 4],
    flat: f64,
    depth: &impl Fn(DVec2) -> f64,
    lines: &mut Vec<[DVec2; 2]>,
) {
    let sides = [0, 1, 2, 3].map(|side| [corners[side], corners[(side + 1) % 4]]);
    let differ = |[(_, a), (_, b)]: &[Corner; 2]| (*a > 0.0) != (*b > 0.0);
    let crossed: Vec<_> = sides.into_iter().filter(differ).collect();
    let unclear = crossed.len() == 4 || corners.iter().all(|(_, depth)| depth.abs() < flat);
    if unclear && sides[0][0].0.distance(sides[0][1].0) > CURVE_LEAST {
        for quarter in quarters(corners, depth) {
            cross(quarter, flat / 4.0, depth, lines);
        }
        return;
    }
    let points: Vec<_> = crossed.into_iter().map(|side| zero_between(side, depth)).collect();
    lines.extend(points.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
}

fn quarters(corners: [Corner; 4], depth: &impl Fn(DVec2) -> f64) -> [[Corner; 4]; 4] {
    let middle = |points: &[Corner]| {
        let sum: DVec2 = points.iter().map(|(point, _)| *point).sum();
        let point = sum / points.len() as f64;
        (point, depth(point))
    };
    let center = middle(&corners);
    let sides = [0, 1, 2, 3].map(|side| middle(&[corners[side], corners[(side + 1) % 4]]));
    [0, 1, 2, 3].map(|k| [corners[k], sides[k], center, sides[(k + 3) % 4]])
}

/// Returns the zero of the depth between two points where its signs differ, by two steps of false
/// position.
fn zero_between([mut a, mut b]: [Corner; 2], depth: &impl Fn(DVec2) -> f64) -> DVec2 {
    let zero = |a: Corner, b: Corner| a.0 + (b.0 - a.0) * (a.1 / (a.1 - b.1));
    for _ in 0..2 {
        let point = zero(a, b);
        let between = (point, depth(point));
        if (between.1 > 0.0) == (a.1 > 0.0) {
            a = between;
        } else {
            b = between;
        }
    }
    zero(a, b)
}

/// Draws the energy curve in a colour, with a rim of the opposite lightness, so that it is visible
/// on every colour.
pub(crate) fn draw_curve(painter: &Painter, rect: Rect, lines: &[[DVec2; 2]], colour: Rgb) {
    let [r, g, b] = colour;
    let is_dark = colour.iter().all(|channel| *channel < 0x80);
    let rim = if is_dark { Color32::from_white_alpha(90) } else { Color32::from_black_alpha(90) };
    for stroke in [Stroke::new(3.0, rim), Stroke::new(1.5, Color32::from_rgb(r, g, b))] {
        let segment = |line: &[DVec2; 2]| {
            Shape::line_segment(line.map(|point| position(rect, point)), stroke)
        };
        painter.extend(lines.iter().map(segment));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_screen::camera::Camera;
    use flipmap_screen::reach::Reach;

    fn screen(center: [&str; 2], width_rad: f64) -> Screen {
        let center = center.map(|text| Exact::parse(text).unwrap());
        let camera = Camera { center, width_rad, ..Camera::whole(Reach::TORUS) };
        Screen { camera, size: DVec2::new(640.0, 480.0), pixels_per_point: 1.0 }
    }

    #[test]
    fn the_curve_is_where_the_energy_is_that_of_its_bound() {
        let screen = screen(["0", "0"], std::f64::consts::TAU);
        let lines = energy_curve(&screen, &PendulumSpec::default(), Rule::Second);
        assert!(lines.len() > 50);
        for point in lines.iter().flatten() {
            let [theta1, theta2] = screen.angle_at(*point).map(Exact::to_f64);
            let depth = 2.0 * theta1.cos() + theta2.cos() - 1.0;
            assert!(depth.abs() < 1e-5, "{depth} at {theta1}, {theta2}");
        }
    }

    #[test]
    fn the_curve_stays_a_line_at_any_depth() {
        // cos θ2 = 1 − 2 cos θ1 at θ1 = 1.3.
        let lit = Exact::from_f64;
        let wanted = lit(1.0) - lit(2.0) * Exact::parse("1.3").unwrap().sin_cos().1;
        // Newton steps from the f64 arc cosine.
        let exact = (0..4).fold(lit(wanted.to_f64().acos()), |theta, _| {
            let (sin, cos) = theta.sin_cos();
            theta + (cos - wanted) / sin
        });
        let center = ["1.3".to_string(), exact.to_string()];
        let screen = screen([&center[0], &center[1]], 1e-90);
        let lines = energy_curve(&screen, &PendulumSpec::default(), Rule::Second);
        let nearest = lines.iter().flatten().map(|p| p.length()).fold(f64::MAX, f64::min);
        assert!(lines.len() > 30 && nearest < 8.0, "{} lines, {nearest}", lines.len());
    }

    #[test]
    fn the_curve_crosses_itself_cleanly_where_the_second_bob_stands() {
        for center in [["0", "3.1415926535"], ["0.013", "3.1"], ["-0.05", "-3.12"]] {
            let screen = screen(center, std::f64::consts::TAU);
            let lines = energy_curve(&screen, &PendulumSpec::default(), Rule::Second);
            for [a, b] in lines {
                let [theta1, theta2] = screen.angle_at((a + b) / 2.0).map(Exact::to_f64);
                let depth = 2.0 * theta1.cos() + theta2.cos() - 1.0;
                assert!(depth.abs() < 1e-3, "{depth} at {theta1}, {theta2}");
            }
        }
    }
}
