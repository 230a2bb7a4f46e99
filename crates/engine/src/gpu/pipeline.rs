//! A compiled kernel: the pipelines of one [`Design`].

use super::device::Gpu;
use super::kernel::Design;
use crate::EngineError;

/// The entry points of a design, compiled for one device.
pub(crate) struct Kernel {
    /// The design that the pipelines were made from.
    pub design: Design,
    /// Pipeline that swaps the lists and sizes the next dispatch.
    pub turn: wgpu::ComputePipeline,
    /// Pipeline that takes whole steps.
    pub advance: wgpu::ComputePipeline,
    /// Pipeline that looks for flips in steps in which the top may be reached.
    pub look: wgpu::ComputePipeline,
    /// Pipeline that puts the pendulums of an upright picture at their starts, where there is one.
    pub begin: Option<wgpu::ComputePipeline>,
    layouts: [wgpu::BindGroupLayout; 3],
}

impl Kernel {
    /// Compiles `design` with `workgroup` invocations in a workgroup.
    pub(crate) fn new(gpu: &Gpu, design: Design, workgroup: u32) -> Result<Self, EngineError> {
        let kernel = Kernel::compile(&gpu.device, design, workgroup);
        gpu.check()?;
        Ok(kernel)
    }

    /// Compiles `design` on any thread; its errors go to the error scopes of that thread, or to the
    /// device's error handler.
    pub(super) fn compile(device: &wgpu::Device, design: Design, workgroup: u32) -> Self {
        let text = in_workgroups(&design.text(), workgroup);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("tile"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let [job, size, starts] =
            [&[true, false, false, false, false][..], &[false], &[true, true]]
                .map(|read_only| layout(device, read_only));
        let pipeline = |entry: &str, groups: &[Option<&wgpu::BindGroupLayout>]| {
            compute_pipeline(device, &module, entry, groups)
        };
        let begin = || pipeline("begin", &[Some(&job), None, Some(&starts)]);
        Kernel {
            design,
            turn: pipeline("turn", &[Some(&job), Some(&size)]),
            advance: pipeline("advance", &[Some(&job)]),
            look: pipeline("look", &[Some(&job)]),
            begin: design.begins().then(begin),
            layouts: [job, size, starts],
        }
    }

    /// Creates a bind group of this kernel.
    pub(crate) fn bind(
        &self,
        gpu: &Gpu,
        group: usize,
        buffers: &[&wgpu::Buffer],
    ) -> wgpu::BindGroup {
        bind(&gpu.device, &self.layouts[group], buffers)
    }
}

/// The text of a kernel with another number of invocations in a workgroup.
fn in_workgroups(text: &str, workgroup: u32) -> String {
    text.replace("const WORKGROUP = 64u;", &format!("const WORKGROUP = {workgroup}u;"))
}

/// Returns the number of workgroups for `count` invocations, or as many as a dispatch can have, in
/// which case each invocation takes several places.
pub(super) fn workgroups(count: u32, workgroup: u32) -> u32 {
    const MAX_PER_SIDE: u32 = 65_535;
    count.div_ceil(workgroup).min(MAX_PER_SIDE)
}

/// A layout of storage buffers, each read-only or not.
pub(crate) fn layout(device: &wgpu::Device, read_only: &[bool]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(read_only)
        .map(|(binding, &read_only)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    })
}

/// Creates a bind group of buffers in the order of their bindings.
pub(crate) fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    buffers: &[&wgpu::Buffer],
) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(buffers)
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// Compiles one entry point of a module.
pub(crate) fn compute_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    entry: &str,
    groups: &[Option<&wgpu::BindGroupLayout>],
) -> wgpu::ComputePipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: groups,
        immediate_size: 0,
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: Some(&layout),
        module,
        entry_point: Some(entry),
        compilation_options: Default::default(),
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::level::LESSON;

    #[test]
    fn every_kernel_takes_another_size_of_workgroup() {
        let text = Design::general(&LESSON, true, false).unwrap().text();
        assert_eq!(in_workgroups(&text, 64), text);
        assert_ne!(in_workgroups(&text, 128), text);
    }
}
