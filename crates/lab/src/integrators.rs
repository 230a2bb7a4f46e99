//! Figure 5: three integrators from one start with one Δt, and the energy error of each.

use std::collections::VecDeque;

use egui::{Color32, Grid, Ui, Vec2};

use super::arrangement::Arrangement;
use super::chart::{AxisScale, Chart, ChartAxis, Curve};
use super::clock::Clock;
use super::controls::{ANGLES, SPEEDS, coloured_row, number_on, thrown};
use super::double_simulation::pendulum;
use super::drawing::{FigureCanvas, StageReach, Tint, ends, wrapped};
use super::energy::Energy;
use super::ruler::StageRuler;
use super::set_up::SetUpWord;
use super::sweep::Sweep;
use super::{FigureRequest, LiveFigure, slopes};
use flipmap_numbers::number_text::{fixed, signed};
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::integrator::{euler, rk4, semi_implicit_euler};
use flipmap_pendulum::{Pendulum, State};

/// One of the three integrators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Integrator {
    /// Explicit Euler, of order 1; gains energy.
    Euler,
    /// Semi-implicit Euler, of order 1; its energy error stays bounded for a long time.
    SemiImplicit,
    /// The classical Runge–Kutta method, of order 4.
    Rk4,
}

impl Integrator {
    /// All integrators, with their names.
    pub(crate) const ALL: [(Integrator, &'static str); 3] = [
        (Integrator::Euler, "explicit Euler"),
        (Integrator::SemiImplicit, "semi-implicit Euler"),
        (Integrator::Rk4, "RK4"),
    ];

    /// Returns the integrator's colour: red, teal or dark blue, and lighter on a dark canvas.
    pub(crate) fn colour(self, tint: &Tint) -> Color32 {
        let [dark, light] = match self {
            Integrator::Euler => [(0xff, 0x5c, 0x57), (0xc4, 0x1e, 0x22)],
            Integrator::SemiImplicit => [(0x2f, 0xc4, 0xb2), (0x00, 0x7f, 0x73)],
            Integrator::Rk4 => [(0x6c, 0x8c, 0xff), (0x1b, 0x2f, 0x8f)],
        };
        let (r, g, b) = if tint.dark { dark } else { light };
        Color32::from_rgb(r, g, b)
    }

    /// Returns the state after a step of `secs`.
    pub(crate) fn step(
        self,
        pendulum: &Pendulum<f64>,
        state: &State<f64>,
        secs: f64,
    ) -> State<f64> {
        state.plus(&match self {
            Integrator::Euler => euler(pendulum, state, secs),
            Integrator::SemiImplicit => semi_implicit_euler(pendulum, state, secs),
            Integrator::Rk4 => rk4(pendulum, state, secs, Turning::Fresh),
        })
    }

    /// Returns the state `secs` after a release at `start`, in equal steps of about `step_secs`.
    pub(crate) fn run(
        self,
        pendulum: &Pendulum<f64>,
        start: State<f64>,
        secs: f64,
        step_secs: f64,
    ) -> State<f64> {
        let steps = (secs / step_secs).round().max(1.0);
        let mut state = start;
        for _ in 0..steps as usize {
            state = self.step(pendulum, &state, secs / steps);
        }
        state
    }
}

/// Speed in rad/s beyond which a run has diverged: no pendulum is that fast.
const DIVERGED_SPEED: f64 = 1e6;

/// The run of one integrator.
#[derive(Clone, Debug)]
struct MethodRun {
    state: State<f64>,
    /// State one step earlier; the drawn state lies between the two.
    before: State<f64>,
    /// Pairs of a time in seconds and the relative energy error at that time.
    errors: Vec<[f64; 2]>,
    diverged_at: Option<f64>,
    /// Past positions of the second bob in metres, the latest last.
    trail: VecDeque<[f64; 2]>,
}

/// Simulated time in seconds that a trail covers.
const TRAIL_SECS: f64 = 1.5;

impl MethodRun {
    /// Returns the angles to draw, `share` of the way from the previous state to the last one.
    fn drawn(&self, share: f64) -> [f64; 2] {
        let (from, to) = (self.before.angle, self.state.angle);
        [0, 1].map(|i| from[i] + share * (to[i] - from[i]))
    }
}

/// The live figure of the three integrators.
#[derive(Clone, Debug)]
pub(crate) struct Integrators {
    start: State<f64>,
    step_secs: f64,
    clock: Clock,
    runs: [MethodRun; 3],
    sweep: Sweep,
    /// True if the slopes of RK4's next step are drawn.
    has_slopes: bool,
}

/// Simulated time in seconds after which the figure restarts.
const MAX_SECS: f64 = 120.0;

impl Default for Integrators {
    fn default() -> Self {
        Integrators::new(State::rest([1.2, 0.9]), 1.0 / 100.0)
    }
}

impl Integrators {
    /// Creates the figure: three pendulums released at `start`, with steps of `step_secs`.
    pub(crate) fn new(start: State<f64>, step_secs: f64) -> Self {
        let sweep = Sweep::of(&pendulum(), start);
        Integrators { sweep, ..Integrators::resting(start, step_secs) }
    }

    /// Creates the figure without its sweep, which takes long to compute.
    fn resting(start: State<f64>, step_secs: f64) -> Self {
        let run = MethodRun {
            state: start,
            before: start,
            errors: vec![[0.0; 2]],
            diverged_at: None,
            trail: VecDeque::new(),
        };
        Integrators {
            start,
            step_secs,
            clock: Clock::new(step_secs),
            runs: [run.clone(), run.clone(), run],
            sweep: Sweep::default(),
            has_slopes: false,
        }
    }

    /// Begins again from a start with another step.
    fn begin(&mut self, start: State<f64>, step_secs: f64) {
        let has_slopes = self.has_slopes;
        *self = Integrators { has_slopes, ..Integrators::new(start, step_secs) };
    }

    /// Draws the three pendulums over one another, each with its trail and its name.
    fn draw_runs(&self, ui: &mut Ui, size: Vec2) {
        let told = format!("Three pendulums. {}", self.told());
        let stage = FigureCanvas::seen(ui, size, StageReach::of_rods(2.0), told);
        let places =
            self.runs.each_ref().map(|run| ends([1.0, 1.0], run.drawn(self.clock.share())));
        let colours = Integrator::ALL.map(|(method, _)| method.colour(&stage.tint));
        for (k, run) in self.runs.iter().enumerate() {
            // The last point of the trail lies ahead of the drawn state.
            let trail: Vec<_> = run.trail.iter().copied().collect();
            let past = trail.len().saturating_sub(1);
            stage.trail(&[&trail[..past], &[places[k][1]]].concat(), colours[k]);
        }
        for ([first, second], colour) in places.into_iter().zip(colours) {
            stage.rod([0.0; 2], first, colour);
            stage.rod(first, second, colour);
            stage.bob(first, 0.4, colour);
            stage.bob(second, 1.0, colour);
        }
        stage.pivot();
        stage.note(None, "One start and one Δt: where the colours part, a method is wrong.");
        if self.has_slopes {
            slopes::draw(&stage, &self.runs[2].state, self.step_secs);
        }
        for (k, (_, name)) in Integrator::ALL.into_iter().enumerate() {
            let words = self.runs[k].diverged_at.map_or(name.to_string(), |at| {
                format!("{name}: diverged at t = {} s", fixed(at, 2))
            });
            stage.label(places[k][1], &words, colours[k]);
        }
        StageRuler::lay_on(ui, &stage);
    }

    fn step(&mut self, secs: f64) {
        let pendulum = pendulum();
        let unit = pendulum.p + pendulum.q;
        let energy = pendulum.energy(&self.start);
        for (run, (method, _)) in self.runs.iter_mut().zip(Integrator::ALL) {
            if run.diverged_at.is_some() {
                continue;
            }
            let state = method.step(&pendulum, &run.state, self.step_secs);
            run.before = run.state;
            let error = (pendulum.energy(&state) - energy) / unit;
            let speed = state.speed[0].abs().max(state.speed[1].abs());
            if speed.is_nan() || speed > DIVERGED_SPEED || !error.is_finite() {
                run.diverged_at = Some(secs);
            } else {
                run.state = state;
                run.errors.push([secs, error]);
                run.trail.push_back(ends([1.0, 1.0], state.angle)[1]);
                if run.trail.len() as f64 * self.step_secs > TRAIL_SECS {
                    run.trail.pop_front();
                }
            }
        }
    }

    fn chart(&self, tint: &Tint) -> Chart {
        let curves = self.runs.iter().zip(Integrator::ALL).map(|(run, (method, name))| {
            Curve::line(name, method.colour(tint), run.errors.clone())
        });
        let end = self.clock.secs().max(10.0);
        Chart {
            across: ChartAxis::new("time, s", 0.0..=end, AxisScale::Linear),
            up: ChartAxis::new("relative energy error", -1e2..=1e2, AxisScale::SignedLog(1e-9)),
            curves: curves.collect(),
            marks: Vec::new(),
        }
    }
}

impl LiveFigure for Integrators {
    fn copied(&self) -> Box<dyn LiveFigure> {
        Box::new(self.clone())
    }

    fn open(&mut self, start: State<f64>) {
        self.begin(start, self.step_secs);
    }

    fn restart(&mut self) {
        let (sweep, has_slopes) = (self.sweep.clone(), self.has_slopes);
        let fresh = Integrators::resting(self.start, self.step_secs);
        *self = Integrators { sweep, has_slopes, ..fresh };
    }

    fn secs(&self) -> f64 {
        self.clock.secs() + self.clock.share() * self.clock.step_secs
    }

    fn advance(&mut self, elapsed_secs: f64) {
        if self.clock.secs() > MAX_SECS {
            self.restart();
        }
        let from = self.clock.taken;
        for k in 1..=self.clock.due(elapsed_secs) as u64 {
            self.step((from + k) as f64 * self.step_secs);
        }
    }

    fn told(&self) -> String {
        let share = self.clock.share();
        let words = self.runs.iter().zip(Integrator::ALL).map(|(run, (_, name))| {
            let [theta1, theta2] = run.drawn(share).map(|angle| fixed(wrapped(angle), 3));
            format!("{name}: {theta1}, {theta2} rad")
        });
        words.collect::<Vec<_>>().join("; ")
    }

    fn draw(&mut self, ui: &mut Ui, size: Vec2) {
        let tint = Tint::of(ui);
        let [errors, sweep] = [self.chart(&tint), self.sweep.chart(&tint)];
        Arrangement::of(size, 2).show(
            ui,
            |ui, size| self.draw_runs(ui, size),
            |ui, size| {
                errors.show(
                    ui,
                    size,
                    "Relative energy error against time of the three integrators",
                );
                sweep.show(ui, size, "State error after one second against the step");
            },
        );
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        let (mut step_ms, mut start) = (self.step_secs * 1e3, self.start);
        let (mut changed, tint) = (false, Tint::of(ui));
        Grid::new("integrators").num_columns(2).show(ui, |ui| {
            changed |= number_on(ui, "Step Δt", " ms", &mut step_ms, 1.0..=200.0, true);
            changed |= number_on(ui, "θ1", " rad", &mut start.angle[0], -3.1..=3.1, false);
            changed |= number_on(ui, "θ2", " rad", &mut start.angle[1], -3.1..=3.1, false);
        });
        let mut asked = None;
        ui.horizontal_wrapped(|ui| {
            if changed || ui.button("Restart").clicked() {
                self.begin(start, step_ms / 1e3);
            }
            let hint = "Pauses, and takes one step of Δt with all three";
            if ui.button("One step").on_hover_text(hint).clicked() {
                self.clock.taken += 1;
                self.step(self.clock.secs());
                asked = Some(FigureRequest::Pause);
            }
            let hint = "The velocities of the second bob that RK4 averages in its next step";
            ui.checkbox(&mut self.has_slopes, "Slopes of RK4").on_hover_text(hint);
        });
        ui.separator();
        Grid::new("integrators now").num_columns(2).show(ui, |ui| {
            thrown(ui, &self.start);
            for (run, (method, name)) in self.runs.iter().zip(Integrator::ALL) {
                let error = run.errors.last().map_or(0.0, |last| last[1]);
                let now = run
                    .diverged_at
                    .map_or(signed(error, 2), |at| format!("diverged at t = {} s", fixed(at, 2)));
                coloured_row(ui, name, method.colour(&tint), now);
            }
        });
        ui.collapsing("Orders", |ui| {
            for (k, (_, name)) in Integrator::ALL.into_iter().enumerate() {
                ui.label(format!("{name}: {:.2}", self.sweep.order(k)));
            }
        });
        for (run, (_, name)) in self.runs.iter().zip(Integrator::ALL) {
            ui.label(name);
            Energy::of_default(&run.state).bar(ui, name);
        }
        if self.runs.iter().any(|run| run.diverged_at.is_some()) {
            ui.label("Restart with a smaller Δt: energy grew without bound.");
        }
        let to_map = ui.button("Show this start on the map").clicked();
        asked.or(to_map.then_some(FigureRequest::ToMap(self.start)))
    }

    fn set_up(&self) -> Vec<SetUpWord> {
        let State { angle, speed } = self.start;
        vec![
            SetUpWord::numbers("start", angle, ANGLES),
            SetUpWord::numbers("step", [self.step_secs], 1e-3..=0.2),
            SetUpWord::numbers("speeds", speed, SPEEDS),
        ]
    }

    fn take_set_up(&mut self, numbers: &[f64]) {
        if let &[t1, t2, step_secs, w1, w2] = numbers {
            self.begin(State { angle: [t1, t2], speed: [w1, w2] }, step_secs);
        }
    }

    fn csv(&self, secs: f64) -> String {
        let mut live = Integrators::resting(self.start, self.step_secs);
        let mut text = "t,euler,semi_implicit_euler,rk4\n0,0,0,0\n".to_string();
        for k in 1..=(secs / self.step_secs) as u64 {
            let t = k as f64 * self.step_secs;
            live.step(t);
            let error = |run: &MethodRun| match run.diverged_at {
                Some(_) => "diverged".to_string(),
                None => run.errors.last().map_or(0.0, |last| last[1]).to_string(),
            };
            let [a, b, c] = [0, 1, 2].map(|k| error(&live.runs[k]));
            text.push_str(&format!("{t},{a},{b},{c}\n"));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn explicit_euler_grows_as_it_is_known_to() {
        // In a small oscillation in a normal mode, every step multiplies the energy by 1 + h²ω².
        let pendulum = pendulum();
        let omega2 = 9.81 * (2.0 - 2f64.sqrt());
        let start = [1e-4, 2f64.sqrt() * 1e-4];
        let lowest = -(pendulum.p + pendulum.q);
        // Uses only the quadratic part of the energy, because rounding of the whole energy would
        // hide the growth.
        let energy = |s: &State<f64>| {
            let [t1, t2] = s.angle;
            let [w1, w2] = s.speed;
            0.5 * (pendulum.a * w1 * w1 + pendulum.b * w2 * w2 + pendulum.p * t1 * t1)
                + pendulum.c * w1 * w2
                + 0.5 * pendulum.q * t2 * t2
        };
        assert!(lowest < 0.0);
        let (mut state, h) = (State::rest(start), 0.01);
        let before = energy(&state);
        for _ in 0..100 {
            state = Integrator::Euler.step(&pendulum, &state, h);
        }
        let growth = (energy(&state) / before).powf(0.01);
        assert!((growth - (1.0 + h * h * omega2)).abs() < 1e-7, "{growth}");
    }

    #[test]
    fn what_is_drawn_lies_between_two_steps() {
        let mut live = Integrators::new(State::rest([1.0, 0.5]), 0.1);
        (0..3).for_each(|_| live.advance(0.1));
        let run = &live.runs[2];
        assert_eq!(run.drawn(0.0), run.before.angle);
        assert!((run.drawn(1.0)[0] - run.state.angle[0]).abs() < 1e-15);
        assert!(run.drawn(0.5) != run.state.angle && run.before.angle != run.state.angle);
    }

    #[test]
    fn a_step_that_is_far_too_long_diverges_and_no_other_number_is_lost() {
        let mut live = Integrators::new(State::rest([2.9, 2.9]), 0.2);
        (0..2000).for_each(|_| live.advance(0.2));
        assert!(live.runs[0].errors.iter().flatten().all(|x| x.is_finite()));
        let mut late = Integrators::new(State::rest([2.9, 2.9]), 0.2);
        (1..=3000).for_each(|k| late.step(f64::from(k) * 0.2));
        assert!(late.runs[0].diverged_at.is_some());
        assert!(late.runs[0].state.angle.iter().all(|x| x.is_finite()));
        assert!(late.csv(600.0).contains("diverged"));
    }
}
