//! Sums, products, quotients and the order of fixed-point numbers.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Fixed;

impl<const N: usize> Add for Fixed<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let mut carry = false;
        Fixed(std::array::from_fn(|k| {
            let (sum, over) = self.0[k].overflowing_add(other.0[k]);
            let (sum, again) = sum.overflowing_add(u64::from(carry));
            carry = over | again;
            sum
        }))
    }
}

impl<const N: usize> Neg for Fixed<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::ZERO - self
    }
}

impl<const N: usize> Sub for Fixed<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let mut borrow = false;
        Fixed(std::array::from_fn(|k| {
            let (rest, under) = self.0[k].overflowing_sub(other.0[k]);
            let (rest, again) = rest.overflowing_sub(u64::from(borrow));
            borrow = under | again;
            rest
        }))
    }
}

impl<const N: usize> Mul for Fixed<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.product(other)
    }
}

impl<const N: usize> Div for Fixed<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let divisor = other.magnitude();
        if divisor.0[..N - 1].iter().all(|&limb| limb == 0) && divisor.0[N - 1] != 0 {
            let quotient = self.over(divisor.0[N - 1]);
            return if other.is_negative() { -quotient } else { quotient };
        }
        if divisor == Self::ZERO {
            // There is no infinity here; the largest number behaves the same in every comparison.
            let largest =
                Fixed(std::array::from_fn(|k| if k + 1 < N { u64::MAX } else { u64::MAX >> 1 }));
            return if self.is_negative() { -largest } else { largest };
        }
        let shift = divisor.shift_to_half();
        let quotient = self.magnitude() * divisor.shifted(shift).reciprocal();
        let quotient = quotient.shifted(shift);
        if self.is_negative() == other.is_negative() { quotient } else { -quotient }
    }
}

impl<const N: usize> PartialOrd for Fixed<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const N: usize> Ord for Fixed<N> {
    fn cmp(&self, other: &Self) -> Ordering {
        let top = (self.0[N - 1] as i64).cmp(&(other.0[N - 1] as i64));
        top.then_with(|| self.0.iter().rev().cmp(other.0.iter().rev()))
    }
}

impl<const N: usize> Default for Fixed<N> {
    fn default() -> Self {
        Self::ZERO
    }
}
