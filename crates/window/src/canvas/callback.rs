//! A frame of the map as a part of egui's frame.

use egui_wgpu::{CallbackResources, CallbackTrait, ScreenDescriptor};

use super::pipeline::{Canvas, MapFrame};

impl CallbackTrait for MapFrame {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(canvas) = resources.get_mut::<Canvas>() {
            canvas.load(device, queue, self);
            canvas.draw(device, queue, self);
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
