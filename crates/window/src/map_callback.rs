//! A frame of the map as a part of egui's frame.

use egui_wgpu::{CallbackResources, CallbackTrait, ScreenDescriptor};

use flipmap_screen::canvas::pipeline::{Canvas, MapFrame};

/// A frame of the map that egui passes to the canvas.
pub(crate) struct MapCallback(pub MapFrame);

impl CallbackTrait for MapCallback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(canvas) = resources.get_mut::<Canvas>() {
            let MapCallback(frame) = self;
            canvas.load(device, queue, frame);
            canvas.draw(device, queue, frame);
        }
        Vec::new()
    }

    fn paint(
        &self,
        _: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(canvas) = resources.get::<Canvas>() {
            canvas.show(pass);
        }
    }
}
