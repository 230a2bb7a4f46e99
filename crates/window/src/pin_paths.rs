//! The recent paths of the pinned pendulums in the plane of angles, drawn over the map.

use egui::{Color32, Painter, Rect, Shape, Stroke};
use glam::DVec2;

use super::camera::Screen;
use super::overlay::position;
use super::state::AppState;
use flipmap_numbers::{Exact, Scalar};

/// Number of points per line of equal opacity.
const BAND: usize = 16;
/// Distance in points from the middle of the canvas beyond which nothing is drawn: far outside any
/// window, and small enough for f32.
const FAR: f64 = 1e5;

/// Draws the recent paths of all pins, fading with age, if the map is the torus of θ1 and θ2.
pub(super) fn draw(painter: &Painter, rect: Rect, state: &AppState) {
    if !state.camera.reach.repeats {
        return;
    }
    let screen = state.screen();
    for pin in state.pins.iter() {
        let points: Vec<([f64; 2], f32)> = pin.trail.points().collect();
        for first in (0..points.len()).step_by(BAND) {
            let band = &points[first..points.len().min(first + BAND + 1)];
            let youth = band.last().map_or(0.0, |(_, youth)| *youth);
            let angles = band.iter().map(|(angle, _)| *angle);
            for line in unbroken(&screen, angles) {
                let line: Vec<_> = line.iter().map(|at| position(rect, *at)).collect();
                let dark = Stroke::new(3.5, Color32::BLACK.gamma_multiply(0.5 * youth));
                painter.add(Shape::line(line.clone(), dark));
                let colour = pin.badge.colour().gamma_multiply(youth);
                painter.add(Shape::line(line, Stroke::new(1.8, colour)));
            }
        }
    }
}

/// Returns the lines through angles as points of the canvas, broken where the angles pass from one
/// side of the torus to the other.
fn unbroken(screen: &Screen, angles: impl Iterator<Item = [f64; 2]>) -> Vec<Vec<DVec2>> {
    let mut lines: Vec<Vec<DVec2>> = Vec::new();
    let mut before: Option<DVec2> = None;
    for angle in angles {
        let offset = screen.camera.offset_of(angle.map(|theta| Exact::from_f64(theta).wrapped()));
        let point = screen.point_of(offset);
        if !point.is_finite() || point.abs().max_element() > FAR {
            before = None;
            continue;
        }
        let goes_on = before
            .is_some_and(|before| (offset - before).abs().max_element() < std::f64::consts::PI);
        match lines.last_mut().filter(|_| goes_on) {
            Some(line) => line.push(point),
            None => lines.push(vec![point]),
        }
        before = Some(offset);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::reach::Reach;

    #[test]
    fn a_path_breaks_where_it_leaves_the_torus_and_comes_back_on_the_other_side() {
        let camera = Camera::whole(Reach::TORUS);
        let screen = Screen { camera, size: DVec2::new(628.0, 628.0), pixels_per_point: 1.0 };
        let path = [[3.0, 0.0], [3.1, 0.1], [3.2, 0.2], [3.3, 0.3]];
        let lines = unbroken(&screen, path.into_iter());
        assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
        assert!(lines[0][1].x > 300.0 && lines[1][0].x < -300.0, "{lines:?}");
        // A motion counts full turns, but the map does not.
        let turned = path.map(|[theta1, theta2]| [theta1 - 8.0 * std::f64::consts::PI, theta2]);
        let again = unbroken(&screen, turned.into_iter());
        assert!((again[0][1] - lines[0][1]).length() < 1e-6);
        let deep = Screen { camera: Camera { width_rad: 1e-30, ..camera }, ..screen };
        let from_middle = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.0]];
        let near = unbroken(&deep, from_middle.into_iter());
        assert_eq!(near, [vec![DVec2::ZERO], vec![DVec2::ZERO]], "what is far off is left out");
    }
}
