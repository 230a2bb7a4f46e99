//! Measures the cost of everything around an engine: writes PNGs of two scenes with an engine that
//! answers at once. Prints nanoseconds of processor time per pixel, over all threads, and seconds
//! until the file is complete.

use std::time::Instant;

use flipmap_engine::mock::MockEngine;
use flipmap_engine::{Cells, IntegratorConfig, Method, Precision};
use flipmap_render::output::{Paths, RenderClock, Sinks, pass_work, render_pass};
use flipmap_render::tiles::Renderer;
use flipmap_scene::{BuiltIn, Document, Sampling};

/// Samples per pixel, and pixels along each side.
const PICTURES: [(Sampling, u32); 4] = [
    (Sampling::SINGLE, 1024),
    (Sampling::SINGLE, 4096),
    (Sampling::SINGLE, 8192),
    (Sampling::Corners, 4096),
];
const CONFIG: IntegratorConfig =
    IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
/// Number of starts in a job for a graphics card.
const JOB_SIZE: usize = 1 << 20;

fn main() {
    let filigree = BuiltIn::named("filigree").expect("a place").document();
    let home = BuiltIn::home().document();
    for (name, document) in [("home", &home), ("filigree", &filigree)] {
        for (samples, side) in PICTURES {
            let (secs, cpu_secs) = drawn(document, samples, side);
            let pixels = f64::from(side) * f64::from(side);
            let ns = cpu_secs.map_or("unknown".to_string(), |s| format!("{:.1}", s * 1e9 / pixels));
            println!(
                "{name:9} {side:>5}²  samples {samples:<7} {secs:>6.2} s  {ns:>6} ns of processor \
                 time a pixel"
            );
        }
    }
}

/// Returns the seconds until a picture is complete, and the seconds of processor time it takes.
fn drawn(document: &Document, samples: Sampling, side: u32) -> (f64, Option<f64>) {
    let mut document = document.clone();
    document.picture.samples = samples;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let size = [side; 2];
    let paths = Paths { picture: Some(folder.path().join("map.png")), ..Paths::default() };
    let (begun, before) = (Instant::now(), cpu_secs());
    let engine = Box::new(MockEngine { job_size: JOB_SIZE, ..MockEngine::default() });
    let mut renderer = Renderer::of(engine, CONFIG, false, None).expect("an engine");
    let mut sinks = Sinks::open(&paths, &document, size).expect("a file");
    let clock = &mut RenderClock::default();
    for pass in sinks.passes(samples) {
        let (what, whither) = ((&document, Cells::Auto), (&mut sinks, &pass));
        let mut work =
            pass_work(&mut renderer, what, size, whither, clock, &|_| true).expect("a pass");
        render_pass(&mut work, renderer.engine(), &mut sinks, &pass, clock, &mut |_| true)
            .expect("done");
    }
    sinks.finish().expect("a complete file");
    let cpu = cpu_secs().zip(before).map(|(after, before)| after - before);
    (begun.elapsed().as_secs_f64(), cpu)
}

/// Seconds of processor time of the whole process, if the system reports them.
fn cpu_secs() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program, which may have spaces, ends with the last parenthesis.
    let numbers = stat.rsplit_once(')')?.1.split_whitespace().skip(11).take(2);
    let ticks: f64 = numbers.map(|ticks| ticks.parse::<f64>()).sum::<Result<_, _>>().ok()?;
    const TICKS_A_SECOND: f64 = 100.0;
    Some(ticks / TICKS_A_SECOND)
}
