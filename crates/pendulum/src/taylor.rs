//! The adaptive Taylor integrator behind the gold standard.
//!
//! Every step expands the motion in powers of time, to an order and over a length that follow from
//! the number type's own precision (Jorba and Zou, *A software package for the numerical
//! integration of ODEs by means of high-order Taylor methods*, Exp. Math. 14, 2005). The expansion
//! is kept, so the motion is known at every moment inside the step, not only at its end.
//!
//! A step is a seventh of the radius of convergence, so each coefficient counts for a seventh of
//! the one before it and needs fewer digits. Number types that are faster with fewer digits make
//! use of this.

use crate::pendulum::{Pendulum, State};
use flipmap_numbers::polynomial::evaluate;
use flipmap_numbers::real::Scalar;

/// A step: the four polynomials in the time since its beginning.
#[derive(Clone, Debug)]
pub struct TaylorStep<T> {
    /// The polynomials' unit of time in seconds: 1 for floating-point types; for others about the
    /// radius of convergence, so that coefficients neither grow nor vanish.
    pub unit_secs: T,
    /// Number of these units in a second.
    pub per_sec: T,
    /// Seconds from the release to the beginning of the step.
    pub start: T,
    /// Length of the step in seconds.
    pub length: T,
    /// Coefficients of θ1 and θ2, rad/unitᵏ.
    pub angle: [Vec<T>; 2],
    /// Coefficients of ω1 and ω2, rad/unitᵏ⁺¹.
    pub speed: [Vec<T>; 2],
}

impl<T: Scalar> TaylorStep<T> {
    /// The state `tau` seconds into the step.
    pub fn state(&self, tau: T) -> State<T> {
        let tau = tau * self.per_sec;
        State {
            angle: [0, 1].map(|i| evaluate(&self.angle[i], tau)),
            speed: [0, 1].map(|i| evaluate(&self.speed[i], tau) * self.per_sec),
        }
    }

    /// Seconds from the release to the end of the step.
    pub fn end(&self) -> T {
        self.start + self.length
    }
}

/// A pendulum in motion, advanced step by step.
#[derive(Clone, Debug)]
pub struct Orbit<T> {
    pendulum: Pendulum<T>,
    state: State<T>,
    /// The part of `state` that was lost to rounding.
    low: State<T>,
    /// Seconds since the release, and the part of them that was lost to rounding.
    time: (T, T),
    series: RecurrenceSeries<T>,
    /// Unit of time of the next step; see [`TaylorStep::unit_secs`].
    unit_secs: f64,
    latest: Option<TaylorStep<T>>,
}

impl<T: Scalar> Orbit<T> {
    /// A pendulum in `state` at time 0.
    pub fn new(pendulum: Pendulum<T>, state: State<T>) -> Self {
        Self::with_bits(pendulum, state, bits_of::<T>())
    }

    /// Like [`Orbit::new`], with errors of about 2^−`bits` a step; floating-point types use all
    /// their digits.
    pub(crate) fn with_bits(pendulum: Pendulum<T>, state: State<T>, bits: u32) -> Self {
        let unit_secs = if T::FLOATING { 1.0 } else { first_unit(&pendulum, &state) };
        Orbit {
            pendulum,
            state,
            unit_secs,
            low: State::rest([T::zero(); 2]),
            time: (T::zero(), T::zero()),
            series: RecurrenceSeries::new(bits.min(bits_of::<T>())),
            latest: None,
        }
    }

    /// Lets errors grow to about 2^−`bits` a step from the next one on, if that is more than
    /// before.
    pub(crate) fn lower_bits(&mut self, bits: u32) {
        if bits < self.series.bits {
            self.series = RecurrenceSeries::new(bits);
        }
    }

    /// The state at the end of the last step.
    pub fn state(&self) -> &State<T> {
        &self.state
    }

    /// Seconds since the release.
    pub fn time(&self) -> T {
        self.time.0
    }

    /// Advances by one step and returns it.
    pub fn step(&mut self) -> TaylorStep<T> {
        let unit_secs = T::from_f64(self.unit_secs);
        let per_sec = T::from_f64(1.0) / unit_secs;
        let (pendulum, state) =
            (in_units(&self.pendulum, unit_secs), in_units_of(&self.state, unit_secs));
        self.series.expand(&pendulum, &state);
        let units = T::from_f64(self.series.step_length());
        let length = units * unit_secs;
        let step = TaylorStep {
            unit_secs,
            per_sec,
            start: self.time.0,
            length,
            angle: self.series.angle.clone(),
            speed: self.series.speed.clone(),
        };
        let change = |c: &[T]| evaluate(&c[1..], units) * units;
        let change = State {
            angle: [0, 1].map(|i| change(&step.angle[i])),
            speed: [0, 1].map(|i| change(&step.speed[i]) * per_sec),
        };
        (self.state, self.low) = self.state.plus_compensated(&self.low, &change);
        self.time = self.time.0.fast_two_sum(self.time.1 + length);
        if !T::FLOATING {
            self.unit_secs = length.to_f64() / SAFETY;
        }
        step
    }

    /// The state `time` seconds after the release; times must not decrease from call to call.
    pub fn state_at(&mut self, time: T) -> State<T> {
        while self.latest.as_ref().is_none_or(|step| step.end() < time) {
            self.latest = Some(self.step());
        }
        let step = self.latest.as_ref().expect("just made");
        step.state(time - step.start)
    }
}

/// The pendulum with time measured in units of `unit` seconds.
fn in_units<T: Scalar>(pendulum: &Pendulum<T>, unit: T) -> Pendulum<T> {
    let square = unit * unit;
    let friction = pendulum.friction.map(|pair| pair.map(|b| b * unit));
    Pendulum { p: pendulum.p * square, q: pendulum.q * square, friction, ..*pendulum }
}

fn in_units_of<T: Scalar>(state: &State<T>, unit: T) -> State<T> {
    State { angle: state.angle, speed: state.speed.map(|speed| speed * unit) }
}

/// The unit of time of an orbit's first step, from an expansion in f64. A start that f64 cannot
/// tell from an equilibrium is first moved away from it, because the coefficients of long numbers
/// must not overflow.
fn first_unit<T: Scalar>(pendulum: &Pendulum<T>, state: &State<T>) -> f64 {
    let mut near = State { angle: state.angle.map(T::to_f64), speed: state.speed.map(T::to_f64) };
    let is_still = near.speed.iter().all(|speed| speed.abs() < ASIDE);
    if is_still && near.angle.iter().all(|angle| angle.sin().abs() < ASIDE * ASIDE) {
        near.angle[0] += ASIDE;
    }
    let mut series = RecurrenceSeries::<f64>::new(bits_of::<f64>());
    series.expand(&pendulum.to_f64(), &near);
    series.step_length() / SAFETY
}

/// Number of bits after the point of a type's numbers around 1.
fn bits_of<T: Scalar>() -> u32 {
    -T::EPSILON.log2() as u32
}

/// The order of Jorba and Zou for relative errors of 2^−`bits`.
fn order_for(bits: u32) -> usize {
    (1.0 + 0.5 * f64::from(bits) * std::f64::consts::LN_2).ceil() as usize + 1
}

/// Coefficients of the motion and of everything that its recurrences need, lowest order first.
#[derive(Clone, Debug)]
struct RecurrenceSeries<T> {
    order: usize,
    /// Errors at the end of a step are about 2^−`bits`.
    bits: u32,
    angle: [Vec<T>; 2],
    speed: [Vec<T>; 2],
    /// Sines and cosines of θ1, θ2 and θ1 − θ2.
    sin: [Vec<T>; 3],
    cos: [Vec<T>; 3],
    /// Derivative of θ1 − θ2.
    delta_speed: Vec<T>,
    speed_squared: [Vec<T>; 2],
    torque: [Vec<T>; 2],
    det: Vec<T>,
    /// Reciprocal of the first coefficient of `det`, for types in which a division takes many
    /// products.
    inverse_det: T,
    alpha: [Vec<T>; 2],
}

impl<T: Scalar> RecurrenceSeries<T> {
    fn new(bits: u32) -> Self {
        let order = order_for(bits);
        let zeros = || vec![T::zero(); order + 1];
        RecurrenceSeries {
            order,
            bits,
            angle: [zeros(), zeros()],
            speed: [zeros(), zeros()],
            sin: [zeros(), zeros(), zeros()],
            cos: [zeros(), zeros(), zeros()],
            delta_speed: zeros(),
            speed_squared: [zeros(), zeros()],
            torque: [zeros(), zeros()],
            det: zeros(),
            inverse_det: T::zero(),
            alpha: [zeros(), zeros()],
        }
    }

    /// Fills in all coefficients for the motion through `state`.
    fn expand(&mut self, pendulum: &Pendulum<T>, state: &State<T>) {
        for i in 0..2 {
            self.angle[i][0] = state.angle[i];
            self.speed[i][0] = state.speed[i];
        }
        for k in 0..self.order {
            self.extend_angles(k);
            self.extend_forces(pendulum, k);
            let next = T::from_f64((k + 1) as f64);
            for i in 0..2 {
                self.speed[i][k + 1] = self.alpha[i][k] / next;
                self.angle[i][k + 1] = self.speed[i][k] / next;
            }
        }
    }

    /// Extends the sines and cosines to order `k`, from sin′ = θ′ cos, cos′ = −θ′ sin, and then the
    /// derivative of θ1 − θ2.
    fn extend_angles(&mut self, k: usize) {
        for i in 0..3 {
            (self.sin[i][k], self.cos[i][k]) = match k.checked_sub(1) {
                None => sin_cos_exact([self.angle[0][0], self.angle[1][0], self.delta()][i]),
                Some(before) => {
                    let derivative = [&self.speed[0], &self.speed[1], &self.delta_speed][i];
                    let over = T::from_f64(k as f64);
                    let sin = self.product(derivative, &self.cos[i], before);
                    let cos = self.product(derivative, &self.sin[i], before);
                    (sin / over, -cos / over)
                }
            };
        }
        self.delta_speed[k] = self.speed[0][k] - self.speed[1][k];
    }

    /// The angle θ1 − θ2 at the beginning.
    fn delta(&self) -> T {
        self.angle[0][0] - self.angle[1][0]
    }

    /// Extends the accelerations to order `k`.
    fn extend_forces(&mut self, pendulum: &Pendulum<T>, k: usize) {
        let Pendulum { a, b, c, p, q, .. } = *pendulum;
        for i in 0..2 {
            self.speed_squared[i][k] = self.square(&self.speed[i], k);
        }
        let (s, cos) = (&self.sin[2], &self.cos[2]);
        self.torque[0][k] = -c * self.product(s, &self.speed_squared[1], k) - p * self.sin[0][k];
        self.torque[1][k] = c * self.product(s, &self.speed_squared[0], k) - q * self.sin[1][k];
        if let Some([first, second]) = pendulum.drag([self.speed[0][k], self.speed[1][k]]) {
            self.torque[0][k] = self.torque[0][k] + first;
            self.torque[1][k] = self.torque[1][k] + second;
        }
        let constant = if k == 0 { pendulum.least_det } else { T::zero() };
        self.det[k] = constant + c * c * self.square(s, k);
        if k == 0 && !T::FLOATING {
            self.inverse_det = T::from_f64(1.0) / self.det[0];
        }
        let pull = [
            b * self.torque[0][k] - c * self.product(cos, &self.torque[1], k),
            a * self.torque[1][k] - c * self.product(cos, &self.torque[0], k),
        ];
        let bits = self.bits_at(k);
        for (alpha, pull) in self.alpha.iter_mut().zip(pull) {
            let known = T::convolution(&self.det[1..=k], &alpha[..k], bits);
            alpha[k] = match T::FLOATING {
                true => (pull - known) / self.det[0],
                false => (pull - known) * self.inverse_det,
            };
        }
    }

    /// Number of bits after the point that coefficients of order `k` need.
    fn bits_at(&self, k: usize) -> u32 {
        (self.bits + GUARD_BITS).saturating_sub((k as f64 * FEWER_BITS) as u32)
    }

    /// The coefficient of order `k` of the product of two series.
    fn product(&self, x: &[T], y: &[T], k: usize) -> T {
        T::convolution(&x[..=k], &y[..=k], self.bits_at(k))
    }

    /// The coefficient of order `k` of the square of a series: each product of two different terms
    /// is computed once and counted twice.
    fn square(&self, x: &[T], k: usize) -> T {
        let (pairs, bits) = (k.div_ceil(2), self.bits_at(k));
        let half = T::convolution(&x[..pairs], &x[k + 1 - pairs..=k], bits);
        let twice = half + half;
        if k.is_multiple_of(2) { x[k / 2].mul_add(x[k / 2], twice) } else { twice }
    }

    /// The step length of Jorba and Zou (their eq. 3-8): e⁻² times the radius of convergence that
    /// the last two orders indicate.
    fn step_length(&self) -> f64 {
        let radius = |order: usize| {
            let largest = [&self.angle, &self.speed]
                .into_iter()
                .flatten()
                .map(|c| c[order].to_f64().abs())
                .fold(0.0, f64::max);
            largest.powf(-1.0 / order as f64)
        };
        let scale = [&self.angle, &self.speed]
            .into_iter()
            .flatten()
            .map(|c| c[0].to_f64().abs())
            .fold(1.0, f64::max);
        let shortest = [self.order - 1, self.order]
            .map(|order| radius(order) * scale.powf(1.0 / order as f64))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        (shortest * SAFETY).min(if T::FLOATING { MAX_STEP } else { RADIUS_CHANGE * SAFETY })
    }
}

/// Sine and cosine; half and whole turns in the number type stand for exact ones, so that a
/// pendulum placed upright stays upright.
fn sin_cos_exact<T: Scalar>(angle: T) -> (T, T) {
    let one = T::from_f64(1.0);
    if angle.abs() == T::pi() {
        (T::zero(), -one)
    } else if angle.abs() == T::pi() + T::pi() {
        (T::zero(), one)
    } else {
        angle.sin_cos()
    }
}

/// Speed (rad/s) below which a start can count as an equilibrium, if its sines are below the square
/// of this; also the angle in rad by which it is then moved away.
const ASIDE: f64 = 1e-6;
/// The factor e⁻² times Jorba and Zou's safety factor exp(−0.7/(p−1)), which is rounded to one
/// value for all orders used.
const SAFETY: f64 = 0.135_335_283 * 0.95;
/// Maximum length of a step in its unit of time: a pendulum at an equilibrium has no time scale.
const MAX_STEP: f64 = 1e3;
/// Largest ratio of the radii of convergence of two successive steps: over a seventh of a radius it
/// changes by at most a seventh, and the estimates need some room. It limits steps in units of the
/// previous radius.
const RADIUS_CHANGE: f64 = 1.15;
/// Number of bits by which each coefficient may be shorter than the one before it: log₂ of 1 /
/// (`RADIUS_CHANGE`² · `SAFETY`). One `RADIUS_CHANGE` is the limit on the step; the other allows
/// for coefficients that grow from one to the next and carry errors along.
const FEWER_BITS: f64 = 2.556;
/// Further bits of coefficients, against rounding errors in the sums of many products.
const GUARD_BITS: u32 = 10;

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::{Dd, Fixed};

    #[test]
    fn energy_stays_to_the_last_digits() {
        let pendulum = Pendulum::points([1.0, 2.0], [1.0, 0.6], 9.81);
        let start = State::rest([2.5, -2.0]);
        let mut orbit = Orbit::new(pendulum, start);
        while orbit.time() < 20.0 {
            orbit.step();
        }
        let drift = pendulum.energy(orbit.state()) - pendulum.energy(&start);
        assert!(drift.abs() < 1e-11, "{drift}");
    }

    #[test]
    fn dd_returns_to_its_start_when_time_is_turned_round() {
        let dd = Dd::new;
        let pendulum = Pendulum::points([dd(1.0); 2], [dd(1.0); 2], dd(1.0));
        let mut there = Orbit::new(pendulum, State::rest([dd(2.0), dd(1.0)]));
        let mut turned = there.state_at(dd(5.0));
        turned.speed = turned.speed.map(|w| -w);
        let back = Orbit::new(pendulum, turned).state_at(dd(5.0));
        assert!((back.angle[0] - dd(2.0)).hi.abs() < 1e-27);
        assert!(back.speed[1].hi.abs() < 1e-27);
    }

    /// The angles after `secs` of a pendulum in long numbers whose steps have errors of 2^−`bits`.
    fn angles_after(secs: f64, bits: u32) -> [Fixed<8>; 2] {
        let lit = Fixed::<8>::from_f64;
        let pendulum = Pendulum::points([lit(1.0), lit(2.0)], [lit(1.0), lit(0.6)], lit(1.0));
        let start = State::rest([lit(2.0), lit(1.0)]);
        Orbit::with_bits(pendulum, start, bits).state_at(lit(secs)).angle
    }

    #[test]
    fn steps_have_the_bits_asked_for_and_not_many_more() {
        for secs in [1.0, 20.0] {
            let truth = angles_after(secs, u32::MAX);
            for bits in [56, 100, 143, 200, 263, 330] {
                let error = angles_after(secs, bits)[0] - truth[0];
                let lost = f64::from(bits) + error.to_f64().abs().log2();
                assert!((-20.0..12.0).contains(&lost), "{secs} s, {bits} bits: {lost} bits lost");
            }
        }
    }

    #[test]
    fn each_coefficient_needs_fewer_bits_by_the_longest_step() {
        let exact = -(RADIUS_CHANGE * RADIUS_CHANGE * SAFETY).log2();
        assert!((0.0..1e-3).contains(&(exact - FEWER_BITS)), "{exact}");
    }

    #[test]
    fn fewer_bits_serve_from_the_next_step_on() {
        let lit = Fixed::<4>::from_f64;
        let pendulum = Pendulum::points([lit(1.0); 2], [lit(1.0); 2], lit(1.0));
        let mut orbit = Orbit::new(pendulum, State::rest([lit(2.0), lit(1.0)]));
        let orders = |orbit: &mut Orbit<Fixed<4>>| orbit.step().angle[0].len();
        let all = orders(&mut orbit);
        orbit.lower_bits(100);
        let fewer = orders(&mut orbit);
        orbit.lower_bits(150);
        assert!(fewer < all && orders(&mut orbit) == fewer, "{fewer} of {all} coefficients");
    }

    #[test]
    fn an_upright_pendulum_stays_upright() {
        let pendulum = Pendulum::points([Dd::new(1.0); 2], [Dd::new(1.0); 2], Dd::new(9.81));
        for angle in [[Dd::PI, Dd::PI], [Dd::PI, -Dd::PI], [Dd::new(0.0), Dd::PI]] {
            let state = Orbit::new(pendulum, State::rest(angle)).state_at(Dd::new(100.0));
            assert_eq!(state, State::rest(angle));
        }
    }

    #[test]
    fn a_pendulum_nearer_to_an_equilibrium_than_f64_tells_falls_as_exactly() {
        let lit = Fixed::<4>::from_f64;
        let pendulum = Pendulum::points([lit(1.0); 2], [lit(1.0); 2], lit(1.0));
        // The motion is linear: from a hundred times the distance, the pendulum gets a hundred
        // times as far in the same time.
        let after = |by: f64| {
            let start = [Fixed::<4>::pi() - lit(by), Fixed::pi() + lit(2.0 * by)];
            let state = Orbit::new(pendulum, State::rest(start)).state_at(lit(3.0));
            state.angle.map(|angle| ((angle - Fixed::pi()) / lit(by)).to_f64())
        };
        let (near, far) = (after(1e-20), after(1e-18));
        for bob in 0..2 {
            let apart = (near[bob] / far[bob] - 1.0).abs();
            assert!(near[bob].abs() > 10.0 && apart < 1e-12, "{near:?}, {far:?}");
        }
    }

    #[test]
    fn a_pendulum_at_rest_stays() {
        let pendulum = Pendulum::points([1.0; 2], [1.0; 2], 9.81);
        let state = Orbit::new(pendulum, State::rest([0.0, 0.0])).state_at(30.0);
        assert_eq!(state, State::rest([0.0, 0.0]));
    }
}
