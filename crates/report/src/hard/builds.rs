//! Pendulums that are hard to integrate: whips, extreme ratios, weightless ones.

use super::{BALANCED, HardBench, HardCase, HardFinding, Of, apart, count, home, oracle_f64};
use flipmap_engine::{EngineError, EventSpec};
use flipmap_numbers::{Dd, Decimal};
use flipmap_pendulum::{Pendulum, Rule, Status};
use flipmap_scene::{Kind, PendulumSpec};

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "fast whips",
        expected: "nine in ten within 1 ms of gold, none failed",
        why: "a light bob on a short rod turns dozens of times while the other one swings, and \
              steps that choose their length follow it at its own pace",
        of: Of::Engine,
        run: whips,
    },
    HardCase {
        name: "ratios of 1e-3 … 1e3",
        expected: "every outcome within 1 ms of gold over 1 s, none failed",
        why: "in reduced units such pendulums are the same equations with large coefficients; the \
              determinant is carried by itself so that it does not cancel",
        of: Of::Engine,
        run: ratios,
    },
    HardCase {
        name: "gravity from 0 to 1e3",
        expected: "all forbidden without it; otherwise times × √g are equal to 1e-9",
        why: "gravity only sets the unit of time, √(l/g)",
        of: Of::Engine,
        run: gravity,
    },
];

/// Starts over the whole torus, off its lines of symmetry: `count` less the forbidden ones.
pub(super) fn scattered(question: &EventSpec, count: u32) -> Vec<[Dd; 2]> {
    // A golden-ratio lattice.
    let at = |k: u32| {
        let place =
            [f64::from(k) + 0.5, (f64::from(k) + 0.3) * 0.618_033_988_749_894_9 * f64::from(count)];
        place.map(|x| {
            Dd::new((x / f64::from(count)).fract() * std::f64::consts::TAU - std::f64::consts::PI)
        })
    };
    let pendulum = question.build.pendulum();
    let open = |start: &[Dd; 2]| !pendulum.forbids(question.rule, start.map(|x| x.hi));
    (0..count).map(at).filter(open).collect()
}

/// Tally of an engine's answers compared with the gold standard.
#[derive(Default)]
struct Tally {
    starts: usize,
    flips: usize,
    right: usize,
    failed: usize,
    worst: f64,
}

impl Tally {
    fn add(
        &mut self,
        bench: &mut HardBench,
        question: &EventSpec,
        lattice: u32,
    ) -> Result<(), EngineError> {
        let starts = scattered(question, lattice);
        let truth = oracle_f64(question, &starts);
        let answers = bench.answers(question, BALANCED, &starts)?;
        self.starts += starts.len();
        self.flips += count(&truth, Status::Answered);
        let sound =
            |o: &flipmap_pendulum::Outcome| o.status != Status::Failed && o.time.is_finite();
        self.failed += answers.iter().chain(&truth).filter(|o| !sound(o)).count();
        for (answer, truth) in answers.iter().zip(&truth) {
            let off = apart(answer, truth);
            self.right += usize::from(off <= 1e-3);
            self.worst = self.worst.max(off);
        }
        Ok(())
    }

    fn text(&self) -> String {
        let Tally { starts, flips, right, failed, worst } = self;
        format!(
            "{starts} starts, {flips} flip: {right} within 1 ms, at most {worst:.0e} s off, {failed} failed"
        )
    }
}

fn question(build: PendulumSpec, budget_secs: f64) -> EventSpec {
    EventSpec { build, rule: Rule::Second, budget_secs, passes: 1 }
}

fn whips(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let mut tally = Tally::default();
    for (kind, masses, lengths) in [
        (Kind::Points, [1.0, 0.01], [1.0, 0.1]),
        (Kind::Points, [1.0, 0.1], [0.3, 0.03]),
        (Kind::Points, [0.02, 1.0], [0.1, 1.0]),
        (Kind::Rods, [1.0, 0.05], [1.0, 0.1]),
    ] {
        let build = PendulumSpec::new(kind, masses, lengths, 9.81);
        tally.add(bench, &question(build, 5.0), 40)?;
    }
    let share = tally.right as f64 / tally.starts as f64;
    HardFinding::new(share >= 0.9 && tally.failed == 0, tally.text())
}

fn ratios(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let mut tally = Tally::default();
    for kind in [Kind::Points, Kind::Rods] {
        for masses in [[1.0, 1e-3], [1e-3, 1.0], [1.0, 1.0]] {
            for lengths in [[1.0, 1e-3], [1e-3, 1.0], [1.0, 1.0]] {
                let build = PendulumSpec::new(kind, masses, lengths, 9.81);
                // Light and short first rods leave few starts open, so more are tried.
                let asked = question(build, 1.0);
                let Pendulum { p, q, .. } = build.pendulum();
                let few = p < 0.1 * q;
                tally.add(bench, &asked, if few { 1000 } else { 16 })?;
            }
        }
    }
    HardFinding::new(tally.right == tally.starts && tally.failed == 0, tally.text())
}

fn gravity(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let pulled =
        |gravity| PendulumSpec { gravity: Decimal::from(gravity), ..PendulumSpec::default() };
    let none = scattered(&question(pulled(0.0), 1.0), 1000).len();
    let starts = scattered(&home(Rule::Second, 1.0), 200);
    let mut scaled = Vec::new();
    for gravity in [1e-6, 1e-3, 1.0, 9.81, 1e3f64] {
        let asked = question(pulled(gravity), 20.0 / gravity.sqrt());
        let mut answers = bench.answers(&asked, BALANCED, &starts)?;
        answers.iter_mut().for_each(|outcome| outcome.time *= gravity.sqrt());
        scaled.push(answers);
    }
    let flips = count(&scaled[0], Status::Answered);
    let worst = scaled.iter().map(|other| super::farthest(other, &scaled[0])).fold(0.0, f64::max);
    HardFinding::new(
        none == 0 && worst <= 1e-9 && flips > 50,
        format!(
            "{flips} flips, times × √g apart by at most {worst:.0e}; {none} starts open at g = 0"
        ),
    )
}
