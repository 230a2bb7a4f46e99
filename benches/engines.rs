//! Microseconds per integrated pixel of the home map (no mirror images, no forbidden starts) on
//! every engine of this machine, beside a scalar f64 RK4 loop on one core, all in one run.
//!
//! `cargo bench` prints a table; quote the ratio, because machines differ and are shared. Rounds
//! are interleaved, and the median of each engine is shown with its spread.

use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::gpu::device;
use flipmap_engine::gpu::open_checked;
use flipmap_engine::{Engine, EventSpec, IntegratorConfig, Method, Precision};
use flipmap_numbers::Dd;
use flipmap_report::{baseline, stopwatch};
use flipmap_scene::{Fate, Grid, Scene};

const SIDE: u32 = 512;
const ROUNDS: usize = 7;
/// Stride at which the scalar loop samples the engines' starts.
const SCALAR_SHARE: usize = 61;

fn main() {
    let scene = Scene::default();
    let question = EventSpec::from(&scene);
    let grid = Grid::new(&scene, [SIDE, SIDE]);
    let starts: Vec<[Dd; 2]> = (0..SIDE * SIDE)
        .filter_map(|k| match grid.fate(k % SIDE, k / SIDE) {
            Fate::Open(angle) => Some(angle),
            _ => None,
        })
        .collect();
    let some: Vec<[Dd; 2]> = starts.iter().step_by(SCALAR_SHARE).copied().collect();
    let mut rows = backends();
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); rows.len() + 1];
    // The first round compiles kernels and warms caches.
    for round in 0..=ROUNDS {
        let scalar = baseline::us_per_pixel(&question, &some);
        let others: Vec<f64> = rows
            .iter_mut()
            .map(|(_, engine, precision)| {
                let config = IntegratorConfig { method: Method::LESSON, precision: *precision };
                let ran = stopwatch::run(engine.as_mut(), &question, config, &starts, &|| false);
                ran.expect("the engine works").us_per_pixel
            })
            .collect();
        if round > 0 {
            for (list, time) in times.iter_mut().zip([scalar].into_iter().chain(others)) {
                list.push(time);
            }
        }
    }
    println!("{} integrated pixels, medians of {ROUNDS} rounds (least to most)", starts.len());
    let scalar = median(&mut times[0]);
    println!("{:48} {:>8.2} µs/pixel", "scalar f64 RK4 loop, one core", scalar);
    for ((name, engine, _), list) in rows.iter().zip(&mut times[1..]) {
        let time = median(list);
        println!(
            "{name:48} {time:>8.2} µs/pixel ({:.2} to {:.2})  {:>6.1}x  {}",
            list[0],
            list[list.len() - 1],
            scalar / time,
            engine.adapter()
        );
    }
}

type Contender = (&'static str, Box<dyn Engine>, Precision);

fn backends() -> Vec<Contender> {
    let mut rows: Vec<Contender> = Vec::new();
    let gpu = |specialised: bool| {
        let adapter = device::adapters().into_iter().next()?;
        let mut engine = open_checked(adapter, &[]).expect("the adapter opens");
        engine.set_specialised(specialised);
        Some(Box::new(engine) as Box<dyn Engine>)
    };
    let kinds = [
        ("gpu f32, made for the scene", true, Precision::F32),
        ("gpu f32, general", false, Precision::F32),
        ("gpu f64, made for the scene", true, Precision::F64),
        ("gpu f64, general", false, Precision::F64),
    ];
    for (name, specialised, precision) in kinds {
        rows.extend(gpu(specialised).map(|engine| (name, engine, precision)));
    }
    for (name, precision) in [("cpu f32", Precision::F32), ("cpu f64", Precision::F64)] {
        let engine = CpuEngine::new(None).expect("threads start");
        rows.push((name, Box::new(engine), precision));
    }
    rows
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
