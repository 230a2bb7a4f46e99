//! Runs a custom integrator on the processor's SIMD lanes, and judges it by the gold standard.
//!
//! `cargo run --release --example custom_integrator`

use flipmap::{Dd, Outcome, Pendulum, Rule, oracle};
use flipmap_engine::EventSpec;
use flipmap_engine::cpu::outcomes;
use flipmap_pendulum::embedded::{Dop853, EmbeddedPair, Trial};
use flipmap_pendulum::flip::right_secs;
use flipmap_pendulum::phase::Phase;
use flipmap_scene::PendulumSpec;

/// Orders 3 and 2 (P. Bogacki and L. F. Shampine, *A 3(2) pair of Runge–Kutta formulas*, 1989).
struct BogackiShampine;

impl EmbeddedPair for BogackiShampine {
    const ORDER: u32 = 3;

    #[inline(always)]
    fn trial<T: flipmap_numbers::Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T> {
        let shifted = |change: &Phase<T>| std::array::from_fn(|i| phase[i] + change[i]);
        let slope = |change: &Phase<T>| pendulum.derivative(&shifted(change));
        let sum = |weights: [f64; 4], k: [&Phase<T>; 4]| -> Phase<T> {
            let part = |i: usize, j: usize| step.lit(weights[j]) * k[j][i];
            std::array::from_fn(|i| step * (part(i, 0) + part(i, 1) + part(i, 2) + part(i, 3)))
        };
        let k1 = pendulum.derivative(phase);
        let k2 = slope(&sum([0.5, 0.0, 0.0, 0.0], [&k1; 4]));
        let k3 = slope(&sum([0.75, 0.0, 0.0, 0.0], [&k2; 4]));
        let change = sum([2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0, 0.0], [&k1, &k2, &k3, &k3]);
        let k4 = slope(&change);
        let error = sum([-5.0 / 72.0, 1.0 / 12.0, 1.0 / 9.0, -0.125], [&k1, &k2, &k3, &k4]);
        Trial::new(change, &error, inverse_scale)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let build = PendulumSpec::default();
    let question = EventSpec { build, rule: Rule::Second, budget_secs: 4.0, passes: 1 };
    let start = |k: u32| [1.6 + 0.02 * f64::from(k % 8), 2.2 + 0.1 * f64::from(k / 8)];
    let starts: Vec<[Dd; 2]> = (0..64).map(|k| start(k).map(Dd::new)).collect();
    let own = outcomes::<BogackiShampine>(&question, 1e-9, &starts)?;
    let ours = outcomes::<Dop853>(&question, 1e-12, &starts)?;
    let is_right = |(start, answer): &(&[Dd; 2], &Outcome)| {
        let (pendulum, angle) = (question.build.pendulum(), start.map(|angle| angle.hi));
        let truth = oracle::outcome(&pendulum, angle, question.rule, question.budget_secs);
        answer.status == truth.status && (truth.time - answer.time).abs() < right_secs(1.0)
    };
    for (name, answers) in [("Bogacki-Shampine", own), ("DOP853", ours)] {
        let right = starts.iter().zip(&answers).filter(is_right).count();
        println!("{name}: {right} of {} right", starts.len());
    }
    Ok(())
}
