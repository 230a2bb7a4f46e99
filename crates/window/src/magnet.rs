//! The magnet of the wheel: over a smooth part of the map, the wheel zooms about the structure next
//! to the pointer, which would otherwise leave the view.

use glam::DVec2;

use super::action::{Action, Look};
use super::model::AppModel;
use flipmap_pendulum::{Outcome, Status};
use flipmap_screen::camera::Screen;
use flipmap_screen::samples_in_view;

/// Number of places along each axis around the pointer that are looked at.
const SIDE: usize = 13;
/// Distance of those places in points.
const STEP: f64 = 8.0;
/// Distance from the pointer, in points, within which structure needs no magnet.
const AT_POINTER: f64 = 16.0;
/// Distance from the pointer, in points, at which structure counts for half.
const NEAR: f64 = 24.0;
/// Least difference between neighbours that is structure, as a logarithm of flip times.
const LEAST: f64 = 0.15;

impl AppModel {
    /// Returns the movement for a turn of the wheel at a point.
    pub(super) fn wheel(&mut self, factor: f64, about: DVec2) -> Action {
        let attracts = self.settings.magnet && factor > 1.0 && self.state.moving.is_none();
        let screen = self.state.screen();
        let explorer = &mut self.compute.explorer;
        let mut outcome = |point| samples_in_view::outcome(&screen, explorer, point);
        let about = if attracts { attracted(&screen, about, &mut outcome) } else { about };
        Action::Look(Look::Zoom { factor, about })
    }
}

/// Returns the point near `about` to zoom about: itself if there is structure at it, or none near
/// it.
fn attracted(
    screen: &Screen,
    about: DVec2,
    outcome: &mut dyn FnMut(DVec2) -> Option<Outcome>,
) -> DVec2 {
    let half = (SIDE / 2) as f64;
    let place = |k: usize| DVec2::new((k % SIDE) as f64 - half, (k / SIDE) as f64 - half) * STEP;
    let known: Vec<Option<Outcome>> = (0..SIDE * SIDE)
        .map(|k| outcome((about + place(k)).clamp(-screen.size / 2.0, screen.size / 2.0)))
        .collect();
    let differ = |a: usize, b: usize| match (known[a], known[b]) {
        (Some(a), Some(b)) => difference(&a, &b),
        _ => 0.0,
    };
    let liveliness = |k: usize| {
        let (x, y) = (k % SIDE, k / SIDE);
        let right = if x + 1 < SIDE { differ(k, k + 1) } else { 0.0 };
        let below = if y + 1 < SIDE { differ(k, k + SIDE) } else { 0.0 };
        right.max(below)
    };
    let lively = (0..SIDE * SIDE).map(|k| (place(k), liveliness(k))).filter(|(_, l)| *l >= LEAST);
    let lively: Vec<(DVec2, f64)> = lively.collect();
    if lively.iter().any(|(away, _)| away.length() <= AT_POINTER) {
        return about;
    }
    let score = |(away, lively): &(DVec2, f64)| lively / (1.0 + (away.length() / NEAR).powi(2));
    let best = lively.iter().max_by(|a, b| score(a).total_cmp(&score(b)));
    best.map_or(about, |(away, _)| about + *away)
}

/// Returns how much two outcomes differ, from 0 to 1; what is never simulated has no structure.
fn difference(a: &Outcome, b: &Outcome) -> f64 {
    match (a.status, b.status) {
        (Status::Answered, Status::Answered) => (a.time / b.time).ln().abs().min(1.0),
        (Status::Answered, Status::Unflipped) | (Status::Unflipped, Status::Answered) => 1.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::tests::state;

    /// Where the wheel zooms about for a pointer in the middle of a map with these times.
    fn about(secs: impl Fn(DVec2) -> Option<f64>) -> DVec2 {
        let screen = state().screen();
        attracted(&screen, DVec2::ZERO, &mut |at| {
            Some(match secs(at) {
                Some(secs) => Outcome::flipped(secs),
                None => Outcome::without_time(Status::Forbidden),
            })
        })
    }

    #[test]
    fn the_wheel_keeps_the_edge_beside_the_pointer_in_view() {
        let edge = about(|at| Some(if at.x < 30.0 { 2.0 } else { 7.0 }));
        assert!((edge.x - 28.0).abs() <= STEP && edge.y.abs() < 1e-9, "{edge}");
    }

    #[test]
    fn smooth_parts_structure_at_the_pointer_and_borders_of_the_forbidden_attract_nothing() {
        assert_eq!(about(|_| Some(3.0)), DVec2::ZERO);
        assert_eq!(about(|at| Some(3.0 + 0.001 * at.x)), DVec2::ZERO);
        assert_eq!(about(|at| Some(if at.x < 5.0 { 2.0 } else { 7.0 })), DVec2::ZERO);
        assert_eq!(about(|at| (at.x < 30.0).then_some(2.0)), DVec2::ZERO);
    }
}
