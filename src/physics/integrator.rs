//! One step of each fixed-step method, as the change it makes to the state.
//!
//! Changes rather than new states, because a change is small: added with
//! [`State::plus_with_rest`] an f32 angle loses nothing over thousands of steps.

use super::pendulum::{Pendulum, State};
use super::real::Real;
use super::trig::Turning;

/// The change of state over `step` seconds by the classical Runge–Kutta method of order 4
/// (Kutta 1901), written for θ″ = α(θ, ω) so that the angles need no stages of their own.
#[inline(always)]
pub fn rk4<T: Real>(
    pendulum: &Pendulum<T>,
    state: &State<T>,
    step: T,
    turning: Turning,
) -> State<T> {
    let (half, sixth) = (step * step.lit(0.5), step * step.lit(1.0 / 6.0));
    let first = state.angle.map(T::sin_cos);
    let alpha_at = |rate: &[T; 2], shift: T, speed: [T; 2]| {
        let turned = |i: usize| turning.turned(first[i], state.angle[i], rate[i] * shift);
        pendulum.acceleration_towards([turned(0), turned(1)], speed)
    };
    let pushed = |alpha: &[T; 2], push: T| [0, 1].map(|i| alpha[i].mul_add(push, state.speed[i]));

    let alpha1 = pendulum.acceleration_towards(first, state.speed);
    let speed2 = pushed(&alpha1, half);
    let alpha2 = alpha_at(&state.speed, half, speed2);
    let speed3 = pushed(&alpha2, half);
    let alpha3 = alpha_at(&speed2, half, speed3);
    let speed4 = pushed(&alpha3, step);
    let alpha4 = alpha_at(&speed3, step, speed4);

    let inner = [0, 1].map(|i| alpha2[i] + alpha3[i]);
    State {
        angle: [0, 1].map(|i| (alpha1[i] + inner[i]).mul_add(sixth, state.speed[i]) * step),
        speed: [0, 1].map(|i| {
            // The last stage is waited for last.
            let known = (alpha1[i] + (inner[i] + inner[i])) * sixth;
            alpha4[i].mul_add(sixth, known)
        }),
    }
}

/// The change over `step` seconds by Euler's explicit method (order 1; gains energy).
pub fn euler<T: Real>(pendulum: &Pendulum<T>, state: &State<T>, step: T) -> State<T> {
    let alpha = pendulum.acceleration(state);
    State {
        angle: state.speed.map(|w| w * step),
        speed: alpha.map(|a| a * step),
    }
}

/// The change over `step` seconds by the semi-implicit Euler method (order 1): speeds first,
/// then angles with the new speeds.
pub fn semi_implicit_euler<T: Real>(
    pendulum: &Pendulum<T>,
    state: &State<T>,
    step: T,
) -> State<T> {
    let speed = pendulum.acceleration(state).map(|a| a * step);
    State {
        angle: [0, 1].map(|i| (state.speed[i] + speed[i]) * step),
        speed,
    }
}

impl<T: Real> State<T> {
    /// This state changed by `change`.
    #[inline(always)]
    pub fn plus(&self, change: &State<T>) -> State<T> {
        State {
            angle: [0, 1].map(|i| self.angle[i] + change.angle[i]),
            speed: [0, 1].map(|i| self.speed[i] + change.speed[i]),
        }
    }

    /// This state, from whose angles rounding took `rest`, changed by `change`: the new state
    /// and what rounding took from its angles (Kahan 1965).
    #[inline(always)]
    pub fn plus_with_rest(&self, rest: [T; 2], change: &State<T>) -> (State<T>, [T; 2]) {
        let angle = [0, 1].map(|i| self.angle[i].fast_two_sum(rest[i] + change.angle[i]));
        let next = State {
            angle: angle.map(|pair| pair.0),
            speed: [0, 1].map(|i| self.speed[i] + change.speed[i]),
        };
        (next, angle.map(|pair| pair.1))
    }

    /// The same with rests of the speeds too.
    pub fn plus_compensated(&self, rest: &State<T>, change: &State<T>) -> (State<T>, State<T>) {
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
    use crate::physics::taylor::Orbit;

    type Method = fn(&Pendulum<f64>, &State<f64>, f64) -> State<f64>;

    const METHODS: [(Method, f64); 3] = [(euler, 1.0), (semi_implicit_euler, 1.0), (fresh_rk4, 4.0)];

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
        // Each normal mode is an oscillator whose energy grows by 1 + h²ω² a step.
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
        let one = State {
            angle: [1.0f32, 1.0],
            speed: [1.0, 1.0],
        };
        let tiny = one.plus(&one).plus(&State::rest([0.0, 0.0]));
        assert_eq!(tiny.angle[0], 2.0);
        let change = State {
            angle: [1e-8f32; 2],
            speed: [1e-8; 2],
        };
        let (mut plain, mut kept) = (one, (one, State::rest([0.0; 2])));
        for _ in 0..1000 {
            plain = plain.plus(&change);
            kept = kept.0.plus_compensated(&kept.1, &change);
        }
        assert_eq!(plain.angle[0], 1.0);
        assert!((kept.0.angle[0] - 1.00001).abs() < 1e-7);
    }
}
