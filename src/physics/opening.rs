//! The first moments after a release: which bobs released near the top pass it at once.
//!
//! From rest every angle is an even function of time, so a bob's path is a polynomial in the square
//! of time, whose lowest coefficients follow from the equations of motion ([`MotionSeries`]). Near
//! the top the distance to it, the acceleration there and even the next derivative can all be
//! arbitrarily small, and their signs decide. The answer is therefore computed with more and more
//! digits until changing the coefficients by more than their rounding errors leaves it unchanged.

use super::pendulum::Pendulum;
use super::polynomial::first_rise;
use super::real::Scalar;
use super::series::MotionSeries;
use super::{Dd, Rule, Theta};

/// Number of coefficients of the expansions in time, every second of which vanishes.
const ORDER: usize = 14;
/// Number of coefficients of the polynomials in the square of time.
const COUNT: usize = ORDER / 2;
/// Approximate angle in rad through which the fastest bob turns in an opening. Each power of the
/// square of time contributes less than the previous one by a factor of the square of this angle.
const TURN: f64 = 0.03;
/// Rounding error of a coefficient, as a multiple of epsilon times the largest value that it can
/// have.
const ROUNDINGS: f64 = 256.0;
/// Difference below which two times of a pass count as the same, in lengths of the opening.
const SAME: f64 = 1e-9;

/// The opening of one pendulum, in reduced units.
#[derive(Clone, Debug)]
pub struct Opening {
    /// The pendulum with the opening's length as its unit of time: exact, and `rounded`.
    exact: Pendulum<Theta>,
    rounded: Pendulum<Dd>,
    rule: Rule,
    length: f64,
    near_rad: f64,
}

/// The course of an opening for a start near the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Begin {
    /// A watched bob passes the top at this reduced time.
    Passes(f64),
    /// No watched bob passes the top within the opening.
    Stays,
}

/// Length of the opening in reduced time: no bob that starts farther than [`near_rad`] from the top
/// reaches it so soon.
///
/// At rest |α| ≤ (B P + C Q) / (AB − C²), and the same with the bobs exchanged; the speeds gained
/// meanwhile add less than a thousandth of that.
pub fn length(pendulum: &Pendulum<f64>) -> f64 {
    TURN / greatest_pull(pendulum).max(1.0)
}

/// Distance from the top in rad that no bob covers within the opening's [`length`].
pub fn near_rad(pendulum: &Pendulum<f64>) -> f64 {
    greatest_pull(pendulum) * length(pendulum).powi(2)
}

fn greatest_pull(Pendulum { a, b, c, p, q, least_det, .. }: &Pendulum<f64>) -> f64 {
    (b * p + c * q).max(a * q + c * p) / least_det
}

/// The distance of an angle from the top in rad: positive just beyond the seam, negative before.
pub fn from_top<T: Scalar>(angle: T) -> T {
    if angle < T::zero() { angle + T::pi() } else { angle - T::pi() }
}

impl Opening {
    /// The opening of a pendulum in reduced units.
    pub fn new(pendulum: &Pendulum<Theta>, rule: Rule) -> Self {
        let near = pendulum.to_f64();
        let length = length(&near);
        Opening {
            exact: in_units(pendulum, length),
            rounded: in_units(&pendulum.map(Theta::to_dd), length),
            rule,
            length,
            near_rad: near_rad(&near),
        }
    }

    /// Returns true if a watched bob is released so near the top that [`Opening::begin`] must
    /// decide; `angle` lies within [−π, π].
    pub fn concerns(&self, angle: [f64; 2]) -> bool {
        // With friction the motion is no series in the square of time.
        if self.rounded.friction.is_some() {
            return false;
        }
        self.rule.watched().iter().any(|&bob| from_top(angle[bob]).abs() <= self.near_rad())
    }

    /// Distance from the top within which [`Opening::begin`] may have to decide, rad.
    pub fn near_rad(&self) -> f64 {
        1.01 * self.near_rad
    }

    /// Decides the course of the opening after a release from rest; `angle` lies within (−π, π].
    pub fn begin(&self, angle: [Theta; 2]) -> Begin {
        let from_top = angle.map(from_top);
        let plain = self.rounded.to_f64();
        self.told(&plain, angle.map(Theta::to_f64), from_top.map(Theta::to_f64))
            .or_else(|| {
                self.told(&self.rounded, angle.map(Theta::to_dd), from_top.map(Theta::to_dd))
            })
            .or_else(|| self.told(&self.exact, angle, from_top))
            .unwrap_or(Begin::Stays)
    }

    /// Applies [`settled`] to a start of this pendulum.
    pub fn settled(&self, angle: [Theta; 2]) -> [Theta; 2] {
        settled(&self.exact, angle)
    }

    /// Decides the course as far as the digits of `T` allow; `None` if they do not suffice.
    fn told<T: Scalar>(
        &self,
        pendulum: &Pendulum<T>,
        angle: [T; 2],
        from_top: [T; 2],
    ) -> Option<Begin> {
        if T::FLOATING && from_top.iter().any(|distance| *distance == T::zero()) {
            // The digits that decide are beyond this number type.
            return None;
        }
        let ways = ways(pendulum, angle, from_top);
        let doubt = T::from_f64(ROUNDINGS * T::EPSILON * self.near_rad);
        let mut first: Option<f64> = None;
        for &bob in self.rule.watched() {
            if from_top[bob].to_f64().abs() > self.near_rad {
                continue;
            }
            let [early, late] =
                [-doubt, doubt].map(|by| pass(&ways[bob], by).map(|square| square.to_f64().sqrt()));
            let time = match (early, late) {
                (None, None) => continue,
                (Some(early), Some(late)) if (early - late).abs() < SAME => 0.5 * (early + late),
                _ => return None,
            };
            first = Some(first.map_or(time, |first| first.min(time)));
        }
        Some(first.map_or(Begin::Stays, |time| Begin::Passes(time * self.length)))
    }
}

/// Returns `angle` (rad, within [−π, π]) with each bob released exactly at the top put on the side
/// to which its first motion leads, whichever derivative causes it.
pub fn settled<T: Scalar>(pendulum: &Pendulum<T>, angle: [T; 2]) -> [T; 2] {
    if angle.iter().all(|theta| theta.abs() < T::pi()) {
        return angle;
    }
    let near = pendulum.to_f64();
    let ways = ways(&in_units(pendulum, length(&near)), angle, angle.map(from_top));
    let doubt = T::from_f64(ROUNDINGS * T::EPSILON * near_rad(&near));
    [0, 1].map(|bob| match first_motion(&ways[bob], doubt) {
        Some(motion) if angle[bob].abs() >= T::pi() => {
            if motion > T::zero() {
                -T::pi()
            } else {
                T::pi()
            }
        }
        _ => angle[bob],
    })
}

/// A pendulum in reduced units, rescaled so that `length` is the unit of time.
fn in_units<T: Scalar>(pendulum: &Pendulum<T>, length: f64) -> Pendulum<T> {
    let square = T::from_f64(length) * T::from_f64(length);
    Pendulum { p: pendulum.p * square, q: pendulum.q * square, ..*pendulum }
}

/// The distances of both bobs from the top as polynomials in the square of time.
fn ways<T: Scalar>(pendulum: &Pendulum<T>, angle: [T; 2], from_top: [T; 2]) -> [[T; COUNT]; 2] {
    let zero = T::zero();
    let vectors = [0, 1].map(|bob| {
        // Near the top, the distance from it carries more digits than the angle.
        if from_top[bob].to_f64().abs() < 0.5 {
            let (sin, cos) = from_top[bob].sin_cos();
            [-cos, -sin]
        } else {
            let (sin, cos) = angle[bob].sin_cos();
            [cos, sin]
        }
    });
    let [[x1, y1], [x2, y2]] = vectors;
    let series = MotionSeries::<T, ORDER>::expand(pendulum, &[x1, y1, x2, y2, zero, zero]);
    [0, 1].map(|bob| {
        std::array::from_fn(|k| match k {
            0 => from_top[bob],
            _ => series.speed[bob][2 * k - 1] / T::from_f64(2.0 * k as f64),
        })
    })
}

/// The first coefficient beyond `doubt` that moves a bob.
fn first_motion<T: Scalar>(way: &[T; COUNT], doubt: T) -> Option<T> {
    way[1..].iter().copied().find(|coefficient| coefficient.abs() > doubt)
}

/// The square of the time at which a bob is first beyond the top, if the first coefficient of its
/// motion is wrong by `by`.
fn pass<T: Scalar>(way: &[T; COUNT], by: T) -> Option<T> {
    let mut way = *way;
    // A start exactly at the top counts as on the side to which it moves.
    let side = if way[0] == T::zero() { first_motion(&way, by.abs())? } else { way[0] };
    if way[0] == T::zero() {
        way.iter_mut().filter(|c| c.abs() <= by.abs()).for_each(|c| *c = T::zero());
    } else {
        way[1] = way[1] + by;
    }
    first_rise(&if side > T::zero() { way.map(|c| -c) } else { way })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Fixed, Status, oracle};

    /// Starts around a point at which bobs are at the top, at many distances from it.
    fn around(corner: [f64; 2]) -> Vec<[Theta; 2]> {
        let quarter = Theta::pi().halved(1);
        let mut starts = Vec::new();
        for exponent in [-4, -6, -9, -14, -20, -30] {
            let far = 10f64.powi(exponent);
            for (x, y) in
                [(1.0, 0.3), (-0.7, 1.0), (0.02, -1.0), (-1.0, -1e-3), (0.0, -1.0), (0.4, 1e-9)]
            {
                let by = [x * far, y * far];
                starts.push([0, 1].map(|i| {
                    let corner = if corner[i] == 2.0 {
                        Theta::pi()
                    } else {
                        quarter * Theta::from_f64(corner[i])
                    };
                    (corner + Theta::from_f64(by[i])).wrapped()
                }));
            }
        }
        starts
    }

    /// A pendulum of points or bars in reduced units.
    fn reduced(bars: bool, masses: [f64; 2], lengths: [f64; 2]) -> Pendulum<Theta> {
        let make = if bars { Pendulum::rods } else { Pendulum::points };
        let [masses, lengths] = [masses, lengths].map(|pair| pair.map(Theta::from_f64));
        make(masses, lengths, Theta::from_f64(1.0)).reduced().0
    }

    fn check(pendulum: &Pendulum<Theta>, corner: [f64; 2], rule: Rule) -> usize {
        let opening = Opening::new(pendulum, rule);
        let short = pendulum.map(Fixed::<4>::from_theta);
        let budget = Fixed::from_f64(opening.length);
        let mut passed = 0;
        for start in around(corner) {
            if !opening.concerns(start.map(Theta::to_f64)) {
                continue;
            }
            let truth = oracle::outcome(&short, start.map(Fixed::from_theta), rule, budget);
            let words = format!(
                "{:?} {rule} {:?}",
                pendulum.to_f64(),
                start.map(|theta| theta.decimal(40))
            );
            match opening.begin(start) {
                Begin::Stays => assert_ne!(truth.status, Status::Flipped, "{words}"),
                Begin::Passes(time) => {
                    passed += 1;
                    assert_eq!(truth.status, Status::Flipped, "{words}");
                    let truth = truth.time.to_f64();
                    assert!(
                        (time - truth).abs() < 1e-7 * opening.length,
                        "{words} {time:e} {truth:e}"
                    );
                }
            }
        }
        passed
    }

    #[test]
    fn openings_are_those_of_the_gold_standard_down_to_1e_30_from_the_top() {
        let light = reduced(false, [0.02, 1.0], [1.0, 0.3]);
        let bars = reduced(true, [1.0; 2], [1.0; 2]);
        let points = reduced(false, [1.0; 2], [1.0; 2]);
        let corners =
            [[0.0, 2.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [-1.0, 2.0], [2.0, 1.0], [0.6, 2.0]];
        for pendulum in [points, bars, light] {
            for (_, rule) in Rule::ALL {
                let passed: usize =
                    corners.iter().map(|corner| check(&pendulum, *corner, rule)).sum();
                assert!(passed >= 5, "{:?} {rule} {passed}", pendulum.to_f64());
            }
        }
    }

    #[test]
    fn a_start_exactly_at_the_top_is_put_where_it_moves() {
        let pendulum = reduced(false, [1.0; 2], [1.0; 2]);
        let quarter = Theta::pi().halved(1);
        // Where the acceleration vanishes, the next derivative decides: the bob stays on one side.
        for start in
            [[quarter, Theta::pi()], [-quarter, Theta::pi()], [Theta::from_f64(2.0), Theta::pi()]]
        {
            assert_eq!(Opening::new(&pendulum, Rule::Second).begin(start), Begin::Stays);
            let [_, side] = settled(&pendulum, start);
            let [_, mirrored] = settled(&pendulum, start.map(|theta| -theta));
            assert_eq!(side.abs(), Theta::pi());
            assert_eq!(side, -mirrored);
        }
        let [_, side] = settled(&pendulum.to_f64(), [2.0, std::f64::consts::PI]);
        assert_eq!(side, -std::f64::consts::PI, "pushed towards larger angles");
    }
}
