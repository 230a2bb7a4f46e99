//! Sums of products of fixed-point numbers, rounded once.
//!
//! The recurrences of a power series are sums of this kind. Coefficients of high order count for
//! little at the end of a step, so their lowest limbs are left out. This is the largest saving
//! possible: the work grows with the square of the number of limbs.

use super::Fixed;

/// Computes Σ xⱼ yₙ₋₁₋ⱼ over two slices of `n` numbers from their highest `limbs` limbs; the lower
/// limbs of the result are zero. The error is at most 2 n times the unit of the last limb kept,
/// times the largest of the numbers.
pub(super) fn convolution<const N: usize>(
    x: &[Fixed<N>],
    y: &[Fixed<N>],
    limbs: usize,
) -> Fixed<N> {
    match limbs {
        2 => of_highest::<N, 2>(x, y),
        3 => of_highest::<N, 3>(x, y),
        4 => of_highest::<N, 4>(x, y),
        5 => of_highest::<N, 5>(x, y),
        6 => of_highest::<N, 6>(x, y),
        7 => of_highest::<N, 7>(x, y),
        8 => of_highest::<N, 8>(x, y),
        _ => unreachable!("numbers have two to eight limbs"),
    }
}

/// Returns the convolution of the highest `M` limbs. They are multiplied as if unsigned, and the
/// effect of the signs is subtracted at the end, as in [`Fixed::product`].
fn of_highest<const N: usize, const M: usize>(x: &[Fixed<N>], y: &[Fixed<N>]) -> Fixed<N> {
    let mut columns = [[0; 2]; M];
    let columns = columns.as_flattened_mut();
    // The column just below the last one kept decides the rounding.
    columns[M - 2] = 1 << 63;
    let mut signs = [0; M];
    for (x, y) in x.iter().zip(y.iter().rev()) {
        let [x, y] = [x, y].map(|number| number.0.last_chunk::<M>().expect("at most all limbs"));
        add_product(columns, x, y);
        add_signs(&mut signs, x, y);
    }
    let (mut sum, mut excess, mut carried) = ([0; N], [0; N], 0u128);
    for k in 0..M {
        sum[N - M + k] = columns[M - 1 + k];
        excess[N - M + k] = carried as u64;
        carried = (carried >> 64) + signs[k];
    }
    Fixed(sum) - Fixed(excess)
}

/// Adds the product of two numbers to the columns of a sum of products, from the column just below
/// the last one kept.
#[inline(always)]
fn add_product<const M: usize>(columns: &mut [u64], x: &[u64; M], y: &[u64; M]) {
    for i in 0..M {
        let mut carry = 0;
        for j in (M - 1).saturating_sub(i + 1)..M {
            let product = u128::from(x[i]) * u128::from(y[j]);
            let sum = product + u128::from(columns[i + j]) + u128::from(carry);
            columns[i + j] = sum as u64;
            carry = (sum >> 64) as u64;
        }
        for column in &mut columns[i + M..2 * M] {
            let (sum, over) = column.overflowing_add(carry);
            *column = sum;
            carry = u64::from(over);
        }
    }
}

/// Adds the excess of a product whose limbs are taken as unsigned: each number if the other one is
/// negative. The excess belongs one limb further up.
#[inline(always)]
fn add_signs<const M: usize>(excess: &mut [u128; M], x: &[u64; M], y: &[u64; M]) {
    let sign = |number: &[u64; M]| ((number[M - 1] as i64) >> 63) as u64;
    let (of_x, of_y) = (sign(x), sign(y));
    for k in 0..M - 1 {
        excess[k] += u128::from(y[k] & of_x) + u128::from(x[k] & of_y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scalar;
    use proptest::prelude::*;

    /// Numbers below 4 in size, of either sign, with digits to the last limb.
    fn number() -> impl Strategy<Value = Fixed<5>> {
        (any::<[u64; 4]>(), -4i64..4)
            .prop_map(|([a, b, c, d], top)| Fixed([a, b, c, d, top as u64]))
    }

    fn one_by_one(x: &[Fixed<5>], y: &[Fixed<5>]) -> Fixed<5> {
        x.iter().zip(y.iter().rev()).fold(Fixed::ZERO, |sum, (x, y)| sum + *x * *y)
    }

    proptest! {
        #[test]
        fn a_convolution_is_the_sum_of_products(
            pairs in prop::collection::vec((number(), number()), 1..40),
        ) {
            let (x, y): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
            let expected = one_by_one(&x, &y);
            for limbs in 2..=5usize {
                let found = convolution(&x, &y, limbs);
                prop_assert!(found.0[..5 - limbs].iter().all(|limb| *limb == 0));
                let unit = (64.0 * (1.0 - limbs as f64)).exp2();
                // Each product is rounded in the expected sum, and lacks lower limbs in the other.
                let most = if limbs == 5 { x.len() as f64 } else { 8.0 * x.len() as f64 + 1.0 };
                let error = (found - expected).to_f64() / unit;
                prop_assert!(error.abs() <= most, "{limbs} limbs: {error} units");
            }
        }
    }

    #[test]
    fn signs_and_carries_of_whole_numbers_are_exact() {
        let of = |values: &[f64]| -> Vec<Fixed<3>> {
            values.iter().map(|v| Fixed::from_f64(*v)).collect()
        };
        let (x, y) = (of(&[-1.0, 2.0, -3.5, 0.0]), of(&[4.0, -0.25, -6.0, -8.0]));
        let expected = Fixed::from_f64(8.0 - 12.0 + 0.875);
        assert_eq!(convolution(&x, &y, 3), expected);
        assert_eq!(convolution(&x, &y, 2), expected);
    }
}
