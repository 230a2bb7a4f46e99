//! Limits on the questions and planes of a window: an engine must be able to compute them, and
//! neighbouring pixels must be different numbers.

use super::integration::Integration;
use super::state::AppState;
use flipmap_engine::choice::EngineRequest;
use flipmap_engine::{Cells, EngineKind, IntegratorConfig, Precision};
use flipmap_scene::lattice::pitch_rad;
use flipmap_screen::camera::Camera;

impl AppState {
    /// Returns a request for an engine that answers the question with the settings of the panels:
    /// otherwise it is `base`. `config` is what the engine that is open computes with. Without f64 on the card, growth and returns go to the processor, because their kernels in
    /// pairs of f32 take minutes to compile.
    pub(super) fn engine_request(
        &self,
        base: &EngineRequest,
        config: Option<IntegratorConfig>,
    ) -> EngineRequest {
        let Integration { kind, spec, .. } = &self.integration;
        let (setting, verify) = (spec.setting, spec.verify);
        let request = EngineRequest { kind: *kind, setting, verify, ..base.clone() };
        let request = request.answering(&self.question);
        let is_in_pairs = config.is_some_and(|config| config.precision == Precision::Df32);
        if request.ends.are_carried() && is_in_pairs {
            return EngineRequest { kind: Some(EngineKind::Cpu), ..request };
        }
        request
    }

    /// Widens a view whose neighbouring pixels would be the same number, and tells the user.
    /// Returns true if it did.
    pub(super) fn make_answerable(&mut self, config: IntegratorConfig) -> bool {
        if self.scene().has_cells() {
            return false;
        }
        let screen = self.aimed_screen();
        let units = screen.camera.reach.units();
        let fits = |level: &u32| Cells::Never.check(&config, units * pitch_rad(*level)).is_ok();
        if fits(&screen.level()) {
            return false;
        }
        let coarser = (0..=screen.level()).rev().find(fits).unwrap_or(0);
        let factor = 2f64.powi((screen.level() - coarser) as i32);
        let camera = Camera { width_rad: screen.camera.width_rad * factor, ..screen.camera };
        self.notices.tell(format!(
            "The view stays wider for this plane or question: neighbouring starts would be one \
             number in {}.",
            config.precision
        ));
        self.go(camera);
        true
    }
}
