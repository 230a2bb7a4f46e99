//! The limits within which a window can answer another question or show another plane: an engine
//! that computes it, and pixels that numbers can tell apart.

use super::camera::Camera;
use super::model::AppModel;
use crate::engine::choice::EngineRequest;
use crate::engine::{Cells, Ends, EngineKind, IntegratorConfig, Precision};
use crate::scene::lattice::pitch_rad;

impl AppModel {
    /// The kind of engine to open: the processor for growth and returns where the card has no f64, because
    /// their kernels in pairs of f32 take minutes to compile.
    pub(super) fn engine_kind(&self) -> Option<EngineKind> {
        let question = &self.state.question;
        let is_carried = Ends::from(question.ask.kind().needs).are_carried();
        let config = self.compute.config();
        if is_carried && config.is_some_and(|config| config.precision == Precision::Df32) {
            return Some(EngineKind::Cpu);
        }
        let kind = self.state.integration.kind;
        EngineRequest { kind, ..self.request.clone() }.answering(question).kind
    }

    /// Changes a view in which neighbouring pixels are one number, and says so. Returns true if it
    /// did.
    pub(super) fn make_answerable(&mut self) -> bool {
        self.compute.config().is_some_and(|config| self.make_view_fit(config))
    }

    fn make_view_fit(&mut self, config: IntegratorConfig) -> bool {
        let scene = self.state.scene();
        if scene.has_cells() {
            return false;
        }
        let screen = self.state.aimed_screen();
        let units = screen.camera.reach.units();
        let fits = |level: &u32| Cells::Never.check(&config, units * pitch_rad(*level)).is_ok();
        if fits(&screen.level()) {
            return false;
        }
        let coarser = (0..=screen.level()).rev().find(fits).unwrap_or(0);
        let factor = 2f64.powi((screen.level() - coarser) as i32);
        let camera = Camera { width_rad: screen.camera.width_rad * factor, ..screen.camera };
        self.state.notices.tell(format!(
            "The view stays wider for this plane or question: neighbouring starts would be one \
             number in {}.",
            config.precision
        ));
        self.state.go(camera);
        true
    }
}
