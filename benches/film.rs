//! Compares the cost of a film that zooms over ten decades, samples and painting, with that of its
//! 600 frames rendered one by one, in one run. Renders only every `FLIPMAP_EVERY`th frame (every
//! 12th by default), with as many samples per pixel as the film, and counts it for its neighbours.

use std::time::Instant;

use flipmap_engine::Engine;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::level::BALANCED;
use flipmap_render::farm::{Parts, Plan, PlannedOutput, Task, run};
use flipmap_render::film::FilmRecipe;
use flipmap_render::tiles::Work;
use flipmap_render::tiles::preview::preview;
use flipmap_scene::film::Film;
use flipmap_scene::keys::{Easing, Key};
use flipmap_scene::{BuiltIn, Document, Sampling};

const FRAMES: u32 = 600;
const SIZE: [u32; 2] = [96, 72];
const SAMPLES: u32 = 2;

fn main() {
    let every = std::env::var("FLIPMAP_EVERY").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let film = film();
    let (samples, computing, painting) = whole(&film);
    let frames = (0..FRAMES).step_by(every).collect::<Vec<_>>();
    let one_by_one: f64 = frames.iter().map(|frame| rendered(&film, *frame)).sum();
    let one_by_one = one_by_one * f64::from(FRAMES) / frames.len() as f64;
    let all = f64::from(FRAMES * SIZE[0] * SIZE[1] * SAMPLES * SAMPLES);
    println!("film: {samples} samples in {computing:.1} s, painted in {painting:.1} s");
    println!("one by one: {all} samples in {one_by_one:.1} s, from {} frames", frames.len());
    println!(
        "the film costs {:.3} of its frames, and has {:.3} of their samples",
        (computing + painting) / one_by_one,
        samples as f64 / all
    );
}

/// A film from home down a filament, with the budget of its last view.
fn film() -> Film {
    let deep = BuiltIn::named("abyss").expect("a place").document();
    let key = |secs, width: &str, center: [String; 2]| {
        let mut scene = Document { question: deep.question, ..Document::default() };
        (scene.view.width, scene.view.center) = (width.to_string(), center);
        scene.picture.samples = Sampling::Square(SAMPLES);
        Key { secs, easing: Easing::Linear, clock: None, scene }
    };
    let home = key(0.0, "6.28", ["0".into(), "0".into()]);
    let end = key(20.0, "6.28e-10", deep.view.center.clone());
    Film { size: SIZE, frames: FRAMES, fps: 30.0, keys: vec![home, end] }
}

fn engine() -> DepthEngine<'static> {
    let processor = Box::new(CpuEngine::new(None).expect("a processor"));
    DepthEngine::new(processor, None).expect("threads")
}

/// Returns the number of samples, and the seconds to compute and to paint them.
fn whole(film: &Film) -> (u64, f64, f64) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut engine = engine();
    let plan = Plan::new(PlannedOutput::Film(film.clone()), 1, (&engine, BALANCED, false), false);
    let task = Task::new(plan, &folder.path().join("plan.toml")).expect("a plan");
    let begun = Instant::now();
    let pieces = task.missing(1, &Parts::default());
    run(&task, &pieces, &mut engine, &|_, _| true).expect("the engine works");
    let computing = begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    let mut parts = Parts::scan(&task.folder, task.forms()).expect("parts");
    let (document, output) = (&film.keys[0].scene, &folder.path().join("frames"));
    let recipe = FilmRecipe { film, document, output };
    recipe.merge(None, &task, &mut parts, &|_, _| true).expect("frames");
    (task.samples(), computing, begun.elapsed().as_secs_f64())
}

/// Seconds to compute a single frame.
fn rendered(film: &Film, frame: u32) -> f64 {
    let scene = film.shot(frame).scene;
    let size = SIZE.map(|side| side * SAMPLES);
    let mut engine = engine();
    let begun = Instant::now();
    let mut work = Work::new(&scene, size, BALANCED, engine.job_size());
    preview(&mut work, size, &mut engine, &|_| true).expect("the engine works");
    begun.elapsed().as_secs_f64()
}
