use flipmap::engine::cpu::CpuEngine;
use flipmap::engine::depth::DepthEngine;
use flipmap::engine::level::{BALANCED, BALANCED_DF32, FAST};
use flipmap::engine::{Engine, Recipe};
use flipmap::physics::{Fixed, Outcome, Pendulum, Scalar, Status, Theta, gold};
use flipmap::scene::{Budget, Scene, View};
use flipmap::tiles::Work;
use flipmap::tiles::preview::preview;
use rayon::prelude::*;
use std::time::Instant;

struct Place { center: [&'static str; 2], width: &'static str }
const PLACES: [Place; 9] = 
include!("/tmp/x/places.in");
fn scene(p: &Place) -> Scene {
    let view = View { center: p.center.map(str::to_string), width: p.width.to_string(), ..View::default() };
    let mut scene = Scene { view, ..Scene::default() };
    scene.question.budget.auto = true;
    scene.question.budget = Budget::for_view(scene.question.budget, &scene.build, &scene.view);
    scene
}
fn truth<const N: usize>(scene: &Scene, pixel: usize) -> Outcome {
    let [x, y] = [pixel % 24, pixel / 24].map(|k| k as f64);
    let px = scene.view.width_rad().to_f64() / 24.0;
    let by = [x + 0.5 - 12.0, 12.0 - y - 0.5].map(|by| Theta::from_f64(by * px));
    let c = scene.view.center_rad();
    let angle = [0, 1].map(|i| (c[i] + by[i]).resized::<N>());
    let pendulum: Pendulum<Fixed<N>> = scene.build.pendulum().convert();
    let o = gold::outcome(&pendulum, angle, scene.question.rule, Fixed::from_f64(scene.question.budget.secs));
    Outcome { status: o.status, time: o.time.to_f64() }
}
fn truths(p: &Place, n: usize) -> Vec<(usize, Outcome)> {
    let scene = scene(p);
    let file = format!("/tmp/x/tr-{}-{n}.json", p.width);
    let pixels: Vec<usize> = (0..n).map(|k| (k * 576 + 288) / n).collect();
    if let Ok(text) = std::fs::read_to_string(&file) {
        return text.lines().zip(pixels).map(|(l, k)| {
            let (s, t) = l.split_once(' ').unwrap();
            let status = match s { "Flipped" => Status::Flipped, "Unflipped" => Status::Unflipped, _ => Status::Forbidden };
            (k, Outcome { status, time: t.parse().unwrap() })
        }).collect();
    }
    let w = scene.view.width_rad().to_f64();
    let o: Vec<Outcome> = pixels.par_iter().map(|k| if w > 1e-24 { truth::<4>(&scene, *k) } else if w > 1e-40 { truth::<5>(&scene, *k) } else { truth::<7>(&scene, *k) }).collect();
    std::fs::write(&file, o.iter().map(|o| format!("{:?} {:?}\n", o.status, o.time)).collect::<String>()).unwrap();
    pixels.into_iter().zip(o).collect()
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let recipe: Recipe = match args[1].as_str() { "f32" => FAST, "df32" => BALANCED_DF32, "dd" => Recipe { method: flipmap::engine::Method::Taylor { tolerance: 1e-24 }, precision: flipmap::engine::Precision::Dd }, "t64" => Recipe { method: flipmap::engine::Method::Taylor { tolerance: 1e-15 }, precision: flipmap::engine::Precision::F64 }, _ => BALANCED };
    let n: usize = args[2].parse().unwrap();
    let side: u32 = args[3].parse().unwrap();
    for k in args[4..].iter().map(|a| a.parse::<usize>().unwrap()) {
        let p = &PLACES[k];
        let scene = scene(p);
        let mut engine = DepthEngine::new(Box::new(CpuEngine::new(None).unwrap()), None).unwrap();
        let t = Instant::now();
        let mut work = Work::new(&scene, [24; 2], recipe, engine.job_size());
        let s = preview(&mut work, [24; 2], &mut engine, &|| true).unwrap().unwrap();
        let first = t.elapsed().as_secs_f64();
        let mut us = f64::MAX; let mut steps = 0.0; let mut rhs = 0.0; let mut b = [0.0; 2];
        for _ in 0..3 {
            let t = Instant::now();
            let mut work = Work::new(&scene, [side; 2], recipe, engine.job_size());
            preview(&mut work, [side; 2], &mut engine, &|| true).unwrap().unwrap();
            us = us.min(t.elapsed().as_secs_f64() * 1e6 / f64::from(side * side));
            let e = work.counts().effort;
            steps = e.steps as f64 / f64::from(side * side);
            rhs = e.rhs_evaluations as f64 / f64::from(side * side);
            b = e.depth.map_or([0.0; 2], |d| d.begins_secs);
        }
        let tr = truths(p, n);
        let right = tr.iter().filter(|(k, t)| { let a = s.get(*k); a.status == t.status && (a.status != Status::Flipped || (a.time - t.time).abs() <= 1e-3) }).count();
        if std::env::var("SHOW").is_ok() { for (k, t) in tr.iter().filter(|(k, t)| { let a = s.get(*k); !(a.status == t.status && (a.status != Status::Flipped || (a.time - t.time).abs() <= 1e-3)) }).take(14) { println!("{k} {:?} {:?}", s.get(*k), t); } }
        println!("{} {}: right {:.4} first {:.2} s, {:.2} us/px steps {:.0} rhs {:.0} begins {:?}", args[1], p.width, right as f64 / n as f64, first, us, steps, rhs, b);
    }
}
