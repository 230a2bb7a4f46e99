//! Compares a quick map with an exact one, pixel by pixel.
//!
//! `cargo run --release --example compare_arrays`
use flipmap::{Accuracy, EngineKind, EngineRequest, IntegrationSetting, Renderer, Samples, Scene};

const SIZE: [u32; 2] = [48, 48];
/// Greatest difference in s that counts as equal.
const TOLERANCE_SECS: f64 = 1e-3;

fn map(level: Accuracy) -> Result<Samples, Box<dyn std::error::Error>> {
    let setting = IntegrationSetting::Accuracy(level);
    let kind = Some(EngineKind::Cpu);
    let request = EngineRequest { kind, setting, ..EngineRequest::default() };
    Ok(Renderer::new(&request)?.render(&Scene::default(), SIZE)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (quick, exact) = (map(Accuracy::Lesson)?, map(Accuracy::Exact)?);
    let differ = quick
        .iter()
        .zip(exact.iter())
        .filter(|(a, b)| a.status != b.status || (a.time - b.time).abs() > TOLERANCE_SECS);
    println!("{} of {} pixels of the lesson's map are wrong", differ.count(), exact.len());
    Ok(())
}
