//! Figure 3: the double pendulum with its parts labelled.

use egui::{Grid, Ui};

use super::controls::{build, row};
use super::double_simulation::DoublePendulumSimulation;
use super::drawing::{COLOURS, FAINT, FigureCanvas, INK, end, ends, wrapped};
use super::{FigureRequest, LiveFigure};
use crate::physics::State;

/// A live figure of two angles, and of the second pivot riding on the first bob.
#[derive(Clone, Debug)]
pub(super) struct Double(DoublePendulumSimulation);

impl Default for Double {
    fn default() -> Self {
        Double(DoublePendulumSimulation::from([0.8, 1.4]))
    }
}

impl LiveFigure for Double {
    fn open(&mut self, start: State<f64>) {
        self.0.release(start);
    }

    fn advance(&mut self, elapsed_secs: f64) {
        self.0.advance(elapsed_secs);
    }

    fn draw(&mut self, ui: &mut Ui, size: egui::Vec2) {
        let angle = self.0.now().angle.map(wrapped);
        let lengths = self.0.build.lengths_m();
        let told = format!("θ1 is {:.3} rad, θ2 is {:.3} rad", angle[0], angle[1]);
        let (stage, response) = FigureCanvas::new(ui, size, 1.1 * (lengths[0] + lengths[1]), told);
        let [first, second] = ends(lengths, angle);
        let short = 0.3 * lengths[0].min(lengths[1]);
        for (at, theta) in [([0.0; 2], angle[0]), (first, angle[1])] {
            stage.dashed(at, [at[0], at[1] - 2.0 * short], FAINT);
            stage.arc(at, theta, short, COLOURS[2]);
        }
        self.0.draw(&stage);
        stage.label([0.0; 2], "pivot", FAINT);
        let beside = |at, theta: f64| end(at, 1.1 * short, 0.5 * theta);
        stage.label(beside([0.0; 2], angle[0]), "θ1", COLOURS[2]);
        stage.label(beside(first, angle[1]), "θ2", COLOURS[2]);
        let [m1, m2] = self.0.build.masses_kg();
        let middle = |from: [f64; 2], to: [f64; 2]| [0, 1].map(|i| 0.5 * (from[i] + to[i]));
        stage.label(middle([0.0; 2], first), &format!("l1 = {:.2} m", lengths[0]), INK);
        stage.label(middle(first, second), &format!("l2 = {:.2} m", lengths[1]), INK);
        stage.label(first, &format!("m1 = {m1:.2} kg, the second pivot"), COLOURS[0]);
        stage.label(second, &format!("m2 = {m2:.2} kg"), COLOURS[1]);
        stage.note("Both angles are from the vertical. Drag either bob.");
        self.0.drag(&stage, &response);
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        if build(ui, &mut self.0.build) {
            self.0.release(self.0.start);
        }
        ui.separator();
        Grid::new("double now").num_columns(2).show(ui, |ui| {
            let state = self.0.state;
            row(ui, "time", format!("{:8.3} s", self.0.secs()));
            for i in 0..2 {
                row(ui, &format!("θ{}", i + 1), format!("{:8.4} rad", wrapped(state.angle[i])));
                row(ui, &format!("ω{}", i + 1), format!("{:8.4} rad/s", state.speed[i]));
            }
        });
        ui.button("Show this start on the map")
            .clicked()
            .then_some(FigureRequest::ToMap(self.0.start))
    }

    fn set(&self) -> Vec<f64> {
        self.0.set()
    }

    fn csv(&self, secs: f64) -> String {
        super::machine::motion(&self.0, secs)
    }
}
