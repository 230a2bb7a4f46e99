//! Counts of the samples in view, for the explanation of the map.

use glam::DVec2;

use flipmap_lab::flips::Seen;
use flipmap_pendulum::Status;
use flipmap_render::tiles::explorer::{Explorer, MAX_CELLS};
use flipmap_scene::lattice::{Placed, SIDE, pitch_rad};
use flipmap_screen::camera::Screen;

/// The counts of the view, and what they depend on.
#[derive(Debug, Default)]
pub(super) struct InView(Option<(Screen, u64, Seen)>);

impl InView {
    /// Returns the counts of the samples that a screen shows, counted again only if it has changed
    /// or more samples are known.
    pub(super) fn seen(&mut self, screen: &Screen, explorer: &mut Explorer) -> Seen {
        let known = explorer.counts().pixels;
        match &self.0 {
            Some((last, then, seen)) if last == screen && *then == known => *seen,
            _ => {
                let seen = counted(screen, explorer);
                self.0 = Some((*screen, known, seen));
                seen
            }
        }
    }
}

/// Counts the known samples of a screen's level that lie on it.
fn counted(screen: &Screen, explorer: &mut Explorer) -> Seen {
    let mut seen = Seen { name: "pixels of this view", ..Seen::default() };
    let level = screen.level();
    for placed in screen.region().cells(level, MAX_CELLS) {
        let Some((known, mirrored)) = explorer.known(placed.cell) else { continue };
        let (stride, places) = (known.stride, Places::of(screen, &placed, level));
        let along = stride.side(SIDE);
        for index in 0..along * along {
            let place = [index % along, index / along];
            let place = place.map(|k| stride.first() + k * stride.places());
            let place = if mirrored { place.map(|k| SIDE - 1 - k) } else { place };
            if places.point(place).abs().cmple(screen.size / 2.0).all() {
                seen.pixels += 1;
                let status = known.samples.get(index as usize).status;
                seen.forbidden += u64::from(status == Status::Forbidden);
            }
        }
    }
    seen
}

/// The points of the canvas on which the places of a cell lie.
struct Places {
    first: DVec2,
    right: DVec2,
    down: DVec2,
}

impl Places {
    fn of(screen: &Screen, placed: &Placed, level: u32) -> Self {
        let pitch = pitch_rad(level);
        let at = |column: f64, row: f64| {
            let half = f64::from(SIDE) / 2.0 - 0.5;
            let from_middle = DVec2::new(column - half, half - row) * pitch;
            screen.point_of(DVec2::from_array(placed.offset) + from_middle)
        };
        let first = at(0.0, 0.0);
        Places { first, right: at(1.0, 0.0) - first, down: at(0.0, 1.0) - first }
    }

    fn point(&self, place: [u32; 2]) -> DVec2 {
        let [column, row] = place.map(f64::from);
        self.first + column * self.right + row * self.down
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::mock::MockEngine;
    use flipmap_engine::{IntegratorConfig, Method, Precision};
    use flipmap_numbers::{Exact, Scalar};
    use flipmap_render::tiles::cache::TILE_BYTES;
    use flipmap_render::tiles::view_target::{Physics, ViewTarget};
    use flipmap_scene::Scene;
    use flipmap_screen::camera::Camera;
    use flipmap_screen::reach::Reach;

    fn look(explorer: &mut Explorer, center: [f64; 2], width_rad: f64) -> Screen {
        let center = center.map(Exact::from_f64);
        let camera = Camera { center, width_rad, ..Camera::whole(Reach::TORUS) };
        let screen = Screen { camera, size: DVec2::new(200.0, 160.0), pixels_per_point: 1.0 };
        let scene = Scene::default();
        let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
        explorer.target(&ViewTarget {
            physics: Physics::of(&scene, config, false),
            budget_secs: scene.question.budget.secs,
            region: screen.region(),
            level: screen.level(),
            pointer: None,
            refinements: 0,
        });
        explorer.work(&mut MockEngine::default(), None).unwrap();
        screen
    }

    #[test]
    fn the_counts_are_those_of_the_view_wherever_the_session_has_been() {
        let mut explorer = Explorer::new(1000 * TILE_BYTES);
        let mut in_view = InView::default();
        let mut share = |center, width_rad| {
            let screen = look(&mut explorer, center, width_rad);
            let seen = in_view.seen(&screen, &mut explorer);
            let pitch = pitch_rad(screen.level());
            let expected = width_rad * width_rad * 0.8 / (pitch * pitch);
            assert!((seen.pixels as f64 / expected - 1.0).abs() < 0.03, "{seen:?} {expected}");
            seen.forbidden as f64 / seen.pixels as f64
        };
        assert_eq!(share([3.0, 0.3], 0.1), 0.0, "nothing is forbidden there");
        assert_eq!(share([0.0, 0.0], 0.1), 1.0, "everything is");
        // The whole width of the torus, and its height of 160 in 200 points around the middle.
        let wide = share([0.0, 0.0], std::f64::consts::TAU);
        assert!((0.3..0.4).contains(&wide), "{wide}");
        assert_eq!(share([3.0, 0.3], 0.1), 0.0);
    }
}
