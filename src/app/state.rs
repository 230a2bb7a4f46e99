//! What the window shows, as plain data, and how actions change it.

use std::path::PathBuf;

use glam::DVec2;

use super::action::{Action, Look};
use super::camera::{Camera, Move, Screen};
use super::history::History;
use super::notices::Notices;
use super::pins::{PinAction, PinId, Pins};
use super::settings::{Layers, Settings, Theme};
use crate::engine::choice::{EngineKind, IntegrationSetting};
use crate::engine::{Accuracy, IntegratorConfig};
use crate::lab::Figure;
use crate::physics::Theta;
use crate::scene::{Budget, Build, Document, FlipQuestion, PictureTable, RunTable, Scene, View};
use crate::tiles::view_target::{Physics, ViewTarget};

/// What opens over or beside the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// The panels at the side.
    Side,
    /// The list of keys.
    Help,
    /// The command palette.
    Commands,
    /// What the window measures of itself.
    Debug,
}

/// Which dialogs are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenDialogs {
    /// The panels at the side.
    pub side: bool,
    /// The list of keys.
    pub help: bool,
    /// The command palette.
    pub commands: bool,
    /// What the window measures of itself.
    pub debug: bool,
    /// The laboratory.
    pub lab: bool,
}

/// What has to be done outside the plain state.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Close the window.
    Quit,
    /// Switch to or from the whole screen.
    FullScreen,
    /// Put a text into the clipboard.
    Copy(String),
    /// Let the person choose a file.
    AskForFile,
    /// Read a file and show what is in it.
    Open(PathBuf),
    /// Open an engine for the setting.
    Reopen,
    /// Launch a flight for the pixel of these starts: itself and its neighbour.
    Pin(Box<[[Theta; 2]; 2]>),
    /// Begin or stop going deeper by itself.
    GoDeeper,
    /// Show a figure of the laboratory, or the map again.
    Lab(Option<Figure>),
    /// Open a start in a figure.
    OpenInLab(Figure, [Theta; 2]),
    /// Show a start on the map.
    FromLab([Theta; 2]),
    /// The pendulums fly by other physics now.
    Relaunch,
    /// Lose the graphics device.
    LoseDevice,
}

/// What the window shows.
#[derive(Debug)]
pub struct AppState {
    /// The pendulum.
    pub build: Build,
    /// What is asked about it.
    pub question: FlipQuestion,
    /// How it is painted.
    pub picture: PictureTable,
    /// Whether the times of its colours follow a deep view.
    pub spreads: bool,
    /// How it is computed, as a scene's file says it.
    pub run: RunTable,
    /// The same, for the engines.
    pub setting: IntegrationSetting,
    /// Whether every pixel is checked.
    pub verify: bool,
    /// Which kind of engine is wanted.
    pub kind: EngineKind,
    /// Where the window looks now.
    pub camera: Camera,
    /// Where it is moving.
    pub moving: Option<Move>,
    /// Whether the map is being dragged.
    pub dragging: bool,
    /// Where it has been.
    pub history: History,
    /// The canvas in points.
    pub canvas: DVec2,
    /// Physical pixels a point.
    pub pixels_per_point: f64,
    /// Where the pointer is on the canvas.
    pub pointer: Option<DVec2>,
    /// The rectangle being drawn.
    pub drawing: Option<[DVec2; 2]>,
    /// What is drawn over the colours.
    pub layers: Layers,
    /// Which dialogs are open.
    pub shown: OpenDialogs,
    /// What the window has to say.
    pub notices: Notices,
    /// The pinned pixels.
    pub pins: Pins,
    /// The pin that the last click made.
    pub clicked: Option<PinId>,
    /// Whether moves are smooth.
    pub animate: bool,
    /// Dark, light, or as the system is.
    pub theme: Theme,
    /// The interface's scale.
    pub ui_scale: f32,
    /// The window's clock, s.
    pub now_secs: f64,
}

/// What a scene asks. A budget that is no other than the automatic one follows the depth.
pub(super) fn following(scene: &Scene) -> FlipQuestion {
    let budget = scene.question.budget;
    let auto = Budget { auto: true, ..budget }.for_view(&scene.build, &scene.view);
    let same = auto.secs == budget.secs;
    FlipQuestion { budget: if budget.auto || same { auto } else { budget }, ..scene.question }
}

impl AppState {
    /// Shows a document, computed as its run table says, which is settled.
    pub fn new(document: &Document, setting: IntegrationSetting, verify: bool) -> Self {
        let scene = document.scene();
        let camera = Camera::from_view(&scene.view);
        AppState {
            build: scene.build,
            question: following(&scene),
            picture: document.picture.clone(),
            spreads: document.picture.times.is_empty(),
            run: document.run.clone(),
            setting,
            verify,
            kind: EngineKind::Auto,
            camera,
            moving: None,
            dragging: false,
            history: History::new(camera),
            canvas: DVec2::new(1280.0, 800.0),
            pixels_per_point: 1.0,
            pointer: None,
            drawing: None,
            layers: Layers { curve: document.picture.curve, ..Layers::default() },
            shown: OpenDialogs {
                side: true,
                help: false,
                commands: false,
                debug: false,
                lab: false,
            },
            notices: Notices::default(),
            pins: Pins::new(&scene),
            clicked: None,
            animate: true,
            theme: Theme::default(),
            ui_scale: 1.0,
            now_secs: 0.0,
        }
    }

    /// What is shown, as people keep it.
    pub fn document(&self) -> Document {
        let curve = self.layers.curve;
        Document {
            pendulum: self.build,
            question: self.question,
            view: self.target().view(),
            picture: PictureTable { curve, ..self.picture.clone() },
            run: self.run.clone(),
            ..Document::default()
        }
    }

    /// What is shown, but for the view.
    pub fn scene(&self) -> Scene {
        Scene { build: self.build, question: self.question, view: View::default() }
    }

    /// Where the window looks, or is about to.
    pub fn target(&self) -> Camera {
        self.moving.map_or(self.camera, |moving| moving.to)
    }

    /// The canvas as it is about to look.
    pub fn aimed_screen(&self) -> Screen {
        self.through(self.target())
    }

    /// The canvas as it looks now.
    pub fn screen(&self) -> Screen {
        self.through(self.camera)
    }

    fn through(&self, camera: Camera) -> Screen {
        Screen { camera, size: self.canvas, pixels_per_point: self.pixels_per_point }
    }

    /// What the scheduler is to compute: of a move, where it ends.
    pub fn view_target(&self, config: IntegratorConfig) -> ViewTarget {
        let screen = self.through(self.target());
        let pointer = self.pointer.map(|point| screen.offset_at(point).to_array());
        let physics =
            Physics { build: self.build, rule: self.question.rule, config, verified: self.verify };
        let width_rad = screen.camera.width_rad;
        let budget_secs = self.question.budget.for_width(&self.build, width_rad).secs;
        ViewTarget { physics, budget_secs, region: screen.region(), level: screen.level(), pointer }
    }

    /// Moves on to a moment of the window's clock. Says whether anything is in motion.
    pub fn tick(&mut self, now_secs: f64) -> bool {
        let elapsed_secs = (now_secs - self.now_secs).max(0.0);
        self.now_secs = now_secs;
        if let Some(moving) = self.moving {
            let (camera, over) = moving.at(now_secs);
            self.camera = camera;
            if over {
                self.moving = None;
            }
        }
        let width_rad = self.target().width_rad;
        self.question.budget = self.question.budget.for_width(&self.build, width_rad);
        if self.moving.is_none() && !self.dragging {
            self.history.visit(self.camera);
        }
        self.pins.advance(elapsed_secs);
        self.moving.is_some() || self.pins.is_playing()
    }

    /// Does what a person wants, and says what else has to be done for it.
    pub fn apply(&mut self, action: Action) -> Option<Effect> {
        match action {
            Action::Look(look) => self.look(look),
            Action::Hover(point) => self.pointer = point,
            Action::Drawing(drawing) => self.drawing = drawing,
            Action::Pin(point) => return Some(Effect::Pin(Box::new(self.pixel_at(point)))),
            Action::GoDeeper => return Some(Effect::GoDeeper),
            Action::Lab(figure) => return Some(Effect::Lab(figure)),
            Action::OpenInLab(figure, start) => return Some(Effect::OpenInLab(figure, start)),
            Action::FromLab(start) => return Some(Effect::FromLab(start)),
            Action::Unpin => {
                if let Some(id) = self.clicked.take() {
                    self.pins.apply(PinAction::Remove(id));
                }
            }
            Action::Pins(action) => self.pins.apply(action),
            Action::PlayPause => self.play_or_pause(),
            Action::Scene(build, question) => {
                (self.build, self.question) = (*build, question);
                return Some(Effect::Relaunch);
            }
            Action::Picture(picture) => {
                self.spreads &= picture.times == self.picture.times;
                self.picture = picture;
            }
            Action::Accuracy(accuracy) => {
                self.set_accuracy(accuracy);
                return Some(Effect::Reopen);
            }
            Action::Engine(kind) => {
                self.kind = kind;
                return Some(Effect::Reopen);
            }
            Action::TryAgain => return Some(Effect::Reopen),
            Action::Layers(layers) => self.layers = layers,
            Action::Toggle(dialog) => self.toggle(dialog),
            Action::Escape => self.escape(),
            Action::Show(document) => return self.show(&document),
            Action::Open(path) => return Some(Effect::Open(path)),
            Action::AskForFile => return Some(Effect::AskForFile),
            Action::Paste(text) => return self.paste(&text),
            Action::CopyLocation => {
                self.notices.tell("The location was copied: paste it anywhere, or here.");
                return Some(Effect::Copy(crate::scene::location::text(&self.document().scene())));
            }
            Action::Find(angle) => self.go(Camera { center: angle, ..self.target() }),
            Action::Dismiss(id) => self.notices.dismiss(id),
            Action::UiScale(scale) => {
                self.ui_scale =
                    scale.clamp(*Settings::UI_SCALES.start(), *Settings::UI_SCALES.end())
            }
            Action::Theme(theme) => self.theme = theme,
            Action::Animate(animate) => self.animate = animate,
            Action::FullScreen => return Some(Effect::FullScreen),
            Action::LoseDevice => return Some(Effect::LoseDevice),
            Action::Quit => return Some(Effect::Quit),
        }
        None
    }

    fn look(&mut self, look: Look) {
        match look {
            Look::Drag(by) => {
                self.moving = None;
                self.dragging = true;
                self.camera = self.camera.moved(-self.screen().offset_at(by));
            }
            Look::Release => self.dragging = false,
            Look::Zoom { factor, about } => {
                let target = self.through(self.target());
                self.go(target.camera.zoomed(factor, target.offset_at(about)));
            }
            Look::Box(corners) => self.zoom_to_box(corners),
            Look::Step(share) => {
                let target = self.through(self.target());
                self.go(target.camera.moved(target.offset_at(share * self.canvas)));
            }
            Look::Home => self.go(Camera::from_view(&View::default())),
            Look::Back => {
                if let Some(camera) = self.history.back() {
                    self.go(camera);
                }
            }
            Look::Forward => {
                if let Some(camera) = self.history.forward() {
                    self.go(camera);
                }
            }
            Look::To(camera) => self.go(camera),
        }
    }

    /// Moves smoothly, or jumps if that is preferred.
    pub(super) fn go(&mut self, to: Camera) {
        if self.animate {
            self.moving = Some(Move { from: self.camera, to, began_secs: self.now_secs });
        } else {
            (self.camera, self.moving) = (to, None);
        }
    }

    fn zoom_to_box(&mut self, [a, b]: [DVec2; 2]) {
        let size = (a - b).abs();
        // A box of a few points is a click that trembled.
        if size.max_element() < 4.0 {
            return;
        }
        let screen = self.screen();
        let factor = (self.canvas / size.max(DVec2::ONE)).min_element();
        let there = self.camera.moved(screen.offset_at((a + b) / 2.0));
        self.go(there.zoomed(factor, DVec2::ZERO));
    }

    /// The starts of the sample drawn at a point, and of its neighbour to the right.
    fn pixel_at(&self, point: DVec2) -> [[Theta; 2]; 2] {
        let screen = self.screen();
        super::hover::sample_at(screen.angle_at(point), screen.level())
    }

    fn play_or_pause(&mut self) {
        let Some(pin) = self.pins.selected() else { return };
        let (id, playing) = (pin.id, pin.playback.is_playing());
        self.pins.apply(if playing { PinAction::Pause(id) } else { PinAction::Play(id) });
    }

    fn set_accuracy(&mut self, accuracy: Accuracy) {
        self.setting = IntegrationSetting::Accuracy(accuracy);
        self.verify = accuracy.verifies();
        self.run = RunTable { accuracy: Some(accuracy.to_string()), ..RunTable::default() };
    }

    fn toggle(&mut self, dialog: Dialog) {
        let shown = match dialog {
            Dialog::Side => &mut self.shown.side,
            Dialog::Help => &mut self.shown.help,
            Dialog::Commands => &mut self.shown.commands,
            Dialog::Debug => &mut self.shown.debug,
        };
        *shown = !*shown;
    }

    fn escape(&mut self) {
        self.drawing = None;
        let dialogs = self.shown.help || self.shown.commands;
        let lab = self.shown.lab && dialogs;
        self.shown = OpenDialogs { help: false, commands: false, lab, ..self.shown };
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::engine::{Method, Precision};
    use crate::physics::Scalar;

    /// The home scene in a window.
    pub fn state() -> AppState {
        AppState::new(&Document::default(), IntegrationSetting::Accuracy(Accuracy::Balanced), false)
    }

    fn look(state: &mut AppState, look: Look) {
        assert_eq!(state.apply(Action::Look(look)), None);
    }

    #[test]
    fn the_point_under_the_pointer_sticks() {
        let mut state = state();
        let grabbed = DVec2::new(300.0, -120.0);
        let angle = state.screen().angle_at(grabbed);
        look(&mut state, Look::Drag(DVec2::new(-700.0, 55.0)));
        let screen = state.screen();
        let now = screen.point_of(screen.camera.offset_of(angle));
        assert!((now - (grabbed + DVec2::new(-700.0, 55.0))).length() < 1e-6, "{now}");
    }

    #[test]
    fn moves_are_interrupted_by_new_ones_and_end_in_the_history() {
        let mut state = state();
        let zoom = Look::Zoom { factor: 4.0, about: DVec2::ZERO };
        look(&mut state, zoom);
        assert!(state.tick(0.1));
        let midway = state.camera.width_rad;
        assert!((1.6..6.2).contains(&midway));
        look(&mut state, zoom);
        assert_eq!(state.camera.width_rad, midway, "no jump");
        assert!(!state.tick(1.0));
        assert!((state.camera.width_rad - std::f64::consts::TAU / 16.0).abs() < 1e-12);
        assert!(state.history.has_back());
        look(&mut state, Look::Back);
        state.tick(2.0);
        assert_eq!(state.camera, Camera::from_view(&View::default()));
        look(&mut state, Look::Forward);
        state.tick(3.0);
        assert!((state.camera.width_rad - std::f64::consts::TAU / 16.0).abs() < 1e-12);
    }

    #[test]
    fn without_animation_moves_are_jumps() {
        let mut state = state();
        state.apply(Action::Animate(false));
        look(&mut state, Look::Step(DVec2::new(0.5, 0.0)));
        assert!(!state.tick(0.0));
        assert!((state.camera.center[0].to_f64() - std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn a_box_fills_the_canvas() {
        let mut state = state();
        state.apply(Action::Animate(false));
        let corners = [DVec2::new(100.0, 100.0), DVec2::new(420.0, 300.0)];
        let middle = state.screen().angle_at((corners[0] + corners[1]) / 2.0);
        look(&mut state, Look::Box(corners));
        assert!((state.camera.width_rad - std::f64::consts::TAU / 4.0).abs() < 1e-12);
        assert!(state.camera.offset_of(middle).length() < 1e-12);
        let before = state.camera;
        look(&mut state, Look::Box([DVec2::ZERO, DVec2::ONE]));
        assert_eq!(state.camera, before, "a click that trembled");
    }

    #[test]
    fn a_bad_paste_is_told_and_the_view_stays() {
        let mut state = state();
        let before = state.camera;
        assert_eq!(state.apply(Action::Paste("https://example.org".to_string())), None);
        assert!(state.notices.iter().next().unwrap().text.contains("not a location"));
        assert_eq!(state.target(), before);
        let paste = Action::Paste("flipmap:center=-1.66,0.1;width=0.4;budget=60".to_string());
        assert_eq!(state.apply(paste), Some(Effect::Relaunch));
        assert_eq!((state.question.budget.secs, state.target().width_rad), (60.0, 0.4));
    }

    #[test]
    fn a_picture_is_computed_as_it_was_made() {
        let mut state = state();
        let mut document = Document::default();
        assert_eq!(state.apply(Action::Show(Box::new(document.clone()))), None);
        document.run.method = Some("rk4".to_string());
        let shown = state.apply(Action::Show(Box::new(document.clone())));
        assert_eq!(shown, Some(Effect::Reopen));
        let IntegrationSetting::Explicit(config) = state.setting else {
            panic!("{:?}", state.setting)
        };
        assert_eq!(config.method, Method::LESSON);
        assert_eq!(state.document().run.step.as_deref(), Some("1/120"));
        document.run.tolerance = Some("much".to_string());
        assert_eq!(state.apply(Action::Show(Box::new(document))), None);
        assert!(state.notices.iter().next().unwrap().text.contains("--tolerance"));
    }

    #[test]
    fn the_location_leads_back() {
        let mut state = state();
        state.apply(Action::Animate(false));
        look(&mut state, Look::Zoom { factor: 1e6, about: DVec2::new(211.0, 37.0) });
        let Some(Effect::Copy(text)) = state.apply(Action::CopyLocation) else { panic!("no copy") };
        let there = state.camera;
        look(&mut state, Look::Home);
        state.apply(Action::Paste(text));
        assert!(state.camera.offset_of(there.center).length() < 1e-5 * there.width_rad);
        assert_eq!(state.camera.width_rad, there.width_rad);
    }

    #[test]
    fn palettes_and_layers_are_not_part_of_the_aim() {
        let mut state = state();
        let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
        let before = state.view_target(config);
        let picture = PictureTable { palette: "magma".to_string(), ..state.picture.clone() };
        state.apply(Action::Picture(picture));
        state.apply(Action::Layers(Layers { grid: true, ..state.layers }));
        assert_eq!(state.view_target(config), before);
        let question = FlipQuestion { budget: Budget::secs(60.0), ..state.question };
        assert_eq!(
            state.apply(Action::Scene(Box::new(state.build), question)),
            Some(Effect::Relaunch)
        );
        assert_ne!(state.view_target(config), before);
    }
}
