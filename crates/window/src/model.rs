//! The app model: a window's plain state, the compute service, the map renderer, and what is saved
//! on disk; everything except the window itself. Any egui context can show it, so tests need no
//! window.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Ui;

use super::action::Action;
use super::canvas::MapRenderer;
use super::commands::{choices, commands};
use super::compute_service::{ComputeService, Wake};
use super::dialog::FileDialog;
use super::exports::Exports;
use super::film::Films;
use super::film_run::FilmCommand;
use super::folders::Folders;
use super::in_view::InView;
use super::keys::pressed;
use super::meter::Meter;
use super::outlook::Estimates;
use super::panels::export::ExportForm;
use super::panels::pendulum::stage;
use super::panels::places::{PlaceForm, Thumbnails};
use super::panels::status::{StatusLine, depth_words, status_line};
use super::panels::timeline::timeline;
use super::panels::view::ViewForm;
use super::panels::{accuracy, card, help, notices};
use super::places::Places;
use super::settings::{Appearance, Loaded, Settings, Store};
use super::spread::ColourSpread;
use super::state::{AppState, Effect};
use super::swing::HoverSwing;
use flipmap_engine::choice::EngineRequest;
use flipmap_engine::run_settings::RunSpec;
use flipmap_lab::{Figure, Lab};
use flipmap_render::tiles::explorer::ViewProgress;
use flipmap_scene::{BuiltIn, Document, RunTable};

/// Options for opening a window.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// Document to show; if none, that of the last session or the home scene.
    pub document: Option<Document>,
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

/// The forms that the user has begun to fill in.
#[derive(Default)]
pub(super) struct Forms {
    pub(super) place: PlaceForm,
    pub(super) view: ViewForm,
    pub(super) export: ExportForm,
    /// True while the form of an export is open, so that its frame is drawn on the map.
    pub(super) exporting: bool,
}

/// The app model behind a window.
pub struct AppModel {
    /// Plain state that is shown.
    pub state: AppState,
    /// Service that computes the map.
    pub compute: ComputeService,
    pub(super) map_renderer: MapRenderer,
    pub(super) swing: HoverSwing,
    pub(super) in_view: InView,
    pub(super) meter: Meter,
    pub(super) store: Store,
    /// Settings kept between runs.
    pub settings: Settings,
    pub(super) places: Places,
    pub(super) forms: Forms,
    pub(super) thumbnails: Thumbnails,
    pub(super) exports: Exports,
    pub(super) asking: Option<Asking>,
    /// Films, and the descent that may become one.
    pub films: Films,
    pub(super) estimates: Estimates,
    /// Figures of the laboratory.
    pub lab: Lab,
    pub(super) request: EngineRequest,
    pub(super) wake: Wake,
    saved: LastSave,
    /// Lines for the debug panel, set by the owner of the window.
    pub measured: Vec<String>,
    pub(super) spread: ColourSpread,
}

/// The settings that the file holds, and the time of the last save.
struct LastSave {
    settings: Option<Settings>,
    at: Instant,
}

/// Time between saves of the settings while the window is used.
const SAVE_EVERY: Duration = Duration::from_secs(20);
/// Time that a frame may spend on preparing jobs.
const WORK: Duration = Duration::from_millis(4);

/// Time between updates of the status line during slow work.
const DOING: Duration = Duration::from_millis(250);

/// Returns the least, default and greatest width in points of the panels at the side of a window;
/// the map keeps more than half of a narrow window.
fn side_widths(window: f32) -> [f32; 3] {
    if window < 700.0 {
        return [0.25, 0.38, 0.45].map(|share| share * window);
    }
    [240.0, 310.0, 480.0]
}

impl AppModel {
    /// Loads what was saved and begins to open an engine.
    pub fn new(options: &WindowOptions, wake: Wake) -> Self {
        let mut store = Store::new(&options.folders);
        let Loaded { settings, notice } = store.load();
        let last = settings.last_scene.clone().filter(|_| settings.restore);
        let document = options.document.clone().or(last);
        let mut document = document.unwrap_or_else(|| BuiltIn::home().document());
        let words = options.run.as_ref().unwrap_or(&document.run).clone();
        let resolved = RunSpec::resolve(words);
        let problem = resolved.as_ref().err().map(ToString::to_string);
        let spec = resolved.unwrap_or_default();
        let (setting, verify) = (spec.setting, spec.verify);
        document.run = spec.table.clone();
        let mut state = AppState::new(&document, spec);
        state.integration.kind = options.request.kind;
        let Settings { animate, theme, ui_scale, edges, .. } = settings;
        state.look = Appearance { animate, theme, ui_scale, edges };
        // A window that keeps nothing would greet its user each time.
        state.shown.card = !settings.greeted && store.keeps();
        if options.document.is_none() {
            state.layers = settings.layers;
        }
        for problem in notice.into_iter().chain(problem) {
            state.notices.fail(problem);
        }
        let cache_bytes = (settings.cache_mib as usize) << 20;
        let request = EngineRequest { setting, verify, ..options.request.clone() };
        let request = request.answering(&document.question);
        let compute = ComputeService::new(request.clone(), cache_bytes, Arc::clone(&wake));
        let places = Places::load(&options.folders);
        AppModel {
            state,
            compute,
            map_renderer: MapRenderer::default(),
            swing: HoverSwing::default(),
            in_view: InView::default(),
            meter: Meter::default(),
            store,
            settings,
            forms: Forms { place: PlaceForm::named(places.free_name()), ..Forms::default() },
            places,
            thumbnails: Thumbnails::default(),
            exports: Exports::default(),
            asking: None,
            films: Films { command: options.film_command, ..Films::default() },
            estimates: Estimates::default(),
            lab: Lab::new(Figure::Machine),
            request,
            wake,
            saved: LastSave { settings: None, at: Instant::now() },
            measured: Vec::new(),
            spread: ColourSpread::default(),
        }
    }

    /// Sets the view target of the engine and takes what it has finished. Returns true if there is
    /// anything new to draw.
    pub fn work(&mut self) -> bool {
        // A hidden map can wait.
        if self.lab_hides_map() {
            return false;
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
        settled || turn.news || spread || news || foreseen
    }

    /// Spreads the colours over the view's times if they follow it; returns true if they have
    /// changed.
    pub(super) fn spread_colours(&mut self) -> bool {
        let progress = self.compute.explorer.progress();
        let complete = progress.idle && progress.wanted > 0;
        self.spread.follow(&mut self.state, &mut self.compute.explorer, complete)
    }

    /// Returns the progress of the view.
    pub fn progress(&self) -> ViewProgress {
        self.compute.explorer.progress()
    }

    /// Forgets what was on the lost graphics device, so that everything is uploaded again.
    pub(crate) fn forget_card(&mut self) {
        self.map_renderer = MapRenderer::default();
        self.thumbnails = Thumbnails::default();
    }

    /// Shows the whole interface once. Returns the effects that only the window can carry out.
    pub fn show(&mut self, ui: &mut Ui) -> Vec<Effect> {
        let ctx = ui.ctx().clone();
        let mut actions = self.keys(&ctx);
        actions.extend(self.films.play(&ctx, &mut self.state));
        let mut commands = commands(&self.state);
        if self.state.shown.commands {
            commands.extend(choices(&self.state.picture));
            actions.extend(help::palette(&ctx, &commands));
        } else {
            help::close_palette(&ctx);
        }
        if self.state.shown.help {
            actions.extend(help::help(&ctx, &commands));
        }
        if self.state.shown.card {
            actions.extend(card::card(&ctx));
        }
        actions.extend(notices::notices(&ctx, &self.state.notices, self.state.now_secs));
        let status = self.status();
        if status.doing.is_some() {
            ctx.request_repaint_after(DOING);
        }
        if !self.is_projecting() {
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
        if self.state.shown.side && !self.state.shown.stage && !self.is_projecting() {
            let [least, default, most] = side_widths(ui.available_width());
            let side = egui::Panel::right("side").default_size(default).size_range(least..=most);
            side.show(ui, |ui| actions.extend(self.side_panel(ui)));
        }
        if let Some(clock) = &self.state.shown.timeline {
            let budget_secs = self.state.question.budget.secs;
            egui::Panel::bottom("timeline")
                .show(ui, |ui| actions.extend(timeline(ui, clock, budget_secs)));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| match self.state.shown.stage {
            true => actions.extend(stage(ui, &self.state.pins).into_iter().map(Action::Pins)),
            false => actions.extend(self.canvas(ui, &commands)),
        });
        self.act(actions)
    }

    /// Returns the actions that the keyboard, the clipboard and dropped files ask for.
    fn keys(&self, ctx: &egui::Context) -> Vec<Action> {
        let typing = ctx.egui_wants_keyboard_input();
        let hidden = self.lab_hides_map();
        ctx.input_mut(|input| {
            let mut actions = pressed(input, &self.state, typing);
            actions.retain(|action| !hidden || !action.is_of_map());
            for event in &input.events {
                if let (egui::Event::Paste(text), false) = (event, typing) {
                    actions.push(Action::Paste(text.clone()));
                }
            }
            let dropped = input.raw.dropped_files.iter();
            actions.extend(dropped.map(|file| Action::Open(file.path().to_path_buf())));
            actions
        })
    }

    fn status(&self) -> StatusLine {
        let progress = self.progress();
        let engine = match (self.compute.engine(), self.compute.config()) {
            (Some((name, adapter, _)), Some(config)) => {
                format!("{} · {name}: {adapter}", accuracy::words(&config))
            }
            _ => match self.compute.opening() {
                Some(said) if said.is_empty() => "opening the engine…".to_string(),
                Some(said) => said,
                None => "no engine: see Accuracy".to_string(),
            },
        };
        let rate = if progress.idle { 0.0 } else { self.meter.rate() };
        let simulated = self.compute.explorer.counts().simulated;
        let depth = self.compute.explorer.depth().zip(self.compute.config());
        let budget_secs = self.state.question.budget.secs;
        let depth = depth.map(|(depth, config)| depth_words(&depth, config.precision, budget_secs));
        let (width, [across, _]) = (self.state.camera.width(), self.state.plane.axes());
        let unit = across.unit();
        let diving =
            self.films.descent.running.is_some().then(|| "going deeper, Esc stops".to_string());
        let smooths = progress.refines && !self.lab_hides_map();
        let smooths = smooths.then(|| "smoothing edges".to_string());
        let doing = self.compute.following().or(diving).or(self.compute.comparing()).or(smooths);
        let flat = self.spread.flat_secs().map(|secs| {
            format!("flat to {secs:.0e} s: nothing smaller here; D follows the nearest filament")
        });
        let doing = doing.or(flat);
        let warning = self.estimates.forecast.warning();
        let left_secs = self.estimates.time_left.secs();
        StatusLine {
            progress,
            left_secs,
            width,
            unit,
            rate,
            simulated,
            engine,
            depth,
            doing,
            warning,
        }
    }

    /// Saves the settings, including how the window was left.
    pub fn save(&mut self) {
        let AppState { look, layers, shown, .. } = &self.state;
        let Appearance { animate, theme, ui_scale, edges } = *look;
        let greeted = self.settings.greeted || !shown.card;
        let settings = self.settings.clone();
        self.settings =
            Settings { animate, theme, ui_scale, edges, layers: *layers, greeted, ..settings };
        self.settings.last_scene = Some(self.state.document());
        self.saved.at = Instant::now();
        if self.saved.settings.as_ref() == Some(&self.settings) {
            return;
        }
        if let Err(error) = self.store.save(&self.settings) {
            log::error!("the settings could not be kept: {error}");
        }
        self.saved.settings = Some(self.settings.clone());
    }

    /// Saves the settings if the last save is some time ago, so that a crash loses little.
    pub(crate) fn save_sometimes(&mut self) {
        if self.saved.at.elapsed() > SAVE_EVERY {
            self.save();
        }
    }
}
