//! Figure 3: the double pendulum with its parts labelled, a chart of any quantity against any, a twin
//! with one difference, and time reversed.

use egui::{Button, ComboBox, Grid, Response, Ui, Vec2, vec2};

use super::arrangement::Arrangement;
use super::chart::{Chart, ChartAxis, Curve};
use super::controls::{FRICTIONS, build, friction, row, thrown};
use super::double_simulation::{DoublePendulumSimulation, draw_rods, told};
use super::drawing::{FigureCanvas, StageReach, Tint, end, ends, wrapped};
use super::energy::hanging_m;
use super::quantity::{PendulumAt, Quantity};
use super::reversal::{MAX_OUT_SECS, Reversal};
use super::ruler::StageRuler;
use super::set_up::SetUpWord;
use super::twin::Twin;
use super::zero_height::{ZERO_LABEL, ZeroHeight};
use super::{FigureRequest, LiveFigure};
use flipmap_numbers::number_text::{column, fixed};
use flipmap_pendulum::State;

/// The live figure of a double pendulum, with both angles and the second pivot on the first bob.
#[derive(Clone, Debug)]
pub(super) struct Double {
    simulation: DoublePendulumSimulation,
    /// The quantities of the chart: across and up.
    axes: [Quantity; 2],
    twin: Option<Twin>,
    reversal: Option<Reversal>,
}

impl Default for Double {
    fn default() -> Self {
        Double {
            simulation: DoublePendulumSimulation::from([0.8, 1.4]),
            axes: [Quantity::Angle(0), Quantity::Angle(1)],
            twin: None,
            reversal: None,
        }
    }
}

impl Double {
    /// Begins again from a start, and time runs forwards.
    fn begin(&mut self, start: State<f64>) {
        self.simulation.release(start);
        self.reversal = None;
        self.begin_twin();
    }

    fn has_friction(&self) -> bool {
        self.simulation.build.friction[0].value() > 0.0
    }

    fn begin_twin(&mut self) {
        if let Some(twin) = &mut self.twin {
            twin.begin(&self.simulation);
        }
    }

    /// Returns the seconds since time was reversed, or `None` if it runs forwards.
    fn secs_back(&self) -> Option<f64> {
        let reversal = self.reversal.as_ref()?;
        Some(self.secs() - reversal.out_secs).filter(|secs| *secs >= 0.0)
    }

    /// Returns the state that is drawn.
    fn shown(&self) -> State<f64> {
        match (&self.reversal, self.secs_back()) {
            (Some(reversal), Some(secs)) => reversal.by_rk4.state_at(secs),
            _ => self.simulation.now(),
        }
    }

    /// Draws the pendulum with its parts named, beside its twin, or on its way back.
    fn draw_stage(&mut self, ui: &mut Ui, size: Vec2) {
        match (self.twin.take(), self.secs_back()) {
            (Some(twin), _) => {
                let (stage, response) = self.draw_beside(ui, size, &twin);
                self.twin = Some(twin);
                self.drag(&stage, &response, None);
            }
            (None, Some(secs)) => self.draw_back(ui, size, secs),
            (None, None) => self.draw_parts(ui, size),
        }
    }

    /// Draws the pendulum, and its twin to the right.
    fn draw_beside(&self, ui: &mut Ui, size: Vec2, twin: &Twin) -> (FigureCanvas, Response) {
        let half = vec2(0.5 * (size.x - 8.0), size.y);
        let both = [&self.simulation.build, &twin.simulation.build];
        let [own, other] = both.map(|build| build.lengths_m().iter().sum::<f64>());
        let reach = StageReach::of_rods(own.max(other));
        let both = ui.horizontal_top(|ui| {
            let told = self.simulation.told();
            let (stage, response) = FigureCanvas::new(ui, half, reach, told);
            self.simulation.draw(&stage);
            stage.note(None, "Drag a bob, or throw it.");
            let right = FigureCanvas::seen(ui, half, reach, twin.simulation.told());
            twin.simulation.draw(&right);
            right.note(None, "The twin, with one difference.");
            StageRuler::lay_on(ui, &stage);
            (stage, response)
        });
        both.inner
    }

    fn drag(&mut self, stage: &FigureCanvas, response: &Response, handles: Option<[[f64; 2]; 2]>) {
        let was_held = self.simulation.held.is_some();
        self.simulation.drag(stage, response, handles);
        if was_held || self.simulation.held.is_some() {
            self.reversal = None;
            self.begin_twin();
        }
    }

    fn draw_parts(&mut self, ui: &mut Ui, size: Vec2) {
        let lengths = self.simulation.build.lengths_m();
        let (reach, told) = (lengths[0] + lengths[1], self.simulation.told());
        let (stage, response) = FigureCanvas::new(ui, size, StageReach::of_rods(reach), told);
        let zero = self.simulation.zero.lay_on(ui, &stage, hanging_m(&self.simulation.build));
        let simulation = &self.simulation;
        let angle = simulation.now().angle.map(wrapped);
        let [first, second] = ends(lengths, angle);
        let (faint, [one, two, three, _]) = (stage.tint.faint, stage.tint.parts);
        stage.note(None, "Both angles are from the vertical. Drag or throw a bob, or drag a ring.");
        // Arcs keep a least size where rods are short, so that their handles can be grabbed.
        let radius = (0.3 * lengths[0].min(lengths[1])).max(0.1 * reach);
        let handles = [end([0.0; 2], radius, angle[0]), end(first, radius, angle[1])];
        for (at, theta) in [([0.0; 2], angle[0]), (first, angle[1])] {
            stage.dashed(at, [at[0], at[1] - 2.0 * radius], faint);
            stage.arc(at, theta, radius, three);
        }
        simulation.draw(&stage);
        handles.iter().for_each(|handle| stage.handle(*handle, three));
        let beside = |at, theta: f64| end(at, 1.05 * radius, 0.5 * theta);
        stage.label(beside([0.0; 2], angle[0]), "θ1", three);
        stage.label(beside(first, angle[1]), "θ2", three);
        let [m1, m2] = simulation.build.masses_kg();
        stage.label(first, &format!("m1 = {} kg, the second pivot", fixed(m1, 2)), one);
        stage.label(second, &format!("m2 = {} kg", fixed(m2, 2)), two);
        let along = |from: [f64; 2], to: [f64; 2]| [0, 1].map(|i| 0.4 * from[i] + 0.6 * to[i]);
        let rods = [along([0.0; 2], first), along(first, second)];
        for (bob, at) in rods.into_iter().enumerate() {
            let words = format!("l{} = {} m", bob + 1, fixed(lengths[bob], 2));
            stage.label(at, &words, stage.tint.ink);
        }
        stage.label([0.0; 2], "pivot", faint);
        zero.into_iter().for_each(|at| stage.label(at, ZERO_LABEL, faint));
        self.drag(&stage, &response, Some(handles));
        StageRuler::lay_on(ui, &stage);
    }

    /// Draws the pendulum on its way back, `secs` after the turn, over the one in double-double.
    fn draw_back(&self, ui: &mut Ui, size: Vec2, secs: f64) {
        let Some(reversal) = &self.reversal else { return };
        let build = &self.simulation.build;
        let lengths = build.lengths_m();
        let reach = StageReach::of_rods(lengths[0] + lengths[1]);
        let stage = FigureCanvas::seen(ui, size, reach, self.told());
        let angle = self.shown().angle;
        let bob = |angle: [f64; 2]| ends(lengths, angle)[1];
        let past = reversal.by_rk4.past(secs).iter().map(|state| bob(state.angle));
        let trail: Vec<_> = past.chain([bob(angle)]).collect();
        stage.trail(&trail, stage.tint.parts[1]);
        let exact = ends(lengths, reversal.exact.state_at(secs).angle);
        for (from, to) in [([0.0; 2], exact[0]), (exact[0], exact[1])] {
            stage.dashed(from, to, stage.tint.faint);
        }
        stage.bob(exact[1], 0.5 * build.masses_kg()[1], stage.tint.faint);
        draw_rods(&stage, build, angle);
        stage.note(None, "Time reversed: RK4 in steps of 1/120 s; in grey, double-double.");
        stage.label(bob(angle), "RK4", stage.tint.parts[1]);
        stage.label(exact[1], "double-double", stage.tint.faint);
        StageRuler::lay_on(ui, &stage);
    }

    /// Returns the chart of one quantity against another over the last seconds, dashed for the twin.
    fn chart(&self, tint: &Tint) -> Chart {
        let (first, twin) = (&self.simulation, self.twin.as_ref().map(|twin| &twin.simulation));
        let own = self.points(first, twin);
        let other = twin.map_or(Vec::new(), |twin| self.points(twin, Some(first)));
        let axis = |i: usize| {
            let values = own.iter().chain(&other).map(|point| point[i]);
            ChartAxis::around(&self.axes[i].name(), values, self.axes[i].is_angle())
        };
        let (across, up) = (axis(0), axis(1));
        let marks = own.last().copied().into_iter().collect();
        let whole = |points: Vec<[f64; 2]>| across.pieces(&up, points);
        let mut curves: Vec<Curve> =
            whole(own).into_iter().map(|piece| Curve::line("", tint.parts[1], piece)).collect();
        curves.extend(whole(other).into_iter().map(|piece| Curve::guide("", tint.faint, piece)));
        Chart { across, up, curves, marks }
    }

    /// Returns the chart's points of a pendulum, whose twin moves in the same steps.
    fn points(
        &self,
        simulation: &DoublePendulumSimulation,
        twin: Option<&DoublePendulumSimulation>,
    ) -> Vec<[f64; 2]> {
        let moments = |of: &DoublePendulumSimulation| {
            let now = (of.secs(), of.now());
            of.path.iter().copied().chain([now]).collect::<Vec<_>>()
        };
        let beside = twin.map(moments).unwrap_or_default();
        let zero_m = self.simulation.zero_m();
        let point = |(k, (secs, state)): (usize, &(f64, State<f64>))| {
            let other = twin.zip(beside.get(k));
            let other =
                other.map(|(twin, (_, state))| PendulumAt { build: &twin.build, state, zero_m });
            let own = PendulumAt { build: &simulation.build, state, zero_m };
            self.axes.map(|quantity| quantity.value(own, *secs, other))
        };
        moments(simulation).iter().enumerate().map(point).collect()
    }

    /// Shows the menus of the chart's quantities.
    fn axis_menus(&mut self, ui: &mut Ui) {
        Grid::new("axes").num_columns(2).show(ui, |ui| {
            for (axis, name) in self.axes.iter_mut().zip(["Across", "Up"]) {
                let label = ui.label(name);
                let menu = ComboBox::from_id_salt(name)
                    .width(180.0)
                    .height(400.0)
                    .selected_text(axis.name());
                let shown = menu.show_ui(ui, |ui| {
                    for quantity in Quantity::ALL {
                        ui.selectable_value(axis, quantity, quantity.name());
                    }
                });
                shown.response.labelled_by(label.id);
                ui.end_row();
            }
        });
    }

    /// Shows the ways to reverse time and to compare with a twin.
    fn experiments(&mut self, ui: &mut Ui) {
        let can_turn = (0.1..MAX_OUT_SECS).contains(&self.secs()) && !self.has_friction();
        match &self.reversal {
            Some(reversal) => {
                let secs_back = self.secs_back().unwrap_or(0.0);
                ui.label(reversal.words(secs_back));
                if ui.button("Forward again").clicked() {
                    self.begin(self.simulation.start);
                }
            }
            None => {
                let button = ui.add_enabled(can_turn, Button::new("Turn all speeds round"));
                if button.on_hover_text("Time reversed: does it find back to its start?").clicked()
                {
                    let simulation = &self.simulation;
                    let (build, out_secs) = (&simulation.build, simulation.secs());
                    self.reversal = Some(Reversal::new(build, simulation.start, out_secs));
                    self.twin = None;
                }
            }
        }
        let mut has_twin = self.twin.is_some();
        if ui.checkbox(&mut has_twin, "A twin beside it").changed() {
            self.begin(self.simulation.start);
            self.twin = has_twin.then(|| Twin::of(&self.simulation));
        }
        if self.twin.as_mut().is_some_and(|twin| twin.controls(ui)) {
            self.begin(self.simulation.start);
        }
    }
}

impl LiveFigure for Double {
    fn copied(&self) -> Box<dyn LiveFigure> {
        Box::new(self.clone())
    }

    fn open(&mut self, start: State<f64>) {
        self.begin(start);
    }

    fn restart(&mut self) {
        self.begin(self.simulation.start);
    }

    fn secs(&self) -> f64 {
        self.simulation.secs()
    }

    fn advance(&mut self, elapsed_secs: f64) {
        let end_secs = self.reversal.as_ref().map_or(f64::INFINITY, |way| 2.0 * way.out_secs);
        let elapsed_secs = elapsed_secs.min((end_secs - self.secs()).max(0.0));
        if let Some(twin) = self.twin.as_mut().filter(|_| self.simulation.held.is_none()) {
            twin.simulation.advance(elapsed_secs);
        }
        self.simulation.advance(elapsed_secs);
    }

    fn told(&self) -> String {
        let angles = told(self.shown().angle);
        match self.secs_back() {
            Some(secs) => format!("{} s after the turn: {angles}", fixed(secs, 2)),
            None => angles,
        }
    }

    fn draw(&mut self, ui: &mut Ui, size: Vec2) {
        let tint = Tint::of(ui);
        let chart = match (&self.reversal, self.secs_back()) {
            (Some(reversal), Some(secs)) => reversal.chart(secs, &tint),
            _ => self.chart(&tint),
        };
        let named = format!("Chart of {} against {}", chart.up.name, chart.across.name);
        Arrangement::of(size, 1).show(
            ui,
            |ui, size| self.draw_stage(ui, size),
            |ui, size| {
                chart.show(ui, size, &named);
            },
        );
    }

    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        let mut is_changed = build(ui, &mut self.simulation.build);
        is_changed |= friction(ui, &mut self.simulation.build);
        if is_changed {
            self.begin(self.simulation.start);
        }
        ui.separator();
        ui.add_enabled_ui(self.reversal.is_none(), |ui| self.axis_menus(ui));
        self.experiments(ui);
        ui.separator();
        let reach_m: f64 = self.simulation.build.lengths_m().iter().sum();
        self.simulation.zero.control(ui, reach_m);
        let (simulation, state) = (&self.simulation, self.shown());
        simulation.energy(&state).bar(ui, "energy");
        Grid::new("double now").num_columns(2).show(ui, |ui| {
            thrown(ui, &simulation.start);
            row(ui, "time", format!("{} s", column(simulation.secs(), 3, 8)));
            for i in 0..2 {
                let [angle, speed] = [wrapped(state.angle[i]), state.speed[i]];
                row(ui, &format!("θ{}", i + 1), format!("{} rad", column(angle, 4, 8)));
                row(ui, &format!("ω{}", i + 1), format!("{} rad/s", column(speed, 4, 8)));
            }
        });
        ui.button("Show this start on the map")
            .clicked()
            .then_some(FigureRequest::ToMap(simulation.start))
    }

    fn set_up(&self) -> Vec<SetUpWord> {
        let mut words = self.simulation.set_up();
        let friction = self.simulation.build.friction[0].value();
        words.push(SetUpWord::numbers("friction", [friction], FRICTIONS));
        words.push(self.simulation.zero.word());
        words
    }

    fn take_set_up(&mut self, numbers: &[f64]) {
        let [others @ .., friction, above_m] = numbers else { return };
        self.simulation.zero = ZeroHeight { above_m: *above_m };
        self.simulation.take_set_up(others);
        self.simulation.build.friction = [(*friction).into(); 2];
        self.twin = None;
        self.begin(self.simulation.start);
    }

    fn csv(&self, secs: f64) -> String {
        super::machine::motion(&self.simulation, secs)
    }
}
