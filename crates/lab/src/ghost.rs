//! Figure 2: a real pendulum against the ghost of the small-angle formula.

use egui::{Grid, Ui, Vec2};

use super::arrangement::Arrangement;
use super::chart::{AxisScale, Chart, ChartAxis, Curve};
use super::controls::{coloured_row, row};
use super::drawing::{FigureCanvas, StageReach, Tint, end};
use super::formula::{Fence, Formula};
use super::ruler::StageRuler;
use super::set_up::SetUpWord;
use super::single_simulation::SinglePendulumSimulation;
use super::{FigureRequest, LiveFigure};
use flipmap_numbers::number_text::{column, fixed};
use flipmap_pendulum::State;
use flipmap_pendulum::simple::MAX_AMPLITUDE;

/// The live figure of a pendulum and its small-angle ghost.
#[derive(Clone, Debug)]
pub(super) struct Ghost(SinglePendulumSimulation);

impl Default for Ghost {
    fn default() -> Self {
        Ghost(SinglePendulumSimulation::from(2.0))
    }
}

impl Ghost {
    /// Returns a chart of the period against the amplitude, in units of the small-angle period.
    fn chart(&self, tint: &Tint) -> Chart {
        let simple = self.0.simple;
        let ratio = |amplitude: f64| simple.period_secs(amplitude) / simple.small_period_secs();
        let at = |k: u32| f64::from(k) / 200.0 * MAX_AMPLITUDE;
        let known = (0..=200).map(|k| [at(k), ratio(at(k))]).collect();
        let (amplitude, longest) = (self.0.amplitude.abs(), ratio(MAX_AMPLITUDE));
        Chart {
            across: ChartAxis::new("amplitude, rad", 0.0..=3.2, AxisScale::Angle),
            up: ChartAxis::new("period / 2π√(r/g)", 0.8..=1.05 * longest, AxisScale::Linear),
            curves: vec![
                Curve::line("exact", tint.parts[1], known),
                Curve::guide("small angles", tint.faint, vec![[0.0, 1.0], [3.2, 1.0]]),
            ],
            marks: vec![[amplitude, ratio(amplitude)]],
        }
    }
}

impl Ghost {
    /// Draws the pendulum and its ghost.
    fn draw_both(&mut self, ui: &mut Ui, size: Vec2) {
        let length = self.0.simple.length;
        let (stage, response) =
            FigureCanvas::new(ui, size, StageReach::of_rods(length), self.told());
        let (faint, two) = (stage.tint.faint, stage.tint.parts[1]);
        stage.note(Some(period(&stage.tint)), "grey: as if sin θ were θ. Drag the bob past 90°.");
        let shadow = end([0.0; 2], length, self.ghost_angle());
        stage.dashed([0.0; 2], shadow, faint);
        stage.bob(shadow, 0.5 * self.0.mass, faint);
        stage.rod([0.0; 2], self.0.bob(), stage.tint.ink);
        stage.pivot();
        stage.bob(self.0.bob(), self.0.mass, two);
        self.0.drag(&stage, &response, false);
        StageRuler::lay_on(ui, &stage);
    }

    /// Returns the ghost's current angle in rad.
    fn ghost_angle(&self) -> f64 {
        if self.0.held {
            return self.0.amplitude;
        }
        self.0.simple.ghost(self.0.amplitude, self.0.secs())
    }
}

/// Returns the exact period by the arithmetic-geometric mean, with the ghost's in grey.
fn period(tint: &Tint) -> Formula {
    let ink = |text: &str| Formula::text(text, tint.ink);
    let ratio =
        Formula::variable("r", None, tint.ink).over(Formula::variable("g", None, tint.parts[2]));
    let amplitude = Formula::variable("θ", Some("0"), tint.parts[0]);
    let half = amplitude.over(ink("2"));
    let mean = Formula::Row(vec![
        ink("agm "),
        Formula::Row(vec![ink("1, cos "), half]).fenced(Fence::Round),
    ]);
    Formula::Row(vec![
        Formula::variable("T", None, tint.parts[1]),
        ink(" = "),
        Formula::text("2π", tint.faint),
        Formula::Root(Box::new(ratio)),
        ink(" / "),
        mean,
    ])
}

impl LiveFigure for Ghost {
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
        let (secs, ghost) = (self.0.secs(), self.ghost_angle());
        let [secs, ghost] = [fixed(secs, 2), fixed(ghost, 3)];
        format!("After {secs} s: θ is {} rad, the ghost's {ghost}", fixed(self.0.angle(), 3))
    }

    fn draw(&mut self, ui: &mut Ui, size: Vec2) {
        let chart = self.chart(&Tint::of(ui));
        let told = "Period against amplitude, with the current one marked";
        Arrangement::of(size, 1).show(
            ui,
            |ui, size| self.draw_both(ui, size),
            |ui, size| {
                chart.show(ui, size, told);
            },
        );
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        self.0.controls(ui);
        ui.separator();
        self.0.energy(self.0.now()).bar(ui, "energy");
        let (simple, tint) = (self.0.simple, Tint::of(ui));
        Grid::new("ghost now").num_columns(2).show(ui, |ui| {
            row(ui, "time", format!("{} s", column(self.0.secs(), 2, 4)));
            let measured = self.0.crossings.period_secs();
            let measured =
                measured.map_or("after two swings".to_string(), |t| format!("{} s", fixed(t, 9)));
            coloured_row(ui, "measured period", tint.parts[0], measured);
            let exact = simple.period_secs(self.0.amplitude);
            coloured_row(ui, "exact, by the AGM", tint.parts[1], format!("{} s", fixed(exact, 9)));
            row(ui, "2π√(r/g)", format!("{} s", fixed(simple.small_period_secs(), 9)));
        });
        None
    }

    fn set_up(&self) -> Vec<SetUpWord> {
        self.0.set_up()
    }

    fn take_set_up(&mut self, numbers: &[f64]) {
        self.0.take_set_up(numbers);
    }

    fn csv(&self, _: f64) -> String {
        let mut text = "amplitude,period,small_angle_period\n".to_string();
        for k in 1..=313 {
            let (amplitude, simple) = (f64::from(k) / 100.0, self.0.simple);
            let (exact, small) = (simple.period_secs(amplitude), simple.small_period_secs());
            text.push_str(&format!("{amplitude},{exact},{small}\n"));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chart_has_room_for_every_period_that_it_shows() {
        for amplitude in [0.1, MAX_AMPLITUDE] {
            let chart = Ghost(SinglePendulumSimulation::from(amplitude)).chart(&Tint::DARK);
            let points = chart.curves.iter().flat_map(|curve| &curve.points).chain(&chart.marks);
            for [across, up] in points {
                assert!(chart.across.range.contains(across) && chart.up.range.contains(up));
            }
        }
    }
}
