//! Hard cases of energy and balance: the rims of the forbidden region, and the upright equilibria.

use super::{BALANCED, HardBench, HardCase, HardFinding, Of, count, home, oracle_dd, oracle_f64};
use flipmap_engine::EngineError;
use flipmap_numbers::Dd;
use flipmap_pendulum::{Pendulum, Rule, Status};

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "rims of the forbidden region",
        expected: "gold's outcomes at excess energies of 1e-3 … 1e-12 P; no flip below the bound",
        why: "below the bound energy conservation closes the top, and just above it opens a gap so \
              narrow, as wide as the root of the excess, that few get through and an integrator \
              that gains energy lets others through too",
        of: Of::Engine,
        run: rims,
    },
    HardCase {
        name: "around the upright equilibria",
        expected: "at offsets of 1e-3 … 1e-15 rad within 0.1 ms of gold; times grow by \
                   ln(1/offset)/λ where the bob leaves the top inward, and not at all where it \
                   goes over the top at once",
        why: "the motion leaves an equilibrium as e^(λt), with λ from the linearised equations, \
              and linear equations cross zero at a time that does not depend on the offset",
        of: Of::Engine,
        run: upright,
    },
];

fn rims(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let question = home(Rule::Second, 20.0);
    let Pendulum { p, q, .. } = question.build.pendulum();
    // The start at θ1 whose energy is `excess` P above the bound.
    let rim = |theta1: f64, excess: f64| {
        let cos2 = (p - q - excess * p - p * theta1.cos()) / q;
        (cos2.abs() <= 1.0).then(|| [Dd::new(theta1), Dd::new(cos2.acos())])
    };
    let along = |excess: f64| (0..60).filter_map(move |k| rim(0.01 + 0.02 * f64::from(k), excess));
    let mut parts = Vec::new();
    let (mut worst, mut flips, mut early) = (0f64, 0, 0);
    for excess in [1e-2, 1e-3, 1e-6, 1e-9, 1e-12] {
        let starts: Vec<[Dd; 2]> = along(excess).collect();
        let truth = oracle_f64(&question, &starts);
        worst = worst.max(bench.worst(&question, &starts, &truth)?);
        flips += count(&truth, Status::Answered);
        early += count(&truth, Status::Forbidden);
        parts.push(format!(
            "{} of {} at {excess:.0e}",
            count(&truth, Status::Answered),
            starts.len()
        ));
    }
    // Submitted all the same: a grid would never submit a forbidden start.
    let below: Vec<[Dd; 2]> = [-1e-12, -1e-9, -1e-6, -1e-3].into_iter().flat_map(along).collect();
    let locked = bench.answers(&question, BALANCED, &below)?;
    let escaped = below.len() - count(&locked, Status::Unflipped);
    HardFinding::new(
        worst <= 1e-6 && escaped == 0 && early == 0 && flips > 0,
        format!(
            "flips above the bound: {}; at most {worst:.0e} s off; below it {escaped} of {}",
            parts.join(", "),
            below.len()
        ),
    )
}

const OFFSETS: [f64; 5] = [1e-3, 1e-6, 1e-9, 1e-12, 1e-15];

/// A departure from an equilibrium: a direction to start in, and `inward` if the watched bob leaves
/// the top inward, so that it has a long way to go before it flips.
struct Departure {
    place: &'static str,
    equilibrium: [Dd; 2],
    towards: [f64; 2],
    inward: bool,
}

const DEPARTURES: [Departure; 4] = [
    Departure {
        place: "(π, −π) inward",
        equilibrium: [Dd::PI, Dd { hi: -Dd::PI.hi, lo: -Dd::PI.lo }],
        towards: [-1.0, 1.2],
        inward: true,
    },
    Departure {
        place: "(π, 0)",
        equilibrium: [Dd::PI, Dd::new(0.0)],
        towards: [-1.0, 0.5],
        inward: true,
    },
    Departure {
        place: "(π, π) over the top",
        equilibrium: [Dd::PI, Dd::PI],
        towards: [-1.0, -0.5],
        inward: false,
    },
    Departure {
        place: "(0, π) over the top",
        equilibrium: [Dd::new(0.0), Dd::PI],
        towards: [-1.0, -0.1],
        inward: false,
    },
];

fn upright(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let question = home(Rule::Second, 60.0);
    let mut parts = Vec::new();
    let mut held = true;
    for Departure { place, equilibrium, towards, inward } in DEPARTURES {
        let start = |offset: f64| [0, 1].map(|i| equilibrium[i] + Dd::new(offset * towards[i]));
        let starts = OFFSETS.map(start);
        let truth = oracle_dd(&question, &starts);
        let worst = bench.worst(&question, &starts, &truth)?;
        let lambda = growth_rate(&question.build.pendulum(), equilibrium);
        let growth = (truth[4].time - truth[2].time) / 1e6f64.ln() * lambda;
        let expected = f64::from(u8::from(inward));
        held &= count(&truth, Status::Answered) == OFFSETS.len()
            && (growth - expected).abs() < 1e-3
            && worst <= 1e-4;
        let [first, .., last] = truth.as_slice() else { continue };
        parts.push(format!(
            "{place}: {:.2} … {:.2} s, growing by {growth:.4}/λ, at most {worst:.0e} s off",
            first.time, last.time
        ));
    }
    HardFinding::new(held, parts.join("; "))
}

/// Rate λ in 1/s at which the motion leaves an equilibrium. By the linearised equations, μ = λ² is
/// the larger root of (AB − C²)μ² + (A Q cos θ2 + B P cos θ1)μ + PQ cos θ1 cos θ2 = 0.
fn growth_rate(pendulum: &Pendulum<f64>, equilibrium: [Dd; 2]) -> f64 {
    let [cos1, cos2] = equilibrium.map(|theta| theta.hi.cos());
    let Pendulum { a, b, p, q, least_det, .. } = *pendulum;
    let half = -0.5 * (a * q * cos2 + b * p * cos1) / least_det;
    let product = p * q * cos1 * cos2 / least_det;
    (half + (half * half - product).sqrt()).sqrt()
}
