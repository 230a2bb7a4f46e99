//! Tests of every clause of the judge and of every part of a run's error scale, on made-up answers
//! whose verdict changes if the clause is left out. Real starts whose verdict changes are in
//! [`super::witnesses`].

use super::judge::{Judge, RunResult};
use super::ladder::{Origin, Run};
use crate::level::{BALANCED, FAST};
use crate::{EventSpec, FinalState, IntegratorConfig, Method, Precision};
use flipmap_pendulum::{Accumulators, Outcome, Rule, Status};
use flipmap_scene::PendulumSpec;
use flipmap_scene::question::Needs;

fn dop853(tolerance: f64) -> IntegratorConfig {
    IntegratorConfig { method: Method::dop853(tolerance), precision: Precision::F64 }
}

fn dopri5(tolerance: f64) -> IntegratorConfig {
    IntegratorConfig { method: Method::dopri5(tolerance), precision: Precision::F64 }
}

const TAYLOR_DD: IntegratorConfig =
    IntegratorConfig { method: Method::Taylor { tolerance: 1e-28 }, precision: Precision::Dd };

fn judge(rule: Rule, ends: Needs) -> Judge {
    let question = EventSpec { build: PendulumSpec::default(), rule, budget_secs: 30.0, passes: 1 };
    Judge::new(&question, ends, 1e-10)
}

/// The answer of a run whose second bob passes the top fast, at a time.
fn flip_at(time: f64) -> RunResult {
    let phase = [0.6, 0.8, -1.0, 0.0, 2.0, 3.0];
    RunResult {
        outcome: Outcome::flipped(time),
        end: FinalState { time, phase, ..FinalState::NOWHERE },
    }
}

/// The answer of a run that ends its budget with the first bob at a sine.
fn hangs_at(sine: f64) -> RunResult {
    let phase = [(1.0 - sine * sine).sqrt(), sine, 1.0, 0.0, 0.0, 0.0];
    let outcome = Outcome::without_time(Status::Unflipped);
    RunResult { outcome, end: FinalState { time: 90.0, phase, ..FinalState::NOWHERE } }
}

fn from_rest(config: IntegratorConfig, answer: RunResult) -> (Run, RunResult) {
    (Run::new(config, Origin::Rest), answer)
}

/// Returns true if the answers to the time of a flip are sure.
fn is_sure(answers: &[(Run, RunResult)]) -> bool {
    judge(Rule::Second, Needs::Outcome).judge(answers).is_sure
}

/// Returns the estimated error in s of the finest answer to the time of a flip.
fn error_secs(answers: &[(Run, RunResult)]) -> Option<f64> {
    judge(Rule::Second, Needs::Outcome).judge(answers).error_secs
}

#[test]
fn the_estimated_error_is_the_growth_that_the_others_show_times_the_finest_scale() {
    let by = |apart: f64| {
        let answers = [from_rest(BALANCED, flip_at(5.0)), from_rest(FAST, flip_at(5.0 + apart))];
        error_secs(&answers).unwrap()
    };
    let [near, far] = [1e-6, 1e-3].map(by);
    assert!((far / near - 1e3).abs() < 1e-6, "{near} {far}");
    // The error scale of the run in f32 is 3e-7, and that of the finest 2e-13.
    assert!((1e-13..1e-11).contains(&near), "{near}");
    assert_eq!(by(0.5), f64::INFINITY, "no run agrees");
    let beside = [from_rest(BALANCED, flip_at(5.0)), from_rest(FAST, hangs_at(0.1))];
    assert_eq!(error_secs(&beside), Some(f64::INFINITY));
    assert_eq!(error_secs(&[from_rest(BALANCED, hangs_at(0.1))]), None, "there is no time");
}

fn of_status(status: Status) -> RunResult {
    RunResult { outcome: Outcome::without_time(status), end: FinalState::NOWHERE }
}

#[test]
fn agreement_by_accident_must_be_rarer_than_one_in_a_million() {
    // The chance is 8e-4 of the distance.
    let by = |apart: f64| {
        is_sure(&[from_rest(BALANCED, flip_at(5.0)), from_rest(FAST, flip_at(5.0 + apart))])
    };
    assert!(by(2.5e-4), "a chance of 2e-7");
    assert!(!by(6e-3), "a chance of 5e-6");
}

#[test]
fn runs_of_one_method_do_not_confirm_each_other() {
    let other = |config| {
        is_sure(&[from_rest(BALANCED, flip_at(5.0)), from_rest(config, flip_at(5.0 + 1e-7))])
    };
    assert!(other(dopri5(1e-9)));
    assert!(!other(dop853(1e-9)));
}

#[test]
fn runs_after_one_start_map_do_not_confirm_each_other() {
    let finest = (Run::new(dop853(1e-14), Origin::StrictMap), flip_at(5.0));
    let other = |from| is_sure(&[finest, (Run::new(FAST, from), flip_at(5.0 + 1e-8))]);
    assert!(other(Origin::Map));
    assert!(!other(Origin::StrictMap));
}

#[test]
fn a_near_miss_before_the_flip_must_be_told_from_a_crossing() {
    let missed_by = |clearance: f64| {
        let missed = |time: f64| {
            let answer = flip_at(time);
            RunResult { end: FinalState { clearance, ..answer.end }, ..answer }
        };
        is_sure(&[from_rest(BALANCED, missed(5.0)), from_rest(FAST, missed(5.0 + 1e-6))])
    };
    assert!(missed_by(1e-3));
    assert!(!missed_by(1e-7));
}

#[test]
fn the_flip_must_be_told_from_a_near_miss() {
    let pushed = |momentum: f64| {
        let slow = |time: f64| {
            let phase = [0.6, 0.8, -1.0, 0.0, -momentum, momentum];
            RunResult { end: FinalState { phase, ..flip_at(time).end }, ..flip_at(time) }
        };
        is_sure(&[from_rest(BALANCED, slow(5.0)), from_rest(FAST, slow(5.0 + 1e-6))])
    };
    assert!(pushed(1.0));
    assert!(!pushed(1e-4));
}

#[test]
fn a_run_that_is_far_off_must_be_explained() {
    // The run by DOPRI5, with an error scale of 2.5e-10, shows a growth of 400 or of 40. An error
    // of 3e-7 that grows as much, and by bad luck a thousand times more, ends far off only in the
    // first case.
    let told = |apart: f64| {
        let far = from_rest(FAST, flip_at(6.0));
        is_sure(&[
            from_rest(BALANCED, flip_at(5.0)),
            from_rest(dopri5(1e-10), flip_at(5.0 + apart)),
            far,
        ])
    };
    assert!(told(1e-7));
    assert!(!told(1e-8));
}

#[test]
fn equal_answers_are_no_nearer_than_their_scale() {
    let equal = |tolerance| {
        is_sure(&[from_rest(dop853(tolerance), flip_at(5.0)), from_rest(FAST, flip_at(5.0))])
    };
    assert!(equal(1e-11));
    assert!(
        !equal(1e-8),
        "the finest run's own error is more than one in a million of what is right"
    );
}

#[test]
fn a_run_that_tells_nothing_takes_nothing_away() {
    // Without a limit, the chance of the middle run would be 2.
    let finer = from_rest(dop853(1e-14), flip_at(5.0));
    let [middle, coarse] = [from_rest(BALANCED, flip_at(5.045)), from_rest(FAST, flip_at(5.022))];
    assert!(is_sure(&[finer, coarse]));
    assert!(is_sure(&[finer, middle, coarse]));
}

#[test]
fn failed_answers_are_never_sure_and_forbidden_ones_if_all_say_so() {
    let [failed, forbidden] = [Status::Failed, Status::Forbidden].map(of_status);
    assert!(!is_sure(&[from_rest(BALANCED, failed), from_rest(FAST, failed)]));
    assert!(is_sure(&[from_rest(BALANCED, forbidden), from_rest(FAST, forbidden)]));
    assert!(!is_sure(&[from_rest(BALANCED, forbidden), from_rest(FAST, flip_at(5.0))]));
}

/// An answer with the growth that it gathered.
fn gathered(answer: RunResult, log_growth: f64) -> RunResult {
    let gathered = Accumulators { log_growth, ..Accumulators::NONE };
    RunResult { end: FinalState { gathered, ..answer.end }, ..answer }
}

#[test]
fn growth_is_told_by_the_finest_run_and_confirmed_by_another_method() {
    let told = |apart: f64, other: IntegratorConfig, log_growth: f64| {
        let finest = from_rest(TAYLOR_DD, gathered(hangs_at(0.5), 20.0));
        let second = from_rest(other, gathered(hangs_at(0.5 + apart), log_growth));
        judge(Rule::Neither, Needs::Growth).judge(&[finest, second]).is_sure
    };
    let other = dopri5(1e-11);
    assert!(told(5e-3, other, 20.001));
    assert!(!told(5e-3, other, 21.0), "they do not agree");
    let same = IntegratorConfig { method: Method::Taylor { tolerance: 1e-11 }, ..TAYLOR_DD };
    assert!(!told(5e-3, same, 20.001), "one method");
}

#[test]
fn errors_are_no_smaller_than_known_displacements() {
    let scale = |run: Run, map_error: f64| {
        run.error_scale(&FinalState { map_error, ..FinalState::NOWHERE }, 1e-9)
    };
    let run = Run::new(dop853(1e-14), Origin::Rest);
    assert!(scale(run, 0.0) < 1e-13);
    assert_eq!(scale(run.nudged([6e-5, 8e-5]), 0.0), 1e-4);
    let map = Run::new(dop853(1e-20), Origin::Map);
    assert!(scale(map, 0.0) < 2e-15);
    assert!(scale(map, 1e-5) >= 1e-5, "what the map's polynomials leave out");
    assert!(scale(map.nudged([0.6, 0.8]), 0.0) >= 1e-9);
}
