//! Dual numbers: values with their derivatives along some directions, so that a right-hand side
//! written once also moves the tangents of a motion.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::real::{Angle, Real};

/// A value and its derivatives along `N` directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// Value of the number.
    pub value: f64,
    /// Derivatives of the value.
    pub slope: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A constant.
    pub fn new(value: f64) -> Self {
        Dual { value, slope: [0.0; N] }
    }

    /// The number f(x, y) = `value` with ∂f/∂x = `by_x` and ∂f/∂y = `by_y`.
    #[inline(always)]
    fn of(value: f64, by_x: f64, x: &Self, by_y: f64, y: &Self) -> Self {
        Dual { value, slope: std::array::from_fn(|i| by_x * x.slope[i] + by_y * y.slope[i]) }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    fn add(self, y: Self) -> Self {
        Dual::of(self.value + y.value, 1.0, &self, 1.0, &y)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, y: Self) -> Self {
        Dual::of(self.value - y.value, 1.0, &self, -1.0, &y)
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    fn mul(self, y: Self) -> Self {
        Dual::of(self.value * y.value, y.value, &self, self.value, &y)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    fn div(self, y: Self) -> Self {
        let quotient = self.value / y.value;
        Dual::of(quotient, 1.0 / y.value, &self, -quotient / y.value, &y)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Dual { value: -self.value, slope: self.slope.map(|slope| -slope) }
    }
}

impl<const N: usize> Real for Dual<N> {
    fn lit(self, value: f64) -> Self {
        Dual::new(value)
    }
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
}

impl<const N: usize> Angle for Dual<N> {
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (Dual::of(sin, cos, &self, 0.0, &self), Dual::of(cos, -sin, &self, 0.0, &self))
    }
}
