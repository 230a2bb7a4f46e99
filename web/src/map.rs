//! The map of a page: what is shown, through which camera, and the work for it.

use std::cell::Cell;
use std::rc::Rc;
use std::time::Duration;

use flipmap_engine::adapters::Check;
use flipmap_engine::clock::Instant;
use flipmap_engine::gpu::GpuEngine;
use flipmap_engine::gpu::device::is_software;
use flipmap_engine::level::{Accuracy, BALANCED_DF32, FAST};
use flipmap_engine::{Cells, EngineError, IntegratorConfig};
use flipmap_render::tiles::explorer::Explorer;
use flipmap_render::tiles::view_target::{Physics, ViewTarget};
use flipmap_scene::lattice::{DEEPEST, pitch_rad};
use flipmap_scene::palette::AnswerColours;
use flipmap_scene::{Document, PictureTable, RunTable, Scene, SceneError, Setting, location};
use flipmap_screen::camera::{Camera, Screen};
use flipmap_screen::canvas::colours::gliding_colours;
use flipmap_screen::canvas::pipeline::Canvas;
use flipmap_screen::canvas::{LAYERS, MapRenderer};
use flipmap_screen::captions::words_of;
use flipmap_screen::hover;
use flipmap_screen::pin_start::PinStart;
use flipmap_screen::reach::Reach;
use flipmap_screen::spread::ColourSpread;
use glam::DVec2;

use crate::device::PageDevice;
use crate::direct::DirectEngine;

/// Bytes of samples that a page keeps.
const CACHE_BYTES: usize = 192 << 20;
/// Time that preparing jobs may take of a frame.
const WORK: Duration = Duration::from_millis(8);
/// Longest time that a submission may run on the device while the map is moved, and for
/// [`TOUCHED`] after that.
const MOVING_PACE: Duration = Duration::from_millis(20);
/// Longest time that a submission may run while the map rests, on a card, and on a device that is a
/// program on the processor: there a turn of the browser's takes as long as a short submission.
const RESTING_PACE: [Duration; 2] = [Duration::from_millis(30), Duration::from_millis(120)];
const TOUCHED: Duration = Duration::from_millis(700);

/// Reasons why a map goes no further.
#[derive(Debug, thiserror::Error)]
pub(crate) enum MapError {
    #[error("the browser's graphics device was lost")]
    Lost,
    #[error("{0}")]
    Engine(#[from] EngineError),
    #[error("{0}")]
    Scene(#[from] SceneError),
}

/// A map with its device, engines and samples.
pub(crate) struct Map {
    pub scene: Scene,
    pub picture: PictureTable,
    pub camera: Camera,
    pub size: DVec2,
    pub pixels_per_point: f64,
    pub pointer: Option<DVec2>,
    pub explorer: Explorer,
    pub device: PageDevice,
    canvas: Canvas,
    renderer: MapRenderer,
    engine: DirectEngine,
    config: IntegratorConfig,
    /// The checks that the device has been through, for all engines so far.
    pub checks: Vec<Check>,
    /// True if tiles appear gradually: not where the processor draws.
    fades: bool,
    spread: ColourSpread,
    /// The moment of the last gesture, after which submissions are short for a while.
    touched: Option<Instant>,
    /// True while kernels for pairs of f32 are compiled and checked.
    pub awaits_pairs: Rc<Cell<bool>>,
}

impl Map {
    /// Creates the map of a scene on a device whose first engine has been checked for `fast`.
    pub(crate) fn new(device: PageDevice, engine: GpuEngine, scene: Scene) -> Self {
        let canvas = Canvas::new(&device.gpu.device, device.format(), LAYERS);
        let camera = Camera::from_view(&scene.view, Reach::of(&scene));
        let fades = !is_software(&device.gpu.adapter);
        Map {
            fades,
            spread: ColourSpread::default(),
            touched: None,
            awaits_pairs: Rc::default(),
            scene,
            picture: PictureTable::default(),
            camera,
            size: DVec2::new(1280.0, 800.0),
            pixels_per_point: 1.0,
            pointer: None,
            explorer: Explorer::new(CACHE_BYTES),
            device,
            canvas,
            renderer: MapRenderer::default(),
            checks: engine.verdict().checks.clone(),
            engine: DirectEngine(engine),
            config: FAST,
        }
    }

    /// Computes with another engine and configuration from now on.
    pub(crate) fn raise(&mut self, engine: GpuEngine, config: IntegratorConfig) {
        self.explorer.ground();
        self.checks.extend_from_slice(&engine.verdict().checks);
        (self.engine, self.config) = (DirectEngine(engine), config);
    }

    fn resting_pace(&self) -> Duration {
        RESTING_PACE[usize::from(self.is_software())]
    }

    /// True once the map is computed in pairs of f32.
    pub(crate) fn is_balanced(&self) -> bool {
        self.config == BALANCED_DF32
    }

    /// The canvas as it looks now.
    pub(crate) fn screen(&self) -> Screen {
        Screen { camera: self.camera, size: self.size, pixels_per_point: self.pixels_per_point }
    }

    /// Fits the map to a canvas of this size in points.
    pub(crate) fn resize(&mut self, size: DVec2, pixels_per_point: f64) {
        (self.size, self.pixels_per_point) = (size.max(DVec2::ONE), pixels_per_point);
        let size_px = (self.size * pixels_per_point).round().as_uvec2();
        self.device.resize(size_px.to_array());
        self.look(self.camera);
    }

    /// Shows a location: the view and all that is asked. Returns false if its starts could not be
    /// told apart, and the camera stays above.
    pub(crate) fn go(&mut self, link: &str) -> Result<bool, String> {
        let scene = location::parse(link).map_err(|error| error.to_string())?;
        let fitted = scene.view.fitted(self.size.to_array());
        self.camera = Camera::from_view(&fitted, Reach::of(&scene));
        self.scene = scene;
        Ok(self.look(self.camera))
    }

    /// The location of what is shown.
    pub(crate) fn location(&self) -> String {
        location::text(&self.shown())
    }

    /// The scene that is shown, with the view of the camera.
    pub(crate) fn shown(&self) -> Scene {
        Scene { view: self.camera.view(), ..self.scene.clone() }
    }

    /// What is shown as a document.
    pub(crate) fn document(&self) -> Document {
        let Scene { build, question, ref plane, .. } = self.scene;
        let size_px = (self.size * self.pixels_per_point).round().as_uvec2().to_array();
        let accuracy = if self.is_balanced() { Accuracy::Balanced } else { Accuracy::Fast };
        Document {
            pendulum: build,
            question,
            plane: plane.clone(),
            view: self.camera.view(),
            picture: self.picture.clone(),
            run: RunTable {
                size: Some(size_px),
                accuracy: Some(accuracy.to_string()),
                ..RunTable::default()
            },
            ..Document::default()
        }
    }

    /// Changes a setting of the scene.
    pub(crate) fn set(&mut self, setting: Setting, text: &str) -> Result<(), SceneError> {
        let scene = self.shown().with_words([(setting, text)])?;
        let reach = Reach::of(&scene);
        if reach != self.camera.reach || matches!(setting, Setting::Center | Setting::Width) {
            self.camera = Camera::from_view(&scene.view, reach);
        }
        self.scene = scene;
        self.fit_budget();
        Ok(())
    }

    /// Looks through another camera, as far as starts can be told apart. Returns false if they could
    /// not, and the camera stays above.
    pub(crate) fn look(&mut self, camera: Camera) -> bool {
        let least_rad = self.least_width_rad();
        let deep = camera.width_rad < least_rad;
        self.touched = Some(Instant::now());
        self.camera = Camera { width_rad: camera.width_rad.max(least_rad), ..camera };
        self.fit_budget();
        !deep
    }

    /// The least width of a view in lattice radians whose starts the device can tell apart.
    pub(crate) fn least_width_rad(&self) -> f64 {
        let units = self.camera.reach.units();
        let is_refused =
            |level: &u32| Cells::Never.check(&self.config, pitch_rad(*level) * units).is_err();
        let level = (1..DEEPEST).find(is_refused).unwrap_or(DEEPEST) - 1;
        pitch_rad(level) * self.size.x * self.pixels_per_point
    }

    /// Fits an automatic budget to the view.
    fn fit_budget(&mut self) {
        let budget = self.scene.question.budget;
        if budget.auto && self.scene.is_flip_from_rest() {
            let view = self.camera.view();
            self.scene.question.budget = budget.guessed(&self.scene.build, &view);
        }
    }

    fn target(&self) -> ViewTarget {
        let screen = self.screen();
        let physics = Physics::of(&self.scene, self.config, false);
        ViewTarget {
            physics,
            budget_secs: self.scene.question.budget.secs,
            region: screen.region(),
            level: screen.level(),
            pointer: self.pointer.map(|point| screen.offset_at(point).to_array()),
            refinements: 0,
        }
    }

    /// Advances the work. Returns true if there is something new to draw.
    pub(crate) fn work(&mut self) -> Result<bool, MapError> {
        self.check()?;
        self.explorer.target(&self.target());
        let moves = self.touched.is_some_and(|at| at.elapsed() < TOUCHED);
        let pace = if moves { MOVING_PACE } else { self.resting_pace() };
        self.engine.0.set_pace(pace);
        match self.explorer.work(&mut self.engine, Some(Instant::now() + WORK)) {
            // The device has one voice, and what it refuses now may be a kernel that is compiled ahead.
            Err(EngineError::Driver(_)) if self.awaits_pairs.get() => Ok(false),
            worked => Ok(worked?),
        }
    }

    fn check(&self) -> Result<(), MapError> {
        if self.device.gpu.is_lost() {
            return Err(MapError::Lost);
        }
        if self.awaits_pairs.get() { Ok(()) } else { Ok(self.device.gpu.check()?) }
    }

    /// True while there is work to do.
    pub(crate) fn is_busy(&self) -> bool {
        !self.explorer.is_done()
    }

    /// Draws a frame. Returns true if another one is needed although nothing new is computed.
    pub(crate) fn draw(&mut self, now_secs: f64) -> Result<bool, MapError> {
        self.check()?;
        self.explorer.target(&self.target());
        let progress = self.explorer.progress();
        let at = (now_secs, progress.idle && progress.wanted > 0);
        let screen = self.screen();
        self.spread.follow((&screen, &self.scene), &mut self.picture, &mut self.explorer, at);
        let until_secs = self.scene.question.budget.secs;
        let colours =
            gliding_colours(&self.picture, &self.picture, &self.scene, until_secs, false)?;
        self.renderer.fading.begin(self.fades.then_some(now_secs));
        let frame = self.renderer.frame(&self.screen(), &mut self.explorer, colours);
        let gpu = &self.device.gpu;
        self.canvas.load(&gpu.device, &gpu.queue, &frame);
        self.canvas.draw(&gpu.device, &gpu.queue, &frame);
        self.device.draw(|pass| self.canvas.show(pass));
        Ok(self.renderer.fading.is_running())
    }

    /// What is known of the sample under a point: words on where it starts and what becomes of it.
    pub(crate) fn hover(&mut self, point: DVec2) -> String {
        let (screen, scene) = (self.screen(), &self.scene);
        let level = screen.level();
        let [place, _] = hover::sample_at(screen.angle_at(point), level);
        let until_secs = scene.question.ask.is_time().then_some(scene.question.budget.secs);
        let answer = hover::answer_at(&mut self.explorer, place, level, until_secs);
        words_of((place, answer), scene, level)
    }

    /// The start of the sample under a point, and that of its neighbour; none where there is no
    /// pendulum.
    pub(crate) fn start_at(&self, point: DVec2) -> Option<PinStart> {
        let screen = self.screen();
        let places = hover::sample_at(screen.angle_at(point), screen.level());
        PinStart::on_plane(&self.scene, self.camera.reach, places)
    }

    /// Paints the map in other colours.
    pub(crate) fn paint(&mut self, picture: PictureTable) -> Result<(), SceneError> {
        AnswerColours::new(&self.scene, &picture)?;
        self.picture = picture;
        Ok(())
    }

    /// True if the device is a program on the processor.
    pub(crate) fn is_software(&self) -> bool {
        is_software(&self.device.gpu.adapter)
    }

    /// The device's name, as far as the browser tells it.
    pub(crate) fn adapter(&self) -> String {
        let info = self.device.gpu.adapter.get_info();
        match (info.name.as_str(), self.is_software()) {
            ("", true) => "a graphics device that runs on the processor".to_string(),
            ("", false) => "a graphics card".to_string(),
            (name, _) => name.to_string(),
        }
    }
}
