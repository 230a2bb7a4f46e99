//! flipmap's map in a browser: the same scenes, kernels, tiles and colours as in the window, drawn
//! by WebGPU on a canvas of a page. The page's script (`web/page/page.js`) passes on what people do,
//! and shows what [`PageMap`] tells.

mod device;
mod direct;
mod map;
mod save;
mod tell;
mod twin_flight;
mod waiting;

use flipmap_engine::gpu::device::Gpu;
use flipmap_engine::gpu::{GpuEngine, Waiting, judged};
use flipmap_engine::level::{BALANCED_DF32, FAST};
use flipmap_engine::{Engine, EventSpec, IntegratorConfig};
use flipmap_scene::{Document, Setting, location};
use flipmap_screen::camera::Camera;
use glam::DVec2;
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

use self::device::PageDevice;
use self::map::Map;
pub use self::twin_flight::TwinFlight;
use self::waiting::turn;

/// A map on a canvas.
#[wasm_bindgen]
pub struct PageMap {
    map: Map,
}

/// An engine whose pairs of f32 have been checked.
#[wasm_bindgen]
pub struct PairsEngine(GpuEngine);

#[wasm_bindgen(module = "/src/ahead.js")]
extern "C" {
    #[wasm_bindgen(js_name = compileAhead)]
    fn compile_ahead();
    #[wasm_bindgen(catch, js_name = compiledAhead)]
    async fn compiled_ahead() -> Result<(), JsValue>;
}

/// Returns an engine for a configuration that its device has been checked for.
async fn opened(gpu: Gpu, config: IntegratorConfig) -> Result<GpuEngine, JsError> {
    let waiting = Waiting::Pause(&turn);
    let mut engine = judged(gpu, &[config.precision], waiting).await.map_err(refused)?;
    // One kernel for all scenes: a slider in motion compiles nothing.
    engine.set_specialised(false);
    compile_ahead();
    let compiled = engine.compile_general(&config);
    // What cannot be compiled ahead fails again, with its reason, when it is needed.
    let _ = compiled_ahead().await;
    compiled.map_err(refused)?;
    engine.check_orbits_by(&config, waiting).await.map_err(refused)?;
    if engine.offers(&config) {
        return Ok(engine);
    }
    let failed = engine.verdict().checks.iter().find(|check| !check.passed);
    let name = failed.map_or("orbits", |check| check.name);
    Err(refused(format!("this device's arithmetic failed the self-check ({name})")))
}

fn refused(error: impl std::fmt::Display) -> JsError {
    JsError::new(&error.to_string())
}

#[wasm_bindgen]
impl PageMap {
    /// Opens the browser's graphics device, checks its arithmetic, and shows the location `link`.
    pub async fn open(canvas: HtmlCanvasElement, link: String) -> Result<PageMap, JsError> {
        let scene = location::parse(&link).map_err(refused)?;
        let device = PageDevice::open(canvas).await.map_err(refused)?;
        let engine = opened(device.gpu.clone(), FAST).await?;
        Ok(PageMap { map: Map::new(device, engine, scene) })
    }

    /// Fits the map to a canvas of this size in points.
    pub fn resize(&mut self, width: f64, height: f64, pixels_per_point: f64) {
        self.map.resize(DVec2::new(width, height), pixels_per_point);
    }

    /// Advances the work; returns true if there is something new to draw.
    pub fn work(&mut self) -> Result<bool, JsError> {
        self.map.work().map_err(refused)
    }

    /// True while there is work to do.
    pub fn is_busy(&self) -> bool {
        self.map.is_busy()
    }

    /// Draws; returns true if another frame is needed although nothing new is computed.
    pub fn draw(&mut self, now_secs: f64) -> Result<bool, JsError> {
        self.map.draw(now_secs).map_err(refused)
    }

    /// Shows a location. Returns false where the device's numbers end above it.
    pub fn go(&mut self, link: &str) -> Result<bool, JsError> {
        self.map.go(link).map_err(refused)
    }

    /// The location of what is shown.
    pub fn location(&self) -> String {
        self.map.location()
    }

    /// Moves the map with the pointer, by points to the right and down.
    pub fn drag(&mut self, x: f64, y: f64) {
        let by = self.map.screen().offset_at(DVec2::new(-x, -y));
        self.map.look(self.map.camera.moved(by));
    }

    /// Zooms by a factor about a point, measured from the middle of the canvas. Returns false where
    /// the device's numbers end.
    pub fn zoom(&mut self, factor: f64, x: f64, y: f64) -> bool {
        let about = self.map.screen().offset_at(DVec2::new(x, y));
        let least = self.map.least_width_rad();
        let most = self.map.camera.width_rad / least;
        let is_open = factor <= most;
        self.map.look(self.map.camera.zoomed(factor.min(most.max(1.0)), about));
        is_open
    }

    /// Changes a setting of the scene, by the words of the command line.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), JsError> {
        let setting = Setting::named(name).ok_or_else(|| refused(format!("no setting {name}")))?;
        self.map.set(setting, text).map_err(refused)
    }

    /// Checks the device's pairs of f32, and orbits in them; takes long where kernels compile slowly.
    /// Fails if they are not to be trusted.
    pub fn pairs(&self) -> js_sys::Promise {
        let gpu = self.map.device.gpu.clone();
        let awaited = self.map.awaits_pairs.clone();
        awaited.set(true);
        wasm_bindgen_futures::future_to_promise(async move {
            let engine = opened(gpu, BALANCED_DF32).await;
            awaited.set(false);
            Ok(PairsEngine(engine?).into())
        })
    }

    /// Computes in pairs of f32 from now on.
    pub fn raise(&mut self, pairs: PairsEngine) {
        self.map.raise(pairs.0, BALANCED_DF32);
    }

    /// Turns the map about the middle of the canvas, as if it had been dragged from one point to
    /// another, both measured from there.
    pub fn turn(&mut self, x0: f64, y0: f64, x1: f64, y1: f64) {
        let camera = self.map.screen().turned(DVec2::new(x0, y0), DVec2::new(x1, y1));
        self.map.look(camera);
    }

    /// Stretches the vertical axis by a factor.
    pub fn stretch(&mut self, factor: f64) {
        self.map.look(self.map.camera.stretched(factor));
    }

    /// Shows the whole map, fitted to the canvas.
    pub fn home(&mut self) {
        let camera = Camera::home(self.map.camera.reach, self.map.size);
        self.map.look(camera);
    }

    /// Passes on where the pointer is, near which cells come first.
    pub fn pointer(&mut self, x: f64, y: f64) {
        self.map.pointer = Some(DVec2::new(x, y));
    }

    /// Passes on that the pointer has left the canvas.
    pub fn pointer_gone(&mut self) {
        self.map.pointer = None;
    }

    /// Describes the sample under a point.
    pub fn hover(&mut self, x: f64, y: f64) -> String {
        self.map.hover(DVec2::new(x, y))
    }

    /// Releases the pendulum of the sample under a point, and its twin one sample away.
    pub fn swing(&self, x: f64, y: f64) -> Option<TwinFlight> {
        let start = self.map.start_at(DVec2::new(x, y))?;
        Some(TwinFlight::new(EventSpec::from(&self.map.scene), &start))
    }

    /// Paints the map with the settings of a scene's table `picture`, as JSON; those left out have
    /// their defaults.
    pub fn paint(&mut self, json: &str) -> Result<(), JsError> {
        let picture = serde_json::from_str(json).map_err(refused)?;
        self.map.paint(picture).map_err(refused)
    }

    /// The state of the map, as JSON.
    pub fn tell(&self) -> String {
        self.map.told().to_string()
    }

    /// The legend of the colours, as JSON.
    pub fn legend(&self) -> Result<String, JsError> {
        self.map.legend().map(|legend| legend.to_string()).map_err(refused)
    }

    /// The palettes, questions and scenes to choose from, as JSON.
    pub fn choices(&self) -> String {
        tell::choices().to_string()
    }

    /// What is shown as the text of a scene's file.
    pub fn document(&self) -> String {
        self.map.document().text()
    }

    /// Returns a PNG of the map with a scene inside, which the program opens.
    pub fn saved(&self, png: &[u8], document: &str) -> Result<Vec<u8>, JsError> {
        let document = Document::parse(document).map_err(refused)?;
        save::with_scene(png, &document).map_err(refused)
    }
}
