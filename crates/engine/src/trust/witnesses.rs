//! Starts that were found by a search. For each constant of the judge and the ladder, one of them
//! becomes sure on another rung if the constant is weakened by a factor of ten. Clauses for which
//! no start was found are tested in [`super::clauses`].

use super::checked_job::CheckedJob;
use crate::cpu::CpuEngine;
use crate::depth::DepthEngine;
use crate::level::BALANCED;
use crate::{Deep, Engine, EventSpec, Job, Keep, Leaf, Starts, run_job};
use flipmap_numbers::{Dd, Exact, Scalar};
use flipmap_pendulum::Rule;
use flipmap_pendulum::extremum::Extremum;
use flipmap_scene::lattice::Cell;
use flipmap_scene::question::Needs;
use flipmap_scene::{ExactPlane, Kind, PendulumSpec};

/// A start at rest, or a place in a leaf; the index of the rung on which it becomes sure; and the
/// constants that move it to another rung.
type Witness = ([f64; 2], usize, &'static str);

/// Compares the rungs on which starts become sure with those expected.
fn check(question: EventSpec, ends: Needs, starts: Starts, witnesses: &[Witness]) {
    let mut engine = DepthEngine::new(Box::new(CpuEngine::new(Some(2)).unwrap()), Some(2)).unwrap();
    let keep = Keep { ends, states: false };
    let job = Job { id: 0, question, config: BALANCED, starts, keep };
    let (mut case, mut jobs) = CheckedJob::new(job);
    let mut rungs = vec![None; witnesses.len()];
    let mut index = 0;
    for rung in 0.. {
        let mut next = Vec::new();
        for Job { question, config, starts, keep, .. } in jobs {
            let result =
                run_job(&mut engine as &mut dyn Engine, question, config, starts, keep, &|| true);
            next = case.take(index, result.unwrap().unwrap()).unwrap_or_default();
            index += 1;
        }
        for (k, place) in rungs.iter_mut().enumerate() {
            if place.is_none() && case.is_sure(k) {
                *place = Some(rung);
            }
        }
        if next.is_empty() {
            break;
        }
        jobs = next;
    }
    for ((start, rung, what), found) in witnesses.iter().zip(rungs) {
        assert_eq!(found, Some(*rung), "{start:?}, which tells {what}");
    }
}

fn question(rule: Rule, budget_secs: f64) -> EventSpec {
    EventSpec { build: PendulumSpec::default(), rule, budget_secs, passes: 1 }
}

fn at_rest(witnesses: &[Witness]) -> Starts {
    Starts::Rest(witnesses.iter().map(|(angle, ..)| angle.map(Dd::new)).collect())
}

/// Places in the leaf of a level around a start at rest.
fn in_leaf(center: [&str; 2], level: u32, witnesses: &[Witness]) -> Starts {
    let cell = Cell::around(center.map(|angle| Exact::parse(angle).unwrap()), level);
    let points = witnesses.iter().map(|(point, ..)| *point).collect();
    let leaves = vec![Leaf { cell, points }];
    Starts::Deep(Deep { leaves, plane: Box::new(ExactPlane::AT_REST), strict: false })
}

#[test]
fn of_the_time_of_a_flip() {
    let witnesses: [Witness; 6] = [
        ([-1.602811, -2.867014], 2, "MAX_ERROR_PROBABILITY, SAFETY, the scales of f32 and DOP853"),
        ([-1.565265, -1.602852], 1, "SAFETY, the scales of f32 and DOPRI5"),
        ([2.389554, 1.633769], 1, "OF_CLEARANCE"),
        ([-0.663212, -2.20799], 2, "LINEAR"),
        ([-1.448807, 1.270825], 2, "UNFLIPPED"),
        ([-1.633555, 0.090729], 2, "UNFLIPPED"),
    ];
    check(question(Rule::Second, 30.0), Needs::Outcome, at_rest(&witnesses), &witnesses);
}

#[test]
fn of_turns_and_flips_that_graze_the_top() {
    let witnesses: [Witness; 4] = [
        ([2.899, -1.1635338823654686], 6, "UNLIKELY, and that far runs are explained"),
        ([-2.782, -2.4945069037706165], 4, "UNLIKELY"),
        ([-0.983, -2.3523553390025396], 4, "the height beyond the top"),
        ([-1.339, -2.5067889416427107], 3, "the height beyond the top"),
    ];
    check(question(Rule::Second, 6.0), Needs::Outcome, at_rest(&witnesses), &witnesses);
}

#[test]
fn of_the_first_bob() {
    let witnesses: [Witness; 2] = [
        ([2.188812, 2.750109], 1, "OF_CLEARANCE, MAX_ERROR_PROBABILITY"),
        ([-1.819732, 2.9558], 4, "the scales of f64 and DOP853, LINEAR"),
    ];
    check(question(Rule::First, 20.0), Needs::Outcome, at_rest(&witnesses), &witnesses);
    let rods = PendulumSpec { kind: Kind::Rods, ..PendulumSpec::default() };
    let witnesses: [Witness; 3] = [
        ([2.551636, -1.908982], 6, "the scale of Taylor expansions"),
        ([2.701314, -1.928459], 5, "the scales of f64 and extrapolation, UNFLIPPED"),
        ([2.39825, -1.884929], 5, "the scale of extrapolation, OF_CLEARANCE"),
    ];
    let question = EventSpec { build: rods, ..question(Rule::First, 30.0) };
    check(question, Needs::Outcome, at_rest(&witnesses), &witnesses);
}

#[test]
fn of_states_growth_and_returns() {
    let neither = |secs| question(Rule::Neither, secs);
    let states: [Witness; 3] = [
        ([2.355168, 1.814721], 3, "STATE"),
        ([-1.785374, -0.539467], 1, "STATE, MAX_ERROR_PROBABILITY"),
        ([-2.680131, -3.041647], 3, "the displacement of nudged runs"),
    ];
    check(neither(12.0), Needs::End, at_rest(&states), &states);
    let growth: [Witness; 2] = [
        ([0.545585, 2.415184], 1, "GROWTH, confirmation"),
        ([0.953784, 2.488666], 2, "GROWTH, confirmation"),
    ];
    check(neither(15.0), Needs::Growth, at_rest(&growth), &growth);
    let returns: [Witness; 2] = [
        ([2.006433, -1.769108], 1, "NEAREST, confirmation"),
        ([2.756867, -0.473489], 2, "confirmation"),
    ];
    check(neither(8.0), Needs::Extremum(Extremum::NearestReturn), at_rest(&returns), &returns);
}

#[test]
fn of_deep_starts() {
    let witnesses: [Witness; 1] = [(
        [0.845, -0.072],
        1,
        "MAX_ERROR_PROBABILITY, OF_CLEARANCE, OF_MAPS, the scale of DOPRI5 after a map",
    )];
    let center = ["-1.65907312822246439054652000777423381805419921875", "0.1"];
    let starts = in_leaf(center, 40, &witnesses);
    check(question(Rule::Second, 40.0), Needs::Outcome, starts, &witnesses);
    let witnesses: [Witness; 1] = [([0.224, 0.959], 0, "the scale of DOP853 after a map")];
    let starts = in_leaf(["2.2", "1.3"], 7, &witnesses);
    check(question(Rule::Second, 15.0), Needs::Outcome, starts, &witnesses);
    let witnesses: [Witness; 2] = [
        ([0.154, -0.897], 1, "UNFLIPPED, MAX_ERROR_PROBABILITY"),
        ([0.888, -0.786], 2, "GROWTH, confirmation"),
    ];
    let starts = in_leaf(["2.3", "1.1"], 30, &witnesses);
    check(question(Rule::Neither, 20.0), Needs::Growth, starts, &witnesses);
}
