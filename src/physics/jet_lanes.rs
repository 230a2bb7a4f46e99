//! Eight polynomials at a time, one in each lane: cells of starts are carried together.
//!
//! A product of two polynomials of degree 6 is 210 multiplications, all different, which leaves
//! SIMD registers nothing to share. Eight products of eight cells do the same things in the same
//! order. Every lane is computed exactly as [`Jet`] computes it, operation by operation, so a cell's
//! states do not depend on the cells beside it.

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::{Simd, WithSimd};

use super::jet::{Jet, TERMS, first};
use super::phase::Phase;
use super::real::Real;

/// Number of polynomials in a [`JetLanes`]: those of a register of AVX-512.
pub const JET_LANES: usize = 8;

/// One coefficient of every lane.
type Row = [f64; JET_LANES];

/// Eight polynomials of the degree of [`Jet`], on the instruction set `S`.
#[derive(Clone, Copy, Debug)]
pub(super) struct JetLanes<S> {
    set: S,
    c: [Row; TERMS],
    /// True if any coefficient but the first can differ from zero in any lane.
    varies: bool,
}

impl<S: Simd> JetLanes<S> {
    /// Eight constants.
    #[inline(always)]
    pub(super) fn constants(set: S, values: Row) -> Self {
        let mut c = [[0.0; JET_LANES]; TERMS];
        c[0] = values;
        JetLanes { set, c, varies: false }
    }

    /// Loads the polynomials of eight phases, component by component.
    #[inline(always)]
    pub(super) fn load(set: S, phases: [&Phase<Jet>; JET_LANES]) -> Phase<Self> {
        std::array::from_fn(|i| {
            let mut lanes = JetLanes::constants(set, [0.0; JET_LANES]);
            for (lane, phase) in phases.iter().enumerate() {
                let (c, varies) = phase[i].parts();
                lanes.varies |= varies;
                lanes.c.iter_mut().zip(c).for_each(|(row, c)| row[lane] = *c);
            }
            lanes
        })
    }

    /// The phase in one lane.
    #[inline(always)]
    pub(super) fn lane(phase: &Phase<Self>, lane: usize) -> Phase<Jet> {
        phase.each_ref().map(|jets| Jet::of_parts(jets.c.map(|row| row[lane]), jets.varies))
    }

    /// Adds the polynomials of `other`, each times a constant.
    #[inline(always)]
    fn add_times(&mut self, other: &Self, by: &Row) {
        let rows = if other.varies { TERMS } else { 1 };
        for (sum, row) in self.c[..rows].iter_mut().zip(&other.c) {
            add_product(self.set, sum, row, by);
        }
        self.varies |= other.varies;
    }

    #[inline(always)]
    fn scaled(mut self, by: Row) -> Self {
        for row in &mut self.c {
            for (c, by) in row.iter_mut().zip(by) {
                *c *= by;
            }
        }
        self
    }
}

/// Computes `sum += x · y` in every lane, with two roundings as a single polynomial has them.
#[inline(always)]
fn add_product<S: Simd>(set: S, sum: &mut Row, x: &Row, y: &Row) {
    let (sum, _) = S::as_mut_simd_f64s(sum);
    let (x, _) = S::as_simd_f64s(x);
    let (y, _) = S::as_simd_f64s(y);
    for ((sum, x), y) in sum.iter_mut().zip(x).zip(y) {
        *sum = set.add_f64s(*sum, set.mul_f64s(*x, *y));
    }
}

/// A product of polynomials, as a function of its own: inlined, it would be most of the code.
struct Product<'a>(&'a [Row; TERMS], &'a [Row; TERMS], &'a mut [Row; TERMS]);

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Product(left, right, out) = self;
        macro_rules! degree {
            ($n:literal: $($m:literal)*) => {$(
                for a in 0..=$n {
                    for b in 0..=$m {
                        let to = const { first($n + $m) } + a + b;
                        let (x, y) = (const { first($n) } + a, const { first($m) } + b);
                        add_product(set, &mut out[to], &left[x], &right[y]);
                    }
                }
            )*};
        }
        degree!(0: 0 1 2 3 4 5 6);
        degree!(1: 0 1 2 3 4 5);
        degree!(2: 0 1 2 3 4);
        degree!(3: 0 1 2 3);
        degree!(4: 0 1 2);
        degree!(5: 0 1);
        degree!(6: 0);
    }
}

/// A reciprocal, degree by degree.
struct Reciprocal<'a>(&'a [Row; TERMS], &'a mut [Row; TERMS]);

impl WithSimd for Reciprocal<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Reciprocal(c, out) = self;
        let inverse = c[0].map(|c| 1.0 / c);
        let less = inverse.map(|c| -c);
        out[0] = inverse;
        macro_rules! degree {
            ($n:literal: $($m:literal)*) => {
                let mut sum = [[0.0; JET_LANES]; $n + 1];
                $(for a in 0..=$m {
                    for b in 0..=$n - $m {
                        let (x, y) = (const { first($m) } + a, const { first($n - $m) } + b);
                        add_product(set, &mut sum[a + b], &c[x], &out[y]);
                    }
                })*
                for j in 0..=$n {
                    add_product(set, &mut out[const { first($n) } + j], &less, &sum[j]);
                }
            };
        }
        degree!(1: 1);
        degree!(2: 1 2);
        degree!(3: 1 2 3);
        degree!(4: 1 2 3 4);
        degree!(5: 1 2 3 4 5);
        degree!(6: 1 2 3 4 5 6);
    }
}

impl<S: Simd> Add for JetLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        let rows = if other.varies { TERMS } else { 1 };
        for (row, other) in self.c[..rows].iter_mut().zip(&other.c) {
            row.iter_mut().zip(other).for_each(|(c, other)| *c += other);
        }
        self.varies = self.varies || other.varies;
        self
    }
}

impl<S: Simd> Neg for JetLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        self.c.iter_mut().flatten().for_each(|c| *c = -*c);
        self
    }
}

impl<S: Simd> Sub for JetLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<S: Simd> Mul for JetLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        if !other.varies {
            return self.scaled(other.c[0]);
        }
        if !self.varies {
            return other.scaled(self.c[0]);
        }
        let mut out = [[0.0; JET_LANES]; TERMS];
        self.set.vectorize(Product(&self.c, &other.c, &mut out));
        JetLanes { c: out, ..self }
    }
}

impl<S: Simd> Div for JetLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        if !other.varies {
            return self.scaled(other.c[0].map(|c| 1.0 / c));
        }
        let mut out = [[0.0; JET_LANES]; TERMS];
        other.set.vectorize(Reciprocal(&other.c, &mut out));
        self * JetLanes { c: out, ..other }
    }
}

impl<S: Simd> Real for JetLanes<S> {
    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        JetLanes::constants(self.set, [value; JET_LANES])
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, mut term: Self) -> Self {
        if factor.varies {
            return self * factor + term;
        }
        term.add_times(&self, &factor.c[0]);
        term
    }

    #[inline(always)]
    fn add_scaled(&mut self, other: &Self, weight: f64) {
        self.add_times(other, &[weight; JET_LANES]);
    }
}
