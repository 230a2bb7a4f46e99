//! Trial steps of the embedded Runge–Kutta pairs, each with an estimate of its own error.
//!
//! The coefficients are data from the papers cited. The stages are written out, because code for
//! SIMD lanes and for shaders has to be straight-line.

use crate::pendulum::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::real::Real;

/// A trial step, to be taken or tried again with a shorter length.
#[derive(Clone, Copy, Debug)]
pub struct Trial<T> {
    /// Change of the phase over the step.
    pub change: Phase<T>,
    /// Square of the root mean square error of the six components, momenta in units of their scale.
    pub error_squared: T,
    /// Fourth-order terms by which [`quartic`] follows y1 and y2 between the ends; 0 for a pair
    /// that provides none.
    pub bow: [T; 2],
}

impl<T: Real> Trial<T> {
    /// A trial step, from its change and its error, of a pair that provides nothing between the
    /// ends.
    #[inline(always)]
    pub fn new(change: Phase<T>, error: &Phase<T>, inverse_scale: [T; 2]) -> Self {
        let error_squared = square(error, inverse_scale);
        let lit = |value| error_squared.lit(value);
        Trial { change, error_squared: error_squared * lit(1.0 / 6.0), bow: [lit(0.0); 2] }
    }
}

/// The power of the step with which the error that [`dop853`] estimates falls.
pub const DOP853_ORDER: u32 = 8;
/// The power of the step with which the error that [`dopri5`] estimates falls.
pub const DOPRI5_ORDER: u32 = 5;

/// Factor from the length of a step of [`dop853`] with this error to one whose error is a little
/// below `allowed`.
pub(crate) fn dop853_factor(error: f64, allowed: f64) -> f64 {
    0.8 * (allowed / error.max(1e-30)).powf(1.0 / f64::from(DOP853_ORDER))
}

/// Takes a trial step of Dormand and Prince's method of order 8 with error estimates of orders 5
/// and 3 (Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., II.5
/// and II.10): 12 right-hand sides. `inverse_scale` is 1 over the scale of each momentum.
#[inline(always)]
pub fn dop853<T: Real>(
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

/// Addend that keeps the error of a pendulum at rest from being 0/0.
const TINY: f64 = 1e-30;

/// Takes a trial step of Dormand and Prince's pair of orders 5 and 4 (J. Comp. Appl. Math. 6,
/// 1980): 7 right-hand sides.
#[inline(always)]
pub fn dopri5<T: Real>(
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

/// The control points of the quartic that [`dopri5`] gives for a value over its step (Hairer,
/// Nørsett and Wanner, II.6), from the value and its rate of change times the step at both ends.
#[inline(always)]
pub fn quartic<T: Real>([y0, y1]: [T; 2], [rise0, rise1]: [T; 2], bow: T) -> [T; 5] {
    let lit = |value| y0.lit(value);
    let whole = y1 - y0;
    let early = rise0 - whole;
    let late = whole - rise1 - early;
    let quarter = lit(0.25) * (whole + early);
    let sixth = lit(1.0 / 6.0);
    [
        y0,
        y0 + quarter,
        y0 + lit(0.5) * whole + lit(1.0 / 3.0) * early + sixth * (late + bow),
        y1 - lit(0.25) * (whole - early - late),
        y1,
    ]
}

/// Computes `phase + step · Σ weightⱼ kⱼ`.
#[inline(always)]
fn moved<T: Real, const N: usize>(
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
fn sum<T: Real, const N: usize>(k: [&Phase<T>; N], weights: [f64; N]) -> Phase<T> {
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
fn less<T: Real, const N: usize>(
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
fn scaled<T: Real>(rate: &Phase<T>, step: T) -> Phase<T> {
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
fn square<T: Real>(rate: &Phase<T>, inverse_scale: [T; 2]) -> T {
    let (p1, p2) = (rate[4] * inverse_scale[0], rate[5] * inverse_scale[1]);
    let mut total = p1.mul_add(p1, p2 * p2);
    for value in &rate[..4] {
        total = value.mul_add(*value, total);
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;

    /// The value at `x` of the polynomial with these control points.
    fn value(control: [f64; 5], x: f64) -> f64 {
        let binomial = [1.0, 4.0, 6.0, 4.0, 1.0];
        let term = |k: i32| binomial[k as usize] * x.powi(k) * (1.0 - x).powi(4 - k);
        (0..5).map(|k| control[k as usize] * term(k)).sum()
    }

    #[test]
    fn the_quartic_is_the_motion_to_the_order_of_its_method() {
        let unit = Pendulum::points([1.0, 2.0], [1.0, 0.6], 1.0);
        let scale = unit.momentum_scale().map(|scale| 1.0 / scale);
        let start = unit.phase(&State { angle: [1.0, 2.6], speed: [0.5, 1.5] });
        let error = |step: f64| {
            let trial = dopri5(&unit, scale, &start, step);
            let end = plus(&start, &trial.change);
            let (rate, rate_after) = (unit.derivative(&start), unit.derivative(&end));
            let rises = [rate[3] * step, rate_after[3] * step];
            let control = quartic([start[3], end[3]], rises, trial.bow[1]);
            let off = |share: f64| {
                let truth = dop853(&unit, scale, &start, step * share).change[3] + start[3];
                (value(control, share) - truth).abs()
            };
            (1..10).map(|k| off(f64::from(k) / 10.0)).fold(0.0, f64::max)
        };
        let order = (error(0.1) / error(0.05)).log2();
        assert!((order - 5.0).abs() < 0.3 && error(0.1) < 2e-5, "{order} {}", error(0.1));
    }
}
