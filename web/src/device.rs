//! The graphics device of a page, and the surface of its canvas.

use flipmap_engine::EngineError;
use flipmap_engine::gpu::device::Gpu;
use web_sys::HtmlCanvasElement;

/// A device with the surface that it draws on.
pub(crate) struct PageDevice {
    pub gpu: Gpu,
    surface: wgpu::Surface<'static>,
    /// The browser gives a device up once its instance is gone.
    _instance: wgpu::Instance,
    config: wgpu::SurfaceConfiguration,
}

/// Reasons why a page has no map.
#[derive(Debug, thiserror::Error)]
pub(crate) enum OpenError {
    #[error("this browser offers no WebGPU, or no graphics device for it")]
    NoAdapter,
    #[error("the browser's graphics device cannot draw on this page")]
    NoSurface,
    #[error("{0}")]
    Engine(#[from] EngineError),
}

impl PageDevice {
    /// Opens the browser's preferred device for a canvas.
    pub(crate) async fn open(canvas: HtmlCanvasElement) -> Result<Self, OpenError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::BROWSER_WEBGPU;
        let instance = wgpu::Instance::new(descriptor);
        let size = [canvas.width().max(1), canvas.height().max(1)];
        let surface = instance
            .create_surface(wgpu::SurfaceTarget::Canvas(canvas))
            .map_err(|_| OpenError::NoAdapter)?;
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await.map_err(|_| OpenError::NoAdapter)?;
        let config =
            surface.get_default_config(&adapter, size[0], size[1]).ok_or(OpenError::NoSurface)?;
        let gpu = Gpu::opening(adapter).await?;
        surface.configure(&gpu.device, &config);
        Ok(PageDevice { gpu, surface, _instance: instance, config })
    }

    /// The format of the canvas's pixels.
    pub(crate) fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Fits the surface to a canvas of this size in pixels.
    pub(crate) fn resize(&mut self, size_px: [u32; 2]) {
        [self.config.width, self.config.height] = size_px.map(|side| side.max(1));
        self.surface.configure(&self.gpu.device, &self.config);
    }

    /// Draws on the canvas.
    pub(crate) fn draw(&self, draw: impl FnOnce(&mut wgpu::RenderPass<'_>)) {
        use wgpu::CurrentSurfaceTexture::{Suboptimal, Success};
        let (Success(texture) | Suboptimal(texture)) = self.surface.get_current_texture() else {
            return;
        };
        let view = texture.texture.create_view(&Default::default());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("page"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        draw(&mut pass);
        drop(pass);
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.queue.present(texture);
    }
}
