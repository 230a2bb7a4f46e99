//! The state of the window as plain data, and how actions change it.

use std::path::PathBuf;

use glam::DVec2;

use super::auto_budget::following;
use super::colour_cycle::ColourCycle;
use super::favourites::ReplacedFavourite;
use super::history::{History, Snapshot};
use super::integration::Integration;
use super::notices::Notices;
use super::pins::{PinAction, Pins};
use super::sections::{Section, section_of};
use super::settings::{Appearance, Layers};
use flipmap_engine::IntegratorConfig;
use flipmap_engine::run_settings::RunSpec;
use flipmap_numbers::Exact;
use flipmap_render::tiles::view_target::{Physics, ViewTarget};
use flipmap_scene::{Document, PendulumSpec, PictureTable, Plane, QuestionSettings, Scene, View};
use flipmap_screen::camera::{Camera, Move, Screen};
use flipmap_screen::flight::playback::Playback;
use flipmap_screen::reach::Reach;

/// A panel or window that opens over or beside the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// The rail, the side panel and the toolbar.
    Side,
    /// The list of keys.
    Help,
    /// The command palette.
    Commands,
    /// The window's measurements of itself.
    Debug,
    /// The greeting of the first start.
    Greeting,
    /// The pendulums of all pins, in place of the map.
    Stage,
    /// The question before the window closes while exports are running.
    Leaving,
}

/// The dialogs that are open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenDialogs {
    /// True if the rail, the side panel and the toolbar are shown.
    pub side: bool,
    /// Section that the side panel shows, if it is open.
    pub section: Option<Section>,
    /// Panel at the side that is to be scrolled to.
    pub panel: Option<&'static str>,
    /// True if the list of keys is shown.
    pub help: bool,
    /// True if the command palette is shown.
    pub commands: bool,
    /// True if the window's measurements of itself are shown.
    pub debug: bool,
    /// True if the greeting of the first start is shown.
    pub greeting: bool,
    /// True if the pendulums of all pins are shown in place of the map.
    pub stage: bool,
    /// True if the laboratory is shown.
    pub lab: bool,
    /// True if the user is asked whether the window should close.
    pub leaving: bool,
    /// Clock of the map, if any; flips after its time are not drawn.
    pub timeline: Option<Playback>,
    /// Animation of the palette.
    pub cycle: ColourCycle,
}

/// An effect of an action that only the window can have.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Closes the window.
    Quit,
    /// Switches between full screen and a window.
    FullScreen,
    /// Puts a text into the clipboard.
    Copy(String),
    /// Saves the map as it is on the screen as the picture of a document.
    SavePicture(Box<Document>, PathBuf),
    /// Copies the map as it is on the screen, with the marks of a document.
    CopyPicture(Box<Document>),
    /// Destroys the graphics device.
    #[cfg(feature = "rigs")]
    LoseDevice,
}

/// The plain state of the window.
#[derive(Debug)]
pub struct AppState {
    /// Pendulum that is shown.
    pub build: PendulumSpec,
    /// Question that is asked about it.
    pub question: QuestionSettings,
    /// Plane of starts that the view lies in.
    pub plane: Plane,
    /// Colours of the map.
    pub picture: PictureTable,
    /// Integration of pixels, and the engine for it.
    pub integration: Integration,
    /// Camera of the current view.
    pub camera: Camera,
    /// Move in progress, if any.
    pub moving: Option<Move>,
    /// True while the map is being dragged.
    pub dragging: bool,
    /// History of what was shown.
    pub(crate) history: History<Snapshot>,
    /// The moment of the window's clock, in s, at which something other than the view changed last;
    /// none if the view has changed since.
    pub(super) changed_secs: Option<f64>,
    /// The colours of the document that was shown last, before the user changed them.
    pub(super) given: PictureTable,
    /// Size of the canvas in points.
    pub canvas: DVec2,
    /// Physical pixels per point.
    pub pixels_per_point: f64,
    /// Favourites that were replaced, the newest last.
    pub(super) replaced: Vec<ReplacedFavourite>,
    /// Position of the pointer on the canvas, if it is there.
    pub pointer: Option<DVec2>,
    /// Rectangle being drawn, if any.
    pub drawing: Option<[DVec2; 2]>,
    /// Layers drawn over the colours.
    pub layers: Layers,
    /// Dialogs that are open.
    pub shown: OpenDialogs,
    /// Notices to the user.
    pub notices: Notices,
    /// Pinned pixels.
    pub pins: Pins,
    /// Appearance of the window.
    pub look: Appearance,
    /// Time on the window's clock in s.
    pub now_secs: f64,
}

impl AppState {
    /// Creates the state of a document with its resolved settings.
    pub(crate) fn new(document: &Document, spec: RunSpec) -> Self {
        let scene = document.scene();
        let canvas = DVec2::new(1280.0, 800.0);
        let camera = Camera::from_view(&scene.view.fitted(canvas.to_array()), Reach::of(&scene));
        let question = following(&scene);
        let asked = Scene { question, ..scene.clone() };
        let first = Snapshot::new(&asked, camera, document.picture.clone());
        AppState {
            build: scene.build,
            question,
            plane: scene.plane.clone(),
            picture: document.picture.clone(),
            integration: Integration { spec, kind: None },
            camera,
            moving: None,
            dragging: false,
            history: History::new(first),
            changed_secs: None,
            given: document.picture.clone(),
            canvas,
            pixels_per_point: 1.0,
            replaced: Vec::new(),
            pointer: None,
            drawing: None,
            layers: Layers { curve: document.picture.curve, ..Layers::default() },
            shown: OpenDialogs {
                side: true,
                section: Some(Section::Explore),
                panel: None,
                help: false,
                commands: false,
                debug: false,
                greeting: false,
                stage: false,
                lab: false,
                leaving: false,
                timeline: None,
                cycle: ColourCycle::default(),
            },
            notices: Notices::default(),
            pins: Pins::new(&scene),
            look: Appearance::default(),
            now_secs: 0.0,
        }
    }

    /// Returns what is shown as a document.
    pub fn document(&self) -> Document {
        self.document_at(self.target().view())
    }

    /// Returns what is asked and how it is painted as a document of another view.
    pub(super) fn document_at(&self, view: View) -> Document {
        let curve = self.layers.curve;
        Document {
            pendulum: self.build,
            question: self.question,
            plane: self.plane.clone(),
            view,
            picture: PictureTable { curve, ..self.picture.clone() },
            run: self.integration.spec.table.clone(),
            ..Document::default()
        }
    }

    /// Returns what is shown as a document with the budget that was used, also if it follows the
    /// view: on the way down it may be longer than the view's own.
    pub(super) fn as_drawn(&self) -> Document {
        let mut document = self.document();
        document.question.budget.auto = false;
        document
    }

    /// Returns the scene that is shown, but with the default view.
    pub fn scene(&self) -> Scene {
        let plane = self.plane.clone();
        Scene { build: self.build, question: self.question, plane, ..Scene::default() }
    }

    /// Returns the current camera, or the one at the end of a move in progress.
    pub fn target(&self) -> Camera {
        self.moving.map_or(self.camera, |moving| moving.to)
    }

    /// Returns the canvas as it will look at the end of a move.
    pub(crate) fn aimed_screen(&self) -> Screen {
        self.through(self.target())
    }

    /// Returns the canvas as it looks now.
    pub(crate) fn screen(&self) -> Screen {
        self.through(self.camera)
    }

    fn through(&self, camera: Camera) -> Screen {
        Screen { camera, size: self.canvas, pixels_per_point: self.pixels_per_point }
    }

    /// Returns the view target for the scheduler; during a move, that of its end.
    pub fn view_target(&self, config: IntegratorConfig) -> ViewTarget {
        let screen = self.through(self.target());
        let pointer = self.pointer.map(|point| screen.offset_at(point).to_array());
        let physics = Physics::of(&self.scene(), config, self.integration.spec.verify);
        let budget_secs = self.question.budget.secs;
        let refinements = if self.rests() { self.look.edges.refinements() } else { 0 };
        let (region, level) = (screen.region(), screen.level());
        ViewTarget { physics, budget_secs, region, level, pointer, refinements }
    }

    /// Advances to a moment of the window's clock. Returns true if the view, the flips or the
    /// colours are in motion.
    pub fn tick(&mut self, now_secs: f64) -> bool {
        let elapsed_secs = (now_secs - self.now_secs).max(0.0);
        self.now_secs = now_secs;
        self.notices.advance(now_secs);
        if let Some(moving) = self.moving {
            let (camera, over) = moving.at(now_secs);
            self.camera = camera;
            if over {
                self.moving = None;
            }
        }
        if self.moving.is_none() && !self.dragging {
            self.record();
        }
        self.pins.advance(elapsed_secs);
        let budget_secs = self.question.budget.secs;
        // The question may have changed to one without times.
        self.shown.timeline = self.shown.timeline.filter(|_| self.question.ask.is_time());
        if let Some(clock) = &mut self.shown.timeline {
            clock.advance(elapsed_secs, budget_secs, true);
        }
        let plays = self.shown.timeline.is_some_and(|clock| clock.is_playing());
        self.shown.cycle.advance(&mut self.picture, elapsed_secs);
        // Flying pendulums do not count, because they are drawn less often.
        self.moving.is_some() || plays || self.shown.cycle.runs
    }

    /// Returns the starts of the sample drawn at a point, and of its neighbour to the right.
    pub(super) fn pixel_at(&self, point: DVec2) -> [[Exact; 2]; 2] {
        let screen = self.screen();
        flipmap_screen::hover::sample_at(screen.angle_at(point), screen.level())
    }

    /// Paints the map in other colours.
    pub(super) fn paint(&mut self, picture: PictureTable) {
        let of_view = picture.of_view && picture.times == self.picture.times;
        self.picture = PictureTable { of_view, ..picture };
    }

    /// Shows the map up to the time of a clock, or whole again. Refuses a clock if answers are not
    /// times.
    pub(super) fn set_timeline(&mut self, clock: Option<Playback>) {
        if clock.is_some() && !self.question.ask.is_time() {
            self.notices
                .tell("Only flip times can be played; this question does not ask for a time.");
            return;
        }
        self.shown.timeline = clock;
    }

    /// Returns the time in s after which flips are not drawn.
    pub fn shown_until_secs(&self) -> f64 {
        let budget_secs = self.question.budget.secs;
        self.shown.timeline.map_or(budget_secs, |clock| clock.time_secs().min(budget_secs))
    }

    /// Plays or pauses the clock of the map if it is open, otherwise that of the pins.
    pub(super) fn play_or_pause(&mut self) {
        if let Some(clock) = &mut self.shown.timeline {
            let budget_secs = self.question.budget.secs;
            if clock.is_playing() { clock.pause() } else { clock.play(budget_secs) }
        } else if !self.pins.is_empty() {
            let playing = self.pins.is_playing();
            self.pins.apply(if playing { PinAction::Pause } else { PinAction::Play });
        }
    }

    /// Opens or closes a dialog.
    pub fn toggle(&mut self, dialog: Dialog) {
        let shown = match dialog {
            Dialog::Side => &mut self.shown.side,
            Dialog::Help => &mut self.shown.help,
            Dialog::Commands => &mut self.shown.commands,
            Dialog::Debug => &mut self.shown.debug,
            Dialog::Greeting => &mut self.shown.greeting,
            Dialog::Stage => &mut self.shown.stage,
            Dialog::Leaving => &mut self.shown.leaving,
        };
        *shown = !*shown;
        if dialog == Dialog::Debug && self.shown.debug {
            self.open_panel("Measured");
        }
    }

    /// Opens a panel at the side.
    pub(super) fn open_panel(&mut self, name: &'static str) {
        (self.shown.side, self.shown.panel) = (true, Some(name));
        self.shown.section = Some(section_of(name));
    }

    /// Opens a section of the side panel, or closes the panel if it is the one shown.
    pub(super) fn choose_section(&mut self, section: Section) {
        self.shown.section = Some(section).filter(|_| self.shown.section != Some(section));
    }

    /// Returns the location as a text, and tells the user that it was copied.
    pub(super) fn copied_location(&mut self) -> String {
        self.notices.tell("The location was copied: paste it anywhere, or here.");
        flipmap_scene::location::text(&self.document().scene())
    }

    /// Returns the link to the location as a text, and tells the user that it was copied.
    pub(super) fn copied_link(&mut self) -> String {
        self.notices.tell("The link was copied: it shows this map in a browser, or here.");
        flipmap_scene::location::link(&self.document().scene())
    }

    /// Closes whatever is open.
    pub(super) fn escape(&mut self) {
        self.drawing = None;
        let OpenDialogs { help, commands, greeting, stage, lab, leaving, .. } = self.shown;
        // What lies on top is closed first.
        let above = help || commands || greeting || leaving;
        (self.shown.help, self.shown.commands, self.shown.greeting) = (false, false, false);
        self.shown.leaving = false;
        (self.shown.stage, self.shown.lab) = (stage && above, lab && (above || stage));
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::action::Look;
    use crate::settings::EdgeSamples;
    use flipmap_engine::choice::IntegrationSetting;
    use flipmap_engine::level::BALANCED;
    use flipmap_engine::{Accuracy, Method, Precision};
    use flipmap_numbers::Scalar;
    use flipmap_scene::Budget;
    use flipmap_scene::question::QuestionName;

    /// Returns the state of a window with the home scene.
    pub(crate) fn state() -> AppState {
        AppState::new(&Document::default(), RunSpec::of_level(Accuracy::Balanced))
    }

    #[test]
    fn the_point_under_the_pointer_sticks() {
        let mut state = state();
        let grabbed = DVec2::new(300.0, -120.0);
        let angle = state.screen().angle_at(grabbed);
        state.look(Look::Drag(DVec2::new(-700.0, 55.0)));
        let screen = state.screen();
        let now = screen.point_of(screen.camera.offset_of(angle));
        assert!((now - (grabbed + DVec2::new(-700.0, 55.0))).length() < 1e-6, "{now}");
    }

    #[test]
    fn finer_samples_are_wanted_only_while_the_view_rests() {
        let mut state = state();
        let wanted = |state: &AppState| state.view_target(BALANCED).refinements;
        assert_eq!(wanted(&state), 2);
        state.dragging = true;
        assert_eq!(wanted(&state), 0);
        state.dragging = false;
        state.look(Look::Zoom { factor: 4.0, about: DVec2::ZERO });
        assert_eq!(wanted(&state), 0, "on the way");
        state.tick(1.0);
        assert_eq!(wanted(&state), 2);
        state.look.edges = EdgeSamples::One;
        assert_eq!(wanted(&state), 0);
    }

    #[test]
    fn moves_are_interrupted_by_new_ones_and_end_in_the_history() {
        let mut state = state();
        let zoom = Look::Zoom { factor: 4.0, about: DVec2::ZERO };
        state.look(zoom);
        assert!(state.tick(0.1));
        let midway = state.camera.width_rad;
        assert!((1.6..6.2).contains(&midway));
        state.look(zoom);
        assert_eq!(state.camera.width_rad, midway, "no jump");
        assert!(!state.tick(1.0));
        assert!((state.camera.width_rad - std::f64::consts::TAU / 16.0).abs() < 1e-12);
        assert!(state.history.has_back());
        state.look(Look::Back);
        state.tick(2.0);
        assert_eq!(state.camera, Camera::whole(Reach::TORUS));
        state.look(Look::Forward);
        state.tick(3.0);
        assert!((state.camera.width_rad - std::f64::consts::TAU / 16.0).abs() < 1e-12);
    }

    #[test]
    fn without_animation_moves_are_jumps() {
        let mut state = state();
        state.look.animate = false;
        state.look(Look::Step(DVec2::new(0.5, 0.0)));
        assert!(!state.tick(0.0));
        assert!((state.camera.center[0].to_f64() - std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn a_box_fills_the_canvas() {
        let mut state = state();
        state.look.animate = false;
        let corners = [DVec2::new(100.0, 100.0), DVec2::new(420.0, 300.0)];
        let middle = state.screen().angle_at((corners[0] + corners[1]) / 2.0);
        state.look(Look::Box(corners));
        assert!((state.camera.width_rad - std::f64::consts::TAU / 4.0).abs() < 1e-12);
        assert!(state.camera.offset_of(middle).length() < 1e-12);
        let before = state.camera;
        state.look(Look::Box([DVec2::ZERO, DVec2::ONE]));
        assert_eq!(state.camera, before, "a click that trembled");
    }

    #[test]
    fn a_bad_paste_is_told_and_the_view_stays() {
        let mut state = state();
        let before = state.camera;
        assert!(!state.paste("https://example.org"));
        assert!(state.notices.iter().next().unwrap().text.contains("not a location"));
        assert_eq!(state.target(), before);
        assert!(!state.paste("flipmap:center=-1.66,0.1;width=0.4;budget=60"));
        assert_eq!((state.question.budget.secs, state.target().width_rad), (60.0, 0.4));
    }

    #[test]
    fn a_picture_is_computed_as_it_was_made() {
        let mut state = state();
        let mut document = Document::default();
        assert!(!state.show(&document));
        document.run.method = Some("rk4".to_string());
        assert!(state.show(&document), "another engine");
        let IntegrationSetting::Explicit(config) = state.integration.spec.setting else {
            panic!("{:?}", state.integration.spec.setting)
        };
        assert_eq!(config.method, Method::LESSON);
        assert_eq!(state.document().run.step.as_deref(), Some("1/120"));
        document.run.tolerance = Some("much".to_string());
        assert!(!state.show(&document));
        assert!(state.notices.iter().next().unwrap().text.contains("`tolerance`"));
    }

    #[test]
    fn the_location_leads_back() {
        let mut state = state();
        state.look.animate = false;
        state.look(Look::Zoom { factor: 1e6, about: DVec2::new(211.0, 37.0) });
        let text = state.copied_location();
        let there = state.camera;
        state.look(Look::Home);
        state.paste(&text);
        assert!(state.camera.offset_of(there.center).length() < 1e-5 * there.width_rad);
        assert_eq!(state.camera.width_rad, there.width_rad);
    }

    #[test]
    fn another_plane_begins_at_home_and_another_question_in_its_own_colours() {
        let mut state = state();
        state.look.animate = false;
        let ask = |state: &mut AppState, change: fn(&mut Scene)| {
            let mut scene = state.scene();
            change(&mut scene);
            state.ask(&scene);
        };
        state.look(Look::Zoom { factor: 8.0, about: DVec2::new(90.0, 10.0) });
        let before = state.camera;
        ask(&mut state, |scene| scene.question.ask = QuestionName::State);
        assert_eq!(state.camera, before);
        state.picture.channel = Some("omega1".to_string());
        ask(&mut state, |scene| scene.question.ask = QuestionName::Flip);
        assert_eq!(state.picture.channel, None, "flips have no speeds");
        ask(&mut state, |scene| scene.plane.kind = "speeds".parse().unwrap());
        assert_eq!(state.camera, Camera::whole(state.camera.reach));
        assert!(!state.camera.reach.repeats && !state.history.has_back());
        // A faster pendulum has a larger lattice, but the view shows the same starts.
        state.look(Look::Zoom { factor: 4.0, about: DVec2::ZERO });
        let (width, reach) = (state.camera.width(), state.camera.reach);
        ask(&mut state, |scene| scene.build.gravity = 981.0.into());
        assert!(state.camera.reach != reach && (state.camera.width() / width - 1.0).abs() < 1e-9);
    }

    #[test]
    fn palettes_and_layers_are_not_part_of_the_aim() {
        let mut state = state();
        let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
        let before = state.view_target(config);
        let picture = PictureTable { palette: "magma".to_string(), ..state.picture.clone() };
        state.paint(picture);
        state.layers.grid = true;
        assert_eq!(state.view_target(config), before);
        let question = QuestionSettings { budget: Budget::secs(60.0), ..state.question };
        let scene = Scene { question, ..state.scene() };
        state.ask(&scene);
        assert_ne!(state.view_target(config), before);
    }
}
