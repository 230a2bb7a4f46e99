//! The picture of the map, kept on the card from frame to frame.
//!
//! Most frames of the window change nothing of the map: a pendulum swings, a menu opens, a tile
//! arrives. So the map is drawn into a texture of its own, each time only the cells that have changed,
//! and a frame of the window copies it.

use std::collections::HashSet;

use super::pipeline::{CellQuads, MapFrame, Quad, Uniforms};
use crate::app::camera::Screen;

/// The kept picture.
pub struct KeptPicture {
    pipeline: wgpu::RenderPipeline,
    format: wgpu::TextureFormat,
    target: Option<KeptTarget>,
    drawn: Option<Drawn>,
}

/// The texture of a picture.
struct KeptTarget {
    size_px: [u32; 2],
    view: wgpu::TextureView,
    bindings: wgpu::BindGroup,
}

/// The content of a picture.
#[derive(Clone)]
struct Drawn {
    screen: Screen,
    uniforms: Uniforms,
    cells: Vec<CellQuads>,
}

impl Drawn {
    fn of(frame: &MapFrame) -> Self {
        Drawn { screen: frame.screen, uniforms: frame.uniforms, cells: frame.cells.clone() }
    }
}

/// The changes from one frame to the next.
#[derive(Debug, PartialEq)]
pub struct Changes {
    /// Quads of the cells that have changed, in drawing order.
    pub quads: Vec<Quad>,
    /// True if nothing of the picture before stays.
    pub clears: bool,
}

impl KeptPicture {
    /// Creates an empty picture that will be shown on targets of a format.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        KeptPicture { pipeline: pipeline(device, format), format, target: None, drawn: None }
    }

    /// Takes a frame as what the picture shows from now on, and returns what has to be drawn.
    pub fn take(&mut self, device: &wgpu::Device, frame: &MapFrame) -> Changes {
        let most = device.limits().max_texture_dimension_2d;
        let size_px = frame.size_px.map(|side| side.clamp(1, most));
        if self.target.as_ref().is_none_or(|target| target.size_px != size_px) {
            self.target = Some(self.target_of(device, size_px));
            self.drawn = None;
        }
        let before = self.drawn.as_ref().filter(|_| frame.table.is_none());
        let changes = changes(before, frame);
        if changes.clears || !changes.quads.is_empty() {
            self.drawn = Some(Drawn::of(frame));
        }
        changes
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
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
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
        KeptTarget { size_px, view, bindings }
    }

    /// Begins a pass that draws into the picture; none before the first frame.
    pub fn pass<'a>(
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

    /// Shows the picture in the viewport of a pass.
    pub fn show(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(target) = &self.target else { return };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &target.bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Returns what a frame changes of a picture; without one before, all.
fn changes(before: Option<&Drawn>, frame: &MapFrame) -> Changes {
    let uploaded: HashSet<u32> = frame.uploads.iter().map(|(slot, _)| *slot).collect();
    // What is drawn over a part of a cell leaves the rest of it as it was before.
    let uncovers =
        |(old, new): (&CellQuads, &CellQuads)| old != new && !new.whole && !old.quads.is_empty();
    let goes_on = |before: &&Drawn| {
        before.screen == frame.screen
            && before.uniforms == frame.uniforms
            && before.cells.len() == frame.cells.len()
            && !before.cells.iter().zip(&frame.cells).any(uncovers)
    };
    let Some(before) = before.filter(goes_on) else {
        let quads = frame.cells.iter().flat_map(|cell| cell.quads.iter().copied()).collect();
        return Changes { quads, clears: true };
    };
    let pairs = before.cells.iter().zip(&frame.cells);
    let changed = pairs.filter(|(old, new)| {
        old != new || new.quads.iter().any(|quad| uploaded.contains(&quad.slot))
    });
    let quads = changed.flat_map(|(_, new)| new.quads.iter().copied()).collect();
    Changes { quads, clears: false }
}

fn pipeline(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("kept picture"),
        source: wgpu::ShaderSource::Wgsl(include_str!("../../../shaders/kept.wgsl").into()),
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

    use super::*;
    use crate::app::canvas::sample::WordKind;
    use crate::app::state::tests::state;
    use crate::tiles::Samples;

    fn quad(slot: u32) -> Quad {
        Quad { slot, ..Quad::zeroed() }
    }

    /// The quads of a cell, which is not whole if slot 9 is among them.
    fn cell(slots: &[u32]) -> CellQuads {
        let quads: Vec<Quad> = slots.iter().copied().map(quad).collect();
        CellQuads { whole: !quads.is_empty() && !slots.contains(&9), quads }
    }

    fn frame(slots: &[&[u32]], uploaded: &[u32]) -> MapFrame {
        let samples = Arc::new(Samples::unflipped(0));
        MapFrame {
            screen: state().screen(),
            cells: slots.iter().copied().map(cell).collect(),
            uploads: uploaded.iter().map(|slot| (*slot, Arc::clone(&samples))).collect(),
            words: Arc::new(WordKind::Times),
            uniforms: Uniforms::zeroed(),
            table: None,
            size_px: [4, 4],
            is_loaded: Arc::default(),
        }
    }

    #[test]
    fn only_cells_that_change_are_drawn_again() {
        let first = frame(&[&[1], &[2, 3], &[4]], &[]);
        assert_eq!(changes(None, &first).quads.len(), 4);
        let drawn = Drawn::of(&first);
        let drawn_again = |frame: &MapFrame| {
            let Changes { quads, clears } = changes(Some(&drawn), frame);
            (quads.iter().map(|quad| quad.slot).collect::<Vec<_>>(), clears)
        };
        assert_eq!(drawn_again(&first), (vec![], false), "nothing has changed");
        assert_eq!(drawn_again(&frame(&[&[1], &[2, 5], &[4]], &[])), (vec![2, 5], false));
        assert_eq!(drawn_again(&frame(&[&[1], &[2, 3], &[4]], &[3])), (vec![2, 3], false));
        assert_eq!(drawn_again(&frame(&[&[1], &[2, 3]], &[])), (vec![1, 2, 3], true));
        assert_eq!(drawn_again(&frame(&[&[], &[2, 3], &[4]], &[])), (vec![2, 3, 4], true));
        assert_eq!(drawn_again(&frame(&[&[1], &[9], &[4]], &[])), (vec![1, 9, 4], true), "a part");
        let mut moved = frame(&[&[1], &[2, 3], &[4]], &[]);
        moved.screen.camera.width_rad *= 0.99;
        assert_eq!(drawn_again(&moved), (vec![1, 2, 3, 4], true));
        let mut recoloured = frame(&[&[1], &[2, 3], &[4]], &[]);
        recoloured.uniforms.trust = 1;
        assert_eq!(drawn_again(&recoloured), (vec![1, 2, 3, 4], true));
    }
}
