//! The pair of Dormand and Prince of order 8, with error estimates of orders 5 and 3.

use super::stages::{less, moved, scaled, square, sum};
use super::{EmbeddedPair, PairData, Trial};
use crate::pendulum::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::real::Real;

pub(super) const DATA: PairData = PairData {
    name: "dop853",
    order: 8,
    has_bow: false,
    rhs_per_step: 12,
    error_scale: 0.7,
    error_scale_after_map: 100.0,
    carries_tangents_in_df32: false,
    orbit_check: "orbits by dop853",
    colour: 2,
};

/// The pair of Dormand and Prince of order 8, with error estimates of orders 5 and 3 (Hairer, Nørsett
/// and Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., II.5 and II.10).
pub struct Dop853;

impl EmbeddedPair for Dop853 {
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
        let k2 = pendulum.derivative(&moved(phase, step, [&k1], [0.05260015195876773]));
        let k3 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k2],
            [0.0197250569845379, 0.0591751709536137],
        ));
        let k4 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k3],
            [0.02958758547680685, 0.08876275643042054],
        ));
        let k5 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k3, &k4],
            [0.2413651341592667, -0.8845494793282861, 0.924834003261792],
        ));
        let k6 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k4, &k5],
            [0.037037037037037035, 0.17082860872947386, 0.12546768756682242],
        ));
        let k7 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k4, &k5, &k6],
            [0.037109375, 0.17025221101954405, 0.06021653898045596, -0.017578125],
        ));
        let k8 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k4, &k5, &k6, &k7],
            [
                0.03709200011850479,
                0.17038392571223998,
                0.10726203044637328,
                -0.015319437748624402,
                0.008273789163814023,
            ],
        ));
        let k9 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k4, &k5, &k6, &k7, &k8],
            [
                0.6241109587160757,
                -3.3608926294469414,
                -0.868219346841726,
                27.59209969944671,
                20.154067550477894,
                -43.48988418106996,
            ],
        ));
        let k10 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k4, &k5, &k6, &k7, &k8, &k9],
            [
                0.47766253643826434,
                -2.4881146199716677,
                -0.590290826836843,
                21.230051448181193,
                15.279233632882423,
                -33.28821096898486,
                -0.020331201708508627,
            ],
        ));
        let k11 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k4, &k5, &k6, &k7, &k8, &k9, &k10],
            [
                -0.9371424300859873,
                5.186372428844064,
                1.0914373489967295,
                -8.149787010746927,
                -18.52006565999696,
                22.739487099350505,
                2.4936055526796523,
                -3.0467644718982196,
            ],
        ));
        let k12 = pendulum.derivative(&moved(
            phase,
            step,
            [&k1, &k4, &k5, &k6, &k7, &k8, &k9, &k10, &k11],
            [
                2.273310147516538,
                -10.53449546673725,
                -2.0008720582248625,
                -17.9589318631188,
                27.94888452941996,
                -2.8589982771350235,
                -8.87285693353063,
                12.360567175794303,
                0.6433927460157636,
            ],
        ));
        let k = [&k1, &k6, &k7, &k8, &k9, &k10, &k11, &k12];
        let rate = sum(
            k,
            [
                0.054293734116568765,
                4.450312892752409,
                1.8915178993145003,
                -5.801203960010585,
                0.3111643669578199,
                -0.1521609496625161,
                0.20136540080403034,
                0.04471061572777259,
            ],
        );
        if !T::ESTIMATES_ERROR {
            let zero = step.lit(0.0);
            return Trial { change: scaled(&rate, step), error_squared: zero, bow: [zero; 2] };
        }
        let fifth = sum(
            k,
            [
                0.01312004499419488,
                -1.2251564463762044,
                -0.4957589496572502,
                1.6643771824549864,
                -0.35032884874997366,
                0.3341791187130175,
                0.08192320648511571,
                -0.022355307863886294,
            ],
        );
        // The third-order solution differs from the eighth-order one in three terms only.
        let third = less(
            &rate,
            [&k1, &k9, &k12],
            [0.2440944881889764, 0.7338466882816118, 0.02205882352941176],
        );
        let fifth = square(&fifth, inverse_scale);
        let third = square(&third, inverse_scale);
        let both = third.mul_add(step.lit(0.01), fifth) + step.lit(TINY);
        let error = fifth * step;
        Trial {
            change: scaled(&rate, step),
            error_squared: error * error / (both * step.lit(6.0)),
            bow: [step.lit(0.0); 2],
        }
    }
}

/// Factor from the length of a step of [`Dop853`] with this error to one whose error is a little
/// below `allowed`.
pub(crate) fn dop853_factor(error: f64, allowed: f64) -> f64 {
    0.8 * (allowed / error.max(1e-30)).powf(1.0 / f64::from(DATA.order))
}

/// Addend that keeps the error of a pendulum at rest from being 0/0.
const TINY: f64 = 1e-30;
