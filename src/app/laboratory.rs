//! The laboratory in the window: its figures in place of the map, or the map with an explanation.

use egui::{Align2, Ui, vec2};

use super::action::{Action, Look};
use super::camera::Camera;
use super::hover;
use super::model::AppModel;
use super::reach::Reach;
use super::state::Effect;
use crate::lab::flips::{Seen, explain};
use crate::lab::{Figure, FigureRequest};
use crate::physics::{Scalar, State, Theta};
use crate::scene::{Build, Plane, Scene};

/// Width of the view that shows a start from the laboratory, as a fraction of the home view's.
const PART: f64 = 1.0 / 16.0;

impl AppModel {
    /// Returns true if a figure is shown in place of the map.
    pub(super) fn lab_hides_map(&self) -> bool {
        self.state.shown.lab && self.lab.figure != Figure::Map
    }

    /// Returns the name of the figure shown in place of the map.
    pub fn figure_shown(&self) -> Option<&'static str> {
        self.lab_hides_map().then(|| self.lab.figure.name())
    }

    /// Shows a figure, or the map again.
    pub(super) fn show_figure(&mut self, figure: Option<Figure>) {
        self.state.shown.lab = figure.is_some();
        self.lab.figure = figure.unwrap_or(self.lab.figure);
        if self.lab_hides_map() {
            self.compute.rest();
        }
    }

    /// Opens a start in a figure.
    pub(super) fn open_in_lab(&mut self, figure: Figure, start: State<f64>) {
        self.lab.open(figure, start);
        self.show_figure(Some(figure));
    }

    /// Shows the tabs of all figures.
    pub(super) fn figure_tabs(&self, ui: &mut Ui) -> Vec<Action> {
        let mut actions = Vec::new();
        ui.horizontal_wrapped(|ui| {
            for figure in Figure::all() {
                let shown = self.lab.figure == figure;
                if ui.selectable_label(shown, figure.name()).on_hover_text(figure.title()).clicked()
                {
                    actions.push(Action::Lab(Some(figure)));
                }
            }
            if ui.button("Leave the lab").clicked() {
                actions.push(Action::Lab(None));
            }
        });
        actions
    }

    /// Shows the figure that hides the map; it advances only while it is visible.
    pub(super) fn figure(&mut self, ui: &mut Ui) -> Vec<Action> {
        let elapsed_secs = f64::from(ui.input(|input| input.stable_dt));
        if let Some(live) = self.lab.live() {
            live.advance(elapsed_secs);
        }
        ui.ctx().request_repaint();
        let mut actions = self.figure_tabs(ui);
        ui.separator();
        if let Some(FigureRequest::ToMap(start)) = self.lab.show(ui) {
            actions.push(Action::FromLab(start));
        }
        actions
    }

    /// Shows the explanation of the map beside it.
    pub(super) fn explanation(&mut self, ctx: &egui::Context) -> Vec<Action> {
        let counts = self.compute.explorer.counts();
        let seen = Seen {
            pixels: counts.pixels,
            forbidden: counts.forbidden,
            simulated: counts.simulated,
        };
        let mut actions = Vec::new();
        let window = egui::Window::new("What you are seeing").default_width(330.0);
        window.anchor(Align2::LEFT_TOP, vec2(12.0, 48.0)).resizable(false).show(ctx, |ui| {
            ui.label(Figure::Map.sentence());
            if !self.state.scene().is_flip_from_rest() {
                ui.label(self.state.question.ask.kind().about);
                return;
            }
            if let Some(kind) = explain(ui, &self.state.build, &seen) {
                let build = Build { kind, ..self.state.build };
                actions.push(Action::Scene(Box::new(Scene { build, ..self.state.scene() })));
            }
        });
        actions
    }

    /// Goes to a start on the map, or on that of pendulums thrown with its speeds, and pins it.
    pub(super) fn aimed_in_lab(&mut self, start: State<f64>) {
        self.state.shown.lab = false;
        let [omega1, omega2] = start.speed.map(|speed| speed.to_string());
        let origin = ["0".to_string(), "0".to_string(), omega1, omega2];
        let plane = Plane { origin, ..Plane::default() };
        if self.state.plane != plane {
            let scene = Scene { plane, ..self.state.scene() };
            self.act(vec![Action::Scene(Box::new(scene))]);
        }
        let home = Camera::whole(Reach::TORUS);
        let width_rad = home.width_rad * PART;
        let center = start.angle.map(|angle| Theta::from_f64(angle).wrapped());
        let camera = Camera { center, width_rad, ..home };
        self.act(vec![Action::Look(Look::To(camera))]);
        let level = self.state.aimed_screen().level();
        self.affect(Effect::Pin(Box::new(hover::sample_at(camera.center, level))));
    }
}
