//! Dual numbers: values with their derivatives along some directions, so that a right-hand side
//! written once also moves the tangents of a motion.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::real::{Angle, Real};

/// A value and its derivatives along `N` directions; a value may be a register of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize, T = f64> {
    /// Value of the number.
    pub value: T,
    /// Derivatives of the value.
    pub slope: [T; N],
}

impl<const N: usize, T: Real> Dual<N, T> {
    /// A constant.
    #[inline(always)]
    pub fn new(value: T) -> Self {
        Dual { value, slope: [value.lit(0.0); N] }
    }

    /// The number f(x, y) = `value` with ∂f/∂x = `by_x` and ∂f/∂y = `by_y`.
    #[inline(always)]
    fn of(value: T, by_x: T, x: &Self, by_y: T, y: &Self) -> Self {
        Dual { value, slope: std::array::from_fn(|i| by_x * x.slope[i] + by_y * y.slope[i]) }
    }

    /// The number f(x) = `value` with df/dx = `by`.
    #[inline(always)]
    fn at(value: T, by: T, x: &Self) -> Self {
        Dual { value, slope: x.slope.map(|slope| by * slope) }
    }
}

impl<const N: usize, T: Real> Add for Dual<N, T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, y: Self) -> Self {
        let slope = std::array::from_fn(|i| self.slope[i] + y.slope[i]);
        Dual { value: self.value + y.value, slope }
    }
}

impl<const N: usize, T: Real> Sub for Dual<N, T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, y: Self) -> Self {
        let slope = std::array::from_fn(|i| self.slope[i] - y.slope[i]);
        Dual { value: self.value - y.value, slope }
    }
}

impl<const N: usize, T: Real> Mul for Dual<N, T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, y: Self) -> Self {
        Dual::of(self.value * y.value, y.value, &self, self.value, &y)
    }
}

impl<const N: usize, T: Real> Div for Dual<N, T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, y: Self) -> Self {
        let quotient = self.value / y.value;
        Dual::of(quotient, y.value.lit(1.0) / y.value, &self, -quotient / y.value, &y)
    }
}

impl<const N: usize, T: Real> Neg for Dual<N, T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual { value: -self.value, slope: self.slope.map(|slope| -slope) }
    }
}

impl<const N: usize, T: Real> Real for Dual<N, T> {
    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        Dual::new(self.value.lit(value))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
    #[inline(always)]
    fn add_scaled(&mut self, other: &Self, weight: f64) {
        let weight = self.value.lit(weight);
        self.value = other.value * weight + self.value;
        for (slope, other) in self.slope.iter_mut().zip(&other.slope) {
            *slope = weight * *other + *slope;
        }
    }
}

impl<const N: usize, T: Angle> Angle for Dual<N, T> {
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (Dual::at(sin, cos, &self), Dual::at(cos, -sin, &self))
    }
}
