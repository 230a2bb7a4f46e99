//! A ruler that also measures angles: two ends that are dragged over a stage.

use egui::{Id, Sense, Stroke, Ui, Vec2};

use super::drawing::{FigureCanvas, angle_of};
use flipmap_numbers::number_text::fixed;

/// The ruler, which egui remembers while the window is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StageRuler {
    /// True if it lies on the stages.
    pub is_shown: bool,
    /// Its ends as shares of the stage's width and height.
    ends: [[f32; 2]; 2],
}

/// Size in points of the area in which an end can be grabbed.
const GRIP: f32 = 20.0;

impl Default for StageRuler {
    fn default() -> Self {
        StageRuler { is_shown: false, ends: [[0.2, 0.8], [0.4, 0.8]] }
    }
}

impl StageRuler {
    fn id() -> Id {
        Id::unique("ruler")
    }

    /// Shows the switch of the ruler.
    pub(super) fn switch(ui: &mut Ui) {
        let mut ruler = StageRuler::of(ui);
        let switch = ui.checkbox(&mut ruler.is_shown, "Ruler");
        if switch.on_hover_text("Measures distances, and angles from the vertical").changed() {
            ui.data_mut(|data| data.insert_temp(StageRuler::id(), ruler));
        }
    }

    fn of(ui: &Ui) -> Self {
        ui.data(|data| data.get_temp(StageRuler::id())).unwrap_or_default()
    }

    /// Draws the ruler on a stage if it is shown, and follows a drag of its ends.
    pub(super) fn lay_on(ui: &mut Ui, stage: &FigureCanvas) {
        let mut ruler = StageRuler::of(ui);
        if !ruler.is_shown {
            return;
        }
        let rect = stage.rect;
        for (k, end) in ruler.ends.iter_mut().enumerate() {
            let at = rect.lerp_inside(Vec2::from(*end));
            let grip = egui::Rect::from_center_size(at, Vec2::splat(GRIP));
            let response = ui.interact(grip, StageRuler::id().with(k), Sense::drag());
            let moved = (response.drag_delta() / rect.size()) + Vec2::from(*end);
            *end = moved.clamp(Vec2::ZERO, Vec2::splat(1.0)).into();
        }
        ui.data_mut(|data| data.insert_temp(StageRuler::id(), ruler));
        let points = ruler.ends.map(|end| rect.lerp_inside(Vec2::from(end)));
        let colour = stage.tint.parts[3];
        stage.painter.line_segment(points, Stroke::new(2.0, colour));
        let places = points.map(|point| stage.place(point));
        places.iter().for_each(|place| stage.handle(*place, colour));
        stage.label(places[1], &reading(places), colour);
    }
}

/// Returns the distance between two places in m, and the angle of the line from the vertical.
fn reading([from, to]: [[f64; 2]; 2]) -> String {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let degrees = angle_of(from, to).to_degrees();
    format!("{} m, {}°", fixed(length, 2), fixed(degrees, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_reads_lengths_and_angles_from_the_vertical() {
        assert_eq!(reading([[0.0, 0.0], [0.0, -2.0]]), "2.00 m, 0.0°");
        assert_eq!(reading([[1.0, 1.0], [4.0, 5.0]]), "5.00 m, 143.1°");
        assert_eq!(reading([[0.0, 0.0], [-1.0, 0.0]]), "1.00 m, −90.0°");
    }
}
