//! Taylor steps for the quantities that pendulums carry along: the terms of the last two orders
//! give the error.

use flipmap_numbers::Real;
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::embedded::{EmbeddedPair, Trial};
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::series::MotionSeries;

/// Taylor steps with `N` coefficients.
pub(super) struct TaylorPair<const N: usize>;

impl<const N: usize> EmbeddedPair for TaylorPair<N> {
    const ORDER: u32 = N as u32 - 2;

    #[inline(always)]
    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T> {
        let series = MotionSeries::<T, N>::expand(pendulum, phase);
        let mut power = step;
        for _ in 1..N - 2 {
            power = power * step;
        }
        let square_of_power = power * power;
        let mut sum = step.lit(0.0);
        for (i, terms) in series.phase.iter().enumerate() {
            // Symmetry can make one of the two vanish.
            let [last, before] = [terms[N - 1] * step, terms[N - 2]];
            let square = (last * last + before * before) * square_of_power;
            let scale = if i < 4 { step.lit(1.0) } else { inverse_scale[i - 4] };
            sum = sum + square * (scale * scale);
        }
        let none = step.lit(0.0);
        Trial {
            change: series.change(step),
            error_squared: sum * step.lit(1.0 / 6.0),
            bow: [none; 2],
        }
    }
}
