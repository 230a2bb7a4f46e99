//! A device's answers to the operations of the self-check, in each number type.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{CheckResult, operands};
use crate::EngineError;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::{bind, compute_pipeline, layout};
use crate::gpu::shared::{from_parts, to_parts};
use crate::gpu::waiting::Waiting;

/// The device's answers in f32.
pub(super) async fn answers_f32(
    gpu: &Gpu,
    waiting: Waiting<'_>,
    text: String,
) -> Result<Vec<CheckResult>, EngineError> {
    let operands: Vec<f32> = operands().into_iter().flatten().map(|x| x as f32).collect();
    let results: Vec<f32> = ask(gpu, waiting, text, &operands).await?;
    Ok(pair_up(operands.into_iter().map(f64::from), results.into_iter().map(f64::from)))
}

/// The device's answers in pairs of f32.
pub(super) async fn answers_df32(
    gpu: &Gpu,
    waiting: Waiting<'_>,
    text: String,
) -> Result<Vec<CheckResult>, EngineError> {
    let operands: Vec<[f32; 2]> = operands().into_iter().flatten().map(to_parts).collect();
    let results: Vec<[f32; 2]> = ask(gpu, waiting, text, &operands).await?;
    Ok(pair_up(operands.into_iter().map(from_parts), results.into_iter().map(from_parts)))
}

/// The device's answers in f64.
pub(super) async fn answers_f64(
    gpu: &Gpu,
    waiting: Waiting<'_>,
    text: String,
) -> Result<Vec<CheckResult>, EngineError> {
    let operands: Vec<f64> = operands().into_iter().flatten().collect();
    let results: Vec<f64> = ask(gpu, waiting, text, &operands).await?;
    Ok(pair_up(operands.into_iter(), results.into_iter()))
}

fn pair_up(
    operands: impl Iterator<Item = f64>,
    results: impl Iterator<Item = f64>,
) -> Vec<CheckResult> {
    let (operands, results): (Vec<f64>, Vec<f64>) = (operands.collect(), results.collect());
    operands
        .as_chunks()
        .0
        .iter()
        .zip(results.as_chunks().0)
        .map(|(&operands, &results)| CheckResult { operands, results })
        .collect()
}

/// Asks the device for seven answers to each pair of operands.
async fn ask<T: bytemuck::Pod>(
    gpu: &Gpu,
    waiting: Waiting<'_>,
    text: String,
    operands: &[T],
) -> Result<Vec<T>, EngineError> {
    use wgpu::BufferUsages as Usage;
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("selfcheck"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let layout = layout(&gpu.device, &[true, false, true]);
    let pipeline = compute_pipeline(&gpu.device, &module, "check", &[Some(&layout)]);
    let bytes = size_of_val(operands) as u64;
    let input = gpu.buffer("operands", bytes, Usage::STORAGE | Usage::COPY_DST)?;
    let output = gpu.buffer("answers", bytes / 2 * 7, Usage::STORAGE | Usage::COPY_SRC)?;
    let zero = gpu.buffer("zero", 16, Usage::STORAGE | Usage::COPY_DST)?;
    let back = gpu.buffer("answers read back", bytes / 2 * 7, Usage::MAP_READ | Usage::COPY_DST)?;
    gpu.queue.write_buffer(&input, 0, bytemuck::cast_slice(operands));
    let group = bind(&gpu.device, &layout, &[&input, &output, &zero]);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((operands.len() as u32 / 2).div_ceil(64), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &back, 0, output.size());
    gpu.queue.submit([encoder.finish()]);
    let landed = Arc::new(AtomicBool::new(false));
    back.map_async(wgpu::MapMode::Read, .., {
        let landed = landed.clone();
        move |_| landed.store(true, Ordering::Release)
    });
    while !landed.load(Ordering::Acquire) && !gpu.is_lost() {
        let waited = waiting.once(&gpu.device).await;
        gpu.check()?;
        waited?;
    }
    let view = back
        .slice(..)
        .get_mapped_range()
        .map_err(|error| EngineError::Driver(error.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&view))
}
