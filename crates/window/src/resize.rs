//! Fits the home view into a canvas of a new size.

use glam::DVec2;

use super::state::AppState;
use flipmap_screen::camera::Camera;

impl AppState {
    /// Sets the size of the canvas in points. Replaces the home view by that of the new size if it
    /// is shown, the target of a move, or in the history.
    pub(crate) fn resize(&mut self, canvas: DVec2, pixels_per_point: f64) {
        self.pixels_per_point = pixels_per_point;
        if self.canvas == canvas {
            return;
        }
        let [was, now] = [self.canvas, canvas].map(|size| Camera::home(self.camera.reach, size));
        self.canvas = canvas;
        self.history.replace(was, now);
        match &mut self.moving {
            Some(moving) if moving.to == was => moving.to = now,
            None if self.camera == was => self.camera = now,
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::run_settings::RunSpec;
    use flipmap_scene::BuiltIn;

    fn state(scene: &str) -> AppState {
        let document = BuiltIn::named(scene).unwrap().document();
        AppState::new(&document, RunSpec::resolve(document.run.clone()).unwrap())
    }

    #[test]
    fn only_the_home_view_fits_into_another_canvas() {
        let size = DVec2::new(500.0, 900.0);
        let mut home = state("home");
        home.resize(size, 1.0);
        assert_eq!(home.camera, Camera::home(home.camera.reach, size));
        let mut filigree = state("filigree");
        let before = filigree.camera;
        filigree.resize(size, 2.0);
        assert_eq!((filigree.camera, filigree.canvas), (before, size));
    }
}
