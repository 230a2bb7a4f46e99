//! The pendulum without angles: unit vectors along the rods, and momenta.
//!
//! Sines and cosines are needed only once, for the start. After that, a right-hand side takes some
//! twenty multiply-adds and one division on any device, and the top is where `y` changes sign while
//! `x` is negative.

use crate::pendulum::{Pendulum, State};
use flipmap_numbers::real::{Real, Scalar};

/// The phase x1, y1, x2, y2, p1, p2: cosine and sine of θ1 and of θ2, and the conjugate momenta
/// p = ∂L/∂ω in kg m²/s.
///
/// It is an array because a Runge–Kutta step treats all six alike.
pub type Phase<T> = [T; 6];

impl<T: Real> Pendulum<T> {
    /// The time derivative of `phase`.
    ///
    /// With c = cos(θ1−θ2) and s = sin(θ1−θ2), the speeds solve A ω1 + C c ω2 = p1 and
    /// C c ω1 + B ω2 = p2; then x′ = −ωy, y′ = ωx, p1′ = −C s ω1ω2 − P y1 and
    /// p2′ = C s ω1ω2 − Q y2, each with the torque of friction.
    #[inline(always)]
    pub fn derivative(&self, phase: &Phase<T>) -> Phase<T> {
        let [x1, y1, x2, y2, _, _] = *phase;
        let ([w1, w2], sin) = self.speeds_and_sine(phase);
        let pull = sin * (w1 * w2);
        let forces = [-(self.p.mul_add(y1, pull)), (-self.q).mul_add(y2, pull)];
        let [p1, p2] = match self.drag([w1, w2]) {
            None => forces,
            Some(drag) => [forces[0] + drag[0], forces[1] + drag[1]],
        };
        [-(w1 * y1), w1 * x1, -(w2 * y2), w2 * x2, p1, p2]
    }

    /// The angular velocities ω1 and ω2 in rad/s.
    #[inline(always)]
    pub fn speeds(&self, phase: &Phase<T>) -> [T; 2] {
        self.speeds_and_sine(phase).0
    }

    /// The angular velocities and C sin(θ1−θ2).
    #[inline(always)]
    fn speeds_and_sine(&self, phase: &Phase<T>) -> ([T; 2], T) {
        let [x1, y1, x2, y2, p1, p2] = *phase;
        let cos = self.c * x1.mul_add(x2, y1 * y2);
        let sin = self.c * y1.mul_add(x2, -(x1 * y2));
        let inverse_det = sin.lit(1.0) / sin.mul_add(sin, self.least_det);
        let w1 = self.b.mul_add(p1, -(cos * p2)) * inverse_det;
        let w2 = self.a.mul_add(p2, -(cos * p1)) * inverse_det;
        ([w1, w2], sin)
    }
}

/// The phase after a step of the classical Runge–Kutta method.
#[inline(always)]
pub fn rk4<T: Real>(pendulum: &Pendulum<T>, before: &Phase<T>, length: T) -> Phase<T> {
    let half = length * length.lit(0.5);
    let k1 = pendulum.derivative(before);
    let k2 = pendulum.derivative(&moved(before, &k1, half));
    let k3 = pendulum.derivative(&moved(before, &k2, half));
    let k4 = pendulum.derivative(&moved(before, &k3, length));
    let (two, sixth) = (length.lit(2.0), length * length.lit(1.0 / 6.0));
    let mut after = *before;
    for i in 0..6 {
        after[i] = before[i] + (k1[i] + two * (k2[i] + k3[i]) + k4[i]) * sixth;
    }
    after
}

/// Computes `phase + by · slope`.
#[inline(always)]
fn moved<T: Real>(phase: &Phase<T>, slope: &Phase<T>, by: T) -> Phase<T> {
    let mut moved = *phase;
    for i in 0..6 {
        moved[i] = phase[i] + slope[i] * by;
    }
    moved
}

impl<T: Real> Pendulum<T> {
    /// Kinetic plus potential energy in J; zero if both rods are level and at rest.
    pub fn energy_of(&self, phase: &Phase<T>) -> T {
        let [x1, _, x2, _, p1, p2] = *phase;
        let [w1, w2] = self.speeds(phase);
        x1.lit(0.5) * (p1 * w1 + p2 * w2) - (self.p * x1 + self.q * x2)
    }
}

impl<T: Scalar> Pendulum<T> {
    /// Converts `state` to unit vectors and momenta. An angle of exactly ±π in the number type
    /// stands for the top itself.
    pub fn phase(&self, state: &State<T>) -> Phase<T> {
        let [(y1, x1), (y2, x2)] = state.angle.map(|theta| {
            if theta.abs() == T::pi() { (T::zero(), -T::from_f64(1.0)) } else { theta.sin_cos() }
        });
        let cos = self.c * (x1 * x2 + y1 * y2);
        let [w1, w2] = state.speed;
        [x1, y1, x2, y2, self.a * w1 + cos * w2, cos * w1 + self.b * w2]
    }

    /// Approximate limit of each momentum, √(inertia × weight), by which errors are judged.
    pub fn momentum_scale(&self) -> [T; 2] {
        let weight = self.p + self.q;
        [(self.a * weight).sqrt(), (self.b * weight).sqrt()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flow_is_the_motion_of_the_angles() {
        for pendulum in [
            Pendulum::points([1.0, 2.0], [1.0, 0.6], 9.81),
            Pendulum::rods([0.3, 2.0], [0.4, 0.6], 1.62),
        ] {
            let state = State { angle: [1.1f64, -2.3], speed: [3.0, -4.0] };
            let phase = pendulum.phase(&state);
            let [w1, w2] = pendulum.speeds(&phase);
            assert!((w1 - 3.0).abs() < 1e-13 && (w2 + 4.0).abs() < 1e-13);
            let flow = pendulum.derivative(&phase);
            // A central difference over ±ε along the motion of the angles.
            let epsilon = 1e-6;
            let alpha = pendulum.acceleration(&state);
            let moved = |sign: f64| {
                pendulum.phase(&State {
                    angle: [0, 1].map(|i| state.angle[i] + sign * epsilon * state.speed[i]),
                    speed: [0, 1].map(|i| state.speed[i] + sign * epsilon * alpha[i]),
                })
            };
            let (after, before) = (moved(1.0), moved(-1.0));
            for i in 0..6 {
                let slope = (after[i] - before[i]) / (2.0 * epsilon);
                assert!((slope - flow[i]).abs() < 1e-7, "{i}: {slope} {}", flow[i]);
            }
        }
    }

    #[test]
    fn the_top_is_exact() {
        let unit = Pendulum::points([1.0; 2], [1.0; 2], 1.0);
        let phase = unit.phase(&State::rest([0.5, -std::f64::consts::PI]));
        assert_eq!((phase[2], phase[3]), (-1.0, 0.0));
    }
}
