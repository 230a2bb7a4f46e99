//! The self-check: a test of whether an adapter's arithmetic can be trusted.
//!
//! Floating-point arithmetic on graphics cards cannot be relied on: compilers reorder sums, drop
//! error terms and emit wrong code for some functions. So a number type is offered only if a kernel
//! of known operations gives the right results on this very device, bit by bit where the standard
//! requires it. The verdict itself is plain code on plain numbers, so that a test can give it false
//! answers.

mod answers;

use answers::{answers_df32, answers_f32, answers_f64};

use super::device::Gpu;
use super::kernel::selfcheck_text;
use super::waiting::{Waiting, now};
use crate::adapters::{BY_SERIES, Check, Pairs, Verdict};
use crate::level::FINEST;
use crate::{
    Engine, EngineError, EventSpec, IntegratorConfig, Job, Keep, Method, Precision, Starts,
};
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::{Outcome, Rule, oracle};
use flipmap_scene::PendulumSpec;

/// The name of the check that allows compensated states.
const ERROR_TERMS: &str = "error terms of sums";

/// Runs all checks on a device.
pub fn run(gpu: &Gpu) -> Result<Verdict, EngineError> {
    run_with(gpu, &|text| text)
}

/// Runs all checks with the kernel's text changed by `edit`, so that a test can show that a wrong
/// kernel is detected.
pub fn run_with(gpu: &Gpu, edit: &dyn Fn(String) -> String) -> Result<Verdict, EngineError> {
    const ALL: [Precision; 3] = [Precision::F32, Precision::Df32, Precision::F64];
    now(checked(gpu, &ALL, edit, Waiting::Sleep)).unwrap_or_else(|| Err(cannot_wait()))
}

/// Checks the number types in `precisions`; the others are not trusted.
pub(super) async fn checked(
    gpu: &Gpu,
    precisions: &[Precision],
    edit: &dyn Fn(String) -> String,
    waiting: Waiting<'_>,
) -> Result<Verdict, EngineError> {
    let text = |precision| edit(selfcheck_text(precision, Pairs::default()));
    let (mut checks, mut pairs) = (Vec::new(), Pairs::default());
    if precisions.contains(&Precision::F32) {
        let answers = answers_f32(gpu, waiting, text(Precision::F32)).await?;
        checks.extend(judge(Precision::F32, &answers));
    }
    if precisions.contains(&Precision::Df32) {
        let (cheapest, pair_checks) = cheapest_pairs(gpu, edit, waiting).await?;
        checks.extend(pair_checks);
        pairs = cheapest;
    }
    if precisions.contains(&Precision::F64) && gpu.has_f64() {
        let answers = answers_f64(gpu, waiting, text(Precision::F64)).await?;
        checks.extend(judge(Precision::F64, &answers));
    } else if precisions.contains(&Precision::F64) {
        checks.push(Check {
            precision: Precision::F64,
            name: "feature SHADER_F64",
            passed: false,
            detail: "the adapter does not have it".to_string(),
        });
    }
    Ok(Verdict { pairs, ..verdict(checks) })
}

/// Returns the cheapest arithmetic on pairs of f32 that passes all checks, or the last one if none
/// does, with the results of its checks.
async fn cheapest_pairs(
    gpu: &Gpu,
    edit: &dyn Fn(String) -> String,
    waiting: Waiting<'_>,
) -> Result<(Pairs, Vec<Check>), EngineError> {
    let mut last = (Pairs::default(), Vec::new());
    for pairs in Pairs::ALL {
        let text = edit(selfcheck_text(Precision::Df32, pairs));
        last = (pairs, judge(Precision::Df32, &answers_df32(gpu, waiting, text).await?));
        if last.1.iter().all(|check| check.passed) {
            break;
        }
    }
    Ok(last)
}

/// Checks orbits: runs the scheme and precision of each of `configs` through the kernel of an
/// ordinary picture and compares its answers with the gold standard. Many pendulums start at the
/// same few places in a scattered order, so that the packing of those that still run is checked,
/// too. A precision that has already been refused is not run.
pub fn orbits(
    engine: &mut dyn Engine,
    configs: &[IntegratorConfig],
) -> Result<Vec<Check>, EngineError> {
    now(orbits_by(engine, configs, Waiting::Sleep)).unwrap_or_else(|| Err(cannot_wait()))
}

/// The error of a check that a page in a browser has to make before it asks for pictures.
pub(super) fn cannot_wait() -> EngineError {
    EngineError::Unsupported("the device has not been checked for this method".to_string())
}

/// Checks orbits like [`orbits`], and waits for the engine as it is told.
pub(super) async fn orbits_by(
    engine: &mut dyn Engine,
    configs: &[IntegratorConfig],
    waiting: Waiting<'_>,
) -> Result<Vec<Check>, EngineError> {
    let budget_secs = ORBIT_BUDGET_SECS;
    let question =
        EventSpec { build: PendulumSpec::default(), rule: Rule::Second, budget_secs, passes: 1 };
    let pendulum = question.build.pendulum();
    let truth = ORBITS.map(|angle| oracle::outcome(&pendulum, angle, Rule::Second, budget_secs));
    let starts: Vec<[Dd; 2]> = scattered().map(|k| ORBITS[k].map(Dd::new)).collect();
    let mut checks = Vec::new();
    for config in configs {
        let Some((config, allowed_secs)) = orbit_config(config) else { continue };
        let starts = Starts::Rest(starts.clone());
        let job = Job { id: 0, question, config, starts, keep: Keep::NOTHING };
        // The failed checks of a refused precision are already listed.
        if !engine.offers(&config) {
            continue;
        }
        let finished = match engine.submit(job) {
            Ok(()) => waiting.finished(engine).await,
            Err(error) => Err(error),
        };
        let finished = match finished {
            // A driver may refuse the largest kernel and compile the others.
            Err(EngineError::Driver(detail)) if config.method == FINEST.method => {
                let (precision, name) = (config.precision, BY_SERIES);
                checks.push(Check { precision, name, passed: false, detail });
                continue;
            }
            finished => finished?,
        };
        let answers = finished.first().map_or(&[][..], |finished| &finished.outcomes);
        let truth: Vec<Outcome> = scattered().map(|k| truth[k]).collect();
        checks.push(judge_orbits(&config, allowed_secs, answers, &truth));
    }
    Ok(checks)
}

/// Seconds for which the orbits of the check run.
const ORBIT_BUDGET_SECS: f64 = 5.0;

/// Number of pendulums in the check of orbits.
const ORBIT_COUNT: usize = 10_000;

/// Starts of the check of orbits, in rad: two that flip within a second, ten whose flips at 3.0 to
/// 4.4 s move by more than 1000 s per rad of their starts, and one that does not flip.
const ORBITS: [[f64; 2]; 13] = [
    [3.0, 3.0],
    [1.75, -2.5],
    [2.98, -2.1],
    [3.05, -2.33],
    [3.09, 2.14],
    [2.31, -1.89],
    [-3.09, -2.16],
    [3.07, 1.93],
    [3.08, 2.24],
    [-2.89, 1.3],
    [3.05, 1.69],
    [-2.93, 2.11],
    [1.2, 1.6],
];

/// Indices of the starts in [`ORBITS`], in an order in which neighbours end at different times.
fn scattered() -> impl Iterator<Item = usize> {
    // Fibonacci hashing (Knuth, The Art of Computer Programming 3, 6.4).
    (0..ORBIT_COUNT as u32).map(|k| (k.wrapping_mul(2_654_435_769) >> 8) as usize % ORBITS.len())
}

/// Returns the configuration by which a method is checked in a precision, and the largest error
/// allowed in a flip time, in s: far below the error that arithmetic of the next lower precision
/// makes in these orbits. Fixed steps are bounded by the method's own error.
fn orbit_config(config: &IntegratorConfig) -> Option<(IntegratorConfig, f64)> {
    let (method, allowed_secs) = match (config.method, config.precision) {
        (Method::Rk4 { .. }, Precision::F32) => (Method::Rk4 { step_secs: 1.0 / 480.0 }, 5e-3),
        (Method::Rk4 { .. }, _) => (Method::Rk4 { step_secs: 1.0 / 480.0 }, 5e-6),
        (Method::Embedded { pair, .. }, Precision::F32) => {
            (Method::Embedded { pair, tolerance: 1e-7 }, 5e-3)
        }
        (Method::Embedded { pair, .. }, Precision::Df32) => {
            // Four times as many steps as by dop853 add up four times as many rounding errors.
            let allowed_secs = if pair.data().order < 8 { 1e-7 } else { 1e-8 };
            (Method::Embedded { pair, tolerance: 1e-13 }, allowed_secs)
        }
        (Method::Embedded { pair, .. }, Precision::F64 | Precision::Dd) => {
            (Method::Embedded { pair, tolerance: 1e-13 }, 1e-8)
        }
        (Method::Taylor { .. }, _) => (FINEST.method, 1e-8),
        (Method::Extrapolation { .. }, _) => return None,
    };
    Some((IntegratorConfig { method, ..*config }, allowed_secs))
}

/// Compares orbits with the truth. A pendulum whose answer is missing or is not a number fails.
pub(crate) fn judge_orbits(
    config: &IntegratorConfig,
    allowed_secs: f64,
    answers: &[Outcome],
    truth: &[Outcome],
) -> Check {
    let off = |(a, t): (&Outcome, &Outcome)| {
        if a.status == t.status { (a.time - t.time).abs() } else { f64::INFINITY }
    };
    let complete = answers.len() == truth.len();
    let error = worst_of(answers.iter().zip(truth).map(off));
    Check {
        precision: config.precision,
        name: match config.method {
            Method::Rk4 { .. } => "orbits by rk4",
            Method::Embedded { pair, .. } => pair.data().orbit_check,
            Method::Taylor { .. } | Method::Extrapolation { .. } => BY_SERIES,
        },
        passed: complete && error <= allowed_secs,
        detail: format!("worst error {error:.1e} s, allowed {allowed_secs:.1e} s"),
    }
}

/// The largest error; a NaN is the worst of all.
fn worst_of(errors: impl Iterator<Item = f64>) -> f64 {
    errors.map(|error| if error.is_nan() { f64::INFINITY } else { error }).fold(0.0, f64::max)
}

/// Derives the verdict from the checks.
pub fn verdict(checks: Vec<Check>) -> Verdict {
    let all = |precision: Precision, counts: fn(&Check) -> bool| {
        let mut of = checks.iter().filter(|c| c.precision == precision && counts(c)).peekable();
        of.peek().is_some() && of.all(|check| check.passed)
    };
    Verdict {
        f32: all(Precision::F32, |check| check.name != ERROR_TERMS),
        compensated: all(Precision::F32, |check| check.name == ERROR_TERMS),
        df32: all(Precision::Df32, |_| true),
        pairs: Pairs::default(),
        f64: all(Precision::F64, |check| check.name != BY_SERIES),
        checks,
    }
}

/// Pairs of operands: magnitudes from 1e-6 to 30, both signs, and ties of rounding.
pub(crate) fn operands() -> Vec<[f64; 2]> {
    // A fixed linear congruential sequence (Knuth's MMIX constants): the same on every machine.
    let mut seed = 20_261_120_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut number = move || {
        let sign = if random() < 0.5 { -1.0 } else { 1.0 };
        sign * 10f64.powf(random() * 7.5 - 6.0)
    };
    let halves = (-8..8).map(|k| [f64::from(k) + 0.5, 3.0]);
    (0..1008).map(|_| [number(), number()]).chain(halves).collect()
}

/// One answer: the operands as the number type held them, and the device's results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CheckResult {
    /// The pair of operands.
    pub operands: [f64; 2],
    /// Sum, error of the sum (in number types other than f32, the difference), product, quotient,
    /// sine, cosine, rounded value; for pairs, in place of the last three: exact sum and product of
    /// the first parts, product plus the first operand.
    pub results: [f64; 7],
}

/// Compares the answers of a number type with the right ones.
pub(crate) fn judge(precision: Precision, answers: &[CheckResult]) -> Vec<Check> {
    let worst = |error: &dyn Fn(&CheckResult) -> f64| worst_of(answers.iter().map(error));
    let ulp = 2.0 * precision.epsilon();
    let check = |name, allowed: f64, error: f64| Check {
        precision,
        name,
        passed: error <= allowed,
        detail: format!("worst error {error:.1e}, allowed {allowed:.1e}"),
    };
    let exact = |k: usize, truth: &dyn Fn([f64; 2]) -> f64| {
        worst(&|answer: &CheckResult| (answer.results[k] - truth(answer.operands)).abs())
    };
    let relative = |k: usize, truth: &dyn Fn([f64; 2]) -> f64| {
        worst(&|answer: &CheckResult| {
            let truth = truth(answer.operands);
            (answer.results[k] - truth).abs() / truth.abs()
        })
    };
    if precision == Precision::Df32 {
        return vec![
            check("sums", PAIR_ERROR, relative(0, &|[a, b]| a + b)),
            check("differences", PAIR_ERROR, relative(1, &|[a, b]| a - b)),
            check("products", PAIR_ERROR, relative(2, &|[a, b]| a * b)),
            check("quotients", PAIR_ERROR, relative(3, &|[a, b]| a / b)),
            check("error terms of sums", 0.0, exact(4, &|pair| first_parts(pair, |a, b| a + b))),
            check(
                "error terms of products",
                0.0,
                exact(5, &|pair| first_parts(pair, |a, b| a * b)),
            ),
            check("products with a sum", PAIR_ERROR, worst(&beyond_terms)),
        ];
    }
    let sum = move |pair| sum_and_error(precision, pair);
    let product = move |[a, b]: [f64; 2]| match precision {
        Precision::F32 => f64::from(a as f32 * b as f32),
        _ => a * b,
    };
    let (second, name): (Box<dyn Fn([f64; 2]) -> f64>, _) = match precision {
        Precision::F32 => (Box::new(move |pair| sum(pair).1), ERROR_TERMS),
        _ => (Box::new(|[a, b]| a - b), "differences"),
    };
    vec![
        check("sums", 0.0, exact(0, &|pair| sum(pair).0)),
        check(name, 0.0, exact(1, &second)),
        check("products", 0.0, exact(2, &product)),
        check("quotients", 2.5 * ulp, relative(3, &|[a, b]| a / b)),
        check("sines", 4.0 * ulp, exact(4, &|[a, _]| a.sin())),
        check("cosines", 4.0 * ulp, exact(5, &|[a, _]| a.cos())),
        check("rounding", 0.0, worst(&beyond_half)),
    ]
}

/// Applies a function, exact in f64, to the first parts of two pairs.
fn first_parts([a, b]: [f64; 2], function: fn(f64, f64) -> f64) -> f64 {
    function(f64::from(a as f32), f64::from(b as f32))
}

/// Error of `a * b + a`, relative to the sizes of its two terms, because these may cancel.
fn beyond_terms(answer: &CheckResult) -> f64 {
    let [a, b] = answer.operands;
    (answer.results[6] - (a * b + a)).abs() / ((a * b).abs() + a.abs())
}

fn sum_and_error(precision: Precision, [a, b]: [f64; 2]) -> (f64, f64) {
    match precision {
        Precision::F32 => {
            let (sum, error) = (a as f32).fast_two_sum(b as f32);
            (f64::from(sum), f64::from(error))
        }
        _ => a.fast_two_sum(b),
    }
}

/// Error of a rounded value: its distance from a whole number, or the amount by which its distance
/// from the operand exceeds a half. Either neighbour of a tie is accepted, because devices round
/// ties differently (software Vulkan by the width of its registers) and the kernels do not depend
/// on it.
fn beyond_half(answer: &CheckResult) -> f64 {
    let ([operand, _], rounded) = (answer.operands, answer.results[6]);
    (rounded - rounded.round()).abs().max((rounded - operand).abs() - 0.5)
}

/// Largest relative error allowed for pairs of f32: 2⁻⁴⁴.
const PAIR_ERROR: f64 = 5.7e-14;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::shared::{from_parts, to_parts};
    use crate::level::BALANCED;
    use flipmap_pendulum::Status;

    /// The answers of a device whose arithmetic is right.
    fn sound(precision: Precision) -> Vec<CheckResult> {
        let round = |x: f64| match precision {
            Precision::F32 => f64::from(x as f32),
            Precision::Df32 => from_parts(to_parts(x)),
            _ => x,
        };
        let answer = |pair: [f64; 2]| {
            let [a, b] = pair.map(round);
            let (sum, error) = sum_and_error(precision, [a, b]);
            let second = if precision == Precision::F32 { error } else { a - b };
            let (sin, cos) = a.sin_cos();
            let last = if precision == Precision::Df32 {
                let exact = |function| first_parts([a, b], function);
                [exact(|a, b| a + b), exact(|a, b| a * b), round(a * b + a)]
            } else {
                [sin, cos, a.round_ties_even()].map(round)
            };
            let first = [sum, second, a * b, a / b].map(round);
            let results = std::array::from_fn(|k| if k < 4 { first[k] } else { last[k - 4] });
            CheckResult { operands: [a, b], results }
        };
        operands().into_iter().map(answer).collect()
    }

    #[test]
    fn sound_answers_pass() {
        for precision in [Precision::F32, Precision::Df32, Precision::F64] {
            let checks = judge(precision, &sound(precision));
            assert!(checks.iter().all(|check| check.passed), "{checks:?}");
        }
    }

    #[test]
    fn every_check_can_fail() {
        for precision in [Precision::F32, Precision::Df32, Precision::F64] {
            for wrong in 0..7 {
                for value in [f64::NAN, 0.123, f64::INFINITY] {
                    let mut answers = sound(precision);
                    answers[500].results[wrong] = value;
                    let checks = judge(precision, &answers);
                    let failed: Vec<usize> = (0..7).filter(|&k| !checks[k].passed).collect();
                    assert_eq!(failed, [wrong], "{precision} {value}: {checks:?}");
                }
            }
        }
    }

    #[test]
    fn a_wrong_orbit_fails() {
        let truth = [Outcome::flipped(0.5), Outcome::without_time(Status::Unflipped)];
        let passed = |answers: &[Outcome]| judge_orbits(&BALANCED, 1e-8, answers, &truth).passed;
        assert!(passed(&truth));
        assert!(!passed(&[Outcome::flipped(0.5 + 2e-8), truth[1]]));
        assert!(!passed(&[truth[0], Outcome::flipped(0.9)]));
        assert!(!passed(&[Outcome::flipped(f64::NAN), truth[1]]));
        assert!(!passed(&truth[..1]));
    }

    #[test]
    fn a_wrong_expansion_costs_expansions_only() {
        let with = |passed| {
            let check = Check {
                precision: Precision::F64,
                name: BY_SERIES,
                passed,
                detail: "worst error 1.0e-3 s".to_string(),
            };
            verdict([judge(Precision::F64, &sound(Precision::F64)), vec![check]].concat())
        };
        assert!(with(true).f64 && with(true).allows(&FINEST).is_ok());
        let wrong = with(false);
        assert!(wrong.f64 && wrong.allows(&BALANCED).is_ok());
        let why = wrong.allows(&FINEST).unwrap_err();
        assert!(why.contains("the method taylor") && why.contains("1.0e-3 s"), "{why}");
        let bare = verdict(vec![wrong.checks.last().unwrap().clone()]);
        assert!(!bare.f64, "expansions say nothing about the arithmetic");
    }

    #[test]
    fn orbits_amplify_errors_a_thousand_times_and_end_at_scattered_times() {
        let pendulum = PendulumSpec::default().pendulum();
        let time = |angle| oracle::outcome(&pendulum, angle, Rule::Second, ORBIT_BUDGET_SECS).time;
        let nudge = 1e-9;
        for angle @ [first, second] in ORBITS[2..12].iter().copied() {
            let moved = [[first + nudge, second], [first, second + nudge]];
            let slope = moved.map(|moved| (time(moved) - time(angle)) / nudge);
            assert!(slope[0].hypot(slope[1]) > 1e3, "{angle:?}: {slope:?} s per rad");
        }
        let order: Vec<usize> = scattered().collect();
        let counts = (0..ORBITS.len()).map(|k| order.iter().filter(|&&at| at == k).count());
        assert!(counts.min().unwrap() > ORBIT_COUNT / ORBITS.len() / 2);
        let alike = order.windows(2).filter(|pair| pair[0] == pair[1]).count();
        assert!(alike < ORBIT_COUNT / 5, "{alike} neighbours start alike");
    }

    #[test]
    fn folded_error_terms_cost_the_compensation_only() {
        let mut answers = sound(Precision::F32);
        answers.iter_mut().for_each(|answer| answer.results[1] = 0.0);
        let verdict = verdict(judge(Precision::F32, &answers));
        assert!(verdict.f32 && !verdict.compensated && !verdict.df32 && !verdict.f64);
        assert!(verdict.require(Precision::F64).is_err());
    }
}
