//! Dual numbers: values with their derivatives along several directions. A right-hand side written
//! once then also moves the tangents of a motion.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::{Angle, Real};

/// A number whose leading part, of type `S`, is precise enough for computing derivatives.
pub trait Narrow<S>: Real {
    /// The leading part.
    fn narrow(self) -> S;
}

impl<T: Real> Narrow<T> for T {
    #[inline(always)]
    fn narrow(self) -> T {
        self
    }
}

/// A value, or a register of values, and its derivatives along `N` directions, at most four, which may
/// have fewer digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize, T = f64, S = T> {
    /// Value of the number.
    pub value: T,
    /// Derivatives of the value.
    pub slope: [S; N],
}

/// The array of `entry(0)` to `entry(N - 1)`, for at most four directions. Unlike
/// [`std::array::from_fn`] it is always compiled into its caller, without a loop: registers of SIMD
/// lanes need that, and it is less than half the work for the compiler.
#[inline(always)]
fn per_direction<S: Copy, const N: usize>(mut entry: impl FnMut(usize) -> S) -> [S; N] {
    const { assert!(0 < N && N <= 4) };
    let mut array = [entry(0); N];
    if N > 1 {
        array[1] = entry(1);
    }
    if N > 2 {
        array[2] = entry(2);
    }
    if N > 3 {
        array[3] = entry(3);
    }
    array
}

impl<const N: usize, T: Narrow<S>, S: Real> Dual<N, T, S> {
    /// Creates a constant, whose derivatives are zero.
    #[inline(always)]
    pub fn new(value: T) -> Self {
        Dual { value, slope: [value.narrow().lit(0.0); N] }
    }

    /// The number f(x, y) = `value` with ∂f/∂x = `by_x` and ∂f/∂y = `by_y`.
    #[inline(always)]
    fn of(value: T, by_x: S, x: &Self, by_y: S, y: &Self) -> Self {
        Dual { value, slope: per_direction(|i| by_x * x.slope[i] + by_y * y.slope[i]) }
    }

    /// The number f(x) = `value` with df/dx = `by`.
    #[inline(always)]
    fn at(value: T, by: S, x: &Self) -> Self {
        Dual { value, slope: per_direction(|i| by * x.slope[i]) }
    }
}

impl<const N: usize, T: Narrow<S>, S: Real> Add for Dual<N, T, S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, y: Self) -> Self {
        let slope = per_direction(|i| self.slope[i] + y.slope[i]);
        Dual { value: self.value + y.value, slope }
    }
}

impl<const N: usize, T: Narrow<S>, S: Real> Sub for Dual<N, T, S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, y: Self) -> Self {
        let slope = per_direction(|i| self.slope[i] - y.slope[i]);
        Dual { value: self.value - y.value, slope }
    }
}

impl<const N: usize, T: Narrow<S>, S: Real> Mul for Dual<N, T, S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, y: Self) -> Self {
        Dual::of(self.value * y.value, y.value.narrow(), &self, self.value.narrow(), &y)
    }
}

impl<const N: usize, T: Narrow<S>, S: Real> Div for Dual<N, T, S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, y: Self) -> Self {
        let quotient = self.value / y.value;
        let (near, divisor) = (quotient.narrow(), y.value.narrow());
        Dual::of(quotient, divisor.lit(1.0) / divisor, &self, -near / divisor, &y)
    }
}

impl<const N: usize, T: Narrow<S>, S: Real> Neg for Dual<N, T, S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual { value: -self.value, slope: per_direction(|i| -self.slope[i]) }
    }
}

impl<const N: usize, T: Narrow<S>, S: Real> Real for Dual<N, T, S> {
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
        let value = self.value.lit(weight);
        self.value = other.value * value + self.value;
        let weight = value.narrow();
        self.slope = per_direction(|i| weight * other.slope[i] + self.slope[i]);
    }
}

impl<const N: usize, T: Angle> Angle for Dual<N, T> {
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (Dual::at(sin, cos, &self), Dual::at(cos, -sin, &self))
    }
}
