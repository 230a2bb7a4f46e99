//! Divides a figure's area between its stage and its charts.

use egui::{Ui, Vec2, vec2};

/// Least width of a column of charts in points.
const CHARTS_WIDTH: f32 = 280.0;
/// Largest part of the width that a column of charts takes.
const CHARTS_PART: f32 = 0.45;
/// Part of the height that a row of charts below the stage takes.
const CHARTS_HEIGHT: f32 = 0.38;
/// Largest height of a chart in a column, relative to its width.
const CHART_RATIO: f32 = 1.2;
/// Least width of charts in a row in points.
const ROW_WIDTH: f32 = 200.0;
/// Space between the stage and the charts in points.
const GAP: f32 = 8.0;

/// Where a figure's charts are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Arrangement {
    /// In a column to the right of the stage.
    Beside { stage: Vec2, chart: Vec2 },
    /// Below the stage, side by side, or below one another where that leaves them too little width.
    Below { stage: Vec2, chart: Vec2 },
}

impl Arrangement {
    /// Returns the arrangement of a stage and `charts` charts in `size` points in which a pendulum,
    /// which swings in a square, is larger.
    pub(super) fn of(size: Vec2, charts: usize) -> Self {
        let count = charts as f32;
        let widest = CHARTS_WIDTH.max(CHARTS_PART * size.x);
        let column = (size.x - size.y - GAP).clamp(CHARTS_WIDTH, widest);
        let beside = vec2(size.x - column - GAP, size.y);
        let row = CHARTS_HEIGHT * size.y;
        let below = vec2(size.x, size.y - row - GAP);
        if beside.min_elem() >= below.min_elem() {
            let high = (size.y - GAP * (count - 1.0)) / count;
            let chart = vec2(column, high.min(CHART_RATIO * column));
            return Arrangement::Beside { stage: beside, chart };
        }
        let width = (size.x - GAP * (count - 1.0)) / count;
        let width = if width < ROW_WIDTH { size.x } else { width };
        Arrangement::Below { stage: below, chart: vec2(width, row) }
    }

    /// Shows the stage, and then the charts, of which `chart` shows all, each in the size that it
    /// is given.
    pub(super) fn show(
        self,
        ui: &mut Ui,
        stage: impl FnOnce(&mut Ui, Vec2),
        charts: impl FnOnce(&mut Ui, Vec2),
    ) {
        ui.spacing_mut().item_spacing = Vec2::splat(GAP);
        match self {
            Arrangement::Beside { stage: size, chart } => {
                ui.horizontal_top(|ui| {
                    stage(ui, size);
                    ui.vertical(|ui| charts(ui, chart));
                });
            }
            Arrangement::Below { stage: size, chart } => {
                stage(ui, size);
                ui.horizontal_wrapped(|ui| charts(ui, chart));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pendulum_gets_the_larger_square() {
        let Arrangement::Beside { stage, chart } = Arrangement::of(vec2(850.0, 650.0), 2) else {
            panic!("a wide figure has its charts beside the stage")
        };
        assert_eq!(stage, vec2(562.0, 650.0));
        assert_eq!(chart, vec2(280.0, 321.0));
        let Arrangement::Below { stage, chart } = Arrangement::of(vec2(640.0, 1000.0), 2) else {
            panic!("a high figure has its charts below the stage")
        };
        assert_eq!(stage, vec2(640.0, 612.0));
        assert_eq!(chart, vec2(316.0, 380.0));
        let Arrangement::Below { chart, .. } = Arrangement::of(vec2(390.0, 900.0), 2) else {
            panic!("a narrow figure has its charts below the stage")
        };
        assert_eq!(chart.x, 390.0, "charts that would be too narrow are below one another");
    }
}
