//! Promises of each method at any start: energy kept, time reversed, order met.

use super::{BALANCED, FAST, HardBench, HardCase, HardFinding, LESSON, Of, TAYLOR, home};
use flipmap_engine::start::TIME;
use flipmap_engine::{
    EngineError, EventSpec, IntegratorConfig, IntegratorState, Precision, Starts,
};
use flipmap_numbers::trig::Turning;
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::embedded::{Pair, plus};
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::series::MotionSeries;
use flipmap_pendulum::taylor::Orbit;
use flipmap_pendulum::{Pendulum, Rule, State, integrator};

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "energy over 100 s",
        expected: "of P + Q at most 1e-13 (taylor), 1e-6 (dop853), 1e-2 (dopri5 in f32), and 1e-3 \
                   (the lesson's rk4) where nothing whips",
        why: "energy is conserved, so what it drifts by is error; adaptive methods may spend their \
              tolerance, which rises to its power 2/3, in each step",
        of: Of::Cpu,
        run: energy,
    },
    HardCase {
        name: "there and back again",
        expected: "back at the start within 1e-9 rad (dop853), 1e-12 rad (taylor) and 1e-25 rad (taylor in dd) after 5 s, speeds \
                   turned round, and 5 s more",
        why: "the equations are the same with time reversed, so the error of both ways is all that \
              remains",
        of: Of::Cpu,
        run: there_and_back,
    },
    HardCase {
        name: "orders of convergence",
        expected: "4, 5, 8 and N within 0.3",
        why: "halving the step of a method of order p divides its error by 2^p, unless a \
              coefficient is wrong",
        of: Of::Physics,
        run: orders,
    },
];

/// A start that swings and a chaotic one (its neighbours separate by a decade in 9 s), both with
/// too little energy ever to flip.
const LONG: [[f64; 2]; 2] = [[0.5, -0.3], [0.2, 2.8]];

fn energy(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let question = home(Rule::Second, 100.0);
    let (reduced, _) = question.reduced();
    let start = |angles: [f64; 2]| angles.map(Dd::new);
    let mut parts = Vec::new();
    let mut held = true;
    for (name, config, allowed) in [
        ("rk4", LESSON, 1e-3),
        ("rk4 in f32", IntegratorConfig { precision: Precision::F32, ..LESSON }, 1e-3),
        ("dopri5 in f32", FAST, 1e-2),
        ("dop853", BALANCED, 1e-6),
        ("taylor", TAYLOR, 1e-13),
    ] {
        let left = bench.finished(&question, config, Starts::Rest(LONG.map(start).to_vec()))?;
        held &= left.unfinished.len() == LONG.len();
        let mut drifts = [0.0; LONG.len()];
        for (index, paused) in left.unfinished {
            let state = if matches!(
                config,
                IntegratorConfig { method: flipmap_engine::Method::Rk4 { .. }, .. }
            ) {
                let [t1, t2, w1, w2] = [0, 1, 2, 3].map(|i| paused.numbers[i]);
                State { angle: [t1, t2], speed: [w1, w2] }
            } else {
                state_of(&reduced, &phase_of(&paused))
            };
            let begun = reduced.energy(&State::rest(LONG[index]));
            drifts[index] = (reduced.energy(&state) - begun).abs() / (reduced.p + reduced.q);
        }
        held &= drifts.iter().all(|&drift| drift <= allowed);
        parts.push(format!("{name} {:.0e} and {:.0e}", drifts[0], drifts[1]));
    }
    HardFinding::new(held, parts.join(", "))
}

/// The phase of an adaptive integrator state, as the nearest f64.
fn phase_of(paused: &IntegratorState) -> Phase<f64> {
    std::array::from_fn(|i| paused.numbers[i] + paused.numbers[6 + i])
}

fn state_of(pendulum: &Pendulum<f64>, phase: &Phase<f64>) -> State<f64> {
    State {
        angle: [phase[1].atan2(phase[0]), phase[3].atan2(phase[2])],
        speed: pendulum.speeds(phase),
    }
}

fn there_and_back(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let question = home(Rule::Second, 5.0);
    let starts = [[0.9, 1.1], [1.2, 1.6], [1.3, -1.0]].map(|start| start.map(Dd::new));
    let mut parts = Vec::new();
    let mut held = true;
    let in_dd = IntegratorConfig {
        method: flipmap_engine::Method::Taylor { tolerance: 1e-28 },
        precision: Precision::Dd,
    };
    for (name, config, allowed) in
        [("dop853", BALANCED, 1e-9), ("taylor", TAYLOR, 1e-12), ("taylor in dd", in_dd, 1e-25)]
    {
        let there = bench.finished(&question, config, Starts::Rest(starts.to_vec()))?.unfinished;
        let states = there.iter().map(|(_, paused)| turned_round(paused)).collect();
        let turned = Starts::Resumed { states, thrown: false };
        let back = bench.finished(&question, config, turned)?.unfinished;
        held &= back.len() == starts.len();
        let mut worst = 0f64;
        for (((_, there), (_, back)), start) in there.iter().zip(&back).zip(&starts) {
            // Each leg ends with its own last step, a little after the 5 s.
            let beyond = time_of(back) - time_of(there);
            worst = worst.max(miss(&question, start, back, beyond));
        }
        held &= worst <= allowed;
        parts.push(format!("{name} {worst:.0e} rad"));
    }
    HardFinding::new(held, parts.join(", "))
}

fn time_of(paused: &IntegratorState) -> Dd {
    Dd::new(paused.numbers[TIME]) + Dd::new(paused.numbers[TIME + 1])
}

/// The same place with all speeds reversed, at time 0.
fn turned_round(paused: &IntegratorState) -> IntegratorState {
    let mut numbers = paused.numbers;
    for i in [4, 5, 10, 11] {
        numbers[i] = -numbers[i];
    }
    (numbers[TIME], numbers[TIME + 1]) = (0.0, 0.0);
    IntegratorState::new(0, numbers)
}

/// Distance of `back` from a pendulum at reduced time `beyond` after its release at `start`.
fn miss(question: &EventSpec, start: &[Dd; 2], back: &IntegratorState, beyond: Dd) -> f64 {
    let reduced = question.reduced_in::<Dd>().0;
    // From rest the motion is the same in both directions of time.
    let truth = Orbit::new(reduced, State::rest(*start)).state_at(beyond.abs());
    let truth = reduced.phase(&truth);
    let at = |i: usize| Dd { hi: back.numbers[i], lo: back.numbers[6 + i] };
    (0..4).map(|i| (at(i) - truth[i]).abs().hi).fold(0.0, f64::max)
}

fn orders(_: &mut HardBench) -> Result<HardFinding, EngineError> {
    const N: usize = 13;
    let lit = Dd::new;
    let pendulum = Pendulum::points([lit(1.0); 2], [lit(1.0); 2], lit(1.0));
    let begun = pendulum.phase(&State::rest([lit(0.5), lit(-0.3)]));
    let unit = [lit(1.0); 2];
    let fifth = |z: &Phase<Dd>, h| plus(z, &Pair::Dopri5.trial(&pendulum, unit, z, h).change);
    let eighth = |z: &Phase<Dd>, h| plus(z, &Pair::Dop853.trial(&pendulum, unit, z, h).change);
    let taylor = |z: &Phase<Dd>, h| plus(z, &MotionSeries::<Dd, N>::expand(&pendulum, z).change(h));
    let truth = pendulum
        .phase(&Orbit::new(pendulum, State::rest([lit(0.5), lit(-0.3)])).state_at(lit(2.0)));
    let error = |step: &dyn Fn(&Phase<Dd>, Dd) -> Phase<Dd>, steps: u32| {
        let h = lit(2.0 / f64::from(steps));
        let end = (0..steps).fold(begun, |z, _| step(&z, h));
        (0..6).map(|i| (end[i] - truth[i]).hi.powi(2)).sum::<f64>().sqrt()
    };
    let order = |step: &dyn Fn(&Phase<Dd>, Dd) -> Phase<Dd>, steps| {
        (error(step, steps) / error(step, 2 * steps)).log2()
    };
    let rk4 = rk4_error(256) / rk4_error(512);
    let measured = [
        (4.0, rk4.log2()),
        (5.0, order(&fifth, 128)),
        (8.0, order(&eighth, 32)),
        ((N - 1) as f64, order(&taylor, 64)),
    ];
    let held = measured.iter().all(|(expected, order)| (expected - order).abs() < 0.3);
    let [rk4, fifth, eighth, taylor] = measured.map(|(_, order)| order);
    HardFinding::new(
        held,
        format!(
            "rk4 {rk4:.2}, dopri5 {fifth:.2}, dop853 {eighth:.2}, taylor to order {} {taylor:.2}",
            N - 1
        ),
    )
}

/// Error of RK4 in angles and f64 after 2 units of time.
fn rk4_error(steps: u32) -> f64 {
    let pendulum = Pendulum::points([1.0; 2], [1.0; 2], 1.0);
    let start = State::rest([0.5, -0.3]);
    let truth = Orbit::new(pendulum, start).state_at(2.0);
    let step = 2.0 / f64::from(steps);
    let end = (0..steps).fold(start, |state, _| {
        state.plus(&integrator::rk4(&pendulum, &state, step, Turning::Fresh))
    });
    let off = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    off(end.angle, truth.angle).hypot(off(end.speed, truth.speed))
}
