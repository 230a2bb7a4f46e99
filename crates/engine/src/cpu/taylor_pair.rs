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

    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T> {
        let series = MotionSeries::<T, N>::expand(pendulum, phase);
        let power = (0..N - 2).fold(step.lit(1.0), |power, _| power * step);
        // Symmetry can make one of the two vanish.
        let error = series.phase.map(|terms| {
            let [last, before] = [terms[N - 1] * step, terms[N - 2]];
            (last * last + before * before) * (power * power)
        });
        let scale = |i: usize| if i < 4 { step.lit(1.0) } else { inverse_scale[i - 4] };
        let square = |i: usize| error[i] * (scale(i) * scale(i));
        let sum = (1..6).fold(square(0), |sum, i| sum + square(i));
        let none = step.lit(0.0);
        Trial {
            change: series.change(step),
            error_squared: sum * step.lit(1.0 / 6.0),
            bow: [none; 2],
        }
    }
}
