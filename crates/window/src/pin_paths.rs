//! The recent paths of the pinned pendulums in the plane of angles, drawn over the map.

use std::f64::consts::{PI, TAU};

use egui::{Color32, Painter, Rect, Shape, Stroke};
use glam::DVec2;

use super::overlay::position;
use super::state::AppState;
use flipmap_numbers::{Exact, Scalar};
use flipmap_screen::camera::{Camera, Screen};

/// Number of points per line of equal opacity.
const BAND: usize = 16;
/// Distance in points from the middle of the canvas beyond which nothing is drawn: far outside any
/// window, and small enough for f32.
const FAR: f64 = 1e5;

/// Draws the recent paths of all pins, fading with age, on every copy of the torus in view, if the
/// map is the torus of θ1 and θ2.
pub(super) fn draw(painter: &Painter, rect: Rect, state: &AppState) {
    if !state.camera.reach.repeats {
        return;
    }
    let screen = state.screen();
    let copies = copies(&screen);
    for pin in state.pins.iter() {
        let points: Vec<([f64; 2], f32)> = pin.trail.points().collect();
        for first in (0..points.len()).step_by(BAND) {
            let band = &points[first..points.len().min(first + BAND + 1)];
            let youth = band.last().map_or(0.0, |(_, youth)| *youth);
            let dark = Stroke::new(3.5, Color32::BLACK.gamma_multiply(0.5 * youth));
            let bright = Stroke::new(1.8, pin.badge.colour().gamma_multiply(youth));
            for line in unbroken(&screen.camera, band.iter().map(|(angle, _)| *angle)) {
                for line in copies.iter().flat_map(|copy| on_canvas(&screen, &line, *copy)) {
                    let line: Vec<_> = line.into_iter().map(|at| position(rect, at)).collect();
                    painter.add(Shape::line(line.clone(), dark));
                    painter.add(Shape::line(line, bright));
                }
            }
        }
    }
}

/// Returns the offsets in rad of the copies of the plane in view from the one around the middle; a
/// plane that does not repeat has no others.
pub(super) fn copies(screen: &Screen) -> Vec<DVec2> {
    if !screen.camera.reach.repeats {
        return vec![DVec2::ZERO];
    }
    let most = screen.region().half_rad.map(|half| ((half + PI) / TAU).ceil() as i32 - 1);
    let along = |axis: usize| -most[axis]..=most[axis];
    let copy = |x: i32, y: i32| TAU * DVec2::new(f64::from(x), f64::from(y));
    along(1).flat_map(|y| along(0).map(move |x| copy(x, y))).collect()
}

/// Returns the lines through angles as offsets in rad from the middle of a camera's view. Where the
/// angles pass from one side of the torus to the other, one line leaves it and another comes in.
fn unbroken(camera: &Camera, angles: impl Iterator<Item = [f64; 2]>) -> Vec<Vec<DVec2>> {
    let mut lines: Vec<Vec<DVec2>> = Vec::new();
    for angle in angles {
        let offset = camera.offset_of(angle.map(|theta| Exact::from_f64(theta).wrapped()));
        let Some(line) = lines.last_mut() else {
            lines.push(vec![offset]);
            continue;
        };
        let before = line[line.len() - 1];
        let turns = TAU * ((offset - before) / TAU).round();
        line.push(offset - turns);
        if turns != DVec2::ZERO {
            lines.push(vec![before + turns, offset]);
        }
    }
    lines
}

/// Returns the points of the canvas on a copy of a line, broken where it is far off.
fn on_canvas(screen: &Screen, line: &[DVec2], copy: DVec2) -> Vec<Vec<DVec2>> {
    let is_near = |point: &DVec2| point.is_finite() && point.abs().max_element() <= FAR;
    let points: Vec<DVec2> = line.iter().map(|offset| screen.point_of(*offset + copy)).collect();
    let parts = points.split(|point| !is_near(point)).filter(|part| !part.is_empty());
    parts.map(<[DVec2]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_screen::reach::Reach;

    fn screen(width_rad: f64, size: DVec2) -> Screen {
        let camera = Camera { width_rad, ..Camera::whole(Reach::TORUS) };
        Screen { camera, size, pixels_per_point: 1.0 }
    }

    fn drawn(screen: &Screen, path: impl Iterator<Item = [f64; 2]> + Clone) -> Vec<Vec<DVec2>> {
        let lines = unbroken(&screen.camera, path);
        let copies = copies(screen);
        let on = |copy: &DVec2| -> Vec<Vec<DVec2>> {
            lines.iter().flat_map(|line| on_canvas(screen, line, *copy)).collect()
        };
        copies.iter().flat_map(on).collect()
    }

    #[test]
    fn a_path_leaves_the_torus_and_comes_in_on_the_other_side() {
        let screen = screen(TAU, DVec2::splat(628.0));
        assert_eq!(copies(&screen), [DVec2::ZERO]);
        let path = [[3.0, 0.0], [3.1, 0.1], [3.2, 0.2], [3.3, 0.3]];
        let lines = drawn(&screen, path.into_iter());
        assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3]);
        assert!(lines[0][2].x > 314.0 && lines[1][0].x < -314.0, "no gap: {lines:?}");
        let across = DVec2::new(628.0, 0.0);
        assert!((lines[0][1] - across - lines[1][0]).length() < 0.1, "the same point");
        // A motion counts full turns, but the map does not.
        let turned = path.map(|[theta1, theta2]| [theta1 - 8.0 * PI, theta2]);
        let again = drawn(&screen, turned.into_iter());
        assert!((again[0][1] - lines[0][1]).length() < 1e-6);
    }

    #[test]
    fn what_is_far_off_is_left_out() {
        let deep = screen(1e-30, DVec2::splat(628.0));
        assert_eq!(copies(&deep), [DVec2::ZERO]);
        let from_middle = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.0]];
        assert_eq!(drawn(&deep, from_middle.into_iter()), [vec![DVec2::ZERO], vec![DVec2::ZERO]]);
    }

    #[test]
    fn every_copy_in_view_has_the_path() {
        // Three copies across, of which those at the sides are shown in part, and one up.
        let wide = screen(1.5 * TAU, DVec2::new(942.0, 628.0));
        assert_eq!(copies(&wide), [-1.0, 0.0, 1.0].map(|x| DVec2::new(x * TAU, 0.0)));
        let lines = drawn(&wide, [[0.0, 1.0], [0.1, 1.0]].into_iter());
        let starts: Vec<f64> = lines.iter().map(|line| line[0].x.round()).collect();
        assert_eq!(starts, [-628.0, 0.0, 628.0]);
        let bounded = Camera::whole(Reach { doublings: 4, repeats: false });
        assert_eq!(copies(&Screen { camera: bounded, ..wide }), [DVec2::ZERO]);
    }
}
