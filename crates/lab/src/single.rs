//! Figure 1: the single pendulum with its parts labelled.

use egui::{Grid, Ui, Vec2};

use super::arrangement::Arrangement;
use super::chart::{AxisScale, Chart, ChartAxis, Curve};
use super::controls::row;
use super::drawing::{FigureCanvas, StageReach, Tint, end};
use super::energy::Energy;
use super::formula::Formula;
use super::ruler::StageRuler;
use super::set_up::SetUpWord;
use super::single_simulation::SinglePendulumSimulation;
use super::zero_height::{ZERO_LABEL, ZeroHeight};
use super::{FigureRequest, LiveFigure};
use flipmap_numbers::number_text::{column, fixed};
use flipmap_pendulum::State;
use flipmap_pendulum::simple::Swing;

/// The live figure of a pendulum with one angle, one mass, one rod, and gravity.
#[derive(Clone, Debug)]
pub(super) struct Single(SinglePendulumSimulation);

impl Default for Single {
    fn default() -> Self {
        Single(SinglePendulumSimulation::from(0.9))
    }
}

/// Length of the arrow of gravity, as a fraction of the rod's.
const WEIGHT: f64 = 0.2;
/// Seconds that the energy chart covers.
const CHART_SECS: f64 = 10.0;

impl Single {
    /// Returns a chart of both kinds of energy and their sum against time.
    fn energy_chart(&self, tint: &Tint) -> Chart {
        let now = self.0.secs();
        let from = (now - CHART_SECS).max(0.0);
        let states = || self.0.path.iter().copied().chain([(now, self.0.now())]);
        let curve = |part: fn(Energy) -> f64| -> Vec<[f64; 2]> {
            let recent = states().filter(|(secs, _)| *secs >= from);
            recent.map(|(secs, swing)| [secs, part(self.0.energy(swing))]).collect()
        };
        let highest = self.0.energy(Swing { angle: self.0.amplitude, speed: 0.0 });
        let most = (highest.potential - highest.least).max(1e-3);
        let energies = highest.least..=1.1 * most;
        Chart {
            across: ChartAxis::new("time, s", from..=from + CHART_SECS, AxisScale::Linear),
            up: ChartAxis::new("energy, J", energies, AxisScale::Linear),
            curves: vec![
                Curve::line("kinetic", tint.parts[1], curve(|energy| energy.kinetic)),
                Curve::line("potential", tint.parts[2], curve(|energy| energy.potential)),
                Curve::guide("sum", tint.ink, curve(Energy::sum)),
            ],
            marks: Vec::new(),
        }
    }

    /// Returns a chart of the speed against the angle, with the curve that separates swinging from
    /// rotating.
    fn phase_chart(&self, tint: &Tint) -> Chart {
        let simple = self.0.simple;
        let fastest = 2.0 * (simple.gravity / simple.length).sqrt();
        let border = |sign: f64| -> Vec<[f64; 2]> {
            let angles = (-100..=100).map(|k| f64::from(k) / 100.0 * std::f64::consts::PI);
            angles.map(|angle| [angle, sign * fastest * (0.5 * angle).cos()]).collect()
        };
        let now = self.0.now();
        let path = self.0.path.iter().map(|(_, swing)| [swing.angle, swing.speed]);
        let speeds = -1.1 * fastest..=1.1 * fastest;
        Chart {
            across: ChartAxis::new("angle θ, rad", -3.2..=3.2, AxisScale::Angle),
            up: ChartAxis::new("speed ω, rad/s", speeds, AxisScale::Linear),
            curves: vec![
                Curve::guide("just to the top", tint.faint, border(1.0)),
                Curve::guide("", tint.faint, border(-1.0)),
                Curve::line("", tint.parts[0], path.collect()),
            ],
            marks: vec![[now.angle, now.speed]],
        }
    }

    /// Draws the pendulum with its parts named.
    fn draw_parts(&mut self, ui: &mut Ui, size: Vec2) {
        let (bob, length, angle) = (self.0.bob(), self.0.simple.length, self.0.angle());
        let reach = StageReach { rods_m: length, below_m: WEIGHT * length };
        let (stage, response) = FigureCanvas::new(ui, size, reach, self.told());
        let (ink, faint, [one, two, three, _]) =
            (stage.tint.ink, stage.tint.faint, stage.tint.parts);
        stage.note(Some(equation(&stage.tint)), "Drag the bob, or throw it.");
        let zero = self.0.zero.lay_on(ui, &stage, -length);
        let tip = [bob[0], bob[1] - WEIGHT * length];
        stage.dashed([0.0; 2], [0.0, -0.6 * length], faint);
        stage.arc([0.0; 2], angle, 0.35 * length, one);
        stage.rod([0.0; 2], bob, ink);
        stage.pivot();
        stage.arrow(bob, [0.0, -WEIGHT * length], three);
        stage.bob(bob, self.0.mass, two);
        stage.label(bob, &format!("mass m = {} kg", fixed(self.0.mass, 2)), two);
        let weight = self.0.mass * self.0.simple.gravity;
        stage.label(tip, &format!("gravity m g = {} N", fixed(weight, 2)), three);
        stage.label(end([0.0; 2], 0.37 * length, 0.5 * angle), "θ", one);
        let along = end([0.0; 2], 0.72 * length, angle);
        stage.label(along, &format!("rod r = {} m", fixed(length, 2)), ink);
        stage.label([0.0; 2], "pivot", faint);
        zero.into_iter().for_each(|at| stage.label(at, ZERO_LABEL, faint));
        self.0.drag(&stage, &response, true);
        StageRuler::lay_on(ui, &stage);
    }
}

/// Returns the equation of motion, each symbol in the colour of its part.
fn equation(tint: &Tint) -> Formula {
    let [one, _, three, _] = tint.parts;
    let ink = |text: &str| Formula::text(text, tint.ink);
    let ratio = Formula::variable("g", None, three).over(Formula::variable("r", None, tint.ink));
    Formula::Row(vec![
        Formula::variable("α", None, one),
        ink(" = −"),
        ratio,
        ink(" sin "),
        Formula::variable("θ", None, one),
    ])
}

impl LiveFigure for Single {
    fn copied(&self) -> Box<dyn LiveFigure> {
        Box::new(self.clone())
    }

    fn open(&mut self, start: State<f64>) {
        self.0.release(start.angle[0]);
    }

    fn restart(&mut self) {
        self.0.release(self.0.amplitude);
    }

    fn secs(&self) -> f64 {
        self.0.secs()
    }

    fn advance(&mut self, elapsed_secs: f64) {
        self.0.advance(elapsed_secs);
    }

    fn told(&self) -> String {
        format!("A pendulum at θ = {} rad", fixed(self.0.angle(), 3))
    }

    fn draw(&mut self, ui: &mut Ui, size: Vec2) {
        let tint = Tint::of(ui);
        let [energy, phase] = [self.energy_chart(&tint), self.phase_chart(&tint)];
        Arrangement::of(size, 2).show(
            ui,
            |ui, size| self.draw_parts(ui, size),
            |ui, size| {
                energy.show(ui, size, "Kinetic and potential energy and their sum against time");
                let told = "Phase plot: speed against angle, with the current state marked";
                phase.show(ui, size, told);
            },
        );
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        self.0.controls(ui);
        ui.separator();
        self.0.zero.control(ui, self.0.simple.length);
        self.0.energy(self.0.now()).bar(ui, "energy");
        Grid::new("single now").num_columns(2).show(ui, |ui| {
            row(ui, "time", format!("{} s", column(self.0.secs(), 3, 8)));
            row(ui, "θ", format!("{} rad", column(self.0.swing.angle, 4, 8)));
            row(ui, "speed ω", format!("{} rad/s", column(self.0.swing.speed, 4, 8)));
            let acceleration = self.0.simple.acceleration(self.0.swing.angle);
            row(ui, "acceleration α", format!("{} rad/s²", column(acceleration, 4, 8)));
        });
        None
    }

    fn set_up(&self) -> Vec<SetUpWord> {
        let mut words = self.0.set_up();
        words.push(self.0.zero.word());
        words
    }

    fn take_set_up(&mut self, numbers: &[f64]) {
        let [others @ .., above_m] = numbers else { return };
        self.0.zero = ZeroHeight { above_m: *above_m };
        self.0.take_set_up(others);
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
    fn the_charts_show_energy_that_is_kept_and_a_path_within_its_border() {
        let mut live = Single(SinglePendulumSimulation::from(2.5));
        (0..150).for_each(|_| live.advance(0.1));
        let chart = live.energy_chart(&Tint::DARK);
        let [kinetic, potential, sum] = [0, 1, 2].map(|k| &chart.curves[k].points);
        assert!(sum.len() > 500 && sum[0][0] >= live.secs() - CHART_SECS);
        let whole = live.0.energy(Swing { angle: 2.5, speed: 0.0 }).potential;
        for ((kinetic, potential), sum) in kinetic.iter().zip(potential).zip(sum) {
            assert!((sum[1] / whole - 1.0).abs() < 1e-6, "{sum:?} of {whole}");
            assert!(kinetic[1] >= 0.0 && potential[1] <= whole * (1.0 + 1e-6));
        }
        assert!(kinetic.iter().any(|point| point[1] > 0.9 * whole));
        let chart = live.phase_chart(&Tint::DARK);
        for [angle, speed] in &chart.curves[2].points {
            let border = 2.0 * 9.81f64.sqrt() * (0.5 * angle).cos();
            assert!(speed.abs() < border, "the pendulum swings, and never reaches the top");
        }
        assert_eq!(chart.marks, [[live.0.now().angle, live.0.now().speed]]);
    }

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
