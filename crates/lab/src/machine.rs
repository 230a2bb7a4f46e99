//! Figure 4: the double pendulum as a machine, with its matrix equation live.

use egui::{Grid, Ui, vec2};

use super::controls::{build, row};
use super::double_simulation::DoublePendulumSimulation;
use super::drawing::{FigureCanvas, LETTER, StageReach, Tint};
use super::equation;
use super::ruler::StageRuler;
use super::set_up::SetUpWord;
use super::{FigureRequest, LiveFigure};
use flipmap_numbers::number_text::{fixed, signed};
use flipmap_pendulum::State;

/// A live figure of the double pendulum with its equation and energy.
#[derive(Clone, Debug)]
pub(super) struct MachineFigure(DoublePendulumSimulation);

impl Default for MachineFigure {
    fn default() -> Self {
        MachineFigure(DoublePendulumSimulation::from([2.0, 2.6]))
    }
}

impl LiveFigure for MachineFigure {
    fn copied(&self) -> Box<dyn LiveFigure> {
        Box::new(self.clone())
    }

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
        let tint = Tint::of(ui);
        let formula = equation::formula(&self.0, &tint);
        let high = formula.fitted(ui.painter(), size.x, LETTER, tint.ink).height();
        let upper = vec2(size.x, size.y - high - 16.0);
        let reach = StageReach::of_rods(self.0.build.lengths_m().iter().sum::<f64>());
        let (stage, response) = FigureCanvas::new(ui, upper, reach, self.told());
        self.0.draw(&stage);
        let words = "with Δ = θ1 − θ2. Drag either bob to aim it again, or throw it.";
        stage.note(Some(equation::short(&tint)), words);
        self.0.drag(&stage, &response, None);
        StageRuler::lay_on(ui, &stage);
        ui.add_space(8.0);
        formula.show(ui, size.x, LETTER, &equation::told(&self.0));
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        if build(ui, &mut self.0.build) {
            self.0.release(self.0.start);
        }
        ui.separator();
        determinant(ui, &self.0);
        ui.separator();
        energy(ui, &self.0);
        if ui.button("Let go again").clicked() {
            self.0.release(self.0.start);
        }
        ui.button("Show this start on the map")
            .clicked()
            .then_some(FigureRequest::ToMap(self.0.start))
    }

    fn set_up(&self) -> Vec<SetUpWord> {
        self.0.set_up()
    }

    fn take_set_up(&mut self, numbers: &[f64]) {
        self.0.take_set_up(numbers);
    }

    fn csv(&self, secs: f64) -> String {
        motion(&self.0, secs)
    }
}

/// Shows the determinant of M and its lower bound.
fn determinant(ui: &mut Ui, simulation: &DoublePendulumSimulation) {
    let pendulum = simulation.pendulum();
    let [[a, c], [_, b]] = pendulum.equation(&simulation.state).mass;
    Grid::new("determinant").num_columns(2).show(ui, |ui| {
        let least = pendulum.least_det;
        row(ui, "det M", format!("{} kg² m⁴", fixed(a * b - c * c, 4)));
        row(ui, "never below", format!("{} kg² m⁴", fixed(least, 4)));
        row(ui, "time", format!("{} s", fixed(simulation.secs(), 3)));
    });
}

/// Shows the kinetic and potential energy, and how far their sum has moved.
fn energy(ui: &mut Ui, simulation: &DoublePendulumSimulation) {
    let pendulum = simulation.pendulum();
    simulation.energy(&simulation.state).bar(ui, "energy");
    let begun = simulation.energy(&simulation.start);
    let all = (begun.sum() - begun.least).max(1e-12);
    let error = (pendulum.energy(&simulation.state) - pendulum.energy(&simulation.start)) / all;
    ui.horizontal(|ui| {
        ui.label("relative energy error");
        ui.monospace(signed(error, 2));
    });
}

/// Returns the motion from the start as CSV, a hundred lines per second.
pub(super) fn motion(simulation: &DoublePendulumSimulation, secs: f64) -> String {
    let mut live = DoublePendulumSimulation { held: None, ..simulation.clone() };
    live.release(simulation.start);
    let pendulum = live.pendulum();
    let energy = pendulum.energy(&live.state);
    let mut text = "t,theta1,theta2,omega1,omega2,energy_error\n".to_string();
    for k in 0..=(secs * 100.0) as u32 {
        let state = live.now();
        let (angle, speed) = (state.angle, state.speed);
        let error = (pendulum.energy(&state) - energy) / (pendulum.p + pendulum.q);
        let t = f64::from(k) / 100.0;
        let line = format!("{t},{},{},{},{},{error}\n", angle[0], angle[1], speed[0], speed[1]);
        text.push_str(&line);
        live.advance(0.01);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::{Dd, Scalar};
    use flipmap_pendulum::taylor::Orbit;

    #[test]
    fn rows_are_states_at_their_moments() {
        let simulation = DoublePendulumSimulation::from([2.0, -1.0]);
        let start = State::rest(simulation.start.angle.map(Dd::new));
        let mut orbit = Orbit::new(simulation.pendulum().map(Dd::new), start);
        for line in motion(&simulation, 0.5).lines().skip(2) {
            let row: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
            let truth = orbit.state_at(Dd::new(row[0]));
            let off = (row[1] - truth.angle[0].to_f64()).abs();
            assert!(off < 1e-8, "{line}: {off:e}");
        }
    }
}
