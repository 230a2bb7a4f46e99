//! Hard cases of chaos: the limits of what any method can predict.

use rayon::prelude::*;

use super::tangent::spectrum;
use super::{BALANCED, HardBench, HardCase, HardFinding, Of, TAYLOR, apart, builds, home};
use flipmap_engine::{EngineError, EventSpec};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Pendulum, Rule, Status};
use flipmap_scene::{Kind, PendulumSpec};

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "Lyapunov spectrum",
        expected: "sum 0 within 1e-6; pairs ±λ and two near 0; at T = 20 √(l/g) the largest has \
                   10/50/90 % within 0.06 of .15/.36/.56 over the open starts",
        why: "the motion keeps volumes and its tangent map is symplectic, and neither the energy \
              nor the moment of release grows",
        of: Of::Physics,
        run: lyapunov,
    },
    HardCase {
        name: "budgets of 1000 s",
        expected: "two methods in f64 disagree about nine in ten pixels that flip after 100 s, \
                   and about at most one in twenty of those before 10 s",
        why: "differences of 1e-16 grow by a few tenths of a decade a second in chaos, so after 100 s \
              nothing is left that two different roundings could agree about",
        of: Of::Cpu,
        run: long_budgets,
    },
];

fn lyapunov(_: &mut HardBench) -> Result<HardFinding, EngineError> {
    let unit = Pendulum::points([1.0; 2], [1.0; 2], 1.0);
    let build = PendulumSpec::new(Kind::Points, [1.0; 2], [1.0; 2], 1.0);
    let asked = EventSpec { build, rule: Rule::Second, budget_secs: 1.0, passes: 1 };
    let long = spectrum(&unit, [2.0, 2.0], 500.0);
    let sum: f64 = long.iter().sum();
    let pair = long[0] + long[3];
    let starts = builds::scattered(&asked, 350);
    let mut exponents: Vec<f64> = starts
        .par_iter()
        .map(|start| spectrum(&unit, start.map(|theta| theta.hi), 20.0)[0])
        .collect();
    exponents.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| exponents[(share * exponents.len() as f64) as usize];
    let deciles = [at(0.1), at(0.5), at(0.9)];
    let near = |i: usize, target: f64| (deciles[i] - target).abs() <= 0.06;
    let held = sum.abs() < 1e-6
        && pair.abs() < 0.02
        && long[1].abs().max(long[2].abs()) < 0.05
        && long[0] > 0.1
        && near(0, 0.15)
        && near(1, 0.36)
        && near(2, 0.56);
    let [first, second, third, fourth] = long;
    let [low, middle, high] = deciles;
    HardFinding::new(
        held,
        format!(
            "from (2, 2) over 500: {first:.3}, {second:.3}, {third:.3}, {fourth:.3}, sum {sum:.0e}; \
             {} starts at T = 20: {low:.2}/{middle:.2}/{high:.2}",
            exponents.len()
        ),
    )
}

fn long_budgets(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let question = home(Rule::Second, 1000.0);
    let starts: Vec<[Dd; 2]> = builds::scattered(&question, 1500);
    let by_one = bench.answers(&question, BALANCED, &starts)?;
    let by_other = bench.answers(&question, TAYLOR, &starts)?;
    let flips_in = |from: f64, to: f64| {
        let late = move |o: &flipmap_pendulum::Outcome| {
            o.status == Status::Answered && (from..to).contains(&o.time)
        };
        let pairs = by_one.iter().zip(&by_other).filter(move |(a, b)| late(a) || late(b));
        pairs.map(|(a, b)| apart(a, b) > 1e-3).collect::<Vec<bool>>()
    };
    let share =
        |differ: &[bool]| differ.iter().filter(|&&d| d).count() as f64 / differ.len() as f64;
    let (late, early) = (flips_in(100.0, 1e4), flips_in(0.0, 10.0));
    let never = by_one
        .iter()
        .zip(&by_other)
        .filter(|(a, b)| [a, b].iter().all(|o| o.status == Status::Unflipped))
        .count();
    HardFinding::new(
        late.len() >= 10 && share(&late) >= 0.9 && share(&early) <= 0.05,
        format!(
            "they disagree about {:.2} of {} pixels that flip after 100 s (of {} before 10 s: {:.3}); \
             {never} flip by neither",
            share(&late),
            late.len(),
            early.len(),
            share(&early)
        ),
    )
}
