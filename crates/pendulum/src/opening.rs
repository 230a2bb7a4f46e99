//! The first moments of a launch, which decide which bobs that begin near the top pass it at once.
//!
//! A bob's distance from the top is a power series in time, whose coefficients follow from the
//! equations of motion: a series in the square of time from rest without friction, in all powers of
//! time otherwise. Near the top the distance, the speed, the acceleration and even the next
//! derivative can all be arbitrarily small, and their signs decide. The passes are therefore
//! computed with more and more digits until they no longer change when the coefficients change by
//! more than their errors. Engines integrate such a start from the end of its first moments
//! ([`FirstMoments`]), and cells of starts examine the top from then on.

use crate::first_moments::{FirstMoments, FirstPass, Release};
use crate::flip::side_at_top;
use crate::pendulum::{Pendulum, State};
use flipmap_numbers::real::Scalar;
use flipmap_numbers::sign_changes::sign_changes;
use flipmap_numbers::{Dd, Exact};

/// Approximate angle in rad through which the fastest bob turns in an opening. Each power of time
/// contributes less than the previous one by about this factor.
const TURN: f64 = 0.03;
/// Number of coefficients of a series in f64, and below in double-double and in long numbers:
/// [`TURN`] to this power is below epsilon, so truncation errors stay below rounding errors.
pub(super) const ORDER_F64: usize = 14;
pub(super) const ORDER_DD: usize = 24;
const ORDER_THETA: usize = 90;
/// Rounding error of a coefficient, as a multiple of epsilon times the largest value that it can
/// have.
const ROUNDINGS: f64 = 256.0;
/// Difference below which two times of a pass count as the same, as a share of the opening's
/// length.
const SAME: f64 = 1e-9;
/// Distance from the top in rad beyond which a release from rest without friction is integrated
/// like any other start.
const PLAIN_RAD: f64 = 1e-18;
/// Distance from the top in rad below which double-double cannot tell its two sides apart.
pub(crate) const INDISTINCT_RAD: f64 = 1e-29;

/// Bounds on the angular accelerations of a pendulum, in reduced units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rates {
    /// Greatest angular acceleration at rest.
    pull: f64,
    /// Greatest angular acceleration due to rotation, divided by the square of the greater speed.
    whirl: f64,
    /// Greatest angular deceleration due to friction, divided by the greater speed.
    drag: f64,
}

impl Rates {
    /// The bounds for a pendulum in reduced units: the equations of motion, solved for the
    /// accelerations, with all sines and cosines 1 and the least determinant.
    pub(crate) fn new(pendulum: &Pendulum<f64>) -> Self {
        let Pendulum { a, b, c, p, q, least_det, friction, lengths: _ } = *pendulum;
        let [b1, b2] = friction.unwrap_or([0.0; 2]);
        let both = (a.max(b) + c) / least_det;
        Rates {
            pull: (b * p + c * q).max(a * q + c * p) / least_det,
            whirl: c * both,
            drag: (b1 + 2.0 * b2) * both,
        }
    }

    /// Length of the opening in reduced time, for speeds up to `fastest`: no bob that begins
    /// farther than [`Rates::near_rad`] from the top reaches it within this time.
    pub(crate) fn length(&self, fastest: f64) -> f64 {
        TURN / self.pull.max(1.0).max(self.whirl.max(1.0) * fastest).max(self.drag)
    }

    /// Distance in rad that a bob of this speed cannot cover within `length` (at most an
    /// opening's), if neither bob is faster than `fastest` at first. The accelerations count twice,
    /// to allow for the speed gained on the way.
    pub(crate) fn near_rad(&self, speed: f64, fastest: f64, length: f64) -> f64 {
        let acceleration = self.pull + self.whirl * fastest * fastest + self.drag * fastest;
        speed * length + acceleration * length * length
    }
}

/// The signed distance of an angle from the top in rad: negative before the seam at ±π, positive
/// beyond it.
pub fn from_top<T: Scalar>(angle: T) -> T {
    if angle < T::zero() { angle + T::pi() } else { angle - T::pi() }
}

/// The opening of one pendulum, in reduced units.
#[derive(Clone, Debug)]
pub struct Opening {
    exact: Pendulum<Exact>,
    rounded: Pendulum<Dd>,
    plain: Pendulum<f64>,
    /// The bobs whose passes are asked for.
    bobs: &'static [usize],
    rates: Rates,
    /// Reduced time beyond which passes do not matter.
    budget: f64,
}

/// The passes in an opening, and the side of the top of each bob that begins exactly there.
#[derive(Default)]
struct Course {
    passes: Vec<FirstPass>,
    sides: [Option<f64>; 2],
}

impl Opening {
    /// The opening of a pendulum in reduced units, for passes of these bobs within a reduced
    /// `budget`.
    pub fn new(pendulum: &Pendulum<Exact>, bobs: &'static [usize], budget: f64) -> Self {
        let plain = pendulum.to_f64();
        Opening {
            exact: *pendulum,
            rounded: pendulum.map(Exact::to_dd),
            plain,
            bobs,
            rates: Rates::new(&plain),
            budget,
        }
    }

    /// Returns true if a launch with these distances from the top (rad) and reduced speeds begins
    /// so near the top that its first moments must be determined.
    #[inline]
    pub fn concerns(&self, from_top: [f64; 2], speed: [f64; 2]) -> bool {
        let is_lost = |distance: &f64| distance.abs() <= INDISTINCT_RAD;
        let is_near = |bob: &usize| self.is_near(*bob, from_top, speed);
        self.bobs.iter().any(is_near) || from_top.iter().any(is_lost)
    }

    fn is_near(&self, bob: usize, from_top: [f64; 2], speed: [f64; 2]) -> bool {
        from_top[bob].abs() <= 1.01 * self.near_rad(bob, speed)
    }

    /// Distance from the top in rad within which [`Opening::concerns`] may be true for a start from
    /// rest.
    pub fn rest_near_rad(&self) -> f64 {
        (1.01 * self.near_rad(0, [0.0; 2])).max(INDISTINCT_RAD)
    }

    fn near_rad(&self, bob: usize, speed: [f64; 2]) -> f64 {
        let fastest = speed[0].abs().max(speed[1].abs());
        self.rates.near_rad(speed[bob].abs(), fastest, self.rates.length(fastest))
    }

    /// The length of a start's opening.
    fn length(&self, start: &State<Exact>) -> f64 {
        let [first, second] = start.speed.map(|speed| speed.to_f64().abs());
        self.rates.length(first.max(second)).min(self.budget)
    }

    /// The first moments of a launch from `start`: angles in (−π, π] rad, speeds in reduced units.
    pub fn first_moments(&self, start: &State<Exact>) -> FirstMoments {
        let length = self.length(start);
        let course = self.course::<f64, ORDER_F64, { ORDER_F64 / 2 }>(&self.plain, start, length);
        self.with_more_digits(start, length, course)
    }

    /// Returns the same as [`Opening::first_moments`], with the times of passes in double-double.
    pub fn precise_first_moments(&self, start: &State<Exact>) -> FirstMoments {
        self.with_more_digits(start, self.length(start), None)
    }

    /// Returns the first moments with this course; if it is `None`, determines the course with as
    /// many digits as it takes.
    fn with_more_digits(
        &self,
        start: &State<Exact>,
        length: f64,
        course: Option<Course>,
    ) -> FirstMoments {
        let Course { passes, sides } = course
            .or_else(|| self.course::<Dd, ORDER_DD, { ORDER_DD / 2 }>(&self.rounded, start, length))
            .or_else(|| {
                self.course::<Exact, ORDER_THETA, { ORDER_THETA / 2 }>(&self.exact, start, length)
            })
            .unwrap_or_default();
        let length = if self.is_carried(start) { length } else { 0.0 };
        FirstMoments::new(start, length, passes, sides)
    }

    /// Returns true if a start is integrated from the end of its first moments. A motion that is
    /// even in time leaves the top the way it came. Any number type can therefore follow it from
    /// the release, unless it begins much nearer the top than the type's rounding errors.
    fn is_carried(&self, start: &State<Exact>) -> bool {
        let speed = start.speed.map(Exact::to_f64);
        let from_top = start.angle.map(|angle| from_top(angle).to_f64());
        let is_even = start.speed == [Exact::ZERO; 2] && self.plain.friction.is_none();
        let is_carried = |&bob: &usize| {
            let is_plain = is_even && from_top[bob].abs() > PLAIN_RAD;
            !is_plain && self.is_near(bob, from_top, speed)
        };
        self.bobs.iter().any(is_carried)
    }

    /// Determines the course with the digits of `T`; `None` if they do not suffice. `N` is the
    /// number of coefficients in time, `H` half of it.
    fn course<T: Scalar, const N: usize, const H: usize>(
        &self,
        pendulum: &Pendulum<T>,
        start: &State<Exact>,
        length: f64,
    ) -> Option<Course> {
        let release = Release::<T>::new(start);
        let series = release.series::<N>(pendulum, T::from_f64(length));
        let is_even = release.is_at_rest() && pendulum.friction.is_none();
        let fastest = release.speed.iter().fold(0.0, |most: f64, w| most.max(w.to_f64().abs()));
        let mut course = Course { passes: Vec::new(), sides: [None; 2] };
        for (bob, series) in series.iter().enumerate() {
            let near = self.rates.near_rad(release.speed[bob].to_f64().abs(), fastest, length);
            // Fixed-point numbers have the same error whatever their size.
            let size = if T::FLOATING { near } else { near.max(1.0) };
            let doubt = T::from_f64(ROUNDINGS * T::EPSILON * size);
            let mut way = *series;
            if way[0] == T::zero() {
                let leading = leading(&way, is_even, doubt)?;
                course.sides[bob] = side_at_top(leading.map(|k| way[k])).map(T::to_f64);
                way[..leading.unwrap_or(N)].fill(T::zero());
            }
            if !self.bobs.contains(&bob) || way[0].to_f64().abs() > near {
                continue;
            }
            let doubtful = way.iter().position(|c| *c != T::zero()).unwrap_or(0).max(2);
            let [early, late] = [-doubt, doubt].map(|by| {
                let mut way = way;
                way[doubtful] = way[doubtful] + by;
                if is_even { changes_from_rest::<T, N, H>(&way) } else { sign_changes(&way) }
            });
            course.passes.extend(passes(bob, &way, [early, late], length)?);
        }
        course.passes.sort_by(|a, b| a.time.hi.total_cmp(&b.time.hi));
        Some(course)
    }
}

/// Returns the order of the first term that moves a bob that begins exactly at the top, or
/// `Some(None)` if nothing moves it; `None` if the digits cannot tell.
fn leading<T: Scalar, const N: usize>(
    way: &[T; N],
    is_even: bool,
    doubt: T,
) -> Option<Option<usize>> {
    let orders = (1..N).filter(|k| !is_even || k % 2 == 0);
    for k in orders {
        // A speed is as exact as it was given; terms of higher orders have rounding errors.
        if way[k].abs() > doubt || (k == 1 && way[k] != T::zero()) {
            return Some(Some(k));
        }
        if k > 1 && T::FLOATING {
            return None;
        }
    }
    Some(None)
}

/// Returns the moments at which an even polynomial changes sign, from the polynomial in the square
/// of time with half its degree.
fn changes_from_rest<T: Scalar, const N: usize, const H: usize>(way: &[T; N]) -> Vec<T> {
    let in_squares: [T; H] = std::array::from_fn(|k| way[2 * k]);
    sign_changes(&in_squares).into_iter().map(Scalar::sqrt).collect()
}

/// Returns the passes of a bob, each midway between its `early` and its `late` time; `None` if
/// these differ.
fn passes<T: Scalar, const N: usize>(
    bob: usize,
    way: &[T; N],
    [early, late]: [Vec<T>; 2],
    length: f64,
) -> Option<Vec<FirstPass>> {
    let is_same = |(a, b): (&T, &T)| (*a - *b).abs().to_f64() < SAME;
    if early.len() != late.len() || !early.iter().zip(&late).all(is_same) {
        return None;
    }
    // Before the first pass, the bob is on the side of its first term.
    let first = way.iter().find(|c| **c != T::zero());
    let begins_before = first.is_some_and(|c| *c < T::zero());
    let pass = |(k, (a, b)): (usize, (&T, &T))| {
        let share = (*a + *b) * T::from_f64(0.5);
        let hi = share.to_f64();
        let share = Dd::new(hi) + Dd::new((share - T::from_f64(hi)).to_f64());
        let anticlockwise = begins_before == (k % 2 == 0);
        FirstPass { bob, time: share * Dd::new(length), anticlockwise }
    };
    Some(early.iter().zip(&late).enumerate().map(pass).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rule, Status, oracle};
    use flipmap_numbers::Fixed;

    /// Starts around a point at which bobs are at the top, at many distances from it.
    fn around(corner: [f64; 2]) -> Vec<[Exact; 2]> {
        let quarter = Exact::pi().halved(1);
        let mut starts = Vec::new();
        for exponent in [-4, -6, -9, -14, -20, -30, -50] {
            let far = 10f64.powi(exponent);
            for (x, y) in [
                (1.0, 0.3),
                (-0.7, 1.0),
                (0.02, -1.0),
                (-1.0, -1e-3),
                (0.0, -1.0),
                (0.4, 1e-9),
                (0.0, 0.0),
            ] {
                let by = [x * far, y * far];
                starts.push([0, 1].map(|i| {
                    let corner = if corner[i] == 2.0 {
                        Exact::pi()
                    } else {
                        quarter * Exact::from_f64(corner[i])
                    };
                    (corner + Exact::from_f64(by[i])).wrapped()
                }));
            }
        }
        starts
    }

    /// A pendulum of points or bars in reduced units.
    fn reduced(bars: bool, masses: [f64; 2], lengths: [f64; 2]) -> Pendulum<Exact> {
        let make = if bars { Pendulum::rods } else { Pendulum::points };
        let [masses, lengths] = [masses, lengths].map(|pair| pair.map(Exact::from_f64));
        make(masses, lengths, Exact::from_f64(1.0)).reduced().0
    }

    fn rubbed(pendulum: Pendulum<Exact>, friction: [f64; 2]) -> Pendulum<Exact> {
        Pendulum { friction: Some(friction.map(Exact::from_f64)), ..pendulum }
    }

    /// Compares the first pass of each start with that of the gold standard in 384-bit numbers;
    /// returns the number of starts that pass.
    fn check(pendulum: &Pendulum<Exact>, starts: &[State<Exact>], rule: Rule) -> usize {
        let opening = Opening::new(pendulum, rule.watched(), 1e3);
        let mut passed = 0;
        for start in starts {
            let from_top = start.angle.map(|angle| from_top(angle).to_f64());
            if !opening.concerns(from_top, start.speed.map(Exact::to_f64)) {
                continue;
            }
            let moments = opening.first_moments(start);
            let length = opening.length(start);
            let budget = Fixed::from_f64(length);
            let short = pendulum.map(Fixed::<6>::from_theta);
            let given = State {
                angle: start.angle.map(Fixed::from_theta),
                speed: start.speed.map(Fixed::from_theta),
            };
            let truth = oracle::outcome_from(&short, &given, rule, budget);
            let words = format!("{:?} {rule} {start:?} {:?}", pendulum.to_f64(), moments.passes);
            let Some(first) = moments.passes.first() else {
                assert_ne!(truth.status, Status::Answered, "{words}");
                continue;
            };
            let begins_there = from_top.contains(&0.0);
            if begins_there && first.time.hi < 1e-25 {
                // The bob leaves the top and comes back sooner than the gold standard's digits can
                // tell.
                continue;
            }
            passed += 1;
            assert_eq!(truth.status, Status::Answered, "{words}");
            let (time, truth) = (first.time.to_f64(), truth.time.to_f64());
            assert!((time - truth).abs() < 1e-9 * length, "{words} {time:e} {truth:e}");
        }
        passed
    }

    const CORNERS: [[f64; 2]; 7] =
        [[0.0, 2.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [-1.0, 2.0], [2.0, 1.0], [0.6, 2.0]];

    fn pendulums() -> [Pendulum<Exact>; 3] {
        [
            reduced(false, [1.0; 2], [1.0; 2]),
            reduced(true, [1.0; 2], [1.0; 2]),
            reduced(false, [0.02, 1.0], [1.0, 0.3]),
        ]
    }

    #[test]
    fn openings_are_those_of_the_gold_standard_down_to_1e_50_from_the_top() {
        for pendulum in pendulums() {
            for (_, rule) in Rule::ALL {
                let starts = CORNERS.into_iter().flat_map(around).map(State::rest);
                let passed = check(&pendulum, &starts.collect::<Vec<_>>(), rule);
                assert!(passed >= 5, "{:?} {rule} {passed}", pendulum.to_f64());
            }
        }
    }

    #[test]
    fn openings_with_friction_are_those_of_the_gold_standard() {
        for pendulum in pendulums() {
            for friction in [[0.1, 0.1], [0.0, 30.0], [1e-6, 0.0], [1e3, 1e3]] {
                let starts = CORNERS.into_iter().flat_map(around).map(State::rest);
                let starts: Vec<_> = starts.step_by(3).collect();
                let passed = check(&rubbed(pendulum, friction), &starts, Rule::Either);
                assert!(passed >= 10, "{:?} {friction:?} {passed}", pendulum.to_f64());
            }
        }
    }

    #[test]
    fn openings_of_thrown_pendulums_are_those_of_the_gold_standard() {
        let speeds = [[0.0, 1.0], [0.0, -1.0], [3.0, 1e-12], [40.0, -1e-30], [-2.0, 0.0]];
        for pendulum in pendulums() {
            for speed in speeds {
                let speed = speed.map(Exact::from_f64);
                let starts = CORNERS.into_iter().flat_map(around);
                let thrown: Vec<_> = starts.map(|angle| State { angle, speed }).collect();
                let passed = check(&pendulum, &thrown, Rule::Either)
                    + check(&rubbed(pendulum, [0.2, 3.0]), &thrown, Rule::Second);
                assert!(passed >= 20, "{:?} {speed:?} {passed}", pendulum.to_f64());
            }
        }
    }

    #[test]
    fn a_start_exactly_at_the_top_is_put_where_it_moves() {
        let pendulum = reduced(false, [1.0; 2], [1.0; 2]);
        let quarter = Exact::pi().halved(1);
        let opening = Opening::new(&pendulum, Rule::Second.watched(), 1e3);
        let thrown = |angle: [Exact; 2], speed: f64| State {
            angle,
            speed: [Exact::ZERO, Exact::from_f64(speed)],
        };
        // Where the acceleration vanishes, the next derivative decides: the bob stays on one side.
        for (theta1, speed, side) in [
            (quarter, 0.0, None),
            (-quarter, 0.0, None),
            (Exact::from_f64(2.0), 0.0, Some(-1.0)),
            (Exact::from_f64(2.0), 0.5, Some(-1.0)),
            (Exact::from_f64(2.0), -0.5, Some(1.0)),
            (Exact::from_f64(-2.0), -1e-90, Some(1.0)),
        ] {
            let start = thrown([theta1, Exact::pi()], speed);
            let moments = opening.first_moments(&start);
            assert!(moments.passes.is_empty(), "{theta1} {speed}");
            let mirrored = opening.first_moments(&thrown([-theta1, Exact::pi()], -speed));
            assert_eq!(moments.angle[1].abs(), Dd::PI);
            assert_eq!(moments.angle[1], -mirrored.angle[1], "{theta1} {speed}");
            assert!(side.is_none_or(|side| moments.angle[1].hi.signum() == side));
        }
    }

    #[test]
    fn a_bob_thrown_over_the_top_passes_it_once_and_a_braked_one_comes_back() {
        let pendulum = reduced(false, [1.0; 2], [1.0; 2]);
        let opening = Opening::new(&pendulum, Rule::Second.watched(), 1e3);
        let just_below = Exact::pi() - Exact::parse("1e-70").unwrap();
        let passes = |theta1: f64, speed: f64| {
            let angle = [Exact::from_f64(theta1), just_below];
            let speed = [Exact::ZERO, Exact::from_f64(speed)];
            opening.first_moments(&State { angle, speed }).passes
        };
        let over = passes(1.0, 2.0);
        assert!(over.len() == 1 && over[0].anticlockwise && over[0].time.hi < 1e-69, "{over:?}");
        assert!(passes(1.0, -2.0).is_empty());
        // θ1 = 1 pulls the bob back: it is over the top for 1e-3 units of time.
        let braked = passes(1.0, 3e-4);
        assert!(braked.len() == 2 && braked[0].anticlockwise && !braked[1].anticlockwise);
    }

    #[test]
    fn first_moments_end_where_the_gold_standard_is() {
        let pendulum = rubbed(reduced(false, [1.0, 0.4], [1.0, 0.7]), [0.3, 0.8]);
        let opening = Opening::new(&pendulum, Rule::Second.watched(), 1e3);
        let angle = [Exact::from_f64(0.7), Exact::pi() - Exact::from_f64(1e-25)];
        let start = State { angle, speed: [-1.5, 0.25].map(Exact::from_f64) };
        let moments = opening.first_moments(&start);
        let mut orbit = crate::taylor::Orbit::new(pendulum, start);
        let truth = pendulum.phase(&orbit.state_at(Exact::from_f64(moments.length)));
        let precise = moments.precise_end(&pendulum.map(Exact::to_dd));
        let end = moments.end(&pendulum.to_f64());
        for i in 0..6 {
            assert!((precise[i] - truth[i].to_dd()).abs().hi < 1e-30, "{i}");
            assert!((end[i] - truth[i].to_f64()).abs() < 1e-15, "{i}");
        }
    }
}
