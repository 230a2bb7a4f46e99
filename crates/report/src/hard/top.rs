//! Hard cases near the top: grazing crossings, near misses, and starts at the top itself.

use super::{
    BALANCED, HardBench, HardCase, HardFinding, Of, apart, farthest, home, oracle_dd, oracle_f64,
};
use flipmap_engine::{EngineError, EventSpec};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Rule, State, Status, oracle};

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "grazing passes",
        expected: "right within 1 µs at 1e-9 rad and more on both sides of a tangent pass",
        why: "where a pass becomes a miss the bob's highest point touches the top, and its height \
              there is linear in the start: errors of 1e-12 in the state decide offsets of 1e-9, \
              but none of their own size",
        of: Of::Engine,
        run: grazing,
    },
    HardCase {
        name: "passes within the first step",
        expected: "seen, though the bob starts and ends the step below the top",
        why: "near (π/2, π) the second bob's acceleration changes its sign, so a bob let go a \
              hair below the top can rise over it and fall back before the first step ends",
        of: Of::Engine,
        run: first_step,
    },
    HardCase {
        name: "starts at the top",
        expected: "the same from −π as from π, no flip at time 0, gold within 1 µs",
        why: "−π and π are one place, and the bob leaves it inward on the side its first motion \
              leads to, so the flip is a later one",
        of: Of::Engine,
        run: at_the_top,
    },
];

/// θ1, and two values of θ2 between which the flip time jumps because a crossing becomes a miss.
const JUMPS: [[f64; 3]; 4] = [
    [2.9, 2.89194, 2.89351],
    [2.9, 1.18535, 1.18692],
    [2.2, -0.00314, -0.00157],
    [2.9, 2.7789, 2.78047],
];
const OFFSETS: [f64; 10] = [1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15];
/// Smallest offset in rad that must be decided; smaller ones are measured, not required.
const DECIDABLE: f64 = 1e-9;

fn grazing(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let question = home(Rule::Second, 8.0);
    let mut starts = Vec::new();
    for [theta1, low, high] in JUMPS {
        let edge = tangent_start(&question, theta1, [low, high]);
        for offset in OFFSETS {
            for side in [-offset, offset] {
                starts.push([Dd::new(theta1), edge + Dd::new(side)]);
            }
        }
    }
    let truth = oracle_dd(&question, &starts);
    let mut wrong = [0f64; OFFSETS.len()];
    for &config in bench.exact() {
        let answers = bench.answers(&question, config, &starts)?;
        for (i, (answer, truth)) in answers.iter().zip(&truth).enumerate() {
            let wrong = &mut wrong[i / 2 % OFFSETS.len()];
            *wrong = wrong.max(apart(answer, truth));
        }
    }
    let jumps = truth.chunks(2).all(|sides| apart(&sides[0], &sides[1]) > 0.01);
    let by_offset = || OFFSETS.into_iter().zip(wrong);
    let demanded = by_offset().filter(|&(offset, _)| offset >= DECIDABLE);
    let worst = demanded.map(|(_, wrong)| wrong).fold(0.0, f64::max);
    let decided = by_offset().take_while(|&(_, wrong)| wrong <= 1e-3).last().map_or(1.0, |o| o.0);
    HardFinding::new(
        jumps && worst <= 1e-6,
        format!(
            "{} tangent passes: at most {worst:.0e} s off at 1e-9 rad and more; every pass or miss \
             is told right down to {decided:.0e} rad",
            JUMPS.len()
        ),
    )
}

/// θ2 at which the flip time jumps, to 1e-18 rad: bisected in f64 to 1e-9, then in double-double.
fn tangent_start(question: &EventSpec, theta1: f64, [low, high]: [f64; 2]) -> Dd {
    type Judge = fn(&EventSpec, &[[Dd; 2]]) -> Vec<Outcome>;
    let half = Dd::new(0.5);
    let narrow = |[mut low, mut high]: [Dd; 2], width: f64, judge: Judge| {
        let outcome = |theta2: Dd| judge(question, &[[Dd::new(theta1), theta2]])[0];
        let (mut at_low, mut at_high) = (outcome(low), outcome(high));
        while (high - low).hi > width {
            let middle = (low + high) * half;
            let there = outcome(middle);
            // The half across which the times differ more holds the jump.
            if apart(&there, &at_low) <= apart(&there, &at_high) {
                (low, at_low) = (middle, there);
            } else {
                (high, at_high) = (middle, there);
            }
        }
        [low, high]
    };
    let [low, high] = narrow([Dd::new(low), Dd::new(high)], 1e-9, oracle_f64);
    let margin = Dd::new(1e-9);
    let [low, high] = narrow([low - margin, high + margin], 1e-18, oracle_dd);
    (low + high) * half
}

fn first_step(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let quarter = Dd::PI * Dd::new(0.5);
    // The bob rises by about offset²/2.
    let start = |offset: f64, share: f64| {
        let below = Dd::new(0.5 * offset * offset * share);
        [quarter + Dd::new(offset), Dd::PI - below]
    };
    let starts: Vec<[Dd; 2]> = [1e-3, 5e-4, 2e-4, 1e-4]
        .into_iter()
        .flat_map(|offset| [0.5, 0.8, 0.95, 1.05, 1.2].map(|share| start(offset, share)))
        .collect();
    let question = home(Rule::Second, 0.1);
    let truth = oracle_dd(&question, &starts);
    let passes = truth.iter().filter(|o| o.status == Status::Answered && o.time < 0.02).count();
    let worst = bench.worst(&question, &starts, &truth)?;
    HardFinding::new(
        passes >= 8 && worst < 1e-6,
        format!("{passes} of {} starts pass; at most {worst:.0e} s off", starts.len()),
    )
}

fn at_the_top(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let mut total = 0;
    let (mut worst, mut mirrored, mut earliest) = (0f64, 0f64, f64::INFINITY);
    for (rule, tops) in [(Rule::Second, &[1][..]), (Rule::First, &[0]), (Rule::Either, &[0, 1])] {
        let question = home(rule, 4.0);
        let others = (-14..15).map(|k| Dd::new(0.21 * f64::from(k) + 0.03));
        let starts: Vec<[Dd; 2]> = tops
            .iter()
            .flat_map(|&top| {
                others
                    .clone()
                    .map(move |other| if top == 0 { [Dd::PI, other] } else { [other, Dd::PI] })
            })
            .filter(|&start| !question.build.pendulum_in().forbids(rule, start))
            .collect();
        let truth = oracle_dd(&question, &starts);
        let there = bench.answers(&question, BALANCED, &settled(&question, &starts))?;
        let turned: Vec<[Dd; 2]> = starts.iter().map(|start| start.map(other_side)).collect();
        let back = bench.answers(&question, BALANCED, &turned)?;
        total += starts.len();
        worst = worst.max(farthest(&there, &truth));
        mirrored = mirrored.max(farthest(&there, &back));
        let flips = there.iter().filter(|o| o.status == Status::Answered);
        earliest = flips.map(|o| o.time).fold(earliest, f64::min);
    }
    HardFinding::new(
        worst <= 1e-6 && mirrored == 0.0 && earliest > 0.1,
        format!(
            "{total} starts: at most {worst:.0e} s off gold, {mirrored:.0e} s between −π and π, \
             earliest flip at {earliest:.2} s"
        ),
    )
}

/// The same place on the torus, with π replaced by −π.
fn other_side(theta: Dd) -> Dd {
    if theta == Dd::PI { -Dd::PI } else { theta }
}

/// The starts as a grid gives them: a bob at the top is put on the side of its first motion.
fn settled(question: &EventSpec, starts: &[[Dd; 2]]) -> Vec<[Dd; 2]> {
    let pendulum = question.build.pendulum_in();
    let settled = |start: &[Dd; 2]| oracle::settled(&pendulum, &State::rest(*start)).angle;
    starts.iter().map(settled).collect()
}
