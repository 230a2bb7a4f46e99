//! Taylor expansions on the card, by which `exact` checks other methods.

use crate::common::*;
use crate::rewritten::Rewritten;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::gpu::device::is_software;
use flipmap_engine::level::FINEST;
use flipmap_engine::trust::TrustEngine;
use flipmap_engine::{
    Accuracy, Engine, EventSpec, FinalState, Job, JobResult, Keep, Starts, Trust, Wait,
};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Rule, Status};
use flipmap_scene::Scene;
use flipmap_scene::question::Needs;

needs_adapter! {
    checks:
    they_end_where_those_of_the_processor_do
    they_count_the_passes_that_the_processor_counts
    they_carry_no_tangents
    exact_is_sure_of_the_same_starts
}

/// A question whose budget is so short that roundings stay small.
fn soon(rule: Rule, passes: u32) -> EventSpec {
    EventSpec { rule, passes, budget_secs: 4.0, ..question(&Scene::default()) }
}

/// Returns the results of both engines, with all final states.
fn on_both(question: EventSpec, starts: &[[Dd; 2]]) -> [JobResult; 2] {
    let ended = |engine: &mut dyn Engine| {
        let starts = Starts::Rest(starts.to_vec());
        let job = Job { id: 0, question, config: FINEST, starts, keep: Keep::ENDS };
        engine.submit(job).unwrap();
        engine.poll(Wait::UntilFinished).unwrap().remove(0)
    };
    let both = [ended(&mut gpu_engine()), ended(&mut CpuEngine::new(None).unwrap())];
    assert!(both.iter().all(|result| result.ends.len() == starts.len()));
    let statuses = |result: &JobResult| -> Vec<Status> {
        result.outcomes.iter().map(|outcome| outcome.status).collect()
    };
    assert_eq!(statuses(&both[0]), statuses(&both[1]), "{question:?}");
    both
}

mod checks {
    use super::*;

    pub(crate) fn they_end_where_those_of_the_processor_do() {
        let starts = open_starts(&Scene::default(), 64, 1);
        for rule in [Rule::Second, Rule::Either] {
            let [gpu, cpu] = on_both(soon(rule, 1), &starts);
            // A pendulum that does not flip ends with the last step of the budget, and steps differ
            // slightly in length.
            let flipped = gpu.outcomes.iter().map(|outcome| outcome.status == Status::Answered);
            let ends = gpu.ends.iter().zip(&cpu.ends).zip(flipped);
            let ends: Vec<(&FinalState, &FinalState)> =
                ends.filter(|(_, flips)| *flips).map(|(e, _)| e).collect();
            assert!(ends.len() > 300, "{}", ends.len());
            for (a, b) in &ends {
                assert!((a.time - b.time).abs() < 1e-8, "{a:?} and {b:?}");
                let apart = |i: usize| (a.phase[i] - b.phase[i]).abs();
                assert!((0..6).all(|i| apart(i) < 1e-8), "{a:?} and {b:?}");
                assert_eq!(a.clearance == 0.0, b.clearance == 0.0, "{a:?} and {b:?}");
            }
            // Clearances are bounds, which depend on how a step is divided.
            let near = ends.iter().filter(|(a, b)| a.clearance.min(b.clearance) > 0.0);
            let ratios: Vec<f64> = near.map(|(a, b)| (a.clearance / b.clearance).ln()).collect();
            let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
            assert!(ratios.len() > 100 && mean.abs() < 0.5, "{}, {mean}", ratios.len());
        }
    }

    pub(crate) fn they_count_the_passes_that_the_processor_counts() {
        let starts = open_starts(&Scene::default(), 48, 1);
        for (rule, passes) in [(Rule::Either, u32::MAX), (Rule::Second, 3)] {
            let both = on_both(soon(rule, passes), &starts);
            let [gpu, cpu] = both.map(|result| {
                result.ends.iter().map(|end| end.gathered.passes).collect::<Vec<[u32; 4]>>()
            });
            assert_eq!(gpu, cpu, "{rule}");
            assert!(gpu.iter().flatten().sum::<u32>() > 1000);
            // Both bobs pass, in both directions, some more than once.
            let counted = |place: usize| gpu.iter().map(move |passes| passes[place]).max();
            let most: Vec<u32> = (0..4).filter_map(counted).collect();
            let watched = if rule == Rule::Either { 0 } else { 2 };
            assert!(most[watched..].iter().all(|&most| most > 1), "{most:?}");
        }
    }

    pub(crate) fn they_carry_no_tangents() {
        let starts = Starts::Rest(open_starts(&Scene::default(), 8, 1));
        let keep = Keep { ends: Needs::Growth, states: false };
        let question = soon(Rule::Neither, 1);
        let job = Job { id: 0, question, config: FINEST, starts, keep };
        let error = gpu_engine().submit(job).unwrap_err().to_string();
        assert!(
            error.contains("the method taylor") && error.contains("graphics adapters"),
            "{error}"
        );
    }

    pub(crate) fn exact_is_sure_of_the_same_starts() {
        let starts = open_starts(&Scene::default(), 96, 1);
        let question = question(&Scene::default());
        let config = Accuracy::Exact.configs()[0];
        let checked = |engine: Box<dyn Engine>| {
            let starts = Starts::Rest(starts.clone());
            finished(&mut TrustEngine::new(engine, None).unwrap(), &question, config, starts)
        };
        let gpu = gpu_engine();
        assert_eq!(gpu.checks_by(&FINEST), !is_software(&gpu.gpu().adapter));
        let card = Rewritten { engine: gpu, rewrite: |job| job };
        assert!(card.checks_by(&FINEST), "the card makes the check");
        let [gpu, cpu] =
            [checked(Box::new(card)), checked(Box::new(CpuEngine::new(None).unwrap()))];
        for assurances in [&gpu.assurances, &cpu.assurances] {
            let confirmed = assurances.iter().filter(|it| it.trust() == Trust::Confirmed).count();
            assert!(confirmed > 100, "{confirmed} starts of {} needed more digits", starts.len());
            assert!(assurances.iter().all(|it| it.trust() != Trust::Uncertain));
        }
        assert_eq!(share_within(1e-3, &gpu.outcomes, &cpu.outcomes), 1.0);
    }
}
