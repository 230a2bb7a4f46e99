//! The oracle: gold-standard flip times from the Taylor integrator, which finds every pass of the
//! top.
//!
//! Bounds, not samples, decide whether a bob is at the top inside a step: the step is halved until
//! on each part the polynomial provably stays away or provably moves one way, or the part is too
//! short to matter. So a pass that just touches the top is seen, and a near miss is not counted.

use crate::flip::{Outcome, Rule, Status, side_at_top};
use crate::pendulum::{Pendulum, State};
use crate::taylor::{Orbit, TaylorStep};
use flipmap_numbers::polynomial::{evaluate, root_between};
use flipmap_numbers::real::Scalar;

/// The outcome of a release from rest at `angle` (rad, within (−π, π]), with flips up to and
/// including `budget` seconds.
pub fn outcome<T: Scalar>(
    pendulum: &Pendulum<T>,
    angle: [T; 2],
    rule: Rule,
    budget: T,
) -> Outcome<T> {
    outcome_from(pendulum, &State::rest(angle), rule, budget)
}

/// Returns the same as [`outcome`] for a start (rad, within (−π, π]) that may have speeds (rad/s).
pub fn outcome_from<T: Scalar>(
    pendulum: &Pendulum<T>,
    start: &State<T>,
    rule: Rule,
    budget: T,
) -> Outcome<T> {
    outcome_in_bits(pendulum, start, rule, budget, &|_| u32::MAX)
}

/// Returns the same as [`outcome_from`], with errors of about 2^−`bits(t)` in the step that begins
/// at t seconds; floating-point types use all their digits.
pub fn outcome_in_bits<T: Scalar>(
    pendulum: &Pendulum<T>,
    start: &State<T>,
    rule: Rule,
    budget: T,
    bits: &dyn Fn(f64) -> u32,
) -> Outcome<T> {
    let at_rest = start.speed == [T::zero(); 2];
    let depth = match at_rest {
        true => pendulum.depth(start.angle.map(|theta| theta.sin_cos().1)),
        false => -pendulum.energy(start),
    };
    if pendulum.forbids_depth(rule, depth) {
        return Outcome::without_time(Status::Forbidden);
    }
    if at_rest && is_balanced(start.angle) {
        return Outcome::without_time(Status::Unflipped);
    }
    first_flip(pendulum, start, rule, budget, bits)
}

/// Puts each bob that begins exactly at the top on the side on which it counts as being (see
/// [`side_at_top`]), by the expansion of its motion.
pub fn settled<T: Scalar>(pendulum: &Pendulum<T>, start: &State<T>) -> State<T> {
    if start.angle.iter().all(|theta| theta.abs() < T::pi()) {
        return *start;
    }
    let step = Orbit::new(*pendulum, *start).step();
    let side = |bob: usize| {
        let motion = &step.angle[bob][1..];
        let largest = motion.iter().fold(T::zero(), |most, c| most.max(c.abs()));
        let noise = T::from_f64(NOISE * T::EPSILON) * largest;
        let is_moving = |(k, c): (usize, &T)| c.abs() > noise || (k == 0 && *c != T::zero());
        let first = motion.iter().enumerate().find(|term| is_moving(*term));
        side_at_top(first.map(|(_, c)| *c))
    };
    let angle = [0, 1].map(|bob| match start.angle[bob] {
        theta if theta.abs() < T::pi() => theta,
        theta => side(bob).map_or(theta, |side| side * T::pi()),
    });
    State { angle, ..*start }
}

/// Rounding errors of an expansion's coefficients, in epsilons of the largest.
const NOISE: f64 = 256.0;

fn first_flip<T: Scalar>(
    pendulum: &Pendulum<T>,
    start: &State<T>,
    rule: Rule,
    budget: T,
    bits: &dyn Fn(f64) -> u32,
) -> Outcome<T> {
    let mut orbit = Orbit::new(*pendulum, settled(pendulum, start));
    while orbit.time() <= budget {
        orbit.lower_bits(bits(orbit.time().to_f64()));
        let step = orbit.step();
        if !orbit.state().speed[1].is_finite() {
            return Outcome::without_time(Status::Failed);
        }
        if let Some(tau) = flip_within(&step, rule) {
            let time = step.start + tau;
            return if time <= budget {
                Outcome::flipped(time)
            } else {
                Outcome::without_time(Status::Unflipped)
            };
        }
    }
    Outcome::without_time(Status::Unflipped)
}

/// Returns true if both rods are exactly vertical, where a pendulum at rest stays for ever.
pub fn is_balanced<T: Scalar>(angle: [T; 2]) -> bool {
    angle.iter().all(|&theta| theta == T::zero() || theta.abs() == T::pi())
}

/// Seconds into `step` at which `rule` is first met; `None` if it is not met.
pub fn flip_within<T: Scalar>(step: &TaylorStep<T>, rule: Rule) -> Option<T> {
    let units = step.length * step.per_sec;
    rule.watched()
        .iter()
        .filter_map(|&bob| first_passage(&step.angle[bob], units))
        .reduce(|a, b| if b < a { b } else { a })
        .map(|tau| tau * step.unit_secs)
}

/// All moments in (0, length] at which an unwrapped angle passes an odd multiple of π, in either
/// direction.
pub(crate) fn passages<T: Scalar>(angle: &[T], length: T) -> Vec<T> {
    let turn = 2.0 * std::f64::consts::PI;
    let reach = reach(angle, length).to_f64();
    let start = angle[0].to_f64();
    let index = |x: f64| ((x / turn) - 0.5).round() as i64;
    let mut times = Vec::new();
    for k in index(start - reach) - 1..=index(start + reach) + 1 {
        let mut above = angle.to_vec();
        above[0] = above[0] - T::pi() * T::from_f64((2 * k + 1) as f64);
        let below: Vec<T> = above.iter().map(|&c| -c).collect();
        for f in [above, below] {
            let mut from = T::zero();
            while let Some(time) = first_rise(&f, [from, length], resolved(), most_halvings::<T>())
            {
                times.push(time);
                from = time + length * T::from_f64(1e-9);
            }
        }
    }
    times
}

/// A bound on how far an angle moves in `length`.
fn reach<T: Scalar>(angle: &[T], length: T) -> T {
    angle[1..].iter().rev().fold(T::zero(), |sum, c| (sum + c.abs()) * length)
}

/// The first moment in (0, length] at which |angle| reaches π moving outward.
fn first_passage<T: Scalar>(angle: &[T], length: T) -> Option<T> {
    // The bound on the whole step comes first: most steps never come near the top.
    if angle[0].abs() + reach(angle, length) < T::pi() {
        return None;
    }
    [1.0, -1.0]
        .into_iter()
        .filter_map(|side| {
            let mut above: Vec<T> = angle.iter().map(|&c| c * T::from_f64(side)).collect();
            above[0] = above[0] - T::pi();
            first_rise(&above, [T::zero(), length], resolved(), most_halvings::<T>())
        })
        .reduce(|a, b| if b < a { b } else { a })
}

/// Smallest motion of an angle that can be resolved, 8 epsilons; below it the angle is at rest.
fn resolved<T: Scalar>() -> T {
    T::from_f64(8.0 * T::EPSILON)
}

/// Maximum number of halvings: a part of a step cut that often cannot be resolved further.
fn most_halvings<T: Scalar>() -> usize {
    (-T::EPSILON.log2()).ceil().max(50.0) as usize
}

/// The first time in (from, to] at which `f` rises to zero from below; parts in which it moves by
/// less than `least` cannot be resolved.
fn first_rise<T: Scalar>(f: &[T], [from, to]: [T; 2], least: T, halvings: usize) -> Option<T> {
    let half = T::from_f64(0.5);
    let (middle, radius) = ((from + to) * half, (to - from) * half);
    let local = shifted(f, middle);
    let tail = |first: usize, weight: fn(usize) -> f64| {
        let mut power = T::from_f64(1.0);
        local[first..].iter().enumerate().fold(T::zero(), |sum, (k, c)| {
            power = if k == 0 { power } else { power * radius };
            sum + c.abs() * power * T::from_f64(weight(k + first))
        })
    };
    let spread = tail(1, |_| 1.0) * radius;
    if local[0].abs() > spread {
        return None;
    }
    if spread <= least {
        return rises_through(f, from, middle, local[0]);
    }
    if local[1].abs() > tail(2, |k| k as f64) * radius {
        let rises = local[1] > T::zero() && evaluate(f, from) < T::zero();
        return (rises && evaluate(f, to) >= T::zero())
            .then(|| root_between(f, &derivative(f), from, to));
    }
    if halvings == 0 {
        return rises_through(f, from, middle, local[0]);
    }
    first_rise(f, [from, middle], least, halvings - 1)
        .or_else(|| first_rise(f, [middle, to], least, halvings - 1))
}

/// Decides parts in which nothing can be resolved: returns the middle if `f` has risen by then.
fn rises_through<T: Scalar>(f: &[T], from: T, middle: T, at_middle: T) -> Option<T> {
    (evaluate(f, from) < T::zero() && at_middle >= T::zero()).then_some(middle)
}

/// The coefficients of f′.
fn derivative<T: Scalar>(f: &[T]) -> Vec<T> {
    (1..f.len()).map(|k| f[k] * T::from_f64(k as f64)).collect()
}

/// The coefficients of `f` about `centre` (repeated synthetic division).
fn shifted<T: Scalar>(f: &[T], centre: T) -> Vec<T> {
    let mut c = f.to_vec();
    for first in 0..c.len() {
        for k in (first..c.len() - 1).rev() {
            c[k] = c[k + 1].mul_add(centre, c[k]);
        }
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::Fixed;

    fn rise(f: &[f64], to: f64) -> Option<f64> {
        first_rise(f, [0.0, to], resolved(), most_halvings::<f64>())
    }

    #[test]
    fn a_tangent_pass_is_decided_by_its_peak() {
        // e − (t − ½)² written out: passes for e > 0, misses for e < 0.
        let pass = |e: f64| rise(&[e - 0.25, 1.0, -1.0], 1.0);
        for e in [1e-3, 1e-8, 1e-14] {
            let time = pass(e).expect("just over");
            assert!((time - (0.5 - e.sqrt())).abs() < 1e-8, "{e}: {time}");
            assert_eq!(pass(-e), None);
        }
    }

    #[test]
    fn an_angle_that_rests_at_the_top_is_decided_at_once() {
        assert_eq!(rise(&[0.0; 20], 1e3), None);
        assert!(passages(&[std::f64::consts::PI; 1], 1.0).is_empty());
        let noise: [f64; 4] = [1e-17, -3e-17, 2e-17, 1e-18];
        assert_eq!(rise(&noise, 1.0), None);
    }

    #[test]
    fn moving_inward_over_the_top_is_no_flip() {
        assert_eq!(rise(&[0.1, -0.5, 0.0], 1.0), None);
    }

    #[test]
    fn fixed_point_of_any_length_flips_when_double_double_does() {
        fn time<T: Scalar>(rule: Rule) -> T {
            let unit = Pendulum::points([1.0; 2], [1.0; 2], 1.0).map(T::from_f64);
            let angle = ["2.2", "-1.9"].map(|text| T::parse(text).unwrap());
            outcome(&unit, angle, rule, T::from_f64(60.0)).time
        }
        let truth = "5.7004778507307246850926008522389852";
        let error = (time::<Fixed<4>>(Rule::Second) - Fixed::parse(truth).unwrap()).to_f64();
        assert!(error.abs() < 1e-33, "{error:e}");
        let short = time::<Fixed<3>>(Rule::First) - time::<Fixed<7>>(Rule::First).resized();
        assert!(short.to_f64().abs() < 1e-28, "{short}");
    }

    #[test]
    fn both_bobs_are_watched_by_either() {
        let unit = Pendulum::points([1.0; 2], [1.0; 2], 1.0);
        let time = |rule| outcome(&unit, [-2.0, 3.0], rule, 60.0).time;
        assert!((time(Rule::First) - 22.017521284556085).abs() < 1e-9);
        assert_eq!(time(Rule::Either), time(Rule::Second));
    }

    #[test]
    fn upright_pendulums_balance_for_ever() {
        let unit = Pendulum::points([1.0; 2], [1.0; 2], 1.0);
        let pi = std::f64::consts::PI;
        for angle in [[pi, pi], [0.0, pi], [pi, 0.0]] {
            let status = outcome(&unit, angle, Rule::Second, 100.0).status;
            assert!(matches!(status, Status::Unflipped | Status::Forbidden));
        }
    }
}
