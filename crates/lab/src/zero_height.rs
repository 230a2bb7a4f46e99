//! The height at which potential energy counts as zero: a line across a stage, which can be dragged.

use std::ops::RangeInclusive;

use egui::{CursorIcon, Grid, Id, Rect, Sense, Ui, Vec2, pos2};

use super::controls::number;
use super::drawing::FigureCanvas;
use super::set_up::SetUpWord;

/// A height at which potential energy counts as zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ZeroHeight {
    /// Height in m above the centre of mass of the pendulum that hangs at rest.
    pub above_m: f64,
}

/// Name of the line on a stage.
pub(super) const ZERO_LABEL: &str = "energy 0";
/// Range of the height in m.
const HEIGHTS: RangeInclusive<f64> = 0.0..=12.0;
/// Size in points of the area in which the line can be grabbed.
const GRIP: f32 = 20.0;

impl ZeroHeight {
    /// Shows the height as a number with a slider, as high as a pendulum of this reach in m swings.
    pub(super) fn control(&mut self, ui: &mut Ui, reach_m: f64) {
        Grid::new("zero").num_columns(2).show(ui, |ui| {
            number(ui, "Raise energy 0", " m", &mut self.above_m, 0.0..=2.0 * reach_m);
        });
    }

    /// Draws the line on a stage, on which the pendulum's centre of mass hangs at `hanging_m` above the
    /// pivot, and follows a drag of its handle. Returns the handle's place, where there is room for
    /// [`ZERO_LABEL`]; none if the height is outside the stage.
    pub(super) fn lay_on(
        &mut self,
        ui: &mut Ui,
        stage: &FigureCanvas,
        hanging_m: f64,
    ) -> Option<[f64; 2]> {
        // At the edge, away from bobs.
        let x = stage.rect.right() - 0.5 * GRIP;
        let at = |above_m: f64| pos2(x, stage.at([0.0, hanging_m + above_m]).y);
        if !stage.rect.contains(at(self.above_m)) {
            return None;
        }
        let grip = Rect::from_center_size(at(self.above_m), Vec2::splat(GRIP));
        let response = ui.interact(grip, Id::unique("zero height"), Sense::drag());
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let y = pointer.y.clamp(stage.rect.top(), stage.rect.bottom());
            let [_, height] = stage.place(pos2(x, y));
            self.above_m = (height - hanging_m).clamp(*HEIGHTS.start(), *HEIGHTS.end());
        }
        let handle = stage.place(at(self.above_m));
        stage.level(handle, stage.tint.faint.gamma_multiply(0.6));
        stage.handle(handle, stage.tint.parts[2]);
        let hint = "Drag the height from which potential energy is counted";
        response.on_hover_text(hint).on_hover_cursor(CursorIcon::ResizeVertical);
        Some(handle)
    }

    /// Returns the height as a word of a set-up.
    pub(super) fn word(self) -> SetUpWord {
        SetUpWord::numbers("zero", [self.above_m], HEIGHTS)
    }
}
