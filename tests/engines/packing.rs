//! Outcomes that a card packs before they are read back.

use crate::common::*;
use flipmap_engine::gpu::GpuEngine;
use flipmap_engine::{
    Engine, EventSpec, IntegratorConfig, IntegratorState, Job, JobResult, Keep, Method, Precision,
    Starts, Wait,
};
use flipmap_pendulum::{Rule, Status};
use flipmap_scene::Scene;

needs_adapter! {
    checks:
    packed_outcomes_are_those_that_come_back_whole
    work_beyond_a_word_is_counted
    packed_outcomes_are_a_third_of_the_bytes
}

fn result(engine: &mut GpuEngine, keep: Keep, job: &Job) -> JobResult {
    engine.submit(Job { keep, ..job.clone() }).unwrap();
    engine.poll(Wait::UntilFinished).unwrap().remove(0)
}

/// Returns the results of a job, packed and unpacked. States, which only the second has, and lane
/// steps, which depend on timing, are removed. The results are too long to print if they differ.
fn both(engine: &mut GpuEngine, job: &Job) -> [JobResult; 2] {
    [Keep::NOTHING, Keep::STATES].map(|keep| {
        let mut result = result(engine, keep, job);
        result.unfinished.clear();
        result.effort.lane_steps = 0;
        result
    })
}

/// Returns the job of a home map with this many pixels along each side.
fn job(question: EventSpec, config: IntegratorConfig, side: u32) -> Job {
    let starts = Starts::Rest(open_starts(&Scene::default(), side, 1));
    Job { id: 7, question, config, starts, keep: Keep::NOTHING }
}

mod checks {
    use super::*;

    pub(crate) fn packed_outcomes_are_those_that_come_back_whole() {
        let config = |method, precision| IntegratorConfig { method, precision };
        let methods = [
            lesson(Precision::F32),
            lesson(Precision::F64),
            config(Method::dopri5(1e-7), Precision::F32),
            config(Method::dopri5(1e-9), Precision::Df32),
            config(Method::dop853(1e-12), Precision::F64),
        ];
        let mut engine = gpu_engine();
        for config in methods {
            for rule in [Rule::Second, Rule::Either, Rule::Neither] {
                let question = EventSpec { rule, budget_secs: 6.0, ..question(&Scene::default()) };
                let [packed, whole] = both(&mut engine, &job(question, config, 24));
                assert!(packed == whole, "{config:?} {rule:?}");
                let flipped = packed.outcomes.iter().filter(|o| o.status == Status::Answered);
                assert_eq!(flipped.count() > 0, rule != Rule::Neither);
                assert!(packed.effort.steps > 0 && packed.outcomes.len() > 100);
            }
        }
    }

    pub(crate) fn work_beyond_a_word_is_counted() {
        let mut engine = gpu_engine();
        for precision in [Precision::F32, Precision::F64] {
            let (question, config) = (question(&Scene::default()), lesson(precision));
            let soon = EventSpec { budget_secs: 1.0, ..question };
            let begun = result(&mut engine, Keep::STATES, &job(soon, config, 24));
            // Adds so many earlier steps to each pendulum that the steps of nine fill a word.
            let before = u32::MAX / 9;
            let late = |(_, state): (usize, IntegratorState)| IntegratorState {
                steps: state.steps + before,
                ..state
            };
            let states: Vec<IntegratorState> = begun.unfinished.into_iter().map(late).collect();
            assert!(states.len() > 300);
            let budget_secs = f64::from(before + 700) / 120.0;
            let starts = Starts::Resumed { states, thrown: false };
            let question = EventSpec { budget_secs, ..question };
            let [packed, whole] = both(&mut engine, &Job { starts, ..job(question, config, 1) });
            assert!(packed == whole, "{precision}");
            let steps = packed.effort.steps as usize / packed.outcomes.len();
            assert!((100..700).contains(&steps), "{steps} steps each");
        }
    }

    pub(crate) fn packed_outcomes_are_a_third_of_the_bytes() {
        let mut engine = gpu_engine();
        // Bytes of the list lengths after each submission, and of the work counts.
        let (progress, work) = (272, 32);
        let adaptive = Method::dop853(1e-12);
        for (config, packed) in [
            (lesson(Precision::F32), 8),
            (lesson(Precision::F64), 12),
            (IntegratorConfig { method: adaptive, precision: Precision::F64 }, 8),
        ] {
            let job = job(question(&Scene::default()), config, 32);
            let mut bytes = |keep| {
                let before = engine.gpu_stats().unwrap_or_default();
                let count = result(&mut engine, keep, &job).outcomes.len() as u64;
                let after = engine.gpu_stats().unwrap();
                let submissions = after.submissions - before.submissions;
                (after.download_bytes - before.download_bytes - submissions * progress, count)
            };
            // The first job of a configuration checks its orbits.
            bytes(Keep::NOTHING);
            let (all, count) = bytes(Keep::NOTHING);
            assert_eq!(all, work + packed * count, "{config:?}");
            assert!(bytes(Keep::STATES).0 > 24 * count);
        }
    }
}
