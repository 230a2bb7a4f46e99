//! The gold standard compared with exact reference values: the time of the first |θ| = π from rest
//! for unit parameters (m = l = g = 1), on which two formulations agree to over 40 digits.

use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::{Outcome, Pendulum, Rule, Status, oracle};

/// Starts (exact decimals) and times of the first |θ2| = π. The time of (−2, 3) was recomputed with
/// 45 digits in another program, as were both of [`FIRST`]: an older table had lost or swapped
/// digits.
const SECOND: [(&str, &str, &str); 8] = [
    ("3", "3", "1.7679165584206265650865198320412758"),
    ("2", "2", "15.1122983169151143533674566430220564"),
    ("2.5", "0", "8.0069380155503382229337963587501019"),
    ("1", "3", "32.6611170568751763143993511206464973"),
    ("-2", "3", "1.5074705996796280399916720307403882"),
    ("1.75", "-2.5", "1.6893645848634986005782697108916244"),
    ("3.1", "-0.1", "42.1707477715428171850960988462145765"),
    ("2.2", "-1.9", "5.7004778507307246850926008522389852"),
];

const FIRST: [(&str, &str, &str); 2] = [
    ("3", "3", "6.7645613427664177766229749154534621"),
    ("-2", "3", "22.0175212845560551684699021882719"),
];

fn unit<T: Scalar>() -> Pendulum<T> {
    let one = T::from_f64(1.0);
    Pendulum::points([one; 2], [one; 2], one)
}

fn start<T: Scalar>(theta1: &str, theta2: &str) -> [T; 2] {
    [theta1, theta2].map(|text| T::parse(text).expect("a decimal"))
}

fn outcome<T: Scalar>(theta1: &str, theta2: &str, rule: Rule) -> Outcome<T> {
    oracle::outcome(&unit(), start(theta1, theta2), rule, T::from_f64(60.0))
}

/// Sensitivity of the flip time to the start: |∂T/∂θ1| + |∂T/∂θ2|, by differences in dd.
fn sensitivity(theta1: &str, theta2: &str, rule: Rule) -> f64 {
    let nudge = Dd::new(1e-11);
    let angle = start::<Dd>(theta1, theta2);
    let time = |angle| oracle::outcome(&unit(), angle, rule, Dd::new(60.0)).time;
    (0..2)
        .map(|i| {
            let (mut up, mut down) = (angle, angle);
            up[i] = up[i] + nudge;
            down[i] = down[i] - nudge;
            ((time(up) - time(down)) / (nudge + nudge)).hi.abs()
        })
        .sum()
}

#[test]
fn flip_times_in_f64() {
    let second = SECOND.map(|(theta1, theta2, time)| (theta1, theta2, time, Rule::Second));
    let first = FIRST.map(|(theta1, theta2, time)| (theta1, theta2, time, Rule::First));
    for (theta1, theta2, time, rule) in second.into_iter().chain(first) {
        let error = outcome::<f64>(theta1, theta2, rule).time - f64::parse(time).unwrap();
        let allowed = 1e-12 + 1e-15 * sensitivity(theta1, theta2, rule);
        println!("{rule} ({theta1}, {theta2}): {error:e} of {allowed:e}");
        assert!(error.abs() <= allowed, "{rule} ({theta1}, {theta2}): {error:e} > {allowed:e}");
    }
}

#[test]
fn flip_times_in_dd() {
    for (theta1, theta2, time) in SECOND {
        let error = outcome::<Dd>(theta1, theta2, Rule::Second).time - Dd::parse(time).unwrap();
        println!("({theta1}, {theta2}): {:e}", error.hi);
        assert!(error.hi.abs() <= 1e-25, "({theta1}, {theta2}): {:e}", error.hi);
    }
    for (theta1, theta2, time) in FIRST {
        let error = outcome::<Dd>(theta1, theta2, Rule::First).time - Dd::parse(time).unwrap();
        assert!(error.hi.abs() <= 1e-25, "first ({theta1}, {theta2}): {:e}", error.hi);
    }
}

#[test]
fn two_starts_flip_neither_bob() {
    for (theta1, theta2) in [("0.5", "3"), ("1.2", "1.6")] {
        let status = outcome::<f64>(theta1, theta2, Rule::Either).status;
        assert!(matches!(status, Status::Unflipped | Status::Forbidden), "{status:?}");
    }
}

#[test]
fn counts_on_the_grid_are_exact() {
    let grid: Vec<[f64; 2]> = (0..64 * 64)
        .map(|k| [k % 64, k / 64].map(|i| (i as f64 + 0.5 - 32.0) * std::f64::consts::TAU / 64.0))
        .collect();
    let expected = [
        (Rule::First, [118, 184, 392, 644]),
        (Rule::Second, [300, 686, 1492, 2108]),
        (Rule::Either, [418, 814, 1638, 2162]),
    ];
    for (rule, counts) in expected {
        let times: Vec<f64> = grid
            .iter()
            .map(|&angle| oracle::outcome(&unit(), angle, rule, 20.0))
            .filter(|outcome| outcome.status == Status::Answered)
            .map(|outcome| outcome.time)
            .collect();
        let by = |end: f64| times.iter().filter(|&&time| time <= end).count();
        assert_eq!([2.0, 5.0, 10.0, 20.0].map(by), counts, "{rule}");
    }
}

#[test]
fn flip_times_in_f32() {
    for (theta1, theta2, time) in [SECOND[0], SECOND[4], SECOND[5]] {
        let error = outcome::<f32>(theta1, theta2, Rule::Second).time - f32::parse(time).unwrap();
        assert!(error.abs() <= 1e-5, "({theta1}, {theta2}): {error:e}");
    }
}
