//! Figure 3: the double pendulum with its parts labelled.

use egui::{Grid, Ui};

use super::controls::{build, row};
use super::double_simulation::DoublePendulumSimulation;
use super::drawing::{FigureCanvas, StageReach, end, ends, wrapped};
use super::{FigureRequest, LiveFigure};
use flipmap_numbers::number_text::{column, fixed};
use flipmap_pendulum::State;

/// The live figure of a double pendulum, with both angles and the second pivot on the first bob.
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

    fn restart(&mut self) {
        self.0.release(self.0.start);
    }

    fn secs(&self) -> f64 {
        self.0.secs()
    }

    fn advance(&mut self, elapsed_secs: f64) {
        self.0.advance(elapsed_secs);
    }

    fn told(&self) -> String {
        self.0.told()
    }

    fn draw(&mut self, ui: &mut Ui, size: egui::Vec2) {
        let angle = self.0.now().angle.map(wrapped);
        let lengths = self.0.build.lengths_m();
        let reach = lengths[0] + lengths[1];
        let (stage, response) =
            FigureCanvas::new(ui, size, StageReach::of_rods(reach), self.told());
        let [first, second] = ends(lengths, angle);
        let (faint, [one, two, three, _]) = (stage.tint.faint, stage.tint.parts);
        stage.note(None, "Both angles are from the vertical. Drag a bob, or the ring of an arc.");
        // Arcs keep a least size where rods are short, so that their handles can be grabbed.
        let radius = (0.3 * lengths[0].min(lengths[1])).max(0.1 * reach);
        let handles = [end([0.0; 2], radius, angle[0]), end(first, radius, angle[1])];
        for (at, theta) in [([0.0; 2], angle[0]), (first, angle[1])] {
            stage.dashed(at, [at[0], at[1] - 2.0 * radius], faint);
            stage.arc(at, theta, radius, three);
        }
        self.0.draw(&stage);
        handles.iter().for_each(|handle| stage.handle(*handle, three));
        let beside = |at, theta: f64| end(at, 1.05 * radius, 0.5 * theta);
        stage.label(beside([0.0; 2], angle[0]), "θ1", three);
        stage.label(beside(first, angle[1]), "θ2", three);
        let [m1, m2] = self.0.build.masses_kg();
        stage.label(first, &format!("m1 = {} kg, the second pivot", fixed(m1, 2)), one);
        stage.label(second, &format!("m2 = {} kg", fixed(m2, 2)), two);
        let along = |from: [f64; 2], to: [f64; 2]| [0, 1].map(|i| 0.4 * from[i] + 0.6 * to[i]);
        stage.label(
            along([0.0; 2], first),
            &format!("l1 = {} m", fixed(lengths[0], 2)),
            stage.tint.ink,
        );
        stage.label(
            along(first, second),
            &format!("l2 = {} m", fixed(lengths[1], 2)),
            stage.tint.ink,
        );
        stage.label([0.0; 2], "pivot", faint);
        self.0.drag(&stage, &response, Some(handles));
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        if build(ui, &mut self.0.build) {
            self.0.release(self.0.start);
        }
        ui.separator();
        Grid::new("double now").num_columns(2).show(ui, |ui| {
            let state = self.0.state;
            row(ui, "time", format!("{} s", column(self.0.secs(), 3, 8)));
            for i in 0..2 {
                row(
                    ui,
                    &format!("θ{}", i + 1),
                    format!("{} rad", column(wrapped(state.angle[i]), 4, 8)),
                );
                row(ui, &format!("ω{}", i + 1), format!("{} rad/s", column(state.speed[i], 4, 8)));
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
