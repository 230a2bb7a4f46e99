//! Everything a window holds but the window itself: the plain state, the compute service, the map renderer,
//! and what is kept on disk. It shows itself in any egui, so tests need no window.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Ui;

use super::action::Action;
use super::camera::Camera;
use super::canvas::MapRenderer;
use super::canvas::colours::colours;
use super::commands::{commands, pressed};
use super::compute_service::{ComputeService, Wake};
use super::descent::DescentPath;
use super::dialog::FileDialog;
use super::export::Export;
use super::folders::Folders;
use super::hover;
use super::map::{Hovered, map};
use super::meter::Meter;
use super::outlook::Forecast;
use super::panels::export::ExportForm;
use super::panels::places::{PlaceForm, Thumbnails};
use super::panels::status::{StatusLine, depth_words, status_line};
use super::panels::{accuracy, help, notices};
use super::places::Places;
use super::settings::{Loaded, Settings, Store};
use super::state::{AppState, Effect};
use super::view_samples;
use crate::engine::choice::EngineRequest;
use crate::engine::run_settings;
use crate::lab::{Figure, Lab};
use crate::scene::palette::equalised;
use crate::scene::{Document, PictureTable, RunTable};
use crate::tiles::explorer::ViewProgress;

/// How a window is opened.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// What it shows; where the window was left, if nothing is said.
    pub document: Option<Document>,
    /// How it is computed, as words; as where the window was left, if nothing is said.
    pub run: Option<RunTable>,
    /// Which engine; what it is to compute follows from the words.
    pub request: EngineRequest,
    /// Where settings and bookmarks are.
    pub folders: Folders,
    /// Where the window writes what it measured of itself when it closes.
    pub stats: Option<PathBuf>,
}

/// What the file dialog was opened for.
pub(super) enum Asking {
    Open(FileDialog),
    Export(FileDialog),
}

/// The things of a window.
pub struct AppModel {
    /// What is shown.
    pub state: AppState,
    /// What computes it.
    pub compute: ComputeService,
    pub(super) map_renderer: MapRenderer,
    pub(super) meter: Meter,
    pub(super) store: Store,
    /// What is kept between runs.
    pub settings: Settings,
    pub(super) places: Places,
    pub(super) place_form: PlaceForm,
    pub(super) thumbnails: Thumbnails,
    pub(super) exports: Vec<Export>,
    pub(super) export_form: ExportForm,
    pub(super) asking: Option<Asking>,
    pub(super) descent: DescentPath,
    pub(super) forecast: Forecast,
    /// The figures of the lesson.
    pub lab: Lab,
    pub(super) request: EngineRequest,
    pub(super) wake: Wake,
    /// What the file holds, and since when.
    saved: Option<Settings>,
    saved_at: Instant,
    /// Lines for the debug panel, from whoever owns the window.
    pub measured: Vec<String>,
    /// The view that deep colours were last spread over, and whether at its finest level.
    spread_for: Option<(Camera, bool)>,
}

/// How often the settings are kept while the window is used.
const SAVE_EVERY: Duration = Duration::from_secs(20);
/// How long a frame may prepare jobs.
const WORK: Duration = Duration::from_millis(4);

/// Levels above the finest whose times will do for the colours of a deep view.
const COARSER: u32 = 3;
/// How often the line below tells of what takes longer.
const DOING: Duration = Duration::from_millis(250);

impl AppModel {
    /// Reads what was kept and begins to open an engine.
    pub fn new(options: &WindowOptions, wake: Wake) -> Self {
        let mut store = Store::new(&options.folders);
        let Loaded { settings, notice } = store.load();
        let last = settings.last_scene.clone().filter(|_| settings.restore);
        let mut document = options.document.clone().or(last).unwrap_or_default();
        let words = options.run.as_ref().unwrap_or(&document.run).clone();
        let resolved = run_settings::resolve(words);
        let problem = resolved.as_ref().err().map(ToString::to_string);
        let (setting, run) = resolved.unwrap_or_default();
        let verify = run_settings::verifies(setting, &run);
        document.run = run;
        let mut state = AppState::new(&document, setting, verify);
        state.kind = options.request.kind;
        (state.animate, state.theme, state.ui_scale) =
            (settings.animate, settings.theme, settings.ui_scale);
        if options.document.is_none() {
            state.layers = settings.layers;
        }
        for problem in notice.into_iter().chain(problem) {
            state.notices.fail(problem);
        }
        let cache_bytes = (settings.cache_mib as usize) << 20;
        let request = EngineRequest { setting, ..options.request.clone() };
        let compute = ComputeService::new(request.clone(), verify, cache_bytes, Arc::clone(&wake));
        let places = Places::load(&options.folders);
        AppModel {
            state,
            compute,
            map_renderer: MapRenderer::default(),
            meter: Meter::default(),
            store,
            settings,
            place_form: PlaceForm { name: places.free_name(), ..PlaceForm::default() },
            places,
            thumbnails: Thumbnails::default(),
            exports: Vec::new(),
            export_form: ExportForm::default(),
            asking: None,
            descent: DescentPath::default(),
            forecast: Forecast::default(),
            lab: Lab::new(Figure::Machine),
            request,
            wake,
            saved: None,
            saved_at: Instant::now(),
            measured: Vec::new(),
            spread_for: None,
        }
    }

    /// Aims the engine at what is looked at and takes what it has finished. Says whether there
    /// is anything new to draw.
    pub fn work(&mut self) -> bool {
        // What nobody sees has time.
        if self.lab_hides_map() {
            return false;
        }
        let state = &self.state;
        let turn = self.compute.turn(|config| state.view_target(config), Instant::now() + WORK);
        self.meter.read(Instant::now(), self.compute.explorer.counts().simulated);
        if let Some(failure) = turn.failure {
            self.state.notices.fail(failure);
            return true;
        }
        if turn.news {
            self.tell_pins();
        }
        let spread = self.spread_colours();
        let news = self.follow_descent();
        let foreseen = self.foresee();
        turn.news || spread || news || foreseen
    }

    /// Spreads the palette over the times of a deep view, once it is whole at a coarse level and
    /// again at the finest: they lie so close together that it would look flat. What a person
    /// chose is left alone. Says whether the colours have changed.
    fn spread_colours(&mut self) -> bool {
        let camera = self.state.target();
        if camera.width_rad >= PictureTable::SPREAD_BELOW_RAD {
            let clear = self.state.spreads && !self.state.picture.times.is_empty();
            if clear {
                self.state.picture.times = Vec::new();
            }
            self.state.spreads = self.state.picture.times.is_empty();
            self.spread_for = None;
            return clear;
        }
        if !self.state.spreads || self.state.moving.is_some() {
            return false;
        }
        let near = |then: &Camera| {
            let moved = then.offset_of(camera.center).length() < 0.25 * camera.width_rad;
            moved && (then.width_rad / camera.width_rad).ln().abs() < 0.3
        };
        // Whether that was at the finest level.
        let spread = self.spread_for.filter(|(then, _)| near(then)).map(|(_, fine)| fine);
        if spread == Some(true) {
            return false;
        }
        let (screen, explorer) = (self.state.screen(), &mut self.compute.explorer);
        let Some(level) = view_samples::whole_level(&screen, COARSER, explorer) else {
            return false;
        };
        let finest = level == screen.level();
        if spread.is_some() && !finest {
            return false;
        }
        self.spread_for = Some((camera, finest));
        let times = view_samples::times_at(&screen, level, explorer);
        let times = equalised(times.into_iter(), PictureTable::SPREAD_STEPS);
        let change = !times.is_empty();
        if change {
            self.state.picture.times = times;
        }
        change
    }

    /// Tells pins what the map has come to know of their pixels.
    fn tell_pins(&mut self) {
        let (level, budget_secs) = (self.state.screen().level(), self.state.question.budget.secs);
        let silent = self.state.pins.iter().filter(|pin| pin.told.is_none());
        let silent: Vec<_> = silent.map(|pin| (pin.id, pin.start)).collect();
        for (id, start) in silent {
            // Another level has other samples, and other answers.
            if hover::sample_at(start, level)[0] == start
                && let Some(told) =
                    hover::outcome_at(&mut self.compute.explorer, start, level, budget_secs)
            {
                self.state.pins.tell(id, told);
            }
        }
    }

    /// How far the view is.
    pub fn progress(&self) -> ViewProgress {
        self.compute.explorer.progress()
    }

    /// The card's things are gone: everything is put there again.
    pub fn forget_card(&mut self) {
        self.map_renderer = MapRenderer::default();
        self.thumbnails = Thumbnails::default();
    }

    /// One pass of the whole interface. Returns what only the window can do.
    pub fn show(&mut self, ui: &mut Ui) -> Vec<Effect> {
        let ctx = ui.ctx().clone();
        let mut actions = self.keys(&ctx);
        let commands = commands(&self.state);
        if self.state.shown.commands {
            actions.extend(help::palette(&ctx, &commands));
        } else {
            help::close_palette(&ctx);
        }
        if self.state.shown.help {
            actions.extend(help::help(&ctx, &commands));
        }
        actions.extend(notices::notices(&ctx, &self.state.notices));
        let status = self.status();
        if status.doing.is_some() {
            ctx.request_repaint_after(DOING);
        }
        egui::Panel::bottom("status").show(ui, |ui| status_line(ui, &status));
        if self.lab_hides_map() {
            // On what the frame was cleared with: to fill a window twice costs a program that
            // draws in software half its frames.
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
        if self.state.shown.side {
            let side = egui::Panel::right("side").default_size(310.0).size_range(240.0..=480.0);
            side.show(ui, |ui| actions.extend(self.side_panel(ui)));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| actions.extend(self.canvas(ui)));
        self.act(actions)
    }

    /// What the keyboard, the clipboard and dropped files ask for.
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

    fn canvas(&mut self, ui: &mut Ui) -> Vec<Action> {
        let size = ui.available_size_before_wrap();
        self.state.canvas =
            glam::DVec2::new(f64::from(size.x), f64::from(size.y)).max(glam::DVec2::ONE);
        self.state.pixels_per_point = f64::from(ui.ctx().pixels_per_point());
        let screen = self.state.screen();
        let AppState { picture, build, question, layers, .. } = &self.state;
        let (uniforms, table) = match colours(picture, build, question, layers.trust) {
            Ok(colours) => colours,
            // A picture table is checked before it gets here.
            Err(error) => {
                ui.label(error.to_string());
                return Vec::new();
            }
        };
        let frame = self.map_renderer.frame(&screen, &mut self.compute.explorer, uniforms, table);
        let hovered = self.state.pointer.map(|point| {
            let (explorer, level) = (&mut self.compute.explorer, screen.level());
            let [start, _] = hover::sample_at(screen.angle_at(point), level);
            let outcome =
                hover::outcome_at(explorer, start, level, self.state.question.budget.secs);
            Hovered { start, outcome }
        });
        map(ui, &self.state, frame, hovered)
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
        let width_rad = self.state.camera.width_rad;
        let diving = self.descent.running.is_some().then(|| "going deeper, Esc stops".to_string());
        let doing = self.compute.following().or(diving);
        let warning = self.forecast.warning();
        StatusLine { progress, width_rad, rate, simulated, engine, depth, doing, warning }
    }

    /// Keeps how the window was left.
    pub fn save(&mut self) {
        let AppState { animate, theme, ui_scale, layers, .. } = self.state;
        self.settings = Settings { animate, theme, ui_scale, layers, ..self.settings.clone() };
        self.settings.last_scene = Some(self.state.document());
        self.saved_at = Instant::now();
        if self.saved.as_ref() == Some(&self.settings) {
            return;
        }
        if let Err(error) = self.store.save(&self.settings) {
            log::error!("the settings could not be kept: {error}");
        }
        self.saved = Some(self.settings.clone());
    }

    /// Keeps it now and then too, so that a crash costs little.
    pub fn save_sometimes(&mut self) {
        if self.saved_at.elapsed() > SAVE_EVERY {
            self.save();
        }
    }

    /// Shows a file: a picture of ours or a scene.
    pub(super) fn open(&mut self, path: &Path) {
        match crate::output::read_document(path) {
            Ok(document) => {
                self.settings.remember(path);
                if let Some(effect) = self.state.apply(Action::Show(Box::new(document))) {
                    self.affect(effect);
                }
            }
            Err(error) => self.state.notices.fail(format!("{error}.")),
        }
    }
}
