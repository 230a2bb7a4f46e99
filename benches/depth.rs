//! Measures the seconds until the first small picture of a deep view is complete, on one core: the
//! reference in many digits, the cells followed as polynomials, and 16 × 16 pixels. Then, with the
//! reference known, compares microseconds per pixel with those of a view 1e-3 rad wide.

use std::time::Instant;

use flipmap_engine::Engine;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::level::BALANCED;
use flipmap_render::tiles::Work;
use flipmap_render::tiles::preview::preview;
use flipmap_scene::{BuiltIn, Document, Scene};

const SMALL: u32 = 16;
const LARGE: u32 = 256;

fn main() {
    let shallow = Document::parse(
        "[view]\ncenter = [\"1.186751171875\", \"2.043855078125\"]\nwidth = \"1e-3\"",
    );
    let shallow = shallow.expect("a scene").scene();
    let named = |name| BuiltIn::named(name).expect("a place").document().scene();
    let base = measured("1e-3", &shallow, 0.0);
    for name in ["abyss", "trench", "seabed"] {
        measured(name, &named(name), base);
    }
}

/// Prints the times of a view and returns its microseconds per pixel.
fn measured(name: &str, scene: &Scene, base: f64) -> f64 {
    let processor = Box::new(CpuEngine::new(Some(1)).expect("a processor"));
    let mut engine = DepthEngine::new(processor, Some(1)).expect("a thread");
    let first = secs(scene, SMALL, &mut engine);
    secs(scene, LARGE, &mut engine);
    let us = secs(scene, LARGE, &mut engine) * 1e6 / f64::from(LARGE * LARGE);
    let ratio = if base > 0.0 { format!("  {:.2}x", us / base) } else { String::new() };
    println!("{name:8} first picture {first:>7.2} s, then {us:>6.1} µs/pixel{ratio}");
    us
}

fn secs(scene: &Scene, side: u32, engine: &mut dyn Engine) -> f64 {
    let begun = Instant::now();
    let mut work = Work::new(scene, [side; 2], BALANCED, engine.job_size());
    preview(&mut work, [side; 2], engine, &|_| true).expect("the engine works");
    begun.elapsed().as_secs_f64()
}
