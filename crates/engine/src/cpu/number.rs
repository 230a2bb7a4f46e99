//! Number types for the state of lanes: plain f64, f32 with a remainder, or two f64.

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;

use super::lanes::{F32Lanes, F64Lanes, Lanes, MAX_LANES};
use flipmap_numbers::Real;
use flipmap_numbers::dual::Narrow;
use flipmap_pendulum::phase::Phase;

/// A number type of the adaptive methods, one pendulum in each lane.
pub(super) trait Number: Real {
    /// Type of the leading part, in which errors and times are computed.
    type Leading: Lanes;

    /// Loads numbers from `high` and `low` rows of lanes.
    fn load(set: <Self::Leading as Lanes>::Set, high: &[f64], low: &[f64]) -> Self;
    /// Stores numbers to `high` and `low` rows of lanes.
    fn store(self, high: &mut [f64], low: &mut [f64]);
    /// The number that equals `leading`.
    fn exactly(leading: Self::Leading) -> Self;
    /// The nearest value that the leading part holds.
    fn leading(self) -> Self::Leading;
    /// Selects, lane by lane, `self` where `test` is negative, otherwise `other`.
    fn select(self, test: Self::Leading, other: Self) -> Self;
    /// The state `phase` after `change` has been added.
    fn changed(phase: &Phase<Self>, change: &Phase<Self>) -> Phase<Self>;
}

/// Loads the lanes' unit vectors and momenta from `rows`, which are in the order of
/// [`crate::start::PHASE`].
#[inline(always)]
pub(super) fn load_phase<N: Number>(
    set: <N::Leading as Lanes>::Set,
    rows: &[[f64; MAX_LANES]],
) -> Phase<N> {
    [
        N::load(set, &rows[0], &rows[6]),
        N::load(set, &rows[1], &rows[7]),
        N::load(set, &rows[2], &rows[8]),
        N::load(set, &rows[3], &rows[9]),
        N::load(set, &rows[4], &rows[10]),
        N::load(set, &rows[5], &rows[11]),
    ]
}

/// Stores the lanes' unit vectors and momenta to the rows that [`load_phase`] reads.
#[inline(always)]
pub(super) fn store_phase<N: Number>(phase: &Phase<N>, rows: &mut [[f64; MAX_LANES]]) {
    let (high, low) = rows.split_at_mut(6);
    for i in 0..6 {
        phase[i].store(&mut high[i], &mut low[i]);
    }
}

impl<S: Simd> Number for F64Lanes<S> {
    type Leading = Self;

    #[inline(always)]
    fn load(set: S, high: &[f64], _: &[f64]) -> Self {
        <Self as Lanes>::load(set, high)
    }
    #[inline(always)]
    fn store(self, high: &mut [f64], _: &mut [f64]) {
        Lanes::store(self, high);
    }
    #[inline(always)]
    fn exactly(leading: Self) -> Self {
        leading
    }
    #[inline(always)]
    fn leading(self) -> Self {
        self
    }
    #[inline(always)]
    fn select(self, test: Self, other: Self) -> Self {
        Lanes::select(self, test, other)
    }
    #[inline(always)]
    fn changed(phase: &Phase<Self>, change: &Phase<Self>) -> Phase<Self> {
        flipmap_pendulum::embedded::plus(phase, change)
    }
}

impl<S: Simd> Number for F32Lanes<S> {
    type Leading = Self;

    #[inline(always)]
    fn load(set: S, high: &[f64], _: &[f64]) -> Self {
        <Self as Lanes>::load(set, high)
    }
    #[inline(always)]
    fn store(self, high: &mut [f64], _: &mut [f64]) {
        Lanes::store(self, high);
    }
    #[inline(always)]
    fn exactly(leading: Self) -> Self {
        leading
    }
    #[inline(always)]
    fn leading(self) -> Self {
        self
    }
    #[inline(always)]
    fn select(self, test: Self, other: Self) -> Self {
        Lanes::select(self, test, other)
    }
    #[inline(always)]
    fn changed(phase: &Phase<Self>, change: &Phase<Self>) -> Phase<Self> {
        flipmap_pendulum::embedded::plus(phase, change)
    }
}

macro_rules! operators {
    ($name:ident: $($trait:ident $method:ident)*) => {
        $(impl<L: Lanes> $trait for $name<L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                $name::$method(self, other)
            }
        })*
    };
}

/// A number, and the remainder that rounding took from it. Only [`Number::changed`] uses the
/// remainder: sums over thousands of steps need it, single right-hand sides do not.
#[derive(Clone, Copy, Debug)]
pub(super) struct Compensated<L> {
    value: L,
    rest: L,
}

impl<L: Lanes> Compensated<L> {
    #[inline(always)]
    fn new(value: L) -> Self {
        Compensated { value, rest: value.lit(0.0) }
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.value * other.value)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self::new(self.value / other.value)
    }
}

operators!(Compensated: Add add Sub sub Mul mul Div div);

impl<L: Lanes> Neg for Compensated<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.value)
    }
}

impl<L: Lanes> Real for Compensated<L> {
    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        Self::new(self.value.lit(value))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self::new(self.value.mul_add(factor.value, term.value))
    }
}

impl<S: Simd> Number for Compensated<F32Lanes<S>> {
    type Leading = F32Lanes<S>;

    #[inline(always)]
    fn load(set: S, high: &[f64], low: &[f64]) -> Self {
        Compensated { value: Lanes::load(set, high), rest: Lanes::load(set, low) }
    }
    #[inline(always)]
    fn store(self, high: &mut [f64], low: &mut [f64]) {
        Lanes::store(self.value, high);
        Lanes::store(self.rest, low);
    }
    #[inline(always)]
    fn exactly(leading: Self::Leading) -> Self {
        Self::new(leading)
    }
    #[inline(always)]
    fn leading(self) -> Self::Leading {
        self.value
    }
    #[inline(always)]
    fn select(self, test: Self::Leading, other: Self) -> Self {
        Compensated {
            value: Lanes::select(self.value, test, other.value),
            rest: Lanes::select(self.rest, test, other.rest),
        }
    }
    #[inline(always)]
    fn changed(phase: &Phase<Self>, change: &Phase<Self>) -> Phase<Self> {
        let mut next = *phase;
        for i in 0..6 {
            let (value, rest) = phase[i].value.fast_two_sum(phase[i].rest + change[i].value);
            next[i] = Compensated { value, rest };
        }
        next
    }
}

/// The sum of two f64 in every lane, like [`flipmap_numbers::Dd`] and from the same paper.
#[derive(Clone, Copy, Debug)]
pub(super) struct Two<L> {
    high: L,
    low: L,
}

impl<L: Lanes> Two<L> {
    /// Renormalises `high + low`, where |high| ≥ |low|.
    #[inline(always)]
    fn from_fast_sum(high: L, low: L) -> Self {
        let sum = high + low;
        Two { high: sum, low: low - (sum - high) }
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (sum, error) = two_sum(self.high, other.high);
        let (low_sum, low_error) = two_sum(self.low, other.low);
        let first = Self::from_fast_sum(sum, error + low_sum);
        Self::from_fast_sum(first.high, low_error + first.low)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.add(-other)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let error = self.high.fused(other.high, -product);
        let cross = self.high.fused(other.low, self.low * other.high);
        Self::from_fast_sum(product, error + cross)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self.sub(other.mul(Two { high: first, low: first.lit(0.0) }));
        let second = rest.high / other.high;
        let rest = rest.sub(other.mul(Two { high: second, low: first.lit(0.0) }));
        let third = rest.high / other.high;
        Self::from_fast_sum(first, second).add(Two { high: third, low: first.lit(0.0) })
    }
}

/// The sum and its error, whatever the magnitudes (Knuth).
#[inline(always)]
fn two_sum<L: Lanes>(a: L, b: L) -> (L, L) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

operators!(Two: Add add Sub sub Mul mul Div div);

impl<L: Lanes> Neg for Two<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Two { high: -self.high, low: -self.low }
    }
}

impl<L: Lanes> Real for Two<L> {
    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        Two { high: self.high.lit(value), low: self.high.lit(0.0) }
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.mul(factor).add(term)
    }
}

impl<L: Lanes> Narrow<L> for Two<L> {
    #[inline(always)]
    fn narrow(self) -> L {
        self.high
    }
}

impl<S: Simd> Number for Two<F64Lanes<S>> {
    type Leading = F64Lanes<S>;

    #[inline(always)]
    fn load(set: S, high: &[f64], low: &[f64]) -> Self {
        Two { high: Lanes::load(set, high), low: Lanes::load(set, low) }
    }
    #[inline(always)]
    fn store(self, high: &mut [f64], low: &mut [f64]) {
        Lanes::store(self.high, high);
        Lanes::store(self.low, low);
    }
    #[inline(always)]
    fn exactly(leading: Self::Leading) -> Self {
        Two { high: leading, low: leading.lit(0.0) }
    }
    #[inline(always)]
    fn leading(self) -> Self::Leading {
        self.high
    }
    #[inline(always)]
    fn select(self, test: Self::Leading, other: Self) -> Self {
        Two {
            high: Lanes::select(self.high, test, other.high),
            low: Lanes::select(self.low, test, other.low),
        }
    }
    #[inline(always)]
    fn changed(phase: &Phase<Self>, change: &Phase<Self>) -> Phase<Self> {
        flipmap_pendulum::embedded::plus(phase, change)
    }
}
