//! Figure 1: the single pendulum with its parts labelled.

use egui::{Grid, Ui};

use super::controls::row;
use super::drawing::{COLOURS, FAINT, FigureCanvas, INK, end};
use super::single_simulation::SinglePendulumSimulation;
use super::{FigureRequest, LiveFigure};
use crate::physics::State;

/// A live figure of one coordinate, one mass, one rod, and gravity.
#[derive(Clone, Debug)]
pub(super) struct Single(SinglePendulumSimulation);

impl Default for Single {
    fn default() -> Self {
        Single(SinglePendulumSimulation::from(0.9))
    }
}

impl LiveFigure for Single {
    fn open(&mut self, start: State<f64>) {
        self.0.release(start.angle[0]);
    }

    fn advance(&mut self, elapsed_secs: f64) {
        self.0.advance(elapsed_secs);
    }

    fn draw(&mut self, ui: &mut Ui, size: egui::Vec2) {
        let angle = self.0.angle();
        let told = format!("A pendulum at θ = {angle:.3} rad");
        let (stage, response) = FigureCanvas::new(ui, size, 1.15 * self.0.simple.length, told);
        let (bob, length) = (self.0.bob(), self.0.simple.length);
        let most = end([0.0; 2], 0.72 * length, angle);
        stage.dashed([0.0; 2], [0.0, -0.6 * length], FAINT);
        stage.arc([0.0; 2], angle, 0.35 * length, COLOURS[0]);
        stage.rod([0.0; 2], bob, INK);
        stage.pivot();
        stage.bob(bob, self.0.mass, COLOURS[1]);
        stage.arrow(bob, [0.0, -0.35 * length], COLOURS[2]);
        stage.label([0.0, 0.0], "pivot", FAINT);
        stage.label([-0.02 * length, -0.44 * length], "θ, the one coordinate", COLOURS[0]);
        stage.label(most, &format!("rod r = {length:.2} m"), INK);
        stage.label(bob, &format!("mass m = {:.2} kg", self.0.mass), COLOURS[1]);
        let weight = self.0.mass * self.0.simple.gravity;
        let tip = [bob[0], bob[1] - 0.35 * length];
        stage.label(tip, &format!("gravity m g = {weight:.2} N"), COLOURS[2]);
        stage.note("α = −(g/r) sin θ: the mass falls out. Drag the bob.");
        self.0.drag(&stage, &response);
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        self.0.controls(ui);
        ui.separator();
        Grid::new("single now").num_columns(2).show(ui, |ui| {
            row(ui, "time", format!("{:8.3} s", self.0.secs()));
            row(ui, "θ", format!("{:8.4} rad", self.0.swing.angle));
            row(ui, "speed ω", format!("{:8.4} rad/s", self.0.swing.speed));
            let acceleration = self.0.simple.acceleration(self.0.swing.angle);
            row(ui, "acceleration α", format!("{acceleration:8.4} rad/s²"));
        });
        None
    }

    fn set(&self) -> Vec<f64> {
        vec![self.0.amplitude, self.0.simple.length, self.0.mass, self.0.simple.gravity]
    }

    fn csv(&self, secs: f64) -> String {
        let simple = self.0.simple;
        let mut live =
            SinglePendulumSimulation { simple, ..SinglePendulumSimulation::from(self.0.amplitude) };
        let mut text = "t,angle,speed,acceleration\n".to_string();
        for k in 0..=(secs * 100.0) as u32 {
            let swing = live.now();
            let pull = simple.acceleration(swing.angle);
            let line = format!("{},{},{},{pull}\n", f64::from(k) / 100.0, swing.angle, swing.speed);
            text.push_str(&line);
            live.advance(0.01);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_states_at_their_moments() {
        let text = Single(SinglePendulumSimulation::from(2.5)).csv(0.1);
        // The reference is the same motion in steps of 1e-4 s.
        let simple = SinglePendulumSimulation::from(2.5).simple;
        let mut swing = SinglePendulumSimulation::from(2.5).swing;
        for (k, line) in text.lines().skip(1).enumerate() {
            let row: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
            assert!((row[0] - 0.01 * k as f64).abs() < 1e-12);
            let [angle, speed] = [row[1] - swing.angle, row[2] - swing.speed].map(f64::abs);
            assert!(angle < 1e-9 && speed < 1e-8, "{line}: {angle:e} {speed:e}");
            (0..100).for_each(|_| swing = simple.step(swing, 1e-4));
        }
    }
}
