//! egui in a system window: the graphics device, the input, the frames. When the device is lost,
//! the host is discarded and a new one takes over egui's memory.

use std::num::NonZeroU32;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use egui::{Context, Ui, ViewportId};
use egui_wgpu::winit::Painter;
use egui_wgpu::{RendererOptions, SurfaceConfig, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use winit::event::{ElementState, MouseButton, TouchPhase, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoopProxy, OwnedDisplayHandle};
use winit::window::Window;

use super::arrivals::{FrameTime, FrameTimes};
use super::clipboard::{ClipboardReader, Pasted, take_keys};
use super::wake::Woken;
use flipmap_engine::gpu::device::is_software;
use flipmap_lab::typeface;
use flipmap_screen::canvas::LAYERS;
use flipmap_screen::canvas::copied::CopiedPicture;
use flipmap_screen::canvas::pipeline::Canvas;

/// The reason why nothing can be drawn in the window.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// No adapter, or none for this window.
    #[error(
        "no graphics adapter can draw the window ({0}); install Vulkan drivers (on Debian: \
         apt-get install libvulkan1 mesa-vulkan-drivers)"
    )]
    Graphics(#[from] egui_wgpu::WgpuError),
}

/// A graphics device and egui, which together draw a window.
pub(crate) struct EguiHost {
    /// Context of the interface.
    pub ctx: Context,
    input: egui_winit::State,
    clipboard: ClipboardReader,
    proxy: EventLoopProxy<Woken>,
    painter: Painter,
    window: Arc<Window>,
    lost: Arc<AtomicBool>,
    complaint: Arc<Mutex<Option<String>>>,
    /// True if a screen reader is listening.
    screen_reader: bool,
    textures: egui::TexturesDelta,
    times: FrameTimes,
    /// Largest side of a surface in pixels.
    max_px: u32,
}

/// The parts of a host that outlive the loss of its device.
pub(crate) struct SurvivingParts {
    /// State that egui remembers.
    memory: egui::Memory,
    /// Connection to screen readers: a window can have only one during its life.
    adapter: Option<egui_winit::accesskit_winit::Adapter>,
    screen_reader: bool,
}

impl SurvivingParts {
    fn move_into(self, ctx: &Context, input: &mut egui_winit::State) {
        ctx.memory_mut(|memory| *memory = self.memory);
        input.accesskit = self.adapter;
        if self.screen_reader {
            ctx.enable_accesskit();
        }
    }
}

impl EguiHost {
    /// Opens a device for a window that is not shown yet, or for one whose previous host left
    /// `remains`.
    pub(crate) fn new(
        event_loop: &ActiveEventLoop,
        window: &Arc<Window>,
        proxy: &EventLoopProxy<Woken>,
        remains: Option<SurvivingParts>,
    ) -> Result<Self, HostError> {
        let ctx = Context::default();
        typeface::install(&ctx);
        let waker = proxy.clone();
        ctx.set_request_repaint_callback(move |info| {
            // After the event loop has ended, nothing is drawn any more.
            let _ = waker.send_event(Woken::after(info.delay));
        });
        let mut painter = pollster::block_on(Painter::new(
            ctx.clone(),
            configuration(event_loop.owned_display_handle()),
            false,
            // Dithering is costly in software rendering, and no panel has gradients.
            RendererOptions { dithering: false, ..RendererOptions::default() },
        ));
        pollster::block_on(painter.set_window(ViewportId::ROOT, Some(Arc::clone(window))))?;
        let mut input = egui_winit::State::new(
            ctx.clone(),
            ViewportId::ROOT,
            window,
            Some(window.scale_factor() as f32),
            window.theme(),
            painter.max_texture_side(),
        );
        // The clipboard is read on another thread.
        input.set_clipboard_shortcuts(false);
        let screen_reader = remains.as_ref().is_some_and(|remains| remains.screen_reader);
        match remains {
            Some(remains) => remains.move_into(&ctx, &mut input),
            None => input.init_accesskit(event_loop, window, proxy.clone()),
        }
        let mut host = EguiHost {
            ctx,
            input,
            clipboard: ClipboardReader::default(),
            proxy: proxy.clone(),
            painter,
            window: Arc::clone(window),
            lost: Arc::default(),
            complaint: Arc::default(),
            screen_reader,
            textures: egui::TexturesDelta::default(),
            times: FrameTimes::new(Instant::now()),
            max_px: 0,
        };
        host.prepare_device(proxy);
        Ok(host)
    }

    /// Returns true if a graphics card draws rather than the processor.
    pub(crate) fn is_quick(&self) -> bool {
        let state = self.painter.render_state();
        state.is_some_and(|state| !is_software(&state.adapter))
    }

    /// Creates the canvas on the device and registers handlers for its loss and its errors.
    fn prepare_device(&mut self, proxy: &EventLoopProxy<Woken>) {
        let Some(state) = self.painter.render_state() else { return };
        let canvas = Canvas::new(&state.device, state.target_format, LAYERS);
        state.renderer.write().callback_resources.insert(canvas);
        self.max_px = state.device.limits().max_texture_dimension_2d;
        let (lost, waker) = (Arc::clone(&self.lost), proxy.clone());
        state.device.set_device_lost_callback(move |_, why| {
            log::warn!("the window's graphics device is gone: {why}");
            lost.store(true, Ordering::Release);
            let _ = waker.send_event(Woken::after(Duration::ZERO));
        });
        let complaint = Arc::clone(&self.complaint);
        state.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            log::warn!("the window's graphics driver: {error}");
            if let Ok(mut first) = complaint.lock() {
                first.get_or_insert_with(|| error.to_string());
            }
        }));
    }

    /// Begins to copy the map as it is on the screen; none before the first frame.
    pub(crate) fn copied_map(&self) -> Option<CopiedPicture> {
        let state = self.painter.render_state()?;
        let renderer = state.renderer.read();
        renderer.callback_resources.get::<Canvas>()?.copied(&state.device, &state.queue)
    }

    /// Returns true if the device can no longer draw.
    pub(crate) fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Acquire)
    }

    /// Takes the first complaint since the last call, such as an error of the driver.
    pub(crate) fn complaint(&self) -> Option<String> {
        self.complaint.lock().ok().and_then(|mut first| first.take())
    }

    /// Destroys the device, as a driver reset does.
    #[cfg(feature = "rigs")]
    pub(crate) fn lose_device(&self) {
        if let Some(state) = self.painter.render_state() {
            state.device.destroy();
        }
    }

    /// Drops the device and returns what the next host needs.
    pub(crate) fn into_surviving(self) -> SurvivingParts {
        SurvivingParts {
            memory: self.ctx.memory(Clone::clone),
            screen_reader: self.screen_reader,
            adapter: self.input.accesskit,
        }
    }

    /// Handles an event that came at `earliest` or later. Returns true if something may have to be
    /// redrawn.
    pub(crate) fn on_event(&mut self, event: &WindowEvent, earliest: Instant) -> bool {
        match event {
            WindowEvent::Resized(size) => self.resize(size.width, size.height),
            WindowEvent::MouseInput { state, .. } => {
                self.times.button(earliest, *state == ElementState::Released);
            }
            WindowEvent::Touch(touch) => {
                self.times.button(earliest, touch.phase == TouchPhase::Ended);
            }
            _ => {}
        }
        if let WindowEvent::MouseInput { button: MouseButton::Middle, state, .. } = event {
            if let (ElementState::Pressed, Some(point)) = (state, self.ctx.pointer_latest_pos()) {
                self.clipboard.ask(Some(point), &self.proxy);
            }
            return false;
        }
        let repaint = self.input.on_window_event(&self.window, event).repaint;
        if take_keys(&mut self.input.egui_input_mut().events) {
            self.clipboard.ask(None, &self.proxy);
        }
        repaint
    }

    /// Gives egui a text from the clipboard. Returns true if there is none.
    pub(crate) fn paste(&mut self, pasted: Pasted) -> bool {
        let event = match pasted {
            Pasted::Text(text) => egui::Event::Paste(text),
            Pasted::Selection(pos, text) => egui::Event::MiddleClickPaste { pos, text },
            Pasted::Nothing => return true,
            Pasted::Unreachable => match self.input.clipboard_text() {
                Some(text) if !text.is_empty() => egui::Event::Paste(text),
                _ => return true,
            },
        };
        self.input.egui_input_mut().events.push(event);
        self.ctx.request_repaint();
        false
    }

    /// Resizes the surface, up to the limit of the device; complains if the window is larger.
    fn resize(&mut self, width: u32, height: u32) {
        let most = self.max_px.max(1);
        if width.max(height) > most
            && let Ok(mut complaint) = self.complaint.lock()
        {
            complaint.get_or_insert_with(|| {
                format!("the window is {width} × {height} pixels, but this adapter draws at most {most} each way")
            });
        }
        let side = |px: u32| NonZeroU32::new(px.min(most));
        if let (Some(width), Some(height)) = (side(width), side(height)) {
            self.painter.on_window_resized(ViewportId::ROOT, width, height);
        }
    }

    fn tell_screen_reader(&mut self, listening: bool) {
        self.screen_reader = listening;
        if listening { self.ctx.enable_accesskit() } else { self.ctx.disable_accesskit() }
    }

    /// Handles a request of a screen reader.
    pub(crate) fn on_accessibility(&mut self, event: accesskit_event::Event) {
        match event {
            accesskit_event::Event::Wanted => self.tell_screen_reader(true),
            accesskit_event::Event::Action(request) => {
                self.input.on_accesskit_action_request(request);
            }
            accesskit_event::Event::Unwanted => self.tell_screen_reader(false),
        }
        self.ctx.request_repaint();
    }

    /// Polls the device, because a lost device reports its loss only when it is used.
    fn ask_device(&self) {
        if let Some(state) = self.painter.render_state() {
            // The callback for losses reports whatever goes wrong here.
            let _ = state.device.poll(wgpu::PollType::Poll);
        }
    }

    /// Draws and presents a frame. egui's painter panics if the device is lost during the call; the
    /// loss is then handled like any other.
    fn paint(&mut self, primitives: &[egui::ClippedPrimitive], pixels_per_point: f32) {
        let EguiHost { painter, textures, window, ctx, .. } = self;
        // Areas that no panel covers look like a panel.
        let ground = ctx.global_style().visuals.panel_fill.to_normalized_gamma_f32();
        let painted = catch_unwind(AssertUnwindSafe(|| {
            painter.paint_and_update_textures(
                ViewportId::ROOT,
                pixels_per_point,
                ground,
                primitives,
                textures,
                Vec::new(),
                window,
            );
        }));
        if painted.is_err() {
            self.lost.store(true, Ordering::Release);
        }
    }

    /// Runs the interface once and presents it. Returns the delay after which it wants to be shown
    /// again.
    pub(crate) fn frame(
        &mut self,
        event_loop: &ActiveEventLoop,
        show: impl FnMut(&mut Ui),
    ) -> Duration {
        self.ask_device();
        if self.is_lost() {
            return Duration::ZERO;
        }
        let mut raw = self.input.take_egui_input(&self.window);
        let FrameTime { secs, double_click_secs } = self.times.frame(Instant::now());
        self.ctx.options_mut(|all| all.input_options.max_double_click_delay = double_click_secs);
        raw.time = Some(secs);
        let output = self.ctx.run_ui(raw, show);
        self.input.handle_platform_output_with_event_loop(
            &self.window,
            event_loop,
            output.platform_output,
        );
        self.textures.append(output.textures_delta);
        let primitives = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        self.paint(&primitives, output.pixels_per_point);
        let root = output.viewport_output.get(&ViewportId::ROOT);
        root.map_or(Duration::MAX, |root| root.repaint_delay)
    }
}

/// Returns the configuration for a display, with low latency between input and picture.
fn configuration(display: OwnedDisplayHandle) -> WgpuConfiguration {
    let mut setup = WgpuSetupCreateNew::from_display_handle(display);
    let usual = Arc::clone(&setup.device_descriptor);
    // The map's textures are few and permanent. The usual blocks, with room for more, would take
    // half as much of the card's memory again.
    setup.device_descriptor = Arc::new(move |adapter| wgpu::DeviceDescriptor {
        memory_hints: wgpu::MemoryHints::MemoryUsage,
        ..usual(adapter)
    });
    WgpuConfiguration {
        surface: SurfaceConfig::LOW_LATENCY,
        wgpu_setup: WgpuSetup::CreateNew(setup),
        ..WgpuConfiguration::default()
    }
}

pub(crate) use super::wake::accesskit_event;
