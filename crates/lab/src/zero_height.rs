//! The height at which potential energy counts as zero: a line across a stage, which can be dragged.

use std::ops::RangeInclusive;

use egui::{CursorIcon, Grid, Id, Rect, Sense, Ui, Vec2, pos2};

use super::controls::number;
use super::drawing::FigureCanvas;
use super::set_up::SetUpWord;

/// A height at which potential energy counts as zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ZeroHeight {
    /// Height in m above the lowest place that the pendulum reaches.
    pub above_m: f64,
}

/// Name of the line on a stage.
pub(super) const ZERO_LABEL: &str = "energy 0";
/// Range of the height in m.
const HEIGHTS: RangeInclusive<f64> = 0.0..=12.0;
/// Size in points of the area in which the line can be grabbed, and its distance from the edge.
const GRIP: f32 = 20.0;

impl ZeroHeight {
    /// Shows the height as a number with a slider.
    pub(super) fn control(&mut self, ui: &mut Ui) {
        Grid::new("zero").num_columns(2).show(ui, |ui| {
            number(ui, "Energy 0 at", " m", &mut self.above_m, HEIGHTS);
        });
    }

    /// Draws the line on a stage on which the lowest place is `lowest_m` above the pivot, and follows
    /// a drag of its handle. Returns the handle's place, where there is room for [`ZERO_LABEL`]; none
    /// if the height is outside the stage.
    pub(super) fn lay_on(
        &mut self,
        ui: &mut Ui,
        stage: &FigureCanvas,
        lowest_m: f64,
    ) -> Option<[f64; 2]> {
        let x = stage.rect.right() - GRIP;
        let at = |above_m: f64| pos2(x, stage.at([0.0, lowest_m + above_m]).y);
        let grip = Rect::from_center_size(at(self.above_m), Vec2::splat(GRIP));
        let response = ui.interact(grip, Id::unique("zero height"), Sense::drag());
        if response.dragged() {
            let [_, y] = stage.place(at(self.above_m) + response.drag_delta());
            self.above_m = (y - lowest_m).clamp(*HEIGHTS.start(), *HEIGHTS.end());
        }
        if !stage.rect.contains(at(self.above_m)) {
            return None;
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
