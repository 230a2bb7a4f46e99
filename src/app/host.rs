//! egui in a window of the system: the graphics device, the input, the frames. When the device
//! is lost, a host is thrown away and another one made; what egui remembers moves over.

use std::num::NonZeroU32;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use egui::{Context, Ui, ViewportId};
use egui_wgpu::winit::Painter;
use egui_wgpu::{RendererOptions, SurfaceConfig, WgpuConfiguration, WgpuSetup};
use winit::event_loop::{ActiveEventLoop, EventLoopProxy, OwnedDisplayHandle};
use winit::window::Window;

use super::canvas::LAYERS;
use super::canvas::pipeline::Canvas;
use super::wake::Woken;

/// Why there is no picture in the window.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// No adapter, or none for this window.
    #[error(
        "no graphics adapter can draw the window ({0}); install Vulkan drivers (on Debian: \
         apt-get install libvulkan1 mesa-vulkan-drivers)"
    )]
    Graphics(#[from] egui_wgpu::WgpuError),
}

/// A device that draws a window.
pub struct Host {
    /// The interface.
    pub ctx: Context,
    input: egui_winit::State,
    painter: Painter,
    window: Arc<Window>,
    lost: Arc<AtomicBool>,
    complaint: Arc<Mutex<Option<String>>>,
    textures: egui::TexturesDelta,
    /// The largest side of a surface.
    most_px: u32,
}

impl Host {
    /// Opens a device for a window; `memory` is what egui remembered of a device before.
    pub fn new(
        event_loop: &ActiveEventLoop,
        window: &Arc<Window>,
        proxy: &EventLoopProxy<Woken>,
        memory: Option<egui::Memory>,
    ) -> Result<Self, HostError> {
        let ctx = Context::default();
        if let Some(memory) = memory {
            ctx.memory_mut(|mine| *mine = memory);
        }
        let waker = proxy.clone();
        ctx.set_request_repaint_callback(move |info| {
            // Once the loop has ended nobody draws any more.
            let _ = waker.send_event(Woken::after(info.delay));
        });
        let mut painter = pollster::block_on(Painter::new(
            ctx.clone(),
            configuration(event_loop.owned_display_handle()),
            false,
            RendererOptions::default(),
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
        input.init_accesskit(event_loop, window, proxy.clone());
        let mut host = Host {
            ctx,
            input,
            painter,
            window: Arc::clone(window),
            lost: Arc::default(),
            complaint: Arc::default(),
            textures: egui::TexturesDelta::default(),
            most_px: 0,
        };
        host.prepare_device(proxy);
        Ok(host)
    }

    /// Puts the canvas on the device and listens to what goes wrong with it.
    fn prepare_device(&mut self, proxy: &EventLoopProxy<Woken>) {
        let Some(state) = self.painter.render_state() else { return };
        let canvas = Canvas::new(&state.device, state.target_format, LAYERS);
        state.renderer.write().callback_resources.insert(canvas);
        self.most_px = state.device.limits().max_texture_dimension_2d;
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

    /// Whether the device can draw nothing more.
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Acquire)
    }

    /// The first thing the driver refused since the last call.
    pub fn complaint(&self) -> Option<String> {
        self.complaint.lock().ok().and_then(|mut first| first.take())
    }

    /// Throws the device away, as a driver that is reset does.
    pub fn lose_device(&self) {
        if let Some(state) = self.painter.render_state() {
            state.device.destroy();
        }
    }

    /// What egui remembers, for the next host.
    pub fn memory(&self) -> egui::Memory {
        self.ctx.memory(Clone::clone)
    }

    /// Takes an event; says whether something may have to be drawn.
    pub fn on_event(&mut self, event: &winit::event::WindowEvent) -> bool {
        if let winit::event::WindowEvent::Resized(size) = event {
            self.resize(size.width, size.height);
        }
        self.input.on_window_event(&self.window, event).repaint
    }

    /// Gives the surface a new size, as large as it can be; says so if the window is larger.
    fn resize(&mut self, width: u32, height: u32) {
        let most = self.most_px.max(1);
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

    /// A screen reader asks for something.
    pub fn on_accessibility(&mut self, event: accesskit_event::Event) {
        match event {
            accesskit_event::Event::Wanted => self.ctx.enable_accesskit(),
            accesskit_event::Event::Action(request) => {
                self.input.on_accesskit_action_request(request);
            }
            accesskit_event::Event::Unwanted => self.ctx.disable_accesskit(),
        }
        self.ctx.request_repaint();
    }

    /// Shows the interface once and presents it. Returns after how long it wants to be shown
    /// again.
    pub fn frame(&mut self, event_loop: &ActiveEventLoop, show: impl FnMut(&mut Ui)) -> Duration {
        let raw = self.input.take_egui_input(&self.window);
        let output = self.ctx.run_ui(raw, show);
        self.input.handle_platform_output_with_event_loop(
            &self.window,
            event_loop,
            output.platform_output,
        );
        self.textures.append(output.textures_delta);
        let primitives = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        self.painter.paint_and_update_textures(
            ViewportId::ROOT,
            output.pixels_per_point,
            [0.12, 0.12, 0.13, 1.0],
            &primitives,
            &mut self.textures,
            Vec::new(),
            &self.window,
        );
        let root = output.viewport_output.get(&ViewportId::ROOT);
        root.map_or(Duration::MAX, |root| root.repaint_delay)
    }
}

/// A device for a display, with little between input and picture.
fn configuration(display: OwnedDisplayHandle) -> WgpuConfiguration {
    WgpuConfiguration {
        surface: SurfaceConfig::LOW_LATENCY,
        wgpu_setup: WgpuSetup::from_display_handle(display),
        ..WgpuConfiguration::default()
    }
}

pub use super::wake::accesskit_event;
