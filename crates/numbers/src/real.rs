//! The number traits: [`Real`] for arithmetic, [`Angle`] for sines, [`Scalar`] for ordered numbers.

use std::fmt::{Debug, Display};
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::fixed::Exact;

/// A number in which the equations can be written: one value, a register of SIMD lanes, or a symbol
/// that records the operations on it.
///
/// Literals are made from an existing number ([`Real::lit`]), because SIMD lanes and symbols belong
/// to a context that a bare literal does not have.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// False for types whose step lengths another number decides: the error of a step is not
    /// computed.
    const ESTIMATES_ERROR: bool = true;

    /// Returns the literal `value` in the context of `self`.
    fn lit(self, value: f64) -> Self;

    /// Returns `self · factor + term`, fused where the type can do so at no cost.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// Adds `weight · other` to `self`, in place where a copy would cost.
    #[inline(always)]
    fn add_scaled(&mut self, other: &Self, weight: f64) {
        *self = other.mul_add(self.lit(weight), *self);
    }

    /// Returns `(sum, error)` with `sum + error == self + other` exactly, if |self| ≥ |other|
    /// (Dekker 1971); otherwise the error is still right to a rounding of `other`. Types whose
    /// compiler could optimise this away override it.
    #[inline(always)]
    fn fast_two_sum(self, other: Self) -> (Self, Self) {
        let sum = self + other;
        (sum, other - (sum - self))
    }
}

/// A number that has a sine and a cosine. Pairs of lanes and of f32 have none, and run without
/// angles.
pub trait Angle: Real {
    /// Sine and cosine of an angle in rad.
    fn sin_cos(self) -> (Self, Self);
}

/// A single ordered number.
pub trait Scalar: Angle + PartialOrd + Display + Send + Sync + 'static {
    /// Distance from 1 to the next number.
    const EPSILON: f64;
    /// True if small numbers have as many digits as large ones.
    const FLOATING: bool = true;

    /// The nearest number of this type.
    fn from_f64(value: f64) -> Self;
    /// The nearest `f64`.
    fn to_f64(self) -> f64;
    /// π to the precision of the type.
    fn pi() -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// Parses a decimal directly into the type, correctly rounded; `None` if it is not a number.
    fn parse(text: &str) -> Option<Self>;
    /// The number of this type nearest to a long fixed-point number.
    fn from_theta(value: Exact) -> Self;

    /// The number zero.
    fn zero() -> Self {
        Self::from_f64(0.0)
    }
    /// The absolute value.
    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }
    /// The larger of two numbers.
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    /// Returns Σ xⱼ yₙ₋₁₋ⱼ over two slices of `n` numbers, to `bits` bits after the point if the
    /// type is faster with fewer bits than it has.
    fn convolution(x: &[Self], y: &[Self], _bits: u32) -> Self {
        x.iter().zip(y.iter().rev()).fold(Self::zero(), |sum, (x, y)| x.mul_add(*y, sum))
    }
    /// Returns true if the number is neither infinite nor NaN.
    fn is_finite(self) -> bool {
        self.to_f64().is_finite()
    }
}

macro_rules! native_float {
    ($float:ident) => {
        impl Real for $float {
            #[inline(always)]
            fn lit(self, value: f64) -> Self {
                value as $float
            }
            // A separate multiply and add: without a known FMA unit `mul_add` is a library call.
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                self * factor + term
            }
        }

        impl Angle for $float {
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $float::sin_cos(self)
            }
        }

        impl Scalar for $float {
            const EPSILON: f64 = $float::EPSILON as f64;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn pi() -> Self {
                std::f64::consts::PI as $float
            }
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }
            fn from_theta(value: Exact) -> Self {
                value.to_f64() as $float
            }
            fn parse(text: &str) -> Option<Self> {
                text.trim().parse().ok().filter(|value: &$float| value.is_finite())
            }
        }
    };
}

native_float!(f32);
native_float!(f64);
