//! The app model: a window's plain state, the compute service, the map renderer, and what is saved
//! on disk; everything except the window itself. Any egui context can show it, so tests need no
//! window.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Ui;

use super::action::Action;
use super::commands::{choices, commands};
use super::compute_service::{ComputeService, Wake};
use super::dialog::FileDialog;
use super::exploring::Exploring;
use super::exports::Exports;
use super::film::Films;
use super::film_run::FilmCommand;
use super::folders::Folders;
use super::greeting::Greeting;
use super::histogram::TimesInView;
use super::in_view::InView;
use super::kept_keys::KeptKeys;
use super::keys::pressed;
use super::meter::Meter;
use super::outlook::Estimates;
use super::panels::export::ExportForm;
use super::panels::places::{PlaceForm, Thumbnails};
use super::panels::status::status_line;
use super::panels::timeline::timeline;
use super::panels::view::ViewForm;
use super::panels::{command_palette, help, notices};
use super::places::Places;
use super::saving::LastSave;
use super::screen_picture::SavedPictures;
use super::settings::{Appearance, Settings};
use super::state::{AppState, Effect};
use super::store::{Loaded, Store};
use super::swing::HoverSwing;
use flipmap_engine::choice::EngineRequest;
use flipmap_engine::run_settings::RunSpec;
use flipmap_lab::{Figure, Lab};
use flipmap_render::tiles::explorer::ViewProgress;
use flipmap_scene::{BuiltIn, Document, RunTable};
use flipmap_screen::canvas::MapRenderer;
use flipmap_screen::spread::ColourSpread;

/// Options for opening a window.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// Document to show; if none, that of the last session or the home scene.
    pub document: Option<Document>,
    /// Set-up of a figure of the laboratory to open with, as a line of text.
    pub set_up: Option<String>,
    /// Run table to use; if none, that of the document shown.
    pub run: Option<RunTable>,
    /// Engine to use; its integration setting follows from the run table.
    pub request: EngineRequest,
    /// Folders of the settings and bookmarks.
    pub folders: Folders,
    /// File for the window's own measurements, written at rest and when it closes.
    pub stats: Option<PathBuf>,
    /// Command that makes a film; without one, the window only plans films.
    pub film_command: Option<FilmCommand>,
}

/// The open file dialog, by its purpose.
pub(super) enum Asking {
    Open(FileDialog),
    Export(FileDialog),
    Film(FileDialog),
}

impl Asking {
    /// Returns what the user can do where the desktop has no file dialog.
    pub(super) fn instead(&self) -> &'static str {
        match self {
            Asking::Open(_) => "drop the file on the window, or name it: flipmap explore FILE",
            Asking::Export(_) => "type the path in the field File under Export",
            Asking::Film(_) => "type the path in the field Film to under Film",
        }
    }
}

/// The forms that the user has begun to fill in.
#[derive(Default)]
pub(super) struct Forms {
    pub(super) place: PlaceForm,
    pub(super) view: ViewForm,
    pub(super) export: ExportForm,
    /// True while the form of an export is open, so that its frame is drawn on the map.
    pub(super) exporting: bool,
    /// Width in points of the drawer that lies over the map.
    pub(super) drawer_points: f32,
    /// Control that had the keyboard's focus in the last frame.
    pub(super) focused: Option<egui::Id>,
}

/// The app model behind a window.
pub struct AppModel {
    /// Plain state that is shown.
    pub state: AppState,
    /// Service that computes the map.
    pub compute: ComputeService,
    pub(super) map_renderer: MapRenderer,
    pub(super) swing: HoverSwing,
    pub(super) greeting: Greeting,
    pub(super) in_view: InView,
    pub(super) meter: Meter,
    pub(super) store: Store,
    /// Settings kept between runs.
    pub settings: Settings,
    pub(super) places: Places,
    pub(super) forms: Forms,
    pub(super) thumbnails: Thumbnails,
    pub(super) saved_pictures: SavedPictures,
    pub(super) exploring: Exploring,
    pub(super) exports: Exports,
    pub(super) asking: Option<Asking>,
    /// Films, and the descent that may become one.
    pub films: Films,
    pub(super) estimates: Estimates,
    /// Figures of the laboratory.
    pub lab: Lab,
    pub(super) request: EngineRequest,
    pub(super) wake: Wake,
    pub(super) saved: LastSave,
    pub(super) kept_keys: KeptKeys,
    /// Lines for the debug panel, set by the owner of the window.
    pub measured: Vec<String>,
    pub(super) spread: ColourSpread,
    pub(super) times_in_view: TimesInView,
}

/// Time that a frame may spend on preparing jobs.
const WORK: Duration = Duration::from_millis(4);

/// Time between updates of the status line during slow work.
const DOING: Duration = Duration::from_millis(250);

impl AppModel {
    /// Loads what was saved, begins to open an engine, and opens the figure that is to be shown.
    pub fn new(options: &WindowOptions, wake: Wake) -> Self {
        let mut model = AppModel::with_map(options, wake);
        if let Some(set_up) = &options.set_up {
            model.paste(set_up);
        }
        model
    }

    fn with_map(options: &WindowOptions, wake: Wake) -> Self {
        let mut store = Store::new(&options.folders);
        let Loaded { settings, notice } = store.load();
        let last = settings.last_scene.clone().filter(|_| settings.restore);
        let mut document =
            (options.document.clone().or(last)).unwrap_or_else(|| BuiltIn::home().document());
        let resolved = RunSpec::resolve(options.run.as_ref().unwrap_or(&document.run).clone());
        let problem = resolved.as_ref().err().map(ToString::to_string);
        let spec = resolved.unwrap_or_default();
        let (setting, verify) = (spec.setting, spec.verify);
        document.run = spec.table.clone();
        let mut state = AppState::new(&document, spec);
        state.integration.kind = options.request.kind;
        state.look = Appearance::of(&settings);
        // A window that keeps nothing would greet its user each time.
        state.shown.greeting = !settings.greeted && store.keeps();
        state.layers = if options.document.is_none() { settings.layers } else { state.layers };
        for problem in notice.into_iter().chain(problem) {
            state.notices.fail(problem);
        }
        let mut draft = settings.film.draft();
        let mut kept_keys = KeptKeys::new(&options.folders);
        match kept_keys.load(&mut draft) {
            Ok(told) => told.into_iter().for_each(|told| state.notices.tell(told)),
            Err(problem) => state.notices.fail(problem),
        }
        let cache_bytes = (settings.cache_mib as usize) << 20;
        let request = EngineRequest { setting, verify, ..options.request.clone() }
            .answering(&document.question);
        let compute = ComputeService::new(request.clone(), cache_bytes, Arc::clone(&wake));
        let places = Places::load(&options.folders);
        AppModel {
            state,
            compute,
            map_renderer: MapRenderer::default(),
            swing: HoverSwing::default(),
            greeting: Greeting::default(),
            in_view: InView::default(),
            meter: Meter::default(),
            store,
            settings,
            forms: Forms { place: PlaceForm::named(places.free_name()), ..Forms::default() },
            places,
            thumbnails: Thumbnails::default(),
            saved_pictures: SavedPictures::default(),
            exploring: Exploring::default(),
            exports: Exports::default(),
            asking: None,
            films: Films { draft, command: options.film_command, ..Films::default() },
            estimates: Estimates::default(),
            lab: Lab::new(Figure::Machine),
            request,
            wake,
            saved: LastSave::none(),
            kept_keys,
            measured: Vec::new(),
            spread: ColourSpread::default(),
            times_in_view: TimesInView::default(),
        }
    }

    /// Sets the view target of the engine and takes what it has finished. Returns true if there is
    /// anything new to draw.
    pub fn work(&mut self) -> bool {
        let told = self.tell_of_pictures();
        // A hidden map can wait.
        if self.lab_hides_map() {
            return told;
        }
        let (state, wake) = (&mut self.state, &self.wake);
        let settled = self.compute.config().is_some_and(|config| state.make_answerable(config))
            || self.estimates.auto_budget.fit(state, wake);
        let descent = &self.films.descent;
        let target = |config| descent.passing(state.view_target(config));
        let turn = self.compute.turn(target, Instant::now() + WORK);
        self.meter.read(Instant::now(), self.compute.explorer.counts().simulated);
        if let Some(failure) = turn.failure {
            state.notices.fail(failure);
            return true;
        }
        if turn.news {
            state.tell_pins(&mut self.compute.explorer);
        }
        let progress = self.compute.explorer.progress();
        self.estimates.time_left.read(state.target(), &progress, Instant::now());
        let news = self.films.follow_descent(state, progress.share);
        // Views passed during a descent are left before anyone could read a warning about them.
        let stays = self.films.descent.running.is_none();
        let complete = progress.idle && progress.wanted > 0;
        let spread = self.spread_colours();
        let (state, wake) = (&mut self.state, &self.wake);
        let config = self.compute.config().filter(|_| complete && stays);
        let foreseen = self.estimates.forecast.follow(state, config, wake);
        if complete {
            self.see_view();
        }
        told || settled || turn.news || spread || news || foreseen
    }

    /// Spreads the colours over the view's times if they follow it; returns true if they have
    /// changed.
    pub(super) fn spread_colours(&mut self) -> bool {
        let progress = self.compute.explorer.progress();
        let complete = progress.idle && progress.wanted > 0;
        let (screen, scene) = (self.state.screen(), self.state.scene());
        let at = (self.state.now_secs, complete);
        let explorer = &mut self.compute.explorer;
        self.spread.follow((&screen, &scene), &mut self.state.picture, explorer, at)
    }

    /// Returns the progress of the view.
    pub fn progress(&self) -> ViewProgress {
        self.compute.explorer.progress()
    }

    /// Forgets what was on the lost graphics device, so that everything is uploaded again.
    pub(crate) fn forget_card(&mut self) {
        self.map_renderer = MapRenderer::default();
        self.thumbnails = Thumbnails::default();
        self.exploring.forget_card();
    }

    /// Shows the whole interface once. Returns the effects that only the window can carry out.
    pub fn show(&mut self, ui: &mut Ui) -> Vec<Effect> {
        let ctx = ui.ctx().clone();
        let mut actions = self.keys(&ctx);
        actions.extend(self.films.play(&ctx, &mut self.state));
        let mut commands = commands(&self.state);
        if self.state.shown.commands {
            commands.extend(choices(&self.state.picture, &self.settings.palettes));
            actions.extend(command_palette::palette(&ctx, &commands, &mut self.settings));
        } else {
            command_palette::close(&ctx);
        }
        if self.state.shown.help {
            actions.extend(help::help(&ctx, &commands));
        }
        actions.extend(self.ask_before_leaving(&ctx));
        actions.extend(notices::notices(&ctx, &self.state.notices, self.state.now_secs));
        // The line tells of the map, which a figure hides.
        if !self.is_projecting() && !self.lab_hides_map() {
            let status = self.status();
            if status.doing.is_some() {
                ctx.request_repaint_after(DOING);
            }
            egui::Panel::bottom("status").show(ui, |ui| status_line(ui, &status));
        }
        if self.lab_hides_map() {
            // Drawn on the cleared frame without a fill: filling a window twice costs a software
            // renderer half its frames.
            let frame = egui::Frame::NONE.inner_margin(8);
            egui::CentralPanel::default()
                .frame(frame)
                .show(ui, |ui| actions.extend(self.figure(ui)));
            return self.act(actions);
        }
        if self.state.shown.lab {
            egui::Panel::top("figures").show(ui, |ui| actions.extend(self.figure_tabs(ui)));
            actions.extend(self.explanation(&ctx));
        }
        self.forms.exporting = false;
        self.forms.drawer_points = 0.0;
        if self.state.shown.side && !self.state.shown.stage && !self.is_projecting() {
            actions.extend(self.side(ui));
        }
        if let Some(clock) = &self.state.shown.timeline {
            let budget_secs = self.state.question.budget.secs;
            egui::Panel::bottom("timeline")
                .show(ui, |ui| actions.extend(timeline(ui, clock, budget_secs)));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| match self.state.shown.stage {
            true => actions.extend(self.whole_stage(ui)),
            false => actions.extend(self.canvas(ui, &commands)),
        });
        self.act(actions)
    }

    /// Returns the actions that the keyboard, the clipboard and dropped files ask for.
    fn keys(&self, ctx: &egui::Context) -> Vec<Action> {
        // An open menu takes Escape and the arrows for itself.
        let typing = ctx.egui_wants_keyboard_input() || egui::Popup::is_any_open(ctx);
        let hidden = self.lab_hides_map();
        ctx.input_mut(|input| {
            let mut actions = pressed(input, &self.state, typing);
            actions.retain(|action| !hidden || !action.is_of_map());
            for event in &input.events {
                if let (egui::Event::Paste(text), false) = (event, typing) {
                    actions.push(Action::Paste(text.clone()));
                }
                if matches!(event, egui::Event::Copy) && !typing && !hidden {
                    actions.push(Action::CopyPicture);
                }
            }
            let dropped = input.raw.dropped_files.iter();
            actions.extend(dropped.map(|file| Action::Open(file.path().to_path_buf())));
            actions
        })
    }
}
