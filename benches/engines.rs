//! Microseconds per integrated pixel of the home map (no mirror images, no forbidden starts) on
//! every engine here, beside a scalar f64 RK4 loop on one core, all in one run.
//!
//! `cargo bench` prints a table; the ratio is what to quote, because machines differ and are
//! shared. Rounds are interleaved, and the median of each is shown with its spread.

use std::time::Instant;

use flipmap::engine::choice::open_checked;
use flipmap::engine::cpu::CpuEngine;
use flipmap::engine::gpu::device;
use flipmap::engine::{Engine, Job, Method, Precision, Question, Recipe, Starts, Wait};
use flipmap::physics::trig::Turning;
use flipmap::physics::{Dd, State, flip, integrator};
use flipmap::scene::{Fate, Grid, Scene};

const SIDE: u32 = 512;
const ROUNDS: usize = 7;
/// The scalar loop runs every so many starts of what the engines run.
const SCALAR_SHARE: usize = 61;

fn main() {
    let scene = Scene::default();
    let question = Question::from(&scene);
    let grid = Grid::new(&scene, [SIDE, SIDE]);
    let starts: Vec<[Dd; 2]> = (0..SIDE * SIDE)
        .filter_map(|k| match grid.fate(k % SIDE, k / SIDE) {
            Fate::Open(angle) => Some(angle),
            _ => None,
        })
        .collect();
    let mut rows = contenders();
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); rows.len() + 1];
    // The first round compiles kernels and warms caches.
    for round in 0..=ROUNDS {
        let scalar = scalar_us_per_pixel(&question, &starts);
        let others: Vec<f64> = rows
            .iter_mut()
            .map(|(_, engine, precision)| {
                us_per_pixel(engine.as_mut(), *precision, &question, &starts)
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

fn contenders() -> Vec<Contender> {
    let mut rows: Vec<Contender> = Vec::new();
    let gpu = |specialised: bool| {
        let adapter = device::adapters().into_iter().next()?;
        let mut engine = open_checked(adapter).expect("the adapter opens");
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

fn us_per_pixel(
    engine: &mut dyn Engine,
    precision: Precision,
    question: &Question,
    starts: &[[Dd; 2]],
) -> f64 {
    let recipe = Recipe { method: Method::LESSON, precision };
    let begun = Instant::now();
    let mut jobs = (0..).zip(starts.chunks(engine.job_size()));
    let mut flying = 0;
    loop {
        while flying < engine.slots() {
            let Some((id, starts)) = jobs.next() else { break };
            let starts = Starts::Rest(starts.to_vec());
            let job = Job { id, question: *question, recipe, starts, keep_unfinished: false };
            engine.submit(job).expect("the job fits");
            flying += 1;
        }
        if flying == 0 {
            return begun.elapsed().as_secs_f64() * 1e6 / starts.len() as f64;
        }
        flying -= engine.poll(Wait::UntilFinished).expect("the engine works").len();
    }
}

fn scalar_us_per_pixel(question: &Question, starts: &[[Dd; 2]]) -> f64 {
    let step = 1.0 / 120.0;
    let begun = Instant::now();
    let (mut pixels, mut found) = (0, 0.0);
    for angle in starts.iter().step_by(SCALAR_SHARE) {
        let mut state = State::rest(angle.map(|theta| theta.hi));
        pixels += 1;
        for n in 0..3600 {
            let change = integrator::rk4(&question.pendulum, &state, step, Turning::Fresh);
            let next = state.plus(&change);
            if let Some(fraction) =
                flip::fraction_of_step(&question.pendulum, 1, &state, &next, step)
            {
                found += (f64::from(n) + fraction) * step;
                break;
            }
            state = next;
        }
    }
    std::hint::black_box(found);
    begun.elapsed().as_secs_f64() * 1e6 / f64::from(pixels)
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
