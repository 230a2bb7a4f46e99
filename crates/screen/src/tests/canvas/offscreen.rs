//! The canvas drawn into a texture and read back.

use crate::camera::Screen;
use crate::canvas::colours::{CardColours, gliding_colours};
use crate::canvas::pipeline::Canvas;
use crate::canvas::{LAYERS, MapRenderer};
use flipmap_engine::gpu::device::Gpu;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::{PictureTable, Scene};

use crate::tests::common::gpu_engine;

/// Size of the test pictures in pixels; rows of a texture are read back in units of 256 bytes.
pub(crate) const SIZE: [u32; 2] = [256, 192];

/// The settings that the colours of a frame depend on.
pub(crate) struct Paint<'a> {
    pub picture: &'a PictureTable,
    pub scene: &'a Scene,
    pub trust: bool,
}

/// A graphics device with a canvas on it.
pub(crate) struct Studio {
    gpu: Gpu,
    canvas: Canvas,
    pub map_renderer: MapRenderer,
    format: wgpu::TextureFormat,
    /// Time in s up to which flips are drawn; `None` for the whole budget.
    pub until_secs: Option<f64>,
    /// Time of the window's clock at which the next picture is drawn; `None` if nothing fades.
    pub now_secs: Option<f64>,
    /// Number of tiles that the last picture uploaded to the card.
    pub uploads: usize,
}

impl Studio {
    pub(crate) fn new(format: wgpu::TextureFormat) -> Self {
        let gpu = Gpu::open(gpu_engine().gpu().adapter.clone()).unwrap();
        let canvas = Canvas::new(&gpu.device, format, LAYERS);
        let map_renderer = MapRenderer::default();
        Studio { gpu, canvas, map_renderer, format, until_secs: None, now_secs: None, uploads: 0 }
    }

    fn colours(&self, Paint { picture, scene, trust }: &Paint) -> CardColours {
        let until_secs = self.until_secs.unwrap_or(scene.question.budget.secs);
        gliding_colours(picture, picture, scene, until_secs, *trust).unwrap()
    }

    /// Makes a frame and throws it away, as egui does with a pass that it runs again.
    pub(crate) fn throw_away(&mut self, screen: &Screen, explorer: &mut Explorer, paint: &Paint) {
        let colours = self.colours(paint);
        drop(self.map_renderer.frame(screen, explorer, colours));
    }

    /// Draws a screen and returns its pixels, four bytes each; pixels where nothing is drawn are 0.
    pub(crate) fn draw(
        &mut self,
        screen: &Screen,
        explorer: &mut Explorer,
        paint: &Paint,
    ) -> Vec<u8> {
        let colours = self.colours(paint);
        self.map_renderer.fading.begin(self.now_secs);
        let frame = self.map_renderer.frame(screen, explorer, colours);
        self.uploads = frame.uploads.len();
        let Gpu { device, queue, .. } = &self.gpu;
        self.canvas.load(device, queue, &frame);
        let size = wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 };
        let target = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        self.canvas.draw(device, queue, &frame);
        let mut encoder = device.create_command_encoder(&Default::default());
        self.pass(&mut encoder, &target.create_view(&Default::default()));
        let pixels = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(4 * SIZE[0] * SIZE[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * SIZE[0]),
            rows_per_image: None,
        };
        let into = wgpu::TexelCopyBufferInfo { buffer: &pixels, layout };
        encoder.copy_texture_to_buffer(target.as_image_copy(), into, size);
        queue.submit([encoder.finish()]);
        pixels.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.unwrap());
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        pixels.slice(..).get_mapped_range().unwrap().to_vec()
    }

    fn pass(&self, encoder: &mut wgpu::CommandEncoder, view: &wgpu::TextureView) {
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: clear, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        self.canvas.show(&mut pass);
    }
}
