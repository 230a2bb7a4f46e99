//! Sums of stages, of which a pair's steps are made.

use crate::phase::Phase;
use flipmap_numbers::real::Real;

/// Computes `phase + step · Σ weightⱼ kⱼ`.
#[inline(always)]
pub(super) fn moved<T: Real, const N: usize>(
    phase: &Phase<T>,
    step: T,
    k: [&Phase<T>; N],
    weights: [f64; N],
) -> Phase<T> {
    let mut rate = sum(k, weights);
    for i in 0..6 {
        rate[i] = rate[i].mul_add(step, phase[i]);
    }
    rate
}

/// Computes `Σ weightⱼ kⱼ`.
#[inline(always)]
pub(super) fn sum<T: Real, const N: usize>(k: [&Phase<T>; N], weights: [f64; N]) -> Phase<T> {
    let mut sum = *k[0];
    for i in 0..6 {
        sum[i] = sum[i] * sum[i].lit(weights[0]);
        for j in 1..N {
            sum[i].add_scaled(&k[j][i], weights[j]);
        }
    }
    sum
}

/// Computes `rate − Σ weightⱼ kⱼ`.
#[inline(always)]
pub(super) fn less<T: Real, const N: usize>(
    rate: &Phase<T>,
    k: [&Phase<T>; N],
    weights: [f64; N],
) -> Phase<T> {
    let mut rate = *rate;
    for i in 0..6 {
        for j in 0..N {
            rate[i].add_scaled(&k[j][i], -weights[j]);
        }
    }
    rate
}

#[inline(always)]
pub(super) fn scaled<T: Real>(rate: &Phase<T>, step: T) -> Phase<T> {
    let mut change = *rate;
    for value in &mut change {
        *value = *value * step;
    }
    change
}

/// Computes `phase + change`.
#[inline(always)]
pub fn plus<T: Real>(phase: &Phase<T>, change: &Phase<T>) -> Phase<T> {
    let mut next = *phase;
    for i in 0..6 {
        next[i] = next[i] + change[i];
    }
    next
}

/// The sum of the squares of the six components, with momenta in units of their scale.
#[inline(always)]
pub(super) fn square<T: Real>(rate: &Phase<T>, inverse_scale: [T; 2]) -> T {
    let (p1, p2) = (rate[4] * inverse_scale[0], rate[5] * inverse_scale[1]);
    let mut total = p1.mul_add(p1, p2 * p2);
    for value in &rate[..4] {
        total = value.mul_add(*value, total);
    }
    total
}
