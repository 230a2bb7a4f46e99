//! The picture of the map, kept on the card from frame to frame.
//!
//! Most frames of the window change little or nothing of the map: a pendulum swings, a menu opens,
//! a tile arrives. A map that stays in place is therefore drawn into a texture of its own, in which
//! only changed cells are drawn again, and each frame of the window copies the texture. A map that
//! moves or changes its colours is drawn straight into the window: all of it changes, and a copy
//! would only add work.

use std::collections::HashSet;

use super::pipeline::{CellQuads, MapFrame, Quad, Uniforms};
use crate::camera::Screen;

/// The kept picture.
pub(crate) struct KeptPicture {
    pipeline: wgpu::RenderPipeline,
    format: wgpu::TextureFormat,
    target: Option<KeptTarget>,
    content: Content,
}

/// The texture of a picture.
pub(crate) struct KeptTarget {
    size_px: [u32; 2],
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    bindings: wgpu::BindGroup,
}

impl KeptTarget {
    /// Returns the texture and its size in pixels.
    pub(crate) fn texture(&self) -> (&wgpu::Texture, [u32; 2]) {
        (&self.texture, self.size_px)
    }
}

/// The content of a picture.
#[derive(Clone, Default)]
struct Content {
    /// Screen, colours and mixing of the last frame, even if it is not in the picture.
    last: Option<(Screen, Uniforms, bool)>,
    /// Quads in the picture; none if it does not show the last frame.
    cells: Option<Vec<CellQuads>>,
    /// Number of changes so far.
    version: u64,
}

/// The surface that a frame draws on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DrawingSurface {
    /// The window.
    Window,
    /// The picture, cleared first.
    Cleared,
    /// The picture as it is.
    Kept,
}

/// The drawing that a frame needs.
#[derive(Debug, PartialEq)]
pub(crate) struct Changes {
    /// Quads of the cells that have changed, in drawing order.
    pub quads: Vec<Quad>,
    /// Surface that they are drawn on.
    pub on: DrawingSurface,
}

impl Content {
    /// Makes a frame the current one, and returns what has to be drawn.
    fn take(&mut self, frame: &MapFrame) -> Changes {
        let shown = Some((frame.screen, frame.uniforms, frame.mixes));
        let stays = self.last == shown && frame.table.is_none();
        self.last = shown;
        if !stays {
            self.cells = None;
            return Changes { quads: all(frame), on: DrawingSurface::Window };
        }
        let changes = changes(self.cells.as_deref(), frame);
        if changes.on == DrawingSurface::Cleared || !changes.quads.is_empty() {
            self.version += 1;
            self.cells = Some(frame.cells.clone());
        }
        changes
    }
}

impl KeptPicture {
    /// Creates an empty picture that will be shown on targets of a format.
    pub(crate) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let (pipeline, content) = (pipeline(device, format), Content::default());
        KeptPicture { pipeline, format, target: None, content }
    }

    /// Makes a frame the current one, and returns what has to be drawn.
    pub(crate) fn take(&mut self, device: &wgpu::Device, frame: &MapFrame) -> Changes {
        let most = device.limits().max_texture_dimension_2d;
        let size_px = frame.size_px.map(|side| side.clamp(1, most));
        if self.target.as_ref().is_none_or(|target| target.size_px != size_px) {
            self.target = Some(self.target_of(device, size_px));
            self.content.cells = None;
        }
        self.content.take(frame)
    }

    fn target_of(&self, device: &wgpu::Device, size_px: [u32; 2]) -> KeptTarget {
        let [width, height] = size_px;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("kept picture"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("kept picture"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&view),
            }],
        });
        KeptTarget { size_px, texture, view, bindings }
    }

    /// Returns the number of changes of the picture so far.
    pub(crate) fn version(&self) -> u64 {
        self.content.version
    }

    /// Returns the picture; none before the first frame.
    pub(crate) fn target(&self) -> Option<&KeptTarget> {
        self.target.as_ref()
    }

    /// Returns a texture like the picture's with these pixels, four bytes each; none if they are
    /// those of a picture of another size.
    pub(crate) fn target_with(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pixels: &[u8],
    ) -> Option<KeptTarget> {
        let size_px = self.target.as_ref()?.size_px;
        let [width, height] = size_px;
        if pixels.len() as u64 != 4 * u64::from(width) * u64::from(height) {
            return None;
        }
        let target = self.target_of(device, size_px);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: None,
        };
        queue.write_texture(target.texture.as_image_copy(), pixels, layout, target.texture.size());
        Some(target)
    }

    /// Begins a pass that draws into the picture; none before the first frame.
    pub(crate) fn pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        clears: bool,
    ) -> Option<wgpu::RenderPass<'a>> {
        let view = &self.target.as_ref()?.view;
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let load = if clears { clear } else { wgpu::LoadOp::Load };
        Some(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("kept picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        }))
    }

    /// Shows the picture, or another in its place, in the viewport of a pass.
    pub(crate) fn show(&self, pass: &mut wgpu::RenderPass<'_>, other: Option<&KeptTarget>) {
        let Some(target) = other.or(self.target.as_ref()) else { return };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &target.bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn all(frame: &MapFrame) -> Vec<Quad> {
    frame.cells.iter().flat_map(|cell| cell.quads.iter().copied()).collect()
}

/// Returns what a frame changes in a picture of the same screen and colours, or all of the frame if
/// there is none.
fn changes(before: Option<&[CellQuads]>, frame: &MapFrame) -> Changes {
    let uploaded: HashSet<u32> = frame.uploads.iter().map(|upload| upload.slot).collect();
    // Drawing over a part of a cell leaves the old content in the rest of it.
    let uncovers =
        |(old, new): (&CellQuads, &CellQuads)| old != new && !new.whole && !old.quads.is_empty();
    let goes_on = |before: &&[CellQuads]| {
        before.len() == frame.cells.len() && !before.iter().zip(&frame.cells).any(uncovers)
    };
    let Some(before) = before.filter(goes_on) else {
        return Changes { quads: all(frame), on: DrawingSurface::Cleared };
    };
    let changed = before.iter().zip(&frame.cells).filter(|(old, new)| {
        old != new || new.quads.iter().any(|quad| uploaded.contains(&quad.slot))
    });
    let quads = changed.flat_map(|(_, new)| new.quads.iter().copied()).collect();
    Changes { quads, on: DrawingSurface::Kept }
}

fn pipeline(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("kept picture"),
        source: wgpu::ShaderSource::Wgsl(flipmap_shaders::KEPT.into()),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("kept picture"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("corner_of"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some("colour_of"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use bytemuck::Zeroable;
    use glam::DVec2;

    use super::*;
    use crate::camera::Camera;
    use crate::canvas::pipeline::Upload;
    use crate::canvas::sample::WordKind;
    use crate::reach::Reach;
    use flipmap_render::tiles::Samples;

    fn quad(slot: u32) -> Quad {
        Quad { slot, ..Quad::zeroed() }
    }

    /// The quads of a cell, which is not whole if slot 9 is among them.
    fn cell(slots: &[u32]) -> CellQuads {
        let quads: Vec<Quad> = slots.iter().copied().map(quad).collect();
        CellQuads { whole: !quads.is_empty() && !slots.contains(&9), quads }
    }

    fn screen() -> Screen {
        let camera = Camera::whole(Reach::TORUS);
        Screen { camera, size: DVec2::new(1280.0, 800.0), pixels_per_point: 1.0 }
    }

    fn frame(slots: &[&[u32]], uploaded: &[u32]) -> MapFrame {
        let samples = Arc::new(Samples::unflipped(0));
        let upload = |slot| Upload { slot, samples: Arc::clone(&samples), side: 0 };
        MapFrame {
            screen: screen(),
            mixes: true,
            cells: slots.iter().copied().map(cell).collect(),
            uploads: uploaded.iter().map(|&slot| upload(slot)).collect(),
            words: Arc::new(WordKind::Times),
            uniforms: Uniforms::zeroed(),
            table: None,
            size_px: [4, 4],
            ground: None,
            is_loaded: Arc::default(),
            is_grainy: Arc::default(),
        }
    }

    #[test]
    fn only_cells_that_change_are_drawn_again() {
        let first = frame(&[&[1], &[2, 3], &[4]], &[]);
        let mut drawn = Content::default();
        let all = vec![1, 2, 3, 4];
        let told = |content: &mut Content, frame: &MapFrame| {
            let Changes { quads, on } = content.take(frame);
            (quads.iter().map(|quad| quad.slot).collect::<Vec<_>>(), on)
        };
        use DrawingSurface::{Cleared, Kept, Window};
        assert_eq!(told(&mut drawn, &first), (all.clone(), Window), "it may move on");
        assert_eq!(told(&mut drawn, &first), (all.clone(), Cleared), "it stays");
        let drawn_again = |frame: &MapFrame| told(&mut drawn.clone(), frame);
        assert_eq!(drawn_again(&first), (vec![], Kept), "nothing has changed");
        assert_eq!(drawn_again(&frame(&[&[1], &[2, 5], &[4]], &[])), (vec![2, 5], Kept));
        assert_eq!(drawn_again(&frame(&[&[1], &[2, 3], &[4]], &[3])), (vec![2, 3], Kept));
        assert_eq!(drawn_again(&frame(&[&[1], &[2, 3]], &[])), (vec![1, 2, 3], Cleared));
        assert_eq!(drawn_again(&frame(&[&[], &[2, 3], &[4]], &[])), (vec![2, 3, 4], Cleared));
        let part = frame(&[&[1], &[9], &[4]], &[]);
        assert_eq!(drawn_again(&part), (vec![1, 9, 4], Cleared), "a part");
        let mut moved = frame(&[&[1], &[2, 3], &[4]], &[]);
        moved.screen.camera.width_rad *= 0.99;
        assert_eq!(drawn_again(&moved), (all.clone(), Window));
        let mut recoloured = frame(&[&[1], &[2, 3], &[4]], &[]);
        recoloured.uniforms.trust = 1;
        assert_eq!(drawn_again(&recoloured), (all.clone(), Window));
        // What was drawn before the move is no longer in the picture.
        told(&mut drawn, &moved);
        assert_eq!(told(&mut drawn, &first), (all.clone(), Window));
        assert_eq!(told(&mut drawn, &first), (all, Cleared));
    }
}
