//! The pair of Tsitouras of orders 5 and 4.

use super::stages::{moved, plus, scaled, sum};
use super::{EmbeddedPair, PairData, Trial};
use crate::pendulum::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::real::Real;

pub(super) const DATA: PairData = PairData {
    name: "tsit5",
    order: 5,
    has_bow: false,
    rhs_per_step: 7,
    error_scale: 2.5,
    error_scale_after_map: 10.0,
    carries_tangents_in_df32: true,
    orbit_check: "orbits by tsit5",
    colour: 5,
};

/// The pair of Tsitouras of orders 5 and 4 (*Runge–Kutta pairs of order 5(4) satisfying only the first
/// column simplifying assumption*, Computers & Mathematics with Applications 62, 2011).
pub struct Tsit5;

impl EmbeddedPair for Tsit5 {
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
        let k2 = pendulum.derivative(&moved(phase, step, [&k1], [0.161]));
        let weights = [-0.008480655492356989, 0.335480655492357];
        let k3 = pendulum.derivative(&moved(phase, step, [&k1, &k2], weights));
        let weights = [2.8971530571054935, -6.359448489975075, 4.3622954328695815];
        let k4 = pendulum.derivative(&moved(phase, step, [&k1, &k2, &k3], weights));
        let weights =
            [5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525];
        let k5 = pendulum.derivative(&moved(phase, step, [&k1, &k2, &k3, &k4], weights));
        let weights = [
            5.86145544294642,
            -12.92096931784711,
            8.159367898576159,
            -0.071584973281401,
            -0.028269050394068383,
        ];
        let k6 = pendulum.derivative(&moved(phase, step, [&k1, &k2, &k3, &k4, &k5], weights));
        let weights = [
            0.09646076681806523,
            0.01,
            0.4798896504144996,
            1.379008574103742,
            -3.290069515436081,
            2.324710524099774,
        ];
        let change = scaled(&sum([&k1, &k2, &k3, &k4, &k5, &k6], weights), step);
        let k7 = pendulum.derivative(&plus(phase, &change));
        let weights = [
            -0.001780011052225777,
            -0.0008164344596567469,
            0.007880878010261995,
            -0.1447110071732629,
            0.5823571654525552,
            -0.45808210592918697,
            0.015151515151515152,
        ];
        let error = sum([&k1, &k2, &k3, &k4, &k5, &k6, &k7], weights);
        Trial::new(change, &scaled(&error, step), inverse_scale)
    }
}
