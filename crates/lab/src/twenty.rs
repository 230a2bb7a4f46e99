//! Figure 6: pendulums a hair apart, drawn together until they fan out.

use std::ops::RangeInclusive;

use egui::{Color32, Grid, Pos2, Stroke, Ui, Vec2};

use super::arrangement::Arrangement;
use super::chart::{AxisScale, Chart, ChartAxis, Curve};
use super::clock::Clock;
use super::controls::{ANGLES, SPEEDS, number_on, row, thrown};
use super::double_simulation::pendulum;
use super::drawing::{FigureCanvas, StageReach, Tint, ends};
use super::energy::Energy;
use super::ruler::StageRuler;
use super::set_up::SetUpWord;
use super::{FigureRequest, LiveFigure};
use flipmap_numbers::Dd;
use flipmap_numbers::number_text::{brief, fixed, significant};
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::State;
use flipmap_pendulum::integrator::rk4;
use flipmap_pendulum::separation::{Growth, Reading, Ruler, SATURATED_RAD};

/// Range of the nudge in rad.
const NUDGES: RangeInclusive<f64> = 1e-13..=1e-2;
/// Range of the tolerance of a forecast in rad.
const TOLERANCES: RangeInclusive<f64> = 1e-3..=1.0;
/// Range of the uncertainty of a forecast's start in rad.
const PRECISIONS: RangeInclusive<f64> = 1e-16..=1e-3;

/// Pendulums released from almost the same start.
#[derive(Clone, Debug)]
pub(crate) struct Twenty {
    start: State<f64>,
    count: usize,
    nudge_rad: f64,
    clock: Clock,
    states: Vec<State<f64>>,
    readings: Vec<Reading>,
    /// Largest tolerated error of a forecast, in rad.
    tolerance_rad: f64,
    /// Uncertainty of a forecast's start, in rad.
    precision_rad: f64,
}

/// Number of steps per second.
const STEPS_A_SEC: f64 = 480.0;
/// Largest number of pendulums.
const MAX_PENDULUMS: f64 = 500.0;
/// Number of steps between two readings.
const READ_EVERY: u64 = 12;
/// Longest simulated time in seconds; nothing new happens after that.
const MAX_SECS: f64 = 60.0;

impl Default for Twenty {
    fn default() -> Self {
        Twenty::new(State::rest([2.2, 2.5]), 20, 1e-7)
    }
}

impl Twenty {
    /// Creates `count` pendulums, each released `nudge_rad` further in θ1 than the one before.
    pub(crate) fn new(start: State<f64>, count: usize, nudge_rad: f64) -> Self {
        let [theta1, theta2] = start.angle;
        let at = |k: usize| State { angle: [theta1 + k as f64 * nudge_rad, theta2], ..start };
        Twenty {
            start,
            count,
            nudge_rad,
            clock: Clock::new(1.0 / STEPS_A_SEC),
            states: (0..count).map(at).collect(),
            readings: Vec::new(),
            tolerance_rad: 0.1,
            precision_rad: 1e-7,
        }
    }

    fn begin(&mut self, start: State<f64>, count: usize, nudge_rad: f64) {
        let Twenty { tolerance_rad, precision_rad, .. } = *self;
        *self = Twenty { tolerance_rad, precision_rad, ..Twenty::new(start, count, nudge_rad) };
    }

    fn step(&mut self) {
        let pendulum = pendulum();
        for state in &mut self.states {
            *state = state.plus(&rk4(&pendulum, state, self.clock.step_secs, Turning::Fresh));
        }
    }

    fn read(&mut self, secs: f64) {
        let pendulum = pendulum();
        let long = |state: &State<f64>| State {
            angle: state.angle.map(Dd::new),
            speed: state.speed.map(Dd::new),
        };
        let [first, last] = [&self.states[0], &self.states[self.count - 1]].map(long);
        let separation_rad = Ruler::new(&pendulum).distance(&first, &last);
        self.readings.push(Reading { secs, energy_error: 0.0, separation_rad });
    }

    /// Returns the fitted growth of the separation so far, or `None` if it cannot be fitted yet.
    pub(crate) fn growth(&self) -> Option<Growth> {
        Growth::fit(&self.readings)
    }

    /// Returns how long a forecast holds if its start is known to `precision_rad`, in seconds.
    fn horizon_secs(&self, rate_per_sec: f64) -> f64 {
        (self.tolerance_rad / self.precision_rad).ln() / rate_per_sec
    }

    /// Draws all pendulums.
    fn draw_fan(&self, ui: &mut Ui, size: Vec2) {
        let stage = FigureCanvas::seen(ui, size, StageReach::of_rods(2.0), self.told());
        let bobs = |state: &State<f64>| ends([1.0, 1.0], state.angle).map(|bob| stage.at(bob));
        let places: Vec<[Pos2; 2]> = self.states.iter().map(bobs).collect();
        let drawn = distinct(&places);
        for &k in &drawn {
            draw_glowing(&stage, places[k], shade(k, self.count, &stage.tint), drawn.len());
        }
        stage.pivot();
        let words = "All of them are drawn: at first they look like one.";
        stage.note(None, words);
        StageRuler::lay_on(ui, &stage);
    }

    fn chart(&self, tint: &Tint) -> Chart {
        let points = self.readings.iter().map(|r| [r.secs, r.separation_rad]).collect();
        let end = self.clock.secs().max(10.0);
        let mut curves = vec![Curve::line("first from last", tint.parts[1], points)];
        if let Some(growth) = self.growth() {
            let line = [0.0, growth.until_secs].map(|t| [t, growth.separation_rad(t)]).to_vec();
            curves.push(Curve::guide("fitted climb", tint.ink, line));
        }
        let saturated = vec![[0.0, SATURATED_RAD], [end, SATURATED_RAD]];
        curves.push(Curve::guide("saturated", tint.faint, saturated));
        Chart {
            across: ChartAxis::new("time, s", 0.0..=end, AxisScale::Linear),
            up: ChartAxis::new("separation, rad", 1e-13..=1e2, AxisScale::Log),
            curves,
            marks: Vec::new(),
        }
    }
}

/// Returns the colour of pendulum `k` of `count`, from orange to blue.
fn shade(k: usize, count: usize, tint: &Tint) -> Color32 {
    let share = k as f32 / (count - 1).max(1) as f32;
    tint.parts[0].lerp_to_gamma(tint.parts[1], share)
}

/// Distance in points below which two pendulums look like one.
const SAME_POINTS: f32 = 0.5;

/// Returns the indices of pendulums of which each looks different from the one before, so that
/// pendulums that coincide are drawn as one.
fn distinct(places: &[[Pos2; 2]]) -> Vec<usize> {
    let mut drawn: Vec<usize> = Vec::new();
    for (k, place) in places.iter().enumerate() {
        let apart = |other: usize| {
            let other = places[other];
            (0..2).any(|bob| place[bob].distance(other[bob]) > SAME_POINTS)
        };
        if drawn.last().is_none_or(|last| apart(*last)) {
            drawn.push(k);
        }
    }
    drawn
}

/// Draws one of `count` pendulums that look different, as a line in a faint glow.
fn draw_glowing(stage: &FigureCanvas, [first, second]: [Pos2; 2], colour: Color32, count: usize) {
    let pivot = stage.at([0.0; 2]);
    // Dimming keeps the lines of a dense fan apart.
    let dimming = (20.0 / count as f32).sqrt().min(1.0);
    for (width, light) in [(6.0, 0.12), (2.0, 0.9)] {
        let colour = colour.gamma_multiply(light * dimming);
        let stroke = Stroke::new(width, colour);
        stage.painter.line_segment([pivot, first], stroke);
        stage.painter.line_segment([first, second], stroke);
        stage.painter.circle_filled(second, 2.0 + 0.5 * width, colour);
    }
}

/// Describes a growth by the time in which the separation is multiplied by e.
fn growth_words(growth: &Growth) -> String {
    let secs = 1.0 / growth.rate_per_sec;
    let uncertainty = growth.uncertainty_per_sec * secs * secs;
    format!("× e every {} ± {} s", fixed(secs, 2), fixed(uncertainty, 2))
}

impl LiveFigure for Twenty {
    fn copied(&self) -> Box<dyn LiveFigure> {
        Box::new(self.clone())
    }

    fn open(&mut self, start: State<f64>) {
        self.begin(start, self.count, self.nudge_rad);
    }

    fn restart(&mut self) {
        self.begin(self.start, self.count, self.nudge_rad);
    }

    fn secs(&self) -> f64 {
        self.clock.secs() + self.clock.share() * self.clock.step_secs
    }

    fn advance(&mut self, elapsed_secs: f64) {
        if self.clock.secs() > MAX_SECS {
            return;
        }
        let from = self.clock.taken;
        for k in 0..self.clock.due(elapsed_secs) as u64 {
            if (from + k).is_multiple_of(READ_EVERY) {
                self.read((from + k) as f64 * self.clock.step_secs);
            }
            self.step();
        }
    }

    fn told(&self) -> String {
        let apart = self.readings.last().map_or(0.0, |reading| reading.separation_rad);
        let secs = fixed(self.secs(), 2);
        format!("{} pendulums after {secs} s, {} rad apart", self.count, brief(apart))
    }

    fn draw(&mut self, ui: &mut Ui, size: Vec2) {
        let chart = self.chart(&Tint::of(ui));
        let told = "Separation of the first and the last pendulum against time";
        Arrangement::of(size, 1).show(
            ui,
            |ui, size| self.draw_fan(ui, size),
            |ui, size| {
                chart.show(ui, size, told);
            },
        );
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        let (mut count, mut nudge, mut start) = (self.count as f64, self.nudge_rad, self.start);
        let mut changed = false;
        Grid::new("twenty").num_columns(2).show(ui, |ui| {
            changed |= number_on(ui, "Pendulums", "", &mut count, 2.0..=MAX_PENDULUMS, true);
            changed |= number_on(ui, "Nudge", " rad", &mut nudge, NUDGES, true);
            changed |= number_on(ui, "θ1", " rad", &mut start.angle[0], -3.1..=3.1, false);
            changed |= number_on(ui, "θ2", " rad", &mut start.angle[1], -3.1..=3.1, false);
            number_on(ui, "Tolerance", " rad", &mut self.tolerance_rad, TOLERANCES, true);
            number_on(ui, "Precision", " rad", &mut self.precision_rad, PRECISIONS, true);
        });
        if changed || ui.button("Restart").clicked() {
            self.begin(start, count.round() as usize, nudge);
        }
        ui.separator();
        Energy::of_default(&self.states[0]).bar(ui, "energy");
        Grid::new("twenty now").num_columns(2).show(ui, |ui| {
            thrown(ui, &self.start);
            row(ui, "time", format!("{} s", fixed(self.clock.secs(), 2)));
            if let Some(Reading { separation_rad: apart, .. }) = self.readings.last() {
                let full = if *apart > SATURATED_RAD { ", saturated" } else { "" };
                row(ui, "first from last", format!("{} rad{full}", significant(*apart, 3)));
            }
            match self.growth().filter(|growth| growth.rate_per_sec > 0.0) {
                Some(growth) => {
                    let more = 1000f64.ln() / growth.rate_per_sec;
                    let horizon = self.horizon_secs(growth.rate_per_sec);
                    row(ui, "growth, 1/λ", growth_words(&growth));
                    row(ui, "horizon", format!("{} s", fixed(horizon, 1)));
                    row(ui, "for 1000 × precision", format!("+{} s", fixed(more, 1)));
                }
                None => row(ui, "growth, 1/λ", "not known yet"),
            }
        });
        ui.button("Show this start on the map")
            .clicked()
            .then_some(FigureRequest::ToMap(self.start))
    }

    fn set_up(&self) -> Vec<SetUpWord> {
        let State { angle, speed } = self.start;
        vec![
            SetUpWord::numbers("start", angle, ANGLES),
            SetUpWord::numbers("count", [self.count as f64], 2.0..=MAX_PENDULUMS),
            SetUpWord::numbers("nudge", [self.nudge_rad], NUDGES),
            SetUpWord::numbers("speeds", speed, SPEEDS),
            SetUpWord::numbers("tolerance", [self.tolerance_rad], TOLERANCES),
            SetUpWord::numbers("precision", [self.precision_rad], PRECISIONS),
        ]
    }

    fn take_set_up(&mut self, numbers: &[f64]) {
        let &[t1, t2, count, nudge, w1, w2, tolerance, precision] = numbers else { return };
        (self.tolerance_rad, self.precision_rad) = (tolerance, precision);
        let start = State { angle: [t1, t2], speed: [w1, w2] };
        self.begin(start, count.round() as usize, nudge);
    }

    fn csv(&self, secs: f64) -> String {
        let mut live = Twenty::new(self.start, self.count, self.nudge_rad);
        while live.clock.secs() < secs.min(MAX_SECS) {
            live.advance(0.1);
        }
        let mut text = "t,separation\n".to_string();
        for reading in &live.readings {
            text.push_str(&format!("{},{}\n", reading.secs, reading.separation_rad));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::taylor::Orbit;
    use flipmap_scene::PendulumSpec;

    #[test]
    fn the_climb_is_that_of_the_tangent_map() {
        let mut live = Twenty::new(State::rest([2.2, 2.5]), 2, 1e-10);
        (0..150).for_each(|_| live.advance(0.1));
        let fitted = live.growth().unwrap();
        // The reference is the growth of a nudge that stays infinitesimal, integrated in
        // double-double by another method, and read and fitted in the same way.
        let nudge = 1e-22;
        let orbit =
            |angle| Orbit::new(PendulumSpec::default().pendulum_in::<Dd>(), State::rest(angle));
        let start = [2.2, 2.5].map(Dd::new);
        let mut own = orbit(start);
        let mut nudged = orbit([start[0] + Dd::new(nudge), start[1]]);
        let ruler = Ruler::new(&pendulum());
        let readings: Vec<Reading> = live
            .readings
            .iter()
            .take_while(|reading| reading.secs <= fitted.until_secs)
            .map(|reading| {
                let [a, b] = [&mut own, &mut nudged].map(|o| o.state_at(Dd::new(reading.secs)));
                Reading { separation_rad: ruler.distance(&a, &b) * 1e-10 / nudge, ..*reading }
            })
            .collect();
        let known = Growth::fit(&readings).unwrap();
        let off = (known.rate_per_sec - fitted.rate_per_sec).abs();
        assert!(off <= fitted.uncertainty_per_sec, "{fitted:?} for {known:?}");
        assert!(
            fitted.rate_per_sec > 0.5 && fitted.uncertainty_per_sec < 0.5 * fitted.rate_per_sec
        );
    }

    #[test]
    fn pendulums_that_coincide_are_drawn_as_one() {
        let places = |live: &Twenty| -> Vec<[Pos2; 2]> {
            let point = |[x, y]: [f64; 2]| Pos2::new(100.0 * x as f32, -100.0 * y as f32);
            live.states.iter().map(|state| ends([1.0, 1.0], state.angle).map(point)).collect()
        };
        let mut live = Twenty::default();
        assert_eq!(distinct(&places(&live)), [0], "they look like one");
        (0..200).for_each(|_| live.advance(0.1));
        assert_eq!(distinct(&places(&live)).len(), 20, "each is drawn in the fan");
    }

    #[test]
    fn growth_is_told_as_a_time() {
        let growth = Growth { rate_per_sec: 0.5, uncertainty_per_sec: 0.05, ..fitted() };
        assert_eq!(growth_words(&growth), "× e every 2.00 ± 0.20 s");
    }

    fn fitted() -> Growth {
        let mut live = Twenty::default();
        (0..100).for_each(|_| live.advance(0.1));
        live.growth().unwrap()
    }

    #[test]
    fn a_thousand_times_finer_buys_the_logarithm() {
        let mut live = Twenty::default();
        let before = live.horizon_secs(2.0);
        live.precision_rad /= 1000.0;
        assert!((live.horizon_secs(2.0) - before - 1000f64.ln() / 2.0).abs() < 1e-12);
    }
}
