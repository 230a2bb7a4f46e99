//! The pair of Dormand and Prince of orders 5 and 4.

use super::stages::{moved, plus, scaled, square, sum};
use super::{EmbeddedPair, PairData, Trial};
use crate::pendulum::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::real::Real;

pub(super) const DATA: PairData = PairData {
    name: "dopri5",
    order: 5,
    has_bow: true,
    rhs_per_step: 7,
    error_scale: 2.5,
    error_scale_after_map: 10.0,
    carries_tangents_in_df32: true,
    orbit_check: "orbits by dopri5",
    colour: 1,
};

/// The pair of Dormand and Prince of orders 5 and 4 (J. Comp. Appl. Math. 6, 1980).
pub struct Dopri5;

impl EmbeddedPair for Dopri5 {
    const ORDER: u32 = DATA.order;
    const HAS_BOW: bool = DATA.has_bow;

    #[inline(always)]
    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T> {
        let k1 = pendulum.derivative(phase);
        let k2 = pendulum.derivative(&moved(phase, step, [&k1], [0.2]));
        let k3 = pendulum.derivative(&moved(phase, step, [&k1, &k2], [3.0 / 40.0, 9.0 / 40.0]));
        let k4 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k2, &k3],
            [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        ));
        let k5 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k2, &k3, &k4],
            [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
        ));
        let k6 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k2, &k3, &k4, &k5],
            [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
        ));
        let rate = sum(
            [&k1, &k3, &k4, &k5, &k6],
            [35.0 / 384.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
        );
        let change = scaled(&rate, step);
        let k7 = pendulum.derivative(&plus(phase, &change));
        let error = sum(
            [&k1, &k3, &k4, &k5, &k6, &k7],
            [
                71.0 / 57600.0,
                -71.0 / 16695.0,
                71.0 / 1920.0,
                -17253.0 / 339200.0,
                22.0 / 525.0,
                -1.0 / 40.0,
            ],
        );
        let error = square(&error, inverse_scale) * (step * step) * step.lit(1.0 / 6.0);
        let bow = sum(
            [&k1, &k3, &k4, &k5, &k6, &k7],
            [
                -12715105075.0 / 11282082432.0,
                87487479700.0 / 32700410799.0,
                -10690763975.0 / 1880347072.0,
                701980252875.0 / 199316789632.0,
                -1453857185.0 / 822651844.0,
                69997945.0 / 29380423.0,
            ],
        );
        Trial { change, error_squared: error, bow: [bow[1] * step, bow[3] * step] }
    }
}
