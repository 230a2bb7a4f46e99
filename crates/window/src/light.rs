//! The light that falls from the side on the map's relief.

use glam::DVec2;

use super::state::AppState;
use flipmap_scene::PictureTable;

/// Strength of a relief that is switched on.
const STRENGTH: f64 = 0.6;

/// Returns a picture with its relief switched on, or off.
pub(crate) fn switched(picture: &PictureTable) -> PictureTable {
    let relief = if picture.relief > 0.0 { 0.0 } else { STRENGTH };
    PictureTable { relief, ..picture.clone() }
}

impl AppState {
    /// Lets the light come from a point of the map, seen from its middle, to a whole degree.
    pub(super) fn light_from(&mut self, point: DVec2) {
        if point == DVec2::ZERO {
            return;
        }
        let light = (-point.y).atan2(point.x).to_degrees().round().rem_euclid(360.0);
        self.paint(PictureTable { light, ..self.picture.clone() });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::Look;
    use crate::state::tests::state;

    #[test]
    fn the_light_follows_the_pointer_and_is_undone_in_one_step() {
        let mut state = state();
        state.look.animate = false;
        state.paint(switched(&state.picture));
        assert_eq!(state.picture.relief, STRENGTH);
        state.tick(0.0);
        let before = state.picture.clone();
        state.tick(10.0);
        let around =
            [(50.0, 0.0, 0.0), (30.0, -30.0, 45.0), (-9.0, 0.0, 180.0), (0.0, 70.0, 270.0)];
        for (k, (x, y, light)) in around.into_iter().enumerate() {
            state.light_from(DVec2::new(x, y));
            assert_eq!(state.picture.light, light);
            state.tick(10.0 + 0.1 * k as f64);
        }
        state.light_from(DVec2::ZERO);
        assert_eq!(state.picture.light, 270.0, "the middle has no direction");
        state.picture.check().unwrap();
        state.look(Look::Back);
        assert_eq!(state.picture, before);
        assert_eq!(switched(&state.picture).relief, 0.0);
    }
}
