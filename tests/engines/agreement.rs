//! Properties that every engine must have; each test runs once for each engine.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::common::*;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::level::FINEST;
use flipmap_engine::{
    Accuracy, Engine, EventSpec, IntegratorConfig, Keep, Method, Onset, Precision, Separable,
    Starts,
};
use flipmap_numbers::{Dd, Decimal};
use flipmap_pendulum::{Outcome, Rule, Status};
use flipmap_scene::{Budget, Fate, Grid, Kind, PendulumSpec, QuestionSettings, Scene, View};

const PRECISIONS: [Precision; 2] = [Precision::F32, Precision::F64];

/// The configurations that an engine is used with: the lesson in both precisions, and each adaptive
/// method in the precision it is meant for.
fn configs() -> Vec<IntegratorConfig> {
    let config = |method, precision| IntegratorConfig { method, precision };
    let mut configs = PRECISIONS.map(lesson).to_vec();
    configs.push(config(Method::dopri5(1e-7), Precision::F32));
    configs.push(config(Method::dop853(1e-12), Precision::F64));
    configs.push(FINEST);
    configs
}

macro_rules! on_every_engine {
    ($($name:ident)*) => {
        mod cpu {
            $(
                #[test]
                fn $name() {
                    super::$name(&|| Box::new(super::CpuEngine::new(None).unwrap()));
                }
            )*
        }
        mod gpu {
            $(
                #[test]
                #[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
                fn $name() {
                    super::$name(&|| Box::new(super::gpu_engine()));
                }
            )*
        }
    };
}

on_every_engine! {
    the_lesson_is_right_where_rk4_at_120_is
    other_pendulums_and_rules_are_as_right_as_scalar_rk4
    the_levels_keep_their_promises
    balanced_is_right_for_other_pendulums_and_rules
    mirrored_starts_have_mirrored_fates
    a_whole_turn_away_is_the_same_pendulum
    splitting_a_job_changes_nothing
    an_upright_picture_is_begun_as_start_by_start
    stopping_and_going_on_changes_nothing
    the_budget_ends_where_it_says
    starts_at_the_top_begin_inside
    the_lightest_and_fastest_do_not_break_it
    cancelled_jobs_never_come_back
    a_job_without_starts_is_done_at_once
}

type Make<'a> = &'a dyn Fn() -> Box<dyn Engine>;

fn the_lesson_is_right_where_rk4_at_120_is(make: Make) {
    let question = question(&Scene::default());
    let starts = open_starts(&Scene::default(), 512, 4);
    let truth = truth(&question, &starts);
    let mut engine = make();
    for precision in PRECISIONS {
        let answers = answers(engine.as_mut(), &question, lesson(precision), &starts);
        let right = share_within(1e-3, &answers, &truth);
        assert!((0.89..=0.92).contains(&right), "{precision}: {right}");
        let (early, early_truth) = flips_before(2.0, &answers, &truth);
        let right = share_within(1e-4, &early, &early_truth);
        assert!(right >= 0.995, "{precision}: {right} of the flips before 2 s");
    }
}

fn scenes() -> Vec<Scene> {
    let scene = |build: PendulumSpec, rule: Rule, budget: f64| Scene {
        build,
        question: QuestionSettings {
            rule,
            budget: Budget::secs(budget),
            ..QuestionSettings::default()
        },
        ..Scene::default()
    };
    let plain = PendulumSpec::default();
    vec![
        scene(PendulumSpec::new(Kind::Points, [1.0, 2.0], [1.0, 0.6], 9.81), Rule::Second, 30.0),
        scene(PendulumSpec { kind: Kind::Rods, ..plain }, Rule::Second, 30.0),
        scene(plain, Rule::First, 30.0),
        scene(plain, Rule::Either, 30.0),
        scene(PendulumSpec { gravity: Decimal::from(1.62), ..plain }, Rule::Second, 30.0),
    ]
}

fn other_pendulums_and_rules_are_as_right_as_scalar_rk4(make: Make) {
    let mut engine = make();
    for scene in scenes() {
        let question = question(&scene);
        let starts = open_starts(&scene, 72, 1);
        let truth = truth(&question, &starts);
        let plain = share_within(1e-3, &scalar_rk4(&question, &starts), &truth);
        for (precision, allowed) in [(Precision::F32, 0.08), (Precision::F64, 0.02)] {
            let answers = answers(engine.as_mut(), &question, lesson(precision), &starts);
            let right = share_within(1e-3, &answers, &truth);
            assert!((right - plain).abs() <= allowed, "{scene:?} {precision}: {right} {plain}");
        }
    }
}

fn the_levels_keep_their_promises(make: Make) {
    let mut engine = make();
    let home = Scene::default();
    let starts = open_starts(&home, 512, 6);
    let truth = truth(&question(&home), &starts);
    for (level, least) in [(Accuracy::Fast, 0.925), (Accuracy::Balanced, 0.998)] {
        let config = level.configs()[0];
        let answers = answers(engine.as_mut(), &question(&home), config, &starts);
        let right = share_within(1e-3, &answers, &truth);
        assert!(right >= least, "{level}: {right} of {}", starts.len());
    }
}

fn balanced_is_right_for_other_pendulums_and_rules(make: Make) {
    let mut engine = make();
    for mut scene in scenes() {
        if scene.question.rule == Rule::First {
            // Only starts of high energy can satisfy this rule. After 15 s the growth of errors has
            // consumed the digits of f64, those of the gold standard in f64 too.
            scene.question.budget.secs = 12.0;
        }
        let starts = open_starts(&scene, 48, 1);
        let truth = truth(&question(&scene), &starts);
        let config = Accuracy::Balanced.configs()[0];
        let answers = answers(engine.as_mut(), &question(&scene), config, &starts);
        let right = share_within(1e-3, &answers, &truth);
        assert!(right >= 0.99, "{scene:?}: {right} of {}", starts.len());
    }
}

fn mirrored_starts_have_mirrored_fates(make: Make) {
    let starts = open_starts(&Scene::default(), 64, 1);
    let mirrored: Vec<[Dd; 2]> = starts.iter().map(|angle| angle.map(|theta| -theta)).collect();
    let mut engine = make();
    for rule in [Rule::Second, Rule::Either] {
        let question = EventSpec { rule, ..question(&Scene::default()) };
        for config in configs() {
            let there = answers(engine.as_mut(), &question, config, &starts);
            let back = answers(engine.as_mut(), &question, config, &mirrored);
            assert_eq!(there, back, "{rule} {config:?}");
        }
    }
}

fn a_whole_turn_away_is_the_same_pendulum(make: Make) {
    let moved = |center: [&str; 2]| {
        let view =
            View { center: center.map(str::to_string), width: "3".into(), ..View::default() };
        Scene { view, ..Scene::default() }
    };
    let [here, there] = [moved(["2", "1"]), moved(["8.283185307179586", "-5.283185307179586"])];
    let question = question(&here);
    let mut engine = make();
    for config in configs() {
        let [near, far] = [&here, &there]
            .map(|scene| answers(engine.as_mut(), &question, config, &open_starts(scene, 64, 1)));
        let (far, near) = flips_before(5.0, &far, &near);
        let same = share_within(1e-3, &far, &near);
        assert!(same >= 0.999, "{config:?}: {same}");
    }
}

fn splitting_a_job_changes_nothing(make: Make) {
    let question = question(&Scene::default());
    let starts = open_starts(&Scene::default(), 48, 1);
    let mut engine = make();
    for config in configs() {
        let whole = answers(engine.as_mut(), &question, config, &starts);
        let parts: Vec<Outcome> = starts
            .chunks(97)
            .flat_map(|part| answers(engine.as_mut(), &question, config, part))
            .collect();
        assert_eq!(whole, parts, "{config:?}");
    }
}

fn an_upright_picture_is_begun_as_start_by_start(make: Make) {
    let (width, height) = (40, 30);
    let grid = Grid::new(&Scene::default(), [width, height]);
    let upright = grid.upright(0..width, 0..height).expect("not turned");
    let is_open = |place: &u32| {
        upright.is_forbidden((place % width) as usize, (place / width) as usize) == Some(false)
    };
    let places: Vec<u32> = (0..width * height).filter(is_open).collect();
    assert!(places.len() > 300);
    let begun = |places: &[u32]| {
        Starts::Upright(Separable { angles: upright.angles.clone(), places: places.to_vec() })
    };
    let mut engine = make();
    let configs = configs();
    for (passes, &config) in
        [1, 2].iter().flat_map(|passes| configs.iter().map(move |c| (*passes, c)))
    {
        let question = EventSpec { passes, ..question(&Scene::default()) };
        let mut answer = |starts| finished(engine.as_mut(), &question, config, starts);
        let [upright, listed] = [begun(&places), begun(&places).listed()].map(&mut answer);
        assert_eq!(upright.outcomes, listed.outcomes, "{config:?}, {passes} passes");
        assert_eq!(upright.unfinished, listed.unfinished, "{config:?}, {passes} passes");
        let others: Vec<u32> = places.iter().map(|place| place / width * width).collect();
        assert_ne!(answer(begun(&others)).outcomes, listed.outcomes, "the test can fail");
    }
}

fn stopping_and_going_on_changes_nothing(make: Make) {
    let question = question(&Scene::default());
    let starts = open_starts(&Scene::default(), 48, 1);
    let mut engine = make();
    for config in configs() {
        let whole = finished(engine.as_mut(), &question, config, Starts::Rest(starts.clone()));
        let mut outcomes = vec![None; starts.len()];
        let mut open: Vec<usize> = (0..starts.len()).collect();
        let mut next = Starts::Rest(starts.clone());
        let mut evaluations = 0;
        // Stops between steps, inside steps, and almost immediately.
        for budget_secs in [0.001, 1.0, 3.3333, 7.0, 30.0] {
            let question = EventSpec { budget_secs, ..question };
            let part = finished(engine.as_mut(), &question, config, next);
            for (&start, &outcome) in open.iter().zip(&part.outcomes) {
                outcomes[start] = Some(outcome);
            }
            evaluations += part.effort.rhs_evaluations;
            let (left, states): (Vec<usize>, Vec<_>) = part.unfinished.into_iter().unzip();
            open = left.into_iter().map(|index| open[index]).collect();
            next = Starts::Resumed { states, thrown: false };
        }
        let outcomes: Vec<Outcome> = outcomes.into_iter().flatten().collect();
        assert_eq!(outcomes, whole.outcomes, "{config:?}");
        // Only the step around each stop may be done twice.
        let most = whole.effort.rhs_evaluations + 5 * 40 * starts.len() as u64;
        assert!((whole.effort.rhs_evaluations..=most).contains(&evaluations), "{config:?}");
    }
}

fn the_budget_ends_where_it_says(make: Make) {
    let scene = Scene::default();
    let starts = open_starts(&scene, 32, 1);
    let mut engine = make();
    let full = question(&scene);
    let all = answers(engine.as_mut(), &full, lesson(Precision::F64), &starts);
    let some_flip = all.iter().find(|o| o.status == Status::Answered && o.time > 4.0).unwrap().time;
    for budget_secs in [5.0, 5.0001, some_flip, some_flip - 1e-9, 0.4] {
        let question = EventSpec { budget_secs, ..full };
        let cut = answers(engine.as_mut(), &question, lesson(Precision::F64), &starts);
        for (cut, all) in cut.iter().zip(&all) {
            let within = all.status == Status::Answered && all.time <= budget_secs;
            assert_eq!(cut.status == Status::Answered, within, "{budget_secs}: {cut:?} {all:?}");
            assert!(!within || cut == all);
        }
    }
}

fn starts_at_the_top_begin_inside(make: Make) {
    let pi = "3.14159265358979323846264338327950288";
    let view = View { center: ["-2".into(), pi.into()], width: "1e-9".into(), ..View::default() };
    let scene = Scene { view, ..Scene::default() };
    let Fate::BesideTop(moments) = Grid::new(&scene, [1, 1]).fate(0, 0) else {
        panic!("it begins at the top");
    };
    let starts = Starts::Mixed { starts: vec![Onset::BesideTop(moments)], thrown: false };
    let question = question(&scene);
    let truth = truth(&question, &[[Dd::new(-2.0), Dd::PI]])[0];
    assert!(truth.time > 0.1, "{truth:?}");
    let mut engine = make();
    for config in configs() {
        let answer = finished(engine.as_mut(), &question, config, starts.clone()).outcomes[0];
        assert!((answer.time - truth.time).abs() < 1e-2, "{config:?}: {answer:?} {truth:?}");
    }
}

fn the_lightest_and_fastest_do_not_break_it(make: Make) {
    let mut engine = make();
    for (masses, lengths) in
        [([1e-3, 1.0], [1.0, 1.0]), ([1.0, 1e-3], [1.0, 1e-3]), ([1e3, 1.0], [1e-3, 1.0])]
    {
        let build = PendulumSpec::new(Kind::Points, masses, lengths, 9.81);
        let asked = QuestionSettings { budget: Budget::secs(3.0), ..QuestionSettings::default() };
        let scene = Scene { build, question: asked, ..Scene::default() };
        let starts = open_starts(&scene, 24, 1);
        for config in configs() {
            let answers = answers(engine.as_mut(), &question(&scene), config, &starts);
            for outcome in &answers {
                let sound = outcome.time.is_finite() && (0.0..=3.0).contains(&outcome.time);
                assert!(sound && outcome.status != Status::Forbidden, "{build:?}: {outcome:?}");
            }
        }
    }
}

fn a_job_without_starts_is_done_at_once(make: Make) {
    let mut engine = make();
    for config in configs() {
        let none = answers(engine.as_mut(), &question(&Scene::default()), config, &[]);
        assert!(none.is_empty());
    }
}

fn cancelled_jobs_never_come_back(make: Make) {
    use flipmap_engine::{Job, Wait};
    static IDS: AtomicU32 = AtomicU32::new(100);
    let question = question(&Scene::default());
    let starts = Starts::Rest(open_starts(&Scene::default(), 64, 1));
    let mut engine = make();
    let id = u64::from(IDS.fetch_add(1, Ordering::Relaxed));
    let config = lesson(Precision::F32);
    let job = Job { id, question, config, starts, keep: Keep::NOTHING };
    engine.submit(job).unwrap();
    engine.cancel();
    assert!(engine.poll(Wait::UntilFinished).unwrap().is_empty());
    let again = answers(engine.as_mut(), &question, config, &open_starts(&Scene::default(), 8, 1));
    assert!(!again.is_empty());
}
