//! Properties that only the GPU engine must have.

use std::time::{Duration, Instant};

use crate::common::*;
use crate::rewritten::Rewritten;
use flipmap_engine::adapters::{Pairs, Verdict};
use flipmap_engine::choice::{EngineRequest, IntegrationSetting, choose};
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::gpu::device::{Gpu, is_software};
use flipmap_engine::gpu::selfcheck;
use flipmap_engine::gpu::{GpuEngine, MAX_KERNELS};
use flipmap_engine::level::{BALANCED_DF32, FAST_TO_COMPILE, FINEST};
use flipmap_engine::{
    Accuracy, Engine, EngineError, EngineKind, EventSpec, GpuTuning, IntegratorConfig, Job, Keep,
    Method, Precision, Starts, Wait,
};
use flipmap_numbers::Decimal;
use flipmap_pendulum::Rule;
use flipmap_pendulum::extremum::Extremum;
use flipmap_scene::question::Needs;
use flipmap_scene::{PendulumSpec, Scene};

/// The `lesson` configurations in both precisions, those of `fast` and `balanced`, and expansions.
fn configs() -> Vec<IntegratorConfig> {
    let levels = [Accuracy::Fast, Accuracy::Balanced].map(|level| level.configs()[0]);
    let lessons = [lesson(Precision::F32), lesson(Precision::F64)];
    lessons.into_iter().chain(levels).chain([FINEST]).collect()
}

needs_adapter! {
    checks:
    the_two_engines_agree_on_early_flips
    the_length_of_slices_changes_nothing
    slices_end_growth_and_returns_in_the_same_numbers
    several_slices_in_a_submission_take_the_same_steps
    used_buffers_and_other_settings_change_no_answer
    an_engine_on_its_own_thread_gives_the_same_answers_and_tells_what_it_did
    orbits_are_checked_once_before_the_first_job_of_a_method_and_precision
    a_general_kernel_is_as_right_as_one_made_for_the_scene
    a_picture_is_computed_by_the_kernel_that_it_was_begun_with
    a_slider_in_motion_compiles_nothing_and_kernels_are_bounded
    two_f32_are_nearly_as_right_as_f64
    a_lost_device_is_replaced_and_its_jobs_done_again
    the_selfcheck_passes_here_and_its_answers_are_judged
    pairs_of_f32_are_computed_in_the_first_way_that_is_exact
    orbits_pass_by_every_scheme_and_arithmetic_of_another_precision_does_not
    an_untrusted_precision_is_refused_by_name
    f32_without_compensation_still_works
    buffers_beyond_the_limits_are_refused_in_words
}

/// Returns the job in f32, whatever its precision.
fn in_f32(job: Job) -> Job {
    let config = IntegratorConfig { precision: Precision::F32, ..job.config };
    let config = match config.method {
        // f32 is never requested with a method of higher order.
        Method::Embedded { pair, .. } if pair.data().order <= 5 => config,
        Method::Embedded { .. } | Method::Taylor { .. } | Method::Extrapolation { .. } => {
            Accuracy::Fast.configs()[0]
        }
        Method::Rk4 { .. } => config,
    };
    Job { config, ..job }
}

mod checks {
    use super::*;

    pub(crate) fn the_two_engines_agree_on_early_flips() {
        let question = question(&Scene::default());
        let starts = open_starts(&Scene::default(), 512, 4);
        let (mut gpu, mut cpu) = (gpu_engine(), CpuEngine::new(None).unwrap());
        for config in configs() {
            let gpu = answers(&mut gpu, &question, config, &starts);
            let cpu = answers(&mut cpu, &question, config, &starts);
            let (gpu, cpu) = flips_before(2.0, &gpu, &cpu);
            let agree = share_within(1e-5, &gpu, &cpu);
            assert!(agree >= 0.99, "{config:?}: {agree} of {}", cpu.len());
        }
    }

    pub(crate) fn the_length_of_slices_changes_nothing() {
        let question = question(&Scene::default());
        let starts = open_starts(&Scene::default(), 40, 1);
        for config in configs() {
            let outcomes = [1, 20_000].map(|pace| {
                let mut engine = gpu_engine();
                engine.set_pace(Duration::from_micros(pace));
                answers(&mut engine, &question, config, &starts)
            });
            assert_eq!(outcomes[0], outcomes[1], "{config:?}");
        }
    }

    pub(crate) fn slices_end_growth_and_returns_in_the_same_numbers() {
        let question = EventSpec { rule: Rule::Neither, ..question(&Scene::default()) };
        let starts = open_starts(&Scene::default(), 24, 1);
        for ends in [Needs::Growth, Needs::Extremum(Extremum::NearestReturn)] {
            for config in configs().into_iter().filter(|config| *config != FINEST) {
                let results = [1, 1_000_000].map(|pace| {
                    let mut engine = gpu_engine();
                    engine.set_pace(Duration::from_micros(pace));
                    let starts = Starts::Rest(starts.clone());
                    let keep = Keep { ends, states: false };
                    engine.submit(Job { id: 7, question, config, starts, keep }).unwrap();
                    engine.poll(Wait::UntilFinished).unwrap().remove(0)
                });
                assert_eq!(results[0].ends, results[1].ends, "{ends:?} {config:?}");
            }
        }
    }

    pub(crate) fn several_slices_in_a_submission_take_the_same_steps() {
        let question = question(&Scene::default());
        let starts = open_starts(&Scene::default(), 40, 1);
        for config in [lesson(Precision::F32), Accuracy::Balanced.configs()[0]] {
            let [one, many] = ["slices=1", "slices=8"].map(|slices| {
                let mut engine = gpu_engine();
                let tuning = GpuTuning::default().with("pace=1000").unwrap();
                engine.tune(tuning.with(slices).unwrap());
                // The first job also measures how fast the kernel is.
                answers(&mut engine, &question, config, &starts);
                let before = engine.gpu_stats().unwrap().submissions;
                let starts = Starts::Rest(starts.clone());
                let finished = finished(&mut engine, &question, config, starts);
                (finished, engine.gpu_stats().unwrap().submissions - before)
            });
            assert_eq!(one.0.outcomes, many.0.outcomes, "{config:?}");
            assert_eq!(one.0.effort, many.0.effort, "{config:?}");
            assert!(2 * many.1 < one.1, "{config:?}: {} of {} submissions", many.1, one.1);
        }
    }

    pub(crate) fn used_buffers_and_other_settings_change_no_answer() {
        let question = question(&Scene::default());
        let sides = [80, 40, 79];
        let starts = sides.map(|side| open_starts(&Scene::default(), side, 1));
        for config in configs() {
            let mut used = gpu_engine();
            used.tune(GpuTuning::default().with("workgroup=128").unwrap());
            for starts in &starts {
                let mut new = gpu_engine();
                new.tune(GpuTuning::default().with("subgroups=off").unwrap());
                let [used, new] =
                    [&mut used, &mut new].map(|e| answers(e, &question, config, starts));
                assert_eq!(used, new, "{config:?}");
            }
        }
    }

    pub(crate) fn an_engine_on_its_own_thread_gives_the_same_answers_and_tells_what_it_did() {
        let (question, config) = (question(&Scene::default()), lesson(Precision::F32));
        let starts = open_starts(&Scene::default(), 64, 1);
        let expected = answers(&mut gpu_engine(), &question, config, &starts);
        let request = EngineRequest {
            kind: Some(EngineKind::Gpu),
            setting: IntegrationSetting::Explicit(config),
            ..EngineRequest::default()
        };
        let mut engine = choose(&request, &|_| {}).unwrap().engine;
        // Checks use other tolerances, and methods that a software adapter leaves to the processor.
        assert!(engine.offers(&Accuracy::Fast.configs()[0]));
        assert_eq!(engine.offers(&FINEST), !is_software(&gpu_engine().gpu().adapter));
        assert!(!engine.offers(&IntegratorConfig { precision: Precision::Dd, ..FINEST }));
        let before = engine.gpu_stats().unwrap();
        let begun = Instant::now();
        assert_eq!(answers(engine.as_mut(), &question, config, &starts), expected);
        let (secs, after) = (begun.elapsed().as_secs_f64(), engine.gpu_stats().unwrap());
        assert!(after.slices > before.slices && after.submissions <= after.slices);
        let gpu_secs = after.gpu_secs - before.gpu_secs;
        assert!(gpu_secs > 0.0 && gpu_secs < secs, "{gpu_secs} of {secs} s");
        assert!(after.compile_secs > 0.0 && after.host_wait_secs > 0.0);
        // Each start uploads 24 bytes of state and its list index, and downloads 8 bytes of
        // outcome.
        let count = starts.len() as u64;
        assert!(after.upload_bytes - before.upload_bytes > 28 * count);
        assert!(after.download_bytes - before.download_bytes > 8 * count);
    }

    pub(crate) fn orbits_are_checked_once_before_the_first_job_of_a_method_and_precision() {
        let question = question(&Scene::default());
        let starts = open_starts(&Scene::default(), 8, 1);
        let mut engine = gpu_engine();
        let orbits = |engine: &GpuEngine| -> Vec<(&str, Precision)> {
            let checks = engine.verdict().checks.iter();
            let orbits = checks.filter(|check| check.name.starts_with("orbits"));
            orbits.map(|check| (check.name, check.precision)).collect()
        };
        assert_eq!(orbits(&engine), []);
        for config in [0, 1, 0, 1].map(|k| lesson([Precision::F32, Precision::F64][k])) {
            answers(&mut engine, &question, config, &starts);
        }
        let both = [("orbits by rk4", Precision::F32), ("orbits by rk4", Precision::F64)];
        assert_eq!(orbits(&engine), both);
        // A job in flight is not lost by the check before the next one.
        let (config, more) = (lesson(Precision::F32), Accuracy::Fast.configs()[0]);
        for (id, config) in [(7, config), (8, more)] {
            let starts = Starts::Rest(starts.clone());
            engine.submit(Job { id, question, config, starts, keep: Keep::NOTHING }).unwrap();
        }
        let mut ids = Vec::new();
        while ids.len() < 2 {
            ids.extend(engine.poll(Wait::UntilFinished).unwrap().iter().map(|done| done.id));
        }
        ids.sort_unstable();
        assert_eq!((ids, orbits(&engine).len()), (vec![7, 8], 3));
    }

    pub(crate) fn a_general_kernel_is_as_right_as_one_made_for_the_scene() {
        let starts = open_starts(&Scene::default(), 64, 1);
        for rule in [Rule::Second, Rule::Either] {
            let question = EventSpec { rule, ..question(&Scene::default()) };
            let truth = truth(&question, &starts);
            for config in &configs()[1..] {
                let right = [true, false].map(|specialised| {
                    let mut engine = gpu_engine();
                    engine.set_specialised(specialised);
                    let answers = answers(&mut engine, &question, *config, &starts);
                    share_within(1e-3, &answers, &truth)
                });
                assert!((right[0] - right[1]).abs() < 0.01, "{rule} {config:?}: {right:?}");
            }
        }
    }

    /// Returns the question at one position of a slider of masses.
    fn slid(step: u32) -> EventSpec {
        let masses = [1.0, 1.5 + 0.01 * f64::from(step)].map(Decimal::from);
        let build = PendulumSpec { masses, ..PendulumSpec::default() };
        question(&Scene { build, ..Scene::default() })
    }

    pub(crate) fn a_picture_is_computed_by_the_kernel_that_it_was_begun_with() {
        let (question, starts) = (slid(0), open_starts(&Scene::default(), 64, 1));
        let config = lesson(Precision::F32);
        let [own, general] = [true, false].map(|specialised| {
            let mut engine = gpu_engine();
            engine.set_specialised(specialised);
            answers(&mut engine, &question, config, &starts)
        });
        assert_ne!(own, general, "this test would see no switch");
        let mut engine = gpu_engine();
        engine.tune(GpuTuning { at_once: true, ..GpuTuning::default() });
        assert_eq!(answers(&mut engine, &question, config, &starts), general);
        let rest = Starts::Rest(starts.clone());
        let job = Job { id: 0, question, config, starts: rest, keep: Keep::NOTHING };
        let begun = Instant::now();
        while !engine.has_own_kernel(&job).unwrap() {
            assert!(begun.elapsed() < Duration::from_secs(120), "it is never compiled");
            std::thread::sleep(Duration::from_millis(20));
        }
        assert_eq!(answers(&mut engine, &question, config, &starts), general, "the same picture");
        engine.begin_picture();
        assert_eq!(answers(&mut engine, &question, config, &starts), own, "the next picture");
    }

    pub(crate) fn a_slider_in_motion_compiles_nothing_and_kernels_are_bounded() {
        let (config, starts) = (lesson(Precision::F32), open_starts(&Scene::default(), 4, 1));
        let mut engine = gpu_engine();
        engine.tune(GpuTuning { at_once: true, ..GpuTuning::default() });
        answers(&mut engine, &slid(0), config, &starts);
        // The kernel that checks orbits, the general one, and perhaps one compiled while the
        // machine stalled.
        let before = engine.kernel_count();
        for step in 1..40 {
            engine.begin_picture();
            answers(&mut engine, &slid(step), config, &starts);
        }
        let after = engine.kernel_count();
        assert!(after <= before + 2, "{after} kernels after {before}");
        // Without a general kernel every scene has its own kernel, and the oldest are dropped.
        engine.tune(GpuTuning::default());
        let first = answers(&mut engine, &slid(1), config, &starts);
        for step in 2..MAX_KERNELS as u32 + 4 {
            answers(&mut engine, &slid(step), config, &starts);
        }
        assert_eq!(engine.kernel_count(), MAX_KERNELS);
        assert_eq!(answers(&mut engine, &slid(1), config, &starts), first);
    }

    pub(crate) fn two_f32_are_nearly_as_right_as_f64() {
        assert_eq!(Accuracy::Balanced.configs()[1], BALANCED_DF32);
        let (scene, mut engine) = (Scene::default(), gpu_engine());
        let (question, starts) = (question(&scene), open_starts(&scene, 512, 16));
        let orbits = selfcheck::orbits(&mut engine, &[BALANCED_DF32]).unwrap();
        assert!(orbits[0].passed, "{orbits:?}");
        let [pairs, beside] = [Precision::Df32, Precision::F64].map(|precision| {
            let config = IntegratorConfig { precision, ..BALANCED_DF32 };
            finished(&mut engine, &question, config, Starts::Rest(starts.clone()))
        });
        let right = share_within(1e-3, &pairs.outcomes, &truth(&question, &starts));
        assert!(right >= 0.99, "{right} of {}", starts.len());
        let ratio = pairs.effort.steps as f64 / beside.effort.steps as f64;
        assert!((0.95..1.05).contains(&ratio), "noise in errors: {ratio} times f64's steps");
    }

    pub(crate) fn a_lost_device_is_replaced_and_its_jobs_done_again() {
        let question = question(&Scene::default());
        let starts = open_starts(&Scene::default(), 64, 1);
        let config = lesson(Precision::F32);
        let expected = answers(&mut gpu_engine(), &question, config, &starts);
        let mut engine = gpu_engine();
        for id in [1, 2] {
            let starts = Starts::Rest(starts.clone());
            engine.submit(Job { id, question, config, starts, keep: Keep::NOTHING }).unwrap();
        }
        engine.gpu().device.destroy();
        let mut finished = Vec::new();
        while finished.len() < 2 {
            finished.extend(engine.poll(Wait::UntilFinished).unwrap());
        }
        for answer in finished {
            assert_eq!(answer.outcomes, expected);
        }
    }

    pub(crate) fn the_selfcheck_passes_here_and_its_answers_are_judged() {
        let gpu = gpu_engine();
        let verdict = selfcheck::run(gpu.gpu()).unwrap();
        assert!(verdict.f32 && verdict.df32, "{:?}", verdict.checks);
        assert_eq!(verdict.f64, gpu.gpu().has_f64(), "{:?}", verdict.checks);
        // The same kernel with its guards and fences replaced as if a compiler had folded the error
        // terms: the check must detect it.
        let bare = |text: String| {
            text.replace("bitcast<f32>(bitcast<u32>(x) ^ zero)", "x * 1.0000001")
                .replace("fma(a, one(zero), b)", "(a + b) * 1.0000001")
        };
        let bare = selfcheck::run_with(gpu.gpu(), &bare).unwrap();
        assert!(!bare.compensated && !bare.f32 && !bare.df32, "{:?}", bare.checks);
    }

    pub(crate) fn pairs_of_f32_are_computed_in_the_first_way_that_is_exact() {
        let gpu = gpu_engine();
        let pairs = |edit: &dyn Fn(String) -> String| {
            let verdict = selfcheck::run_with(gpu.gpu(), edit).unwrap();
            assert!(verdict.df32, "{:?}", verdict.checks);
            verdict.pairs
        };
        // Multiply-adds that round twice, products that lose their errors, and sums that lose
        // theirs.
        let twice = |text: String| text.replace("fma(a, b, -product)", "0.0");
        let folded = |text: String| text.replace("fma(a, one(zero), b)", "(a + b) * 1.0000001");
        assert_eq!(pairs(&|text| folded(twice(text))), Pairs::Results);
        let plain = |text: String| text.replace("return a + b;", "return (a + b) * 1.0000001;");
        assert_eq!(pairs(&|text| plain(folded(twice(text)))), Pairs::Guarded);
    }

    pub(crate) fn orbits_pass_by_every_scheme_and_arithmetic_of_another_precision_does_not() {
        let mut engine = gpu_engine();
        let more = Accuracy::Fast.configs()[0];
        let more = IntegratorConfig { precision: Precision::F64, ..more };
        let configs: Vec<_> = FAST_TO_COMPILE.into_iter().chain([more, FINEST]).collect();
        let checks = selfcheck::orbits(&mut engine, &configs).unwrap();
        assert_eq!(checks.len(), configs.len());
        assert!(checks.iter().all(|check| check.passed), "{checks:?}");
        // A check of f64 must detect an engine that computes in f32 instead.
        let mut pretender = Rewritten { engine: gpu_engine(), rewrite: in_f32 };
        let checks = selfcheck::orbits(&mut pretender, &configs[1..]).unwrap();
        assert!(checks.iter().filter(|c| c.precision == Precision::F64).all(|c| !c.passed));
    }

    pub(crate) fn an_untrusted_precision_is_refused_by_name() {
        let gpu = Gpu::open(gpu_engine().gpu().adapter.clone()).unwrap();
        let mut checks = selfcheck::run(&gpu).unwrap().checks;
        for check in checks.iter_mut().filter(|check| check.precision == Precision::F64) {
            check.passed = check.name != "sines";
        }
        let mut engine = GpuEngine::new(gpu, selfcheck::verdict(checks));
        let error = engine.submit(Job {
            id: 0,
            question: question(&Scene::default()),
            config: lesson(Precision::F64),
            starts: Starts::Rest(open_starts(&Scene::default(), 4, 1)),
            keep: Keep::NOTHING,
        });
        let message = error.unwrap_err().to_string();
        assert!(message.contains("the precision f64") && message.contains("sines"), "{message}");
    }

    pub(crate) fn f32_without_compensation_still_works() {
        let gpu = Gpu::open(gpu_engine().gpu().adapter.clone()).unwrap();
        let verdict = Verdict { compensated: false, ..selfcheck::run(&gpu).unwrap() };
        let mut engine = GpuEngine::new(gpu, verdict);
        let question = question(&Scene::default());
        let starts = open_starts(&Scene::default(), 64, 1);
        let answers = answers(&mut engine, &question, lesson(Precision::F32), &starts);
        let right = share_within(1e-3, &answers, &truth(&question, &starts));
        assert!(right > 0.87, "{right}");
    }

    pub(crate) fn buffers_beyond_the_limits_are_refused_in_words() {
        let engine = gpu_engine();
        let error = engine.gpu().buffer("a test", u64::MAX / 2, wgpu::BufferUsages::STORAGE);
        let error = error.err().unwrap();
        assert!(matches!(error, EngineError::LimitExceeded { .. }), "{error}");
        assert!(error.to_string().contains("a test needs"), "{error}");
    }
}
