//! Measures microseconds per pixel of narrow views at eleven places on filaments, on all cores with
//! a budget of 30 s, as multiples of those of a view 0.08 rad wide at the same place in the same
//! run. `flipmap deeper` found the last ten of them.

use std::time::Instant;

use flipmap_engine::Engine;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::level::BALANCED;
use flipmap_render::tiles::Work;
use flipmap_render::tiles::preview::preview;
use flipmap_scene::{Scene, View};

const SIDE: u32 = 512;

const CENTRES: [[&str; 2]; 11] = [
    ["-1.6601", "0.1003"],
    ["1.16643583588875", "2.017332919421875"],
    ["-0.8266539131865625", "-2.5526856524621875"],
    ["-1.3899794495525", "1.0555264617596875"],
    ["1.94190051824625", "-0.8532475304696875"],
    ["0.8036377433925", "2.6803324110215625"],
    ["1.6603227648996875", "0.5270327138059375"],
    ["-1.6505716904121875", "-1.44376811923875"],
    ["1.61190927076625", "1.01710427270875"],
    ["0.833536017264375", "-2.2317888684284375"],
    ["-1.200572521159375", "2.187707712525625"],
];

const WIDTHS: [&str; 6] = ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-8"];

fn main() {
    print!("{:32} {:>9}", "centre", "0.08, µs");
    WIDTHS.iter().for_each(|width| print!(" {width:>6}"));
    println!();
    for center in CENTRES {
        let base = us_per_pixel(center, "0.08");
        print!("{:>15.12},{:>15.12}  {base:>9.1}", center[0], center[1]);
        for width in WIDTHS {
            print!(" {:>5.2}x", us_per_pixel(center, width) / base);
        }
        println!();
    }
}

/// Returns the time per pixel of a picture, including the references that it needs.
fn us_per_pixel(center: [&str; 2], width: &str) -> f64 {
    let view =
        View { center: center.map(str::to_string), width: width.to_string(), ..View::default() };
    let scene = Scene { view, ..Scene::default() }.checked().expect("a view");
    let processor = Box::new(CpuEngine::new(None).expect("a processor"));
    let mut engine = DepthEngine::new(processor, None).expect("threads");
    let begun = Instant::now();
    let mut work = Work::new(&scene, [SIDE; 2], BALANCED, engine.job_size());
    preview(&mut work, [SIDE; 2], &mut engine, &|_| true).expect("the engine works");
    begun.elapsed().as_secs_f64() * 1e6 / f64::from(SIDE * SIDE)
}
