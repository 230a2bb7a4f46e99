//! Draws a figure as a picture on any adapter, without a window.

use egui::{Context, RawInput, Rect, Theme, Ui, vec2};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use super::{Lab, typeface};
use flipmap_engine::EngineError;
use flipmap_engine::adapters::INSTALL_HINT;
use flipmap_engine::gpu::device::{Gpu, adapters};

/// An RGB picture, with rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Still {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The pixels, three bytes each.
    pub rgb: Vec<u8>,
}

/// Number of frames per second at which a figure is advanced to the requested time.
const FRAMES_A_SEC: f64 = 60.0;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Draws a figure `secs` after its start.
pub fn still(lab: &mut Lab, size: [u32; 2], secs: f64) -> Result<Still, EngineError> {
    let frames = (secs * FRAMES_A_SEC).round() as u32;
    (0..frames).for_each(|_| lab.advance(1.0 / FRAMES_A_SEC));
    StillPainter::new(size, Theme::Dark)?.paint(|ui| {
        lab.show(ui);
    })
}

/// Draws pictures of a user interface, one after another.
pub struct StillPainter {
    gpu: Gpu,
    renderer: Renderer,
    ctx: Context,
    size: [u32; 2],
}

impl StillPainter {
    /// Opens an adapter for pictures of a size.
    pub fn new(size: [u32; 2], theme: Theme) -> Result<Self, EngineError> {
        let adapter = adapters().into_iter().next();
        let adapter = adapter.ok_or_else(|| EngineError::Unsupported(INSTALL_HINT.to_string()))?;
        let gpu = Gpu::open(adapter)?;
        let most = gpu.device.limits().max_texture_dimension_2d;
        if let Some(&side) = size.iter().find(|side| **side > most) {
            let (needed, allowed) = (u64::from(side), u64::from(most));
            return Err(EngineError::LimitExceeded {
                what: "a side of the still",
                needed,
                allowed,
            });
        }
        let ctx = Context::default();
        ctx.set_theme(theme);
        typeface::install(&ctx);
        let renderer = Renderer::new(&gpu.device, FORMAT, RendererOptions::PREDICTABLE);
        Ok(StillPainter { gpu, renderer, ctx, size })
    }

    /// Draws what `show` lays out.
    pub fn paint(&mut self, mut show: impl FnMut(&mut Ui)) -> Result<Still, EngineError> {
        let StillPainter { gpu, renderer, ctx, size } = self;
        let mut shapes = Vec::new();
        // egui needs more than one pass to settle its layout.
        for _ in 0..3 {
            let mut output = ctx.run_ui(input(*size), |ui| {
                egui::CentralPanel::default().show(ui, &mut show);
            });
            for (id, images) in output.textures_delta.set.drain() {
                for image in images {
                    renderer.update_texture(&gpu.device, &gpu.queue, id, &image);
                }
            }
            shapes = output.shapes;
        }
        let meshes = ctx.tessellate(shapes, 1.0);
        let target = painted(gpu, renderer, &meshes, *size);
        gpu.check()?;
        read_back(gpu, &target, *size)
    }
}

fn input(size: [u32; 2]) -> RawInput {
    let [width, height] = size.map(|side| side as f32);
    let screen_rect = Some(Rect::from_min_size(egui::Pos2::ZERO, vec2(width, height)));
    RawInput { screen_rect, time: Some(0.0), ..RawInput::default() }
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}

fn painted(
    gpu: &Gpu,
    renderer: &mut Renderer,
    meshes: &[egui::ClippedPrimitive],
    size: [u32; 2],
) -> wgpu::Texture {
    let target = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("still"),
        size: extent(size),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let screen = ScreenDescriptor { pixels_per_point: 1.0, size_in_pixels: size };
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let buffers = renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, meshes, &screen);
    {
        let view = target.create_view(&Default::default());
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
            depth_slice: None,
        };
        let descriptor = wgpu::RenderPassDescriptor {
            color_attachments: &[Some(attachment)],
            ..Default::default()
        };
        let mut pass = encoder.begin_render_pass(&descriptor).forget_lifetime();
        renderer.render(&mut pass, meshes, &screen);
    }
    gpu.queue.submit(buffers.into_iter().chain([encoder.finish()]));
    target
}

fn read_back(gpu: &Gpu, from: &wgpu::Texture, size: [u32; 2]) -> Result<Still, EngineError> {
    let [width, height] = size;
    let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("still"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(row),
        rows_per_image: Some(height),
    };
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(from.as_image_copy(), to, extent(size));
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    let wait = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    wait.map_err(|error| EngineError::Driver(error.to_string()))?;
    gpu.check()?;
    let bytes = buffer.slice(..).get_mapped_range();
    let bytes = bytes.map_err(|error| EngineError::Driver(error.to_string()))?;
    let pixels = bytes.chunks(row as usize).flat_map(|row| row[..4 * width as usize].chunks(4));
    let rgb = pixels.flat_map(|pixel| pixel[..3].to_vec()).collect();
    Ok(Still { size, rgb })
}
