//! SIMD lanes as numbers: a register of the instruction set found at run time.

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;

use flipmap_numbers::trig::{
    PI_PARTS_F32, PI_PARTS_F64, Rounding, SERIES_F32, SERIES_F64, sin_cos_with,
};
use flipmap_numbers::{Angle, Real};

/// A register of numbers, one pendulum in each.
pub(super) trait Lanes: Rounding + Angle {
    /// The instruction set.
    type Set: Simd;
    /// Number of lanes.
    const COUNT: usize;

    /// Puts the same value into every lane.
    fn splat(set: Self::Set, value: f64) -> Self;
    /// Loads one value per lane from the first [`Lanes::COUNT`] of `values`.
    fn load(set: Self::Set, values: &[f64]) -> Self;
    /// Stores one value per lane to the first [`Lanes::COUNT`] of `values`.
    fn store(self, values: &mut [f64]);
    /// The magnitudes, lane by lane.
    fn abs(self) -> Self;
    /// The larger of two, lane by lane.
    fn max(self, other: Self) -> Self;
    /// The smaller of two, lane by lane.
    fn min(self, other: Self) -> Self;
    /// `self · factor + term` with one rounding.
    fn fused(self, factor: Self, term: Self) -> Self;
    /// Selects, lane by lane, `self` where `test` is negative, otherwise `other`.
    fn select(self, test: Self, other: Self) -> Self;
    /// log₂ of the magnitude to 0.09, from the bits of the number.
    fn rough_log2(self) -> Self;
    /// 2^x to 6 % for |x| < 100; undoes [`Lanes::rough_log2`] exactly.
    fn rough_exp2(self) -> Self;
    /// `self` where `test` is negative, otherwise 0.
    fn where_negative(self, test: Self) -> Self;
    /// Returns true if any lane is less than the same lane of `other`.
    fn any_less(self, other: Self) -> bool;
    /// Returns true if any lane is at most the same lane of `other`.
    fn any_at_most(self, other: Self) -> bool;
}

/// Largest number of lanes in any register.
pub(super) const MAX_LANES: usize = 16;

/// The numbers in a register, lane by lane.
#[inline(always)]
pub(super) fn row<L: Lanes>(lanes: L) -> [f64; MAX_LANES] {
    let mut row = [0.0; MAX_LANES];
    lanes.store(&mut row);
    row
}

macro_rules! lanes {
    ($name:ident, $float:ident, $register:ident, $count:ident, $magic:expr, $series:expr, $parts:expr,
     $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $neg:ident, $fma:ident,
     $abs:ident, $max:ident, $less:ident, $select:ident, $at_most:ident,
     $min:ident, $fused:ident, $first_true:ident, $signed:ident, $magnitude:expr, $mantissa:expr,
     $bias:expr) => {
        /// A register of this number type.
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name<S: Simd> {
            set: S,
            lanes: S::$register,
        }

        lanes!(operator $name Add add $add);
        lanes!(operator $name Sub sub $sub);
        lanes!(operator $name Mul mul $mul);
        lanes!(operator $name Div div $div);

        impl<S: Simd> Neg for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self { lanes: self.set.$neg(self.lanes), ..self }
            }
        }

        impl<S: Simd> Real for $name<S> {
            #[inline(always)]
            fn lit(self, value: f64) -> Self {
                Self::splat(self.set, value)
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                Self { lanes: self.set.$fma(self.lanes, factor.lanes, term.lanes), ..self }
            }
        }

        impl<S: Simd> Angle for $name<S> {
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                sin_cos_with(self, $parts, &$series)
            }
        }

        impl<S: Simd> Rounding for $name<S> {
            /// Rounds by adding 1.5 · 2^mantissa, which leaves no bits for a fraction.
            #[inline(always)]
            fn nearest(self) -> Self {
                let magic = self.lit($magic);
                (self + magic) - magic
            }
        }

        impl<S: Simd> Lanes for $name<S> {
            type Set = S;
            const COUNT: usize = S::$count;

            #[inline(always)]
            fn splat(set: S, value: f64) -> Self {
                Self { set, lanes: set.$splat(value as $float) }
            }
            #[inline(always)]
            fn load(set: S, values: &[f64]) -> Self {
                let mut lanes = set.$splat(0.0);
                let parts: &mut [$float] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut lanes));
                for (part, &value) in parts.iter_mut().zip(values) {
                    *part = value as $float;
                }
                Self { set, lanes }
            }
            #[inline(always)]
            fn store(self, values: &mut [f64]) {
                let parts: &[$float] = bytemuck::cast_slice(std::slice::from_ref(&self.lanes));
                for (value, &part) in values.iter_mut().zip(parts) {
                    *value = f64::from(part);
                }
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self { lanes: self.set.$abs(self.lanes), ..self }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self { lanes: self.set.$max(self.lanes, other.lanes), ..self }
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self { lanes: self.set.$min(self.lanes, other.lanes), ..self }
            }
            #[inline(always)]
            fn fused(self, factor: Self, term: Self) -> Self {
                Self { lanes: self.set.$fused(self.lanes, factor.lanes, term.lanes), ..self }
            }
            #[inline(always)]
            fn select(self, test: Self, other: Self) -> Self {
                let mask = self.set.$less(test.lanes, self.set.$splat(0.0));
                Self { lanes: self.set.$select(mask, self.lanes, other.lanes), ..self }
            }
            #[inline(always)]
            fn rough_log2(mut self) -> Self {
                let parts: &mut [$float] =
                    bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.lanes));
                for part in parts {
                    let bits = (part.to_bits() & $magnitude) as $signed;
                    *part = bits as $float * (1.0 / $mantissa) - $bias;
                }
                self
            }
            #[inline(always)]
            fn rough_exp2(mut self) -> Self {
                let parts: &mut [$float] =
                    bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.lanes));
                for part in parts {
                    // Converts through f32, because every instruction set has its conversions.
                    let bits = ((*part as f32 + 127.0) * 8_388_608.0) as i32;
                    *part = $float::from(f32::from_bits(bits as u32));
                }
                self
            }
            #[inline(always)]
            fn where_negative(self, test: Self) -> Self {
                let zero = self.set.$splat(0.0);
                let mask = self.set.$less(test.lanes, zero);
                Self { lanes: self.set.$select(mask, self.lanes, zero), ..self }
            }
            #[inline(always)]
            fn any_less(self, other: Self) -> bool {
                self.set.$first_true(self.set.$less(self.lanes, other.lanes)) < Self::COUNT
            }
            #[inline(always)]
            fn any_at_most(self, other: Self) -> bool {
                self.set.$first_true(self.set.$at_most(self.lanes, other.lanes)) < Self::COUNT
            }
        }
    };
    (operator $name:ident $trait:ident $method:ident $function:ident) => {
        impl<S: Simd> $trait for $name<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { lanes: self.set.$function(self.lanes, other.lanes), ..self }
            }
        }
    };
}

lanes!(
    F32Lanes,
    f32,
    f32s,
    F32_LANES,
    12_582_912.0,
    SERIES_F32,
    PI_PARTS_F32,
    splat_f32s,
    add_f32s,
    sub_f32s,
    mul_f32s,
    div_f32s,
    neg_f32s,
    mul_add_e_f32s,
    abs_f32s,
    max_f32s,
    less_than_f32s,
    select_f32s,
    less_than_or_equal_f32s,
    min_f32s,
    mul_add_f32s,
    first_true_m32s,
    i32,
    0x7fff_ffff,
    8_388_608.0,
    127.0
);
lanes!(
    F64Lanes,
    f64,
    f64s,
    F64_LANES,
    6_755_399_441_055_744.0,
    SERIES_F64,
    PI_PARTS_F64,
    splat_f64s,
    add_f64s,
    sub_f64s,
    mul_f64s,
    div_f64s,
    neg_f64s,
    mul_add_e_f64s,
    abs_f64s,
    max_f64s,
    less_than_f64s,
    select_f64s,
    less_than_or_equal_f64s,
    min_f64s,
    mul_add_f64s,
    first_true_m64s,
    i64,
    0x7fff_ffff_ffff_ffff,
    4_503_599_627_370_496.0,
    1023.0
);
