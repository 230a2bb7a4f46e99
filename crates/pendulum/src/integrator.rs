//! One step of each fixed-step method, as the change it makes to the state.
//!
//! The methods return changes rather than new states because a change is small: added with
//! [`State::plus_with_rest`], an f32 angle loses nothing over thousands of steps.

use crate::pendulum::{Pendulum, State};
use flipmap_numbers::real::{Angle, Real};
use flipmap_numbers::trig::Turning;

/// The change of state over `step` seconds by the classical Runge–Kutta method of order 4
/// (Kutta 1901), written for θ″ = α(θ, ω) so that the angles need no stages of their own.
#[inline(always)]
pub fn rk4<T: Angle>(
    pendulum: &Pendulum<T>,
    state: &State<T>,
    step: T,
    turning: Turning,
) -> State<T> {
    let (half, sixth) = (step * step.lit(0.5), step * step.lit(1.0 / 6.0));
    let first = sines(&state.angle);
    let alpha1 = pendulum.acceleration_towards(first, state.speed);
    let speed2 = pushed(&state.speed, &alpha1, half);
    let second = turned(turning, &first, state, &state.speed, half);
    let alpha2 = pendulum.acceleration_towards(second, speed2);
    let speed3 = pushed(&state.speed, &alpha2, half);
    let third = turned(turning, &first, state, &speed2, half);
    let alpha3 = pendulum.acceleration_towards(third, speed3);
    let speed4 = pushed(&state.speed, &alpha3, step);
    let fourth = turned(turning, &first, state, &speed3, step);
    let alpha4 = pendulum.acceleration_towards(fourth, speed4);

    let inner = sums(&alpha2, &alpha3);
    let mean_speed = pushed(&state.speed, &sums(&alpha1, &inner), sixth);
    // The last stage's result is used last, so that nothing else waits for it.
    let known = sums(&alpha1, &sums(&inner, &inner));
    State {
        angle: [mean_speed[0] * step, mean_speed[1] * step],
        speed: pushed(&[known[0] * sixth, known[1] * sixth], &alpha4, sixth),
    }
}

// Pairs are written out, because closures are not inlined into code for SIMD lanes.

#[inline(always)]
fn sines<T: Angle>(angle: &[T; 2]) -> [(T, T); 2] {
    [angle[0].sin_cos(), angle[1].sin_cos()]
}

/// The directions of both rods after turning at `rate` for `time`.
#[inline(always)]
fn turned<T: Angle>(
    turning: Turning,
    first: &[(T, T); 2],
    state: &State<T>,
    rate: &[T; 2],
    time: T,
) -> [(T, T); 2] {
    [
        turning.turned(first[0], state.angle[0], rate[0] * time),
        turning.turned(first[1], state.angle[1], rate[1] * time),
    ]
}

/// Computes `base + rate · time`.
#[inline(always)]
fn pushed<T: Real>(base: &[T; 2], rate: &[T; 2], time: T) -> [T; 2] {
    [rate[0].mul_add(time, base[0]), rate[1].mul_add(time, base[1])]
}

#[inline(always)]
fn sums<T: Real>(a: &[T; 2], b: &[T; 2]) -> [T; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// The change over `step` seconds by Euler's explicit method (order 1; gains energy).
pub fn euler<T: Angle>(pendulum: &Pendulum<T>, state: &State<T>, step: T) -> State<T> {
    let alpha = pendulum.acceleration(state);
    State { angle: state.speed.map(|w| w * step), speed: alpha.map(|a| a * step) }
}

/// The change over `step` seconds by the semi-implicit Euler method (order 1): first the speeds,
/// then the angles with the new speeds.
pub fn semi_implicit_euler<T: Angle>(
    pendulum: &Pendulum<T>,
    state: &State<T>,
    step: T,
) -> State<T> {
    let speed = pendulum.acceleration(state).map(|a| a * step);
    State { angle: [0, 1].map(|i| (state.speed[i] + speed[i]) * step), speed }
}

impl<T: Real> State<T> {
    /// Adds `change` to the state.
    #[inline(always)]
    pub fn plus(&self, change: &State<T>) -> State<T> {
        State { angle: sums(&self.angle, &change.angle), speed: sums(&self.speed, &change.speed) }
    }

    /// Adds `change` to a state whose angles lost `rest` to rounding; returns the new state and
    /// what its angles lost to rounding (Kahan 1965).
    #[inline(always)]
    pub fn plus_with_rest(&self, rest: [T; 2], change: &State<T>) -> (State<T>, [T; 2]) {
        let change_and_rest = sums(&rest, &change.angle);
        let (angle1, rest1) = self.angle[0].fast_two_sum(change_and_rest[0]);
        let (angle2, rest2) = self.angle[1].fast_two_sum(change_and_rest[1]);
        let next = State { angle: [angle1, angle2], speed: sums(&self.speed, &change.speed) };
        (next, [rest1, rest2])
    }

    /// Adds `change` like [`State::plus_with_rest`], and makes up for the rounding of the speeds as
    /// well.
    pub(crate) fn plus_compensated(
        &self,
        rest: &State<T>,
        change: &State<T>,
    ) -> (State<T>, State<T>) {
        let (mut next, angle) = self.plus_with_rest(rest.angle, change);
        let speed = [0, 1].map(|i| self.speed[i].fast_two_sum(rest.speed[i] + change.speed[i]));
        next.speed = speed.map(|pair| pair.0);
        let speed = speed.map(|pair| pair.1);
        (next, State { angle, speed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taylor::Orbit;

    type Method = fn(&Pendulum<f64>, &State<f64>, f64) -> State<f64>;

    const METHODS: [(Method, f64); 3] =
        [(euler, 1.0), (semi_implicit_euler, 1.0), (fresh_rk4, 4.0)];

    fn fresh_rk4(pendulum: &Pendulum<f64>, state: &State<f64>, step: f64) -> State<f64> {
        rk4(pendulum, state, step, Turning::Fresh)
    }

    fn unit() -> Pendulum<f64> {
        Pendulum::points([1.0, 1.0], [1.0, 1.0], 1.0)
    }

    fn run(method: Method, mut state: State<f64>, step: f64, steps: usize) -> State<f64> {
        for _ in 0..steps {
            state = state.plus(&method(&unit(), &state, step));
        }
        state
    }

    #[test]
    fn orders_of_convergence_are_1_1_4() {
        let start = State::rest([0.5, -0.3]);
        let mut orbit = Orbit::new(unit(), start);
        let truth = orbit.state_at(2.0);
        let error = |state: State<f64>| {
            let angles = (state.angle[0] - truth.angle[0]).hypot(state.angle[1] - truth.angle[1]);
            let speeds = (state.speed[0] - truth.speed[0]).hypot(state.speed[1] - truth.speed[1]);
            angles.hypot(speeds)
        };
        for (method, order) in METHODS {
            let coarse = error(run(method, start, 2.0 / 200.0, 200));
            let fine = error(run(method, start, 2.0 / 400.0, 400));
            let slope = (coarse / fine).log2();
            assert!((slope - order).abs() < 0.2, "order {order}: slope {slope}");
        }
    }

    #[test]
    fn explicit_euler_gains_energy_by_the_known_factor() {
        // Each normal mode is an oscillator whose energy grows by a factor of 1 + h²ω² per step.
        let (theta1, step, steps) = (1e-4, 1e-2, 1000);
        let start = State::rest([theta1, 2f64.sqrt() * theta1]);
        let height = |state: &State<f64>| unit().energy(state) + 3.0;
        let gain = height(&run(euler, start, step, steps)) / height(&start);
        let slow_mode = 2.0 - 2f64.sqrt();
        let expected = (1.0 + step * step * slow_mode).powi(steps as i32);
        assert!((gain / expected - 1.0).abs() < 1e-4, "{gain} {expected}");
    }

    #[test]
    fn there_and_back_again() {
        let start = State::rest([2.0, 1.0]);
        let mut state = run(fresh_rk4, start, 1e-3, 1000);
        state.speed = state.speed.map(|w| -w);
        let back = run(fresh_rk4, state, 1e-3, 1000);
        assert!((back.angle[0] - 2.0).abs() < 1e-9 && back.speed[1].abs() < 1e-9);
    }

    #[test]
    fn a_compensated_f32_state_keeps_what_a_plain_one_loses() {
        let one = State { angle: [1.0f32, 1.0], speed: [1.0, 1.0] };
        let tiny = one.plus(&one).plus(&State::rest([0.0, 0.0]));
        assert_eq!(tiny.angle[0], 2.0);
        let change = State { angle: [1e-8f32; 2], speed: [1e-8; 2] };
        let (mut plain, mut kept) = (one, (one, State::rest([0.0; 2])));
        for _ in 0..1000 {
            plain = plain.plus(&change);
            kept = kept.0.plus_compensated(&kept.1, &change);
        }
        assert_eq!(plain.angle[0], 1.0);
        assert!((kept.0.angle[0] - 1.00001).abs() < 1e-7);
    }
}
