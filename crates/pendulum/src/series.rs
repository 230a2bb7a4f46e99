//! One adaptive Taylor step of the motion without angles, for lanes of pendulums.
//!
//! The gold standard's [`super::taylor`] does the same for single pendulums, in angles and with an
//! order that fits its number type; here the order is part of the type and every lane chooses its
//! own step length. The two share no recurrence, so each can check the other.

use crate::pendulum::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::real::Real;

/// The motion as power series in the time since the beginning of a step: `N` coefficients each,
/// lowest order first.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct MotionSeries<T, const N: usize> {
    /// Series of x1, y1, x2, y2, p1 and p2.
    pub phase: [[T; N]; 6],
    /// Series of ω1 and ω2 (the last coefficient is not filled in).
    pub speed: [[T; N]; 2],
}

/// Numbers that begin a cache line, so that no register of SIMD lanes lies across two of them.
#[repr(align(64))]
struct Aligned<T>(T);

impl<T: Real, const N: usize> MotionSeries<T, N> {
    /// Expands the motion through `phase`.
    #[inline(always)]
    pub fn expand(pendulum: &Pendulum<T>, phase: &Phase<T>) -> Self {
        let zero = phase[0].lit(0.0);
        let mut series = MotionSeries { phase: [[zero; N]; 6], speed: [[zero; N]; 2] };
        let MotionSeries { phase: z, speed: w } = &mut series;
        for i in 0..6 {
            z[i][0] = phase[i];
        }
        let mut inner = Aligned([[zero; N]; 4]);
        let Aligned([cos, sin, det, both]) = &mut inner;
        let mut inverse_det = zero;
        for k in 0..N - 1 {
            let [x1, y1, x2, y2, p1, p2] = &*z;
            cos[k] = pendulum.c * (product(x1, x2, k) + product(y1, y2, k));
            sin[k] = pendulum.c * (product(y1, x2, k) - product(x1, y2, k));
            det[k] = product(sin, sin, k);
            if k == 0 {
                det[0] = det[0] + pendulum.least_det;
                inverse_det = zero.lit(1.0) / det[0];
            }
            let pull1 = pendulum.b * p1[k] - product(cos, p2, k);
            let pull2 = pendulum.a * p2[k] - product(cos, p1, k);
            w[0][k] = (pull1 - later_product(det, &w[0], k)) * inverse_det;
            w[1][k] = (pull2 - later_product(det, &w[1], k)) * inverse_det;
            both[k] = product(&w[0], &w[1], k);
            let drive = product(sin, both, k);
            // A division, because the literal 1/(k+1) would be accurate to f64 only.
            let over = zero.lit(1.0) / zero.lit((k + 1) as f64);
            let drag = pendulum.drag([w[0][k], w[1][k]]);
            let next = [
                -product(&w[0], y1, k),
                product(&w[0], x1, k),
                -product(&w[1], y2, k),
                product(&w[1], x2, k),
                -(drive + pendulum.p * y1[k]),
                drive - pendulum.q * y2[k],
            ];
            for i in 0..6 {
                z[i][k + 1] = next[i] * over;
            }
            if let Some([first, second]) = drag {
                z[4][k + 1] = z[4][k + 1] + first * over;
                z[5][k + 1] = z[5][k + 1] + second * over;
            }
        }
        series
    }

    /// The change of the phase after `time`, without the initial phase itself.
    #[inline(always)]
    pub fn change(&self, time: T) -> Phase<T> {
        let mut change = [time; 6];
        for (change, series) in change.iter_mut().zip(&self.phase) {
            let mut sum = series[N - 1];
            for k in (1..N - 1).rev() {
                sum = sum.mul_add(time, series[k]);
            }
            *change = sum * time;
        }
        change
    }
}

/// The coefficient of order `k` of the product of two series.
#[inline(always)]
fn product<T: Real, const N: usize>(x: &[T; N], y: &[T; N], k: usize) -> T {
    from_first(x[0] * y[k], &x[1..k + 1], &y[..k])
}

/// The coefficient of order `k` of the product without the term in `x[0]`, whose partner `y[k]` is
/// not known yet.
#[inline(always)]
fn later_product<T: Real, const N: usize>(x: &[T; N], y: &[T; N], k: usize) -> T {
    from_first(x[0].lit(0.0), &x[1..k + 1], &y[..k])
}

/// Computes `first + Σ xⱼ y₋ⱼ` in two sums, so that neither need wait for the other.
#[inline(always)]
fn from_first<T: Real>(first: T, x: &[T], y: &[T]) -> T {
    let (mut even, mut odd) = (first, first.lit(0.0));
    let (pairs, rest) = x.as_chunks::<2>();
    let (last, opposite) = y.as_rchunks::<2>();
    for (x, y) in pairs.iter().zip(opposite.iter().rev()) {
        even = x[0].mul_add(y[1], even);
        odd = x[1].mul_add(y[0], odd);
    }
    if let ([x], [y]) = (rest, last) {
        even = x.mul_add(*y, even);
    }
    even + odd
}

/// Order of the f64 steps, as Jorba and Zou's rule gives it for errors of 1e-13 per step.
pub const ORDER_F64: usize = 16;
/// Order of the double-double steps, for errors of 1e-25 per step.
pub const ORDER_DD: usize = 30;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;
    use crate::taylor::Orbit;
    use flipmap_numbers::{Dd, Scalar};

    fn error_after<T: Scalar, const N: usize>(step: f64) -> f64 {
        let lit = T::from_f64;
        let unit = Pendulum::points([lit(1.0), lit(2.0)], [lit(1.0), lit(0.6)], lit(1.0));
        let state = State { angle: [lit(1.0), lit(-2.0)], speed: [lit(0.5), lit(1.5)] };
        let phase = unit.phase(&state);
        let change = MotionSeries::<T, N>::expand(&unit, &phase).change(lit(step));
        let truth = unit.phase(&Orbit::new(unit, state).state_at(lit(step)));
        (0..6).map(|i| (phase[i] + change[i] - truth[i]).to_f64().abs()).fold(0.0, f64::max)
    }

    #[test]
    fn agrees_with_the_gold_standard_to_the_last_digits() {
        let error = error_after::<f64, { ORDER_F64 + 1 }>(0.05);
        assert!(error < 2e-15, "{error}");
        let error = error_after::<Dd, { ORDER_DD + 1 }>(0.05);
        assert!(error < 1e-29, "{error}");
    }

    #[test]
    fn the_order_is_what_it_says() {
        let slope = (error_after::<Dd, 9>(0.1) / error_after::<Dd, 9>(0.05)).log2();
        assert!((slope - 9.0).abs() < 0.4, "{slope}");
    }
}
