//! The laboratory in the window: its figures in place of the map, or the map with an explanation.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use egui::{Align2, ScrollArea, Ui, vec2};

use super::action::{Action, LabAction};
use super::model::AppModel;
use super::settings::Settings;
use flipmap_lab::flips::explain;
use flipmap_lab::take_away::{Extent, FPS, TakeAway};
use flipmap_lab::{Figure, FigureRequest, set_up};
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::State;
use flipmap_scene::{PendulumSpec, Plane, Scene};
use flipmap_screen::camera::Camera;
use flipmap_screen::hover;
use flipmap_screen::meant;
use flipmap_screen::reach::Reach;

/// Width of the view that shows a start from the laboratory, as a fraction of the home view's.
const PART: f64 = 1.0 / 16.0;
/// Time between two frames of a figure that plays.
const FRAME: Duration = Duration::from_millis(20);
/// Width and height in pixels of a figure that is taken away.
const TAKEN_SIZE: [u32; 2] = [1280, 800];
/// Longest film or data in s of a figure that is taken away.
const MOST_SECS: f64 = 30.0;
/// Scale of the interface before an audience, relative to the user's own.
const PROJECTOR_SCALE: f32 = 1.6;

impl AppModel {
    /// Returns true if a figure is shown in place of the map.
    pub(super) fn lab_hides_map(&self) -> bool {
        self.state.shown.lab && self.lab.figure != Figure::Map
    }

    /// Returns the name of the figure shown in place of the map.
    pub fn figure_shown(&self) -> Option<&'static str> {
        self.lab_hides_map().then(|| self.lab.figure.name())
    }

    /// Returns true if the lab is shown to an audience.
    pub(super) fn is_projecting(&self) -> bool {
        self.state.shown.lab && self.lab.projector
    }

    /// Returns the scale of the interface.
    pub fn ui_scale(&self) -> f32 {
        let factor = if self.is_projecting() { PROJECTOR_SCALE } else { 1.0 };
        Settings::within_ui_scales(self.state.look.ui_scale * factor)
    }

    /// Reveals the answer of the lesson if it awaits that; otherwise plays or pauses the figure that
    /// hides the map, or what flies on the map.
    pub(super) fn play_or_pause(&mut self) {
        match self.lab_hides_map() || self.state.shown.lab && self.lab.lesson.awaits_reveal() {
            true => self.in_lab(LabAction::PlayPause),
            false => self.state.play_or_pause(),
        }
    }

    /// Leaves the projector mode if no dialog is open, otherwise closes what is.
    pub(super) fn escape(&mut self) {
        let dialogs = self.state.shown.help || self.state.shown.commands;
        match self.is_projecting() && !dialogs {
            true => self.in_lab(LabAction::Projector),
            false => self.state.escape(),
        }
    }

    /// Carries out an action on the laboratory.
    pub(super) fn in_lab(&mut self, action: LabAction) {
        let lab = &mut self.lab;
        match action {
            LabAction::PlayPause => lab.reveal_or_play(),
            LabAction::ShiftSpeed(by) => lab.playing.shift_speed(by),
            LabAction::Projector => {
                // The projector mode is part of the lab, so the lab is opened if the map is shown.
                lab.projector = !(lab.projector && self.state.shown.lab);
                self.show_figure(Some(self.lab.figure));
            }
            LabAction::Lesson => {
                lab.set_lesson(!(lab.lesson.is_on && self.state.shown.lab));
                if lab.lesson.is_on {
                    self.show_figure(Some(Figure::Single));
                }
            }
            LabAction::Step(by) => {
                if let Some(figure) = lab.figure.beside(by).filter(|_| self.state.shown.lab) {
                    self.show_figure(Some(figure));
                }
            }
            LabAction::TakeAway(kind) => self.take_away(kind),
        }
    }

    /// Begins to write the figure that is shown to a new file beside the last picture.
    fn take_away(&mut self, kind: TakeAway) {
        let beside: &Path = self.forms.export.path.as_ref();
        let stem = format!("flipmap-{}", self.lab.figure.name());
        let path = self.saved_pictures.next_path(beside, &stem, kind.ending());
        let secs = self.lab.live().map_or(0.0, |live| live.secs()).clamp(1.0, MOST_SECS);
        let extent = Extent { size_px: TAKEN_SIZE, secs, fps: FPS };
        let mut lab = self.lab.copied();
        self.saved_pictures.begin(path, Arc::clone(&self.wake), move |path| {
            let written = kind.write(&mut lab, path, extent);
            written.map_err(|error| format!("cannot write {}: {error}", path.display()))
        });
    }

    /// Opens what was pasted: a figure's set-up, or the location of a map.
    pub(super) fn paste(&mut self, text: &str) {
        if !text.trim().starts_with(set_up::PREFIX) {
            return self.go_to(|state| state.paste(text));
        }
        match self.lab.open_set_up(text) {
            Ok(()) => self.show_figure(Some(self.lab.figure)),
            Err(error) => {
                self.state.notices.fail(format!("What was pasted opens nothing: {error}."))
            }
        }
    }

    /// Shows a figure, or the map again.
    pub(super) fn show_figure(&mut self, figure: Option<Figure>) {
        self.state.shown.lab = figure.is_some();
        // The greeting would take the first Escape, unseen.
        self.state.shown.greeting &= figure.is_none();
        match figure {
            Some(figure) => self.lab.show_figure(figure),
            None => {
                self.lab.projector = false;
                self.lab.set_lesson(false);
            }
        }
        if self.lab_hides_map() {
            self.compute.rest();
        }
    }

    /// Opens a start in a figure.
    pub(super) fn open_in_lab(&mut self, figure: Figure, start: State<f64>) {
        self.lab.open(figure, start);
        self.show_figure(Some(figure));
    }

    /// Shows the tabs of all figures; in projector mode only the buttons for going on and leaving.
    pub(super) fn figure_tabs(&self, ui: &mut Ui) -> Vec<Action> {
        let mut actions = Vec::new();
        ui.horizontal_wrapped(|ui| {
            if self.lab.projector {
                for (name, by) in [("Previous figure", -1), ("Next figure", 1)] {
                    let is_there = self.lab.figure.beside(by).is_some();
                    if ui.add_enabled(is_there, egui::Button::new(name)).clicked() {
                        actions.push(Action::InLab(LabAction::Step(by)));
                    }
                }
                if ui.button("Leave the projector mode").on_hover_text("Escape").clicked() {
                    actions.push(Action::InLab(LabAction::Projector));
                }
                return;
            }
            for figure in Figure::all() {
                let shown = self.lab.figure == figure;
                if ui.selectable_label(shown, figure.name()).on_hover_text(figure.title()).clicked()
                {
                    actions.push(Action::Lab(Some(figure)));
                }
            }
            ui.separator();
            if ui.selectable_label(self.lab.lesson.is_on, "Lesson").clicked() {
                actions.push(Action::InLab(LabAction::Lesson));
            }
            if ui.button("Projector").on_hover_text("Large, with few controls (F10)").clicked() {
                actions.push(Action::InLab(LabAction::Projector));
            }
            if ui.button("Leave the lab").clicked() {
                actions.push(Action::Lab(None));
            }
        });
        actions
    }

    /// Shows the figure that hides the map; it advances only while it is visible.
    pub(super) fn figure(&mut self, ui: &mut Ui) -> Vec<Action> {
        self.lab.advance(f64::from(ui.input(|input| input.stable_dt)));
        let mut actions = self.figure_tabs(ui);
        ui.separator();
        let request = self.lab.show(ui);
        if self.lab.playing.is_moving() {
            ui.ctx().request_repaint_after(FRAME);
        }
        actions.extend(request.and_then(action_for));
        actions
    }

    /// Shows the explanation of the map over its upper left corner, and the lesson's card while the
    /// lesson is on.
    pub(super) fn explanation(&mut self, ctx: &egui::Context) -> Vec<Action> {
        let seen = self.in_view.seen(&self.state.screen(), &mut self.compute.explorer);
        let mut actions = Vec::new();
        let window = egui::Window::new("What you are seeing").default_width(328.0);
        let most = (ctx.content_rect().height() - 140.0).max(100.0);
        window.anchor(Align2::LEFT_TOP, vec2(8.0, 48.0)).resizable(false).show(ctx, |ui| {
            ScrollArea::vertical().max_height(most).show(ui, |ui| {
                if self.lab.lesson.is_on {
                    actions.extend(self.lab.lesson_card(ui).and_then(action_for));
                }
                if self.lab.lesson.hides_answer() {
                    return;
                }
                ui.label(Figure::Map.sentence());
                if let Some(kind) = explain(ui, &self.state.document(), &seen) {
                    let build = PendulumSpec { kind, ..self.state.build };
                    actions.push(Action::Scene(Box::new(Scene { build, ..self.state.scene() })));
                }
            });
        });
        actions
    }

    /// Goes to a start on the map of pendulums released with its speeds, and pins it.
    pub(super) fn aimed_in_lab(&mut self, start: State<f64>) {
        self.state.shown.lab = false;
        let [omega1, omega2] = start.speed.map(|speed| meant(speed).to_string());
        let origin = ["0".to_string(), "0".to_string(), omega1, omega2];
        let plane = Plane { origin, ..Plane::default() };
        if self.state.plane != plane {
            self.state.ask(&Scene { plane, ..self.state.scene() });
            self.follow(false);
        }
        let home = Camera::whole(Reach::TORUS);
        let width_rad = home.width_rad * PART;
        let center = start.angle.map(|angle| Exact::from_f64(angle).wrapped());
        let camera = Camera { center, width_rad, ..home };
        self.state.go(camera);
        let level = self.state.aimed_screen().level();
        self.pin(hover::sample_at(camera.center, level));
    }
}

/// Returns the action that a figure's request asks for; what the lab has done itself needs none.
fn action_for(request: FigureRequest) -> Option<Action> {
    match request {
        FigureRequest::ToMap(start) => Some(Action::FromLab(start)),
        FigureRequest::Show(figure) => Some(Action::Lab(Some(figure))),
        FigureRequest::EndLesson | FigureRequest::Pause => None,
        FigureRequest::CopySetUp => Some(Action::CopySetUp),
        FigureRequest::TakeAway(kind) => Some(Action::InLab(LabAction::TakeAway(kind))),
    }
}
