//! Greatest speeds of the second bob.

use flipmap_engine::level::{BALANCED, FAST};
use flipmap_engine::{IntegratorConfig, Precision};
use flipmap_numbers::{Angle, Dd, Scalar};
use flipmap_pendulum::State;
use flipmap_pendulum::taylor::{Orbit, TaylorStep};
use flipmap_render::tiles::Samples;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Kind, PendulumSpec, Plane, Scene};
use rayon::prelude::*;

use crate::common::{gpu_engine, lesson};
use crate::truth::*;

/// Number of parts of a step in which the truth looks for a maximum.
const PARTS: usize = 16;
/// Half the time in s between the two places of the bob whose difference gives its speed.
const APART_SECS: f64 = 1e-9;

/// Where the end of the second rod is in a step of an orbit, in m.
fn place(scene: &Scene, step: &TaylorStep<Dd>, tau: Dd) -> [Dd; 2] {
    let State { angle, .. } = step.state(tau);
    let [l1, l2] = scene.build.lengths.map(|length| Dd::from_theta(length.exact()));
    let [(sin1, cos1), (sin2, cos2)] = angle.map(|angle| angle.sin_cos());
    [l1 * sin1 + l2 * sin2, l1 * cos1 + l2 * cos2]
}

/// The speed of the second bob in m/s, from two places shortly before and after.
fn speed(scene: &Scene, step: &TaylorStep<Dd>, tau: f64) -> f64 {
    let [behind, ahead] =
        [-APART_SECS, APART_SECS].map(|by| place(scene, step, Dd::new(tau) + Dd::new(by)));
    let way = [0, 1].map(|i| (ahead[i] - behind[i]).to_f64());
    way[0].hypot(way[1]) / (2.0 * APART_SECS)
}

/// The greatest value of a function with one maximum between two times, and its time, by golden
/// section and at both ends.
fn narrowed(value: &dyn Fn(f64) -> f64, ends: [f64; 2]) -> [f64; 2] {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let [mut low, mut high] = ends;
    while high - low > 1e-8 {
        let [a, b] = [high - golden * (high - low), low + golden * (high - low)];
        if value(a) < value(b) { low = a } else { high = b }
    }
    let all = [ends[0], low, high, ends[1]].map(|at| [value(at), at]);
    all.into_iter().fold([0.0; 2], |best, now| if now[0] > best[0] { now } else { best })
}

/// The greatest speed within `secs` and its time in s: the gold standard's orbit in double-double,
/// in 16 parts of each step, and between the parts beside the fastest ones by golden section.
fn true_greatest(scene: &Scene, start: State<Dd>, secs: f64) -> [f64; 2] {
    let mut orbit = Orbit::new(scene.build.pendulum_in::<Dd>(), start);
    let mut best = [0.0, 0.0];
    while orbit.time().hi < secs {
        let step = orbit.step();
        let length = (step.end() - step.start).hi.min(secs - step.start.hi);
        let at = |part: usize| length * part as f64 / PARTS as f64;
        let speeds: Vec<f64> = (0..=PARTS).map(|part| speed(scene, &step, at(part))).collect();
        for part in 0..=PARTS {
            let (first, last) = (part.saturating_sub(1), (part + 1).min(PARTS));
            let is_top = speeds[first].max(speeds[last]) <= speeds[part];
            if is_top && speeds[part] > best[0] - 0.1 {
                let [value, tau] = narrowed(&|tau| speed(scene, &step, tau), [at(first), at(last)]);
                if value > best[0] {
                    best = [value, step.start.hi + tau];
                }
            }
        }
    }
    best
}

fn truths(scene: &Scene, side: u32, secs: f64) -> Vec<[f64; 2]> {
    let of = |k| true_greatest(scene, start(scene, side, k).unwrap(), secs);
    (0..side * side).into_par_iter().map(of).collect()
}

/// Largest relative error of the speeds of the best `share` of answers.
fn worst(samples: &Samples, truths: &[[f64; 2]], share: f64) -> f64 {
    let error = |(k, truth): (usize, &[f64; 2])| (samples.values(k)[0] / truth[0] - 1.0).abs();
    let mut errors: Vec<f64> = truths.iter().enumerate().map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors[(share * (errors.len() - 1) as f64) as usize]
}

#[test]
fn the_greatest_speeds_of_a_thousand_starts_are_the_gold_standards() {
    let home = scene(QuestionName::Speed, Plane::default(), "6", 3.0);
    let truths = truths(&home, 32, 3.0);
    let by = |config: IntegratorConfig| by_cpu(&home, 32, config);
    let balanced = by(BALANCED);
    assert!(worst(&balanced, &truths, 1.0) < 1e-6, "{:e}", worst(&balanced, &truths, 1.0));
    let soon = |k: usize| (balanced.values(k)[1] - truths[k][1]).abs() < 1e-3;
    let soon = (0..truths.len()).filter(|k| soon(*k)).count();
    assert!(soon >= 1020, "times of {soon} of 1024");
    for (config, allowed) in [(FAST, 1e-3), (lesson(Precision::F64), 1e-3)] {
        let off = worst(&by(config), &truths, 0.98);
        assert!(off < allowed && off > 1e-9, "{config:?}: {off:e}");
    }
}

/// Bars of unlike lengths, thrown, with friction.
fn thrown(secs: f64) -> Scene {
    let throw = plane("speeds", ["2.5", "-1", "0", "0"]);
    let bars = PendulumSpec::new(Kind::Rods, [1.0, 0.7], [1.5, 0.6], 4.0);
    let build = PendulumSpec { friction: [0.02.into(), 0.01.into()], ..bars };
    Scene { build, ..scene(QuestionName::Speed, throw, "12", secs) }.checked().unwrap()
}

#[test]
fn bars_with_friction_and_both_ends_of_the_motion_count() {
    for (secs, least_at_ends) in [(0.05, 48), (0.6, 4), (2.5, 1)] {
        let scene = thrown(secs);
        let truths = truths(&scene, 8, secs);
        let at_ends =
            truths.iter().filter(|[_, time]| *time < 1e-6 || (*time - secs).abs() < 1e-6).count();
        assert!(at_ends >= least_at_ends, "{secs} s: {at_ends} at the ends");
        let off = worst(&by_cpu(&scene, 8, BALANCED), &truths, 1.0);
        assert!(off < 1e-8, "{secs} s: {off:e}");
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn the_card_finds_the_speeds_that_the_processor_does() {
    let scene = thrown(2.5);
    for config in [BALANCED, FAST, lesson(Precision::F64), lesson(Precision::F32)] {
        let by_card = rendered(&scene, 12, config, Box::new(gpu_engine()));
        let by_cpu = by_cpu(&scene, 12, config);
        let allowed = if config.precision == Precision::F32 { 1e-4 } else { 1e-8 };
        let off = |k: usize| (by_card.values(k)[0] / by_cpu.values(k)[0] - 1.0).abs();
        let worst = (0..144).map(off).fold(0.0, f64::max);
        assert!(worst < allowed, "{config:?}: {worst:e}");
    }
}
