//! Polynomials in the two coordinates of a cell of starts, cut off above a degree: arithmetic on
//! them carries a whole neighbourhood of pendulums at once.
//!
//! Both coordinates run from −1 to 1 over the cell. The sum of a degree's coefficients bounds the
//! contribution of that degree, and the rate at which these sums fall tells how much was cut off.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::dual::Dual;
use crate::frame::Frame;
use crate::jet_product::{invert, multiply};
use crate::real::Real;

/// Highest degree kept; higher powers of the coordinates are cut off.
pub const DEGREE: usize = 6;
/// Number of coefficients of a polynomial.
pub(super) const TERMS: usize = (DEGREE + 1) * (DEGREE + 2) / 2;

/// Index of the first coefficient of degree n; those of x^(n−j) y^j follow for j = 0 … n.
pub(super) const fn first(degree: usize) -> usize {
    degree * (degree + 1) / 2
}

/// The polynomial Σ c x^i y^j over i + j ≤ [`DEGREE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    c: [f64; TERMS],
    /// True if any coefficient but the first can differ from zero; constants are much cheaper.
    varies: bool,
}

impl Jet {
    /// The polynomial that has the same value everywhere.
    pub const fn constant(value: f64) -> Self {
        let mut c = [0.0; TERMS];
        c[0] = value;
        Jet { c, varies: false }
    }

    /// The polynomial `half` times one coordinate: the offset of a start from the cell's middle.
    pub const fn coordinate(axis: usize, half: f64) -> Self {
        let mut c = [0.0; TERMS];
        c[1 + axis] = half;
        Jet { c, varies: true }
    }

    /// Value in the middle of the cell.
    pub fn middle(&self) -> f64 {
        self.c[0]
    }

    /// The polynomial with another value in the middle.
    pub fn with_middle(mut self, value: f64) -> Self {
        self.c[0] = value;
        self
    }

    /// The polynomial with its slope along the first coordinate multiplied by `by`.
    #[cfg(feature = "sabotage")]
    pub fn with_larger_slope(mut self, by: f64) -> Self {
        self.c[1] *= by;
        self
    }

    /// A bound, over the whole cell, on the difference from the value in the middle.
    pub fn spread(&self) -> f64 {
        self.c[1..].iter().map(|c| c.abs()).sum()
    }

    /// A bound on the contribution of one degree.
    fn size(&self, degree: usize) -> f64 {
        self.c[first(degree)..first(degree + 1)].iter().map(|c| c.abs()).sum()
    }

    /// An estimate of what was cut off: the sums of the last degrees, continued as a geometric
    /// series; infinite unless each is less than half of the previous one.
    pub fn tail(&self) -> f64 {
        let last = self.size(DEGREE);
        if last == 0.0 {
            return 0.0;
        }
        let fall = |n: usize| (self.size(n) / self.size(n - 2)).sqrt();
        let ratio = fall(DEGREE).max(fall(DEGREE - 1));
        if ratio < 0.5 { last * ratio / (1.0 - ratio) } else { f64::INFINITY }
    }

    /// The coefficients of degree 1.
    pub fn gradient(&self) -> [f64; 2] {
        [self.c[1], self.c[2]]
    }

    /// Coefficients of the polynomial on the line through the middle, in powers of the distance
    /// from the middle in units of a direction vector.
    pub fn along(&self, [x, y]: [f64; 2]) -> [f64; DEGREE + 1] {
        std::array::from_fn(|n| {
            let term = |j: usize| x.powi((n - j) as i32) * y.powi(j as i32);
            (0..=n).map(|j| self.c[first(n) + j] * term(j)).sum()
        })
    }

    /// Value at a point of the cell.
    pub fn at(&self, point: [f64; 2]) -> f64 {
        self.value(point)
    }

    /// Values at `N` points of the cell, given as all first coordinates and all second ones.
    #[inline(always)]
    pub fn values<const N: usize>(&self, [x, y]: &[[f64; N]; 2]) -> [f64; N] {
        let mut sum = [0.0; N];
        for j in (0..=DEGREE).rev() {
            let mut row = [0.0; N];
            for i in (0..=DEGREE - j).rev() {
                let c = self.c[first(i + j) + j];
                (0..N).for_each(|lane| row[lane] = row[lane] * x[lane] + c);
            }
            (0..N).for_each(|lane| sum[lane] = sum[lane] * y[lane] + row[lane]);
        }
        sum
    }

    /// Value at a point of the cell, with its derivative in a direction.
    pub fn along_at(&self, point: [f64; 2], direction: [f64; 2]) -> Dual<1> {
        self.value([0, 1].map(|i| Dual { value: point[i], slope: [direction[i]] }))
    }

    #[inline(always)]
    fn value<T: Real>(&self, [x, y]: [T; 2]) -> T {
        let zero = x.lit(0.0);
        // Horner's rule in y, whose coefficients are polynomials in x.
        (0..=DEGREE).rev().fold(zero, |sum, j| {
            let coefficients = (0..=DEGREE - j).rev().map(|i| x.lit(self.c[first(i + j) + j]));
            sum * y + coefficients.fold(zero, |row, c| row * x + c)
        })
    }

    /// The polynomial in the coordinates of a part of the cell.
    pub fn part(&self, frame: &Frame) -> Self {
        if !self.varies {
            return *self;
        }
        let mut shifted = *self;
        for (axis, &middle) in frame.middle.iter().enumerate() {
            shifted.shift(axis, middle);
        }
        // Replacing x by ax + by and y by cx + dy turns each term into terms of the same degree.
        let [[a, c], [b, d]] = frame.axes;
        let mut one = [0.0; DEGREE + 1];
        one[0] = 1.0;
        let mut out = Jet { c: [0.0; TERMS], varies: true };
        for n in 0..=DEGREE {
            for j in 0..=n {
                let term = powers([a, b], n - j, powers([c, d], j, one));
                for (out, term) in out.c[first(n)..first(n + 1)].iter_mut().zip(term) {
                    *out += shifted.c[first(n) + j] * term;
                }
            }
        }
        out
    }

    /// Bounds, along each of the two axes, on the difference from the value in the middle.
    pub fn extents(&self) -> [f64; 2] {
        let along = |axis: usize| (1..=DEGREE).map(|n| self.c[first(n) + axis * n].abs()).sum();
        [along(0), along(1)]
    }

    /// Adds `by` to one coordinate of the argument (repeated synthetic division).
    fn shift(&mut self, axis: usize, by: f64) {
        let place = |along: usize, across: usize| {
            let n = along + across;
            first(n) + if axis == 0 { across } else { along }
        };
        for across in 0..=DEGREE {
            let last = DEGREE - across;
            for k in 0..last {
                for along in (k..last).rev() {
                    self.c[place(along, across)] += by * self.c[place(along + 1, across)];
                }
            }
        }
    }

    /// The square root, by Newton's method from the root of the middle value, which must be
    /// positive: each iteration doubles the number of degrees that are right.
    pub fn sqrt(self) -> Self {
        let half = Jet::constant(0.5);
        let better = |root: Jet, _| half * (root + self / root);
        (0..3).fold(Jet::constant(self.c[0].sqrt()), better)
    }

    /// Sine and cosine of an angle that varies by `by` over the cell, from its sine and cosine in
    /// the middle.
    pub fn sin_cos_around((sin, cos): (f64, f64), by: Jet) -> (Jet, Jet) {
        let one = Jet::constant(1.0);
        // 1 − by²/2 (1 − by²/12 (1 − by²/30)) and likewise for the sine, up to the degree kept.
        let square = by * by;
        let nested = |divisors: &[f64]| {
            let less = |sum, divisor: &f64| one - square * Jet::constant(1.0 / divisor) * sum;
            divisors.iter().rev().fold(one, less)
        };
        let (cos_by, sin_by) = (nested(&[2.0, 12.0, 30.0]), by * nested(&[6.0, 20.0]));
        let (s, c) = (Jet::constant(sin), Jet::constant(cos));
        (s * cos_by + c * sin_by, c * cos_by - s * sin_by)
    }

    #[inline(always)]
    fn scaled(mut self, by: f64) -> Self {
        self.c.iter_mut().for_each(|c| *c *= by);
        self
    }

    /// The reciprocal, degree by degree; the value in the middle must not be zero.
    fn reciprocal(&self) -> Self {
        if !self.varies {
            return Jet::constant(1.0 / self.c[0]);
        }
        let mut out = Jet { c: [0.0; TERMS], varies: true };
        invert(&self.c, &mut out.c);
        out
    }
}

/// Multiplies a homogeneous polynomial in x and y, given by its coefficients in powers of y, by (ax
/// + by)^`power`.
fn powers([a, b]: [f64; 2], power: usize, mut form: [f64; DEGREE + 1]) -> [f64; DEGREE + 1] {
    for _ in 0..power {
        for j in (1..=DEGREE).rev() {
            form[j] = a * form[j] + b * form[j - 1];
        }
        form[0] *= a;
    }
    form
}

impl Add for Jet {
    type Output = Jet;
    #[inline(always)]
    fn add(mut self, other: Jet) -> Jet {
        if other.varies {
            self.c.iter_mut().zip(&other.c).for_each(|(c, other)| *c += other);
            self.varies = true;
        } else {
            self.c[0] += other.c[0];
        }
        self
    }
}

impl Neg for Jet {
    type Output = Jet;
    #[inline(always)]
    fn neg(mut self) -> Jet {
        self.c.iter_mut().for_each(|c| *c = -*c);
        self
    }
}

impl Sub for Jet {
    type Output = Jet;
    #[inline(always)]
    fn sub(self, other: Jet) -> Jet {
        self + -other
    }
}

impl Mul for Jet {
    type Output = Jet;
    #[inline(always)]
    fn mul(self, other: Jet) -> Jet {
        if !other.varies {
            return self.scaled(other.c[0]);
        }
        if !self.varies {
            return other.scaled(self.c[0]);
        }
        let mut out = Jet { c: [0.0; TERMS], varies: true };
        multiply(&self.c, &other.c, &mut out.c);
        out
    }
}

impl Div for Jet {
    type Output = Jet;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "a quotient is a product with 1 over it")]
    fn div(self, other: Jet) -> Jet {
        self * other.reciprocal()
    }
}

impl Real for Jet {
    // The value in the middle decides the length of a step.
    const ESTIMATES_ERROR: bool = false;

    fn lit(self, value: f64) -> Self {
        Jet::constant(value)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn add_scaled(&mut self, other: &Self, weight: f64) {
        self.varies |= other.varies;
        self.c.iter_mut().zip(&other.c).for_each(|(sum, c)| *sum += c * weight);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Polynomials whose coefficients fall from degree to degree.
    fn jets() -> impl Strategy<Value = Jet> {
        prop::array::uniform32(-1.0..1.0f64).prop_map(|raw| {
            let mut jet = Jet { c: [0.0; TERMS], varies: true };
            for n in 0..=DEGREE {
                let degree = first(n)..first(n + 1);
                for (c, raw) in jet.c[degree.clone()].iter_mut().zip(&raw[degree]) {
                    *c = raw * 0.01f64.powi(n as i32);
                }
            }
            jet.with_middle(2.0 + raw[0])
        })
    }

    proptest! {
        #[test]
        fn arithmetic_is_that_of_the_values(
            a in jets(), b in jets(), x in -1.0..1.0f64, y in -1.0..1.0f64,
        ) {
            let at = |jet: Jet| jet.at([x, y]);
            let near = |jet: Jet, value: f64| (at(jet) - value).abs() < 1e-11;
            prop_assert!(near(a + b, at(a) + at(b)) && near(a - b, at(a) - at(b)));
            prop_assert!(near(a * b, at(a) * at(b)) && near(a / b, at(a) / at(b)));
            let three = Jet::constant(3.0);
            prop_assert!(near(a * three, 3.0 * at(a)) && near(three * a, 3.0 * at(a)));
            prop_assert!(near(three / a, 3.0 / at(a)));
            prop_assert!(near(a.sqrt(), at(a).sqrt()));
        }

        #[test]
        fn values_at_many_points_are_those_at_each(
            a in jets(), x in prop::array::uniform4(-1.0..1.0f64), y in prop::array::uniform4(-1.0..1.0f64),
        ) {
            let each = std::array::from_fn(|k| a.at([x[k], y[k]]));
            prop_assert_eq!(a.values(&[x, y]), each);
        }

        #[test]
        fn derivatives_are_limits_of_differences(
            a in jets(), x in -1.0..1.0f64, y in -1.0..1.0f64, angle in -3.0..3.0f64,
        ) {
            let (sin, cos) = angle.sin_cos();
            let ends = [-1e-5, 1e-5].map(|by| a.at([x + by * cos, y + by * sin]));
            let there = a.along_at([x, y], [cos, sin]);
            prop_assert_eq!(there.value, a.at([x, y]));
            prop_assert!((there.slope[0] - (ends[1] - ends[0]) / 2e-5).abs() < 1e-9);
        }

        #[test]
        fn a_part_is_the_same_polynomial(
            a in jets(), x in -1.0..1.0f64, y in -1.0..1.0f64, angle in -3.0..3.0f64,
        ) {
            let turned = Frame::turned(angle);
            let frame = turned.outside(&Frame::parts([true, false]).nth(1).unwrap());
            let part = a.part(&frame);
            let there = a.at(frame.outward([x, y]));
            prop_assert!((part.at([x, y]) - there).abs() < 1e-14);
            prop_assert!((part.at([x, y]) - part.middle()).abs() <= part.spread() + 1e-15);
        }
    }

    #[test]
    fn what_is_cut_off_is_foreseen() {
        for half in [0.3, 0.1, 0.03] {
            let one = Jet::constant(1.0);
            let jet = one / (one - Jet::coordinate(0, half) - Jet::coordinate(1, half));
            let error = (jet.at([1.0, 1.0]) - 1.0 / (1.0 - 2.0 * half)).abs();
            let ratio = jet.tail() / error;
            assert!(half > 0.25 || (0.9..1.2).contains(&ratio), "{half}: {ratio}");
            assert_eq!(half > 0.25, jet.tail().is_infinite());
        }
    }
}
