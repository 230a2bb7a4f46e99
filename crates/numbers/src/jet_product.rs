//! Products and reciprocals of polynomials, compiled for the widest registers of the processor:
//! they are nearly all the cost of carrying polynomials.
//!
//! Both are written out term by term, which makes the 28 sums of a product variables of their own
//! that AVX-512 keeps in registers. In a loop over coefficients in memory, each of the 210 terms
//! waits for the one before it to be written. Eight polynomials side by side in the lanes of
//! registers were no faster, because their sums and copies cost more than their products (measured:
//! 23 µs per step of each of the eight, 20 µs for one alone; 15 µs since the step around the
//! products is compiled for the same registers).

use pulp::{Arch, Simd, WithSimd};

use crate::jet::{TERMS, first};

/// Coefficients of a polynomial.
type Terms = [f64; TERMS];

/// Writes the product of two polynomials, without the terms above the highest degree kept.
pub(super) fn multiply(left: &Terms, right: &Terms, out: &mut Terms) {
    Arch::new().dispatch(Product(left, right, out));
}

/// Writes the reciprocal of a polynomial, degree by degree; its first coefficient must not be zero.
pub(super) fn invert(c: &Terms, out: &mut Terms) {
    Arch::new().dispatch(Reciprocal(c, out));
}

/// Adds a product with two roundings.
#[inline(always)]
fn add(sum: &mut f64, x: &f64, y: &f64) {
    *sum += x * y;
}

/// The two factors, and the polynomial that receives their product.
struct Product<'a>(&'a Terms, &'a Terms, &'a mut Terms);

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Product(left, right, out) = self;
        let mut sum = [0.0; TERMS];
        macro_rules! degree {
            ($n:literal: $($m:literal)*) => {$(
                for a in 0..=$n {
                    for b in 0..=$m {
                        let to = const { first($n + $m) } + a + b;
                        let (x, y) = (const { first($n) } + a, const { first($m) } + b);
                        add(&mut sum[to], &left[x], &right[y]);
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
        *out = sum;
    }
}

/// A polynomial, and the one that receives its reciprocal.
struct Reciprocal<'a>(&'a Terms, &'a mut Terms);

impl WithSimd for Reciprocal<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Reciprocal(c, result) = self;
        let inverse = 1.0 / c[0];
        let mut out = [0.0; TERMS];
        out[0] = inverse;
        macro_rules! degree {
            ($n:literal: $($m:literal)*) => {
                let mut sum = [0.0; $n + 1];
                $(for a in 0..=$m {
                    for b in 0..=$n - $m {
                        let (x, y) = (const { first($m) } + a, const { first($n - $m) } + b);
                        add(&mut sum[a + b], &c[x], &out[y]);
                    }
                })*
                for (k, sum) in sum.iter().enumerate() {
                    out[const { first($n) } + k] = -inverse * sum;
                }
            };
        }
        degree!(1: 1);
        degree!(2: 1 2);
        degree!(3: 1 2 3);
        degree!(4: 1 2 3 4);
        degree!(5: 1 2 3 4 5);
        degree!(6: 1 2 3 4 5 6);
        *result = out;
    }
}
