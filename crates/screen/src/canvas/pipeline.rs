//! The graphics card's part of the map: an atlas of samples, a colour table, and quads drawn into
//! the kept picture.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bytemuck::{Pod, Zeroable};
use wgpu::util::DeviceExt;

use super::atlas::{SLOTS_ALONG, SLOTS_IN_LAYER};
use super::calm::CalmPicture;
use super::copied::CopiedPicture;
use super::kept::{Changes, DrawingSurface, KeptPicture};
use super::sample::WordKind;
use crate::camera::Screen;
use flipmap_engine::gpu::shared::status_constants;
use flipmap_render::tiles::Samples;
use flipmap_scene::lattice::SIDE;
use flipmap_scene::palette::{Ground, Relief};

/// Returns the source of the shader, with the status codes of [`flipmap_pendulum::Status`] and the
/// constants of the relief.
pub(crate) fn shader() -> String {
    let relief = format!(
        "const STEEPNESS: f32 = {:?};\nconst EDGE: f32 = {:?};\n",
        Relief::STEEPNESS,
        Relief::EDGE
    );
    status_constants() + &relief + flipmap_shaders::PICTURE
}

/// One parallelogram of the map (counterpart in the shader).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Quad {
    /// The first (upper left) corner in clip space.
    pub corner: [f32; 2],
    /// The side from the first corner to the right, in clip space.
    pub right: [f32; 2],
    /// The side from the first corner downwards, in clip space.
    pub down: [f32; 2],
    /// Position of the first corner among the slot's samples, in samples.
    pub texel: [f32; 2],
    /// Number of samples along each side; negative for the mirror image.
    pub span: [f32; 2],
    /// Number of samples along a side of the slot.
    pub side: f32,
    /// Index of the slot that holds the samples.
    pub slot: u32,
    /// Opacity of the samples, from 0 to 1.
    pub alpha: f32,
}

/// The values shared by all quads (counterpart in the shader).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Uniforms {
    /// Value of a word whose number is 0.
    pub value_bias: f32,
    /// Value of one step of a word's number.
    pub value_step: f32,
    /// Value of the first entry of the colour table.
    pub first_value: f32,
    /// Number of table entries per unit of the value.
    pub entries_per_unit: f32,
    /// Value after which answers are not shown.
    pub until_value: f32,
    /// 1 if uncertain pixels are hatched, else 0.
    pub trust: u32,
    /// 1 if the words of samples hold colours, 0 if times.
    pub coloured: u32,
    /// Share of the light that comes from the side.
    pub relief: f32,
    /// Linear light of unflipped starts.
    pub unflipped: [f32; 4],
    /// Linear light of forbidden starts.
    pub forbidden: [f32; 4],
    /// Linear light of failed starts.
    pub failed: [f32; 4],
    /// Direction to the light from the side (right, up, out of the map), and the width of the map
    /// in pixels.
    pub toward: [f32; 4],
}

/// Number of entries of the colour table, enough to take the nearest one instead of a mixture.
pub(crate) const TABLE_ENTRIES: usize = 8192;

/// The quads that show a cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CellQuads {
    /// The quads in drawing order.
    pub quads: Vec<Quad>,
    /// True if they cover the whole cell.
    pub whole: bool,
}

/// Samples to be uploaded.
#[derive(Clone, Debug)]
pub(crate) struct Upload {
    /// Index of the slot to hold them.
    pub slot: u32,
    /// Samples of a cell, row by row.
    pub samples: Arc<Samples>,
    /// Number of samples in a row.
    pub side: u32,
}

/// One frame of the map.
pub struct MapFrame {
    /// The screen that is shown.
    pub(crate) screen: Screen,
    /// True if the light of all samples in a pixel is mixed where there are many.
    pub(crate) mixes: bool,
    /// The quads of every cell in view.
    pub(crate) cells: Vec<CellQuads>,
    /// Samples that are yet to be uploaded.
    pub(crate) uploads: Vec<Upload>,
    /// The words that the samples become.
    pub(crate) words: Arc<WordKind>,
    /// Colours and marks.
    pub(crate) uniforms: Uniforms,
    /// [`TABLE_ENTRIES`] sRGB colours of four bytes each, if they have changed.
    pub(crate) table: Option<Vec<u8>>,
    /// Width and height of the map in physical pixels.
    pub size_px: [u32; 2],
    /// The colours of pixels without an answer, if the picture is to be denoised.
    pub(crate) ground: Option<Ground>,
    /// Set once the frame's data are on the card.
    pub(crate) is_loaded: Arc<AtomicBool>,
    /// True while the picture is to be denoised and is not: another frame is needed.
    pub(crate) is_grainy: Arc<AtomicBool>,
}

/// The resources on the card that live as long as the graphics device.
pub struct Canvas {
    /// Draws the samples of the view's own level.
    plain: Brush,
    /// Draws finer samples, too, at a higher cost per pixel.
    mixing: Brush,
    uniforms: wgpu::Buffer,
    atlas: wgpu::Texture,
    table: wgpu::Texture,
    quads: wgpu::Buffer,
    count: u32,
    kept: KeptPicture,
    calm: CalmPicture,
    /// Surface that the loaded frame draws on.
    on: DrawingSurface,
    /// True if the loaded frame mixes the light of many samples.
    mixes: bool,
}

/// A pipeline with its resources.
struct Brush {
    pipeline: wgpu::RenderPipeline,
    bindings: wgpu::BindGroup,
}

/// Largest number of places along a pixel whose light is mixed, enough for the samples of the
/// finest level.
const MAX_TAPS: u32 = 7;

impl Canvas {
    /// Begins to copy the map as it is on the screen, without what is drawn over it; none before
    /// the first frame.
    pub fn copied(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Option<CopiedPicture> {
        let shown = self.calm.shown().or(self.kept.target())?;
        CopiedPicture::begin(device, queue, shown)
    }

    /// Creates the resources, with an atlas of `layers` layers, for a target format.
    pub fn new(device: &wgpu::Device, target: wgpu::TextureFormat, layers: u32) -> Self {
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("picture"),
            source: wgpu::ShaderSource::Wgsl(shader().into()),
        });
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("canvas"),
            size: size_of::<Uniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let side = SLOTS_ALONG * SIDE;
        let atlas = texture(device, "atlas", [side, side, layers], wgpu::TextureFormat::R32Uint);
        let size = [TABLE_ENTRIES as u32, 1, 1];
        let table = texture(device, "colour table", size, wgpu::TextureFormat::Rgba8UnormSrgb);
        let brush = |max_taps| {
            let pipeline = pipeline(device, &shader, target, max_taps);
            let bindings = bindings(device, &pipeline, &uniforms, &atlas, &table);
            Brush { pipeline, bindings }
        };
        let (plain, mixing) = (brush(1), brush(MAX_TAPS));
        let quads = quad_buffer(device, &[]);
        let (kept, calm) = (KeptPicture::new(device, target), CalmPicture::default());
        let on = DrawingSurface::Kept;
        let (count, mixes) = (0, false);
        Canvas { plain, mixing, uniforms, atlas, table, quads, count, kept, calm, on, mixes }
    }

    /// Uploads a frame's data to the card.
    pub fn load(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, frame: &MapFrame) {
        for upload in &frame.uploads {
            self.upload(queue, upload, &frame.words.words(&upload.samples));
        }
        if let Some(table) = &frame.table {
            let size =
                wgpu::Extent3d { width: TABLE_ENTRIES as u32, height: 1, depth_or_array_layers: 1 };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * TABLE_ENTRIES as u32),
                rows_per_image: None,
            };
            queue.write_texture(self.table.as_image_copy(), table, layout, size);
        }
        queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&frame.uniforms));
        let Changes { quads, on } = self.kept.take(device, frame);
        let bytes = bytemuck::cast_slice(&quads);
        if bytes.len() as u64 > self.quads.size() {
            self.quads = quad_buffer(device, &quads);
        } else {
            queue.write_buffer(&self.quads, 0, bytes);
        }
        (self.count, self.on, self.mixes) = (quads.len() as u32, on, frame.mixes);
        frame.is_loaded.store(true, Ordering::Release);
    }

    fn upload(&self, queue: &wgpu::Queue, &Upload { slot, side, .. }: &Upload, words: &[u32]) {
        let in_layer = slot % SLOTS_IN_LAYER;
        let origin = wgpu::Origin3d {
            x: in_layer % SLOTS_ALONG * SIDE,
            y: in_layer / SLOTS_ALONG * SIDE,
            z: slot / SLOTS_IN_LAYER,
        };
        let target = wgpu::TexelCopyTextureInfo { origin, ..self.atlas.as_image_copy() };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * side),
            rows_per_image: None,
        };
        let size = wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 };
        queue.write_texture(target, bytemuck::cast_slice(words), layout, size);
    }

    /// Draws the changes of the loaded frame into the kept picture and submits them at once: the
    /// commands of the window's frame are lost if there is no surface to show it on, as when the
    /// window is covered.
    fn draw_kept(&self, device: &wgpu::Device, queue: &wgpu::Queue) {
        let clears = self.on == DrawingSurface::Cleared;
        if self.on == DrawingSurface::Window || (self.count == 0 && !clears) {
            return;
        }
        let mut encoder = device.create_command_encoder(&Default::default());
        let Some(mut pass) = self.kept.pass(&mut encoder, clears) else { return };
        self.draw_quads(&mut pass);
        drop(pass);
        queue.submit([encoder.finish()]);
    }

    /// Draws the loaded frame, as far as it is kept, and begins to denoise it once it rests.
    pub fn draw(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, frame: &MapFrame) {
        self.draw_kept(device, queue);
        let rests = self.on != DrawingSurface::Window;
        let ground = frame.ground.filter(|_| rests);
        let is_done = self.calm.follow(device, queue, &self.kept, ground);
        frame.is_grainy.store(frame.ground.is_some() && !is_done, Ordering::Release);
    }

    /// Shows the map in the viewport of a pass.
    pub fn show(&self, pass: &mut wgpu::RenderPass<'_>) {
        match self.on {
            DrawingSurface::Window => self.draw_quads(pass),
            DrawingSurface::Cleared | DrawingSurface::Kept => {
                self.kept.show(pass, self.calm.shown());
            }
        }
    }

    fn draw_quads(&self, pass: &mut wgpu::RenderPass<'_>) {
        let brush = if self.mixes { &self.mixing } else { &self.plain };
        pass.set_pipeline(&brush.pipeline);
        pass.set_bind_group(0, &brush.bindings, &[]);
        pass.set_vertex_buffer(0, self.quads.slice(..));
        pass.draw(0..4, 0..self.count);
    }
}

fn texture(
    device: &wgpu::Device,
    label: &'static str,
    [width, height, depth_or_array_layers]: [u32; 3],
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// Creates the bind group of the shader's resources, in the order of their bindings.
fn bindings(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    uniforms: &wgpu::Buffer,
    atlas: &wgpu::Texture,
    table: &wgpu::Texture,
) -> wgpu::BindGroup {
    let view = |texture: &wgpu::Texture, dimension| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            ..Default::default()
        })
    };
    let atlas = view(atlas, wgpu::TextureViewDimension::D2Array);
    let table = view(table, wgpu::TextureViewDimension::D2);
    let nearest = device.create_sampler(&wgpu::SamplerDescriptor::default());
    let resources = [
        uniforms.as_entire_binding(),
        wgpu::BindingResource::TextureView(&atlas),
        wgpu::BindingResource::TextureView(&table),
        wgpu::BindingResource::Sampler(&nearest),
    ];
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("canvas"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}

/// Creates a vertex buffer of these quads, with room for twice as many, at least 256.
fn quad_buffer(device: &wgpu::Device, quads: &[Quad]) -> wgpu::Buffer {
    let mut room = quads.to_vec();
    room.resize((2 * quads.len()).max(256), Quad::zeroed());
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("quads"),
        contents: bytemuck::cast_slice(&room),
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
    })
}

fn pipeline(
    device: &wgpu::Device,
    shader: &wgpu::ShaderModule,
    target: wgpu::TextureFormat,
    max_taps: u32,
) -> wgpu::RenderPipeline {
    let attributes = wgpu::vertex_attr_array![
        0 => Float32x2, 1 => Float32x2, 2 => Float32x2, 3 => Float32x2, 4 => Float32x2,
        5 => Float32, 6 => Uint32, 7 => Float32
    ];
    let encode = if target.is_srgb() { 0.0 } else { 1.0 };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("picture"),
        layout: None,
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some("corner_of"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Quad>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &attributes,
            })],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some("colour_of"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("ENCODE", encode), ("MAX_TAPS", f64::from(max_taps))],
                ..Default::default()
            },
            targets: &[Some(wgpu::ColorTargetState {
                format: target,
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
