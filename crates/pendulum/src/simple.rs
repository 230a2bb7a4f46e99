//! The single pendulum, a mass on a rod, with its measured and its exact period.
//!
//! The equation of motion is θ″ = −(g/r) sin θ. Released from rest at θ0, the pendulum has the
//! period 2π √(r/g) / agm(1, cos(θ0/2)), with the arithmetic–geometric mean agm (Gauss 1799).

use std::f64::consts::{PI, TAU};

/// The state of a single pendulum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Angle from the downward vertical in rad, anticlockwise.
    pub angle: f64,
    /// Angular velocity in rad/s, anticlockwise.
    pub speed: f64,
}

/// A rod with a mass at its end. The mass does not affect the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simple {
    /// Length of the rod in m.
    pub length: f64,
    /// Gravitational acceleration in m/s².
    pub gravity: f64,
}

impl Simple {
    /// The ratio g/r in 1/s².
    fn stiffness(&self) -> f64 {
        self.gravity / self.length
    }

    /// The angular acceleration at `angle` in rad/s².
    pub fn acceleration(&self, angle: f64) -> f64 {
        -self.stiffness() * angle.sin()
    }

    /// The period of infinitesimal swings, 2π √(r/g), in s.
    pub fn small_period_secs(&self) -> f64 {
        TAU / self.stiffness().sqrt()
    }

    /// The period in s after a release from rest at `amplitude` (rad); it diverges towards the top.
    pub fn period_secs(&self, amplitude: f64) -> f64 {
        self.small_period_secs() / agm(1.0, (0.5 * amplitude).cos().abs())
    }

    /// The angle in rad that the theory of small swings gives `secs` after a release from rest at
    /// `amplitude`.
    pub fn ghost(&self, amplitude: f64, secs: f64) -> f64 {
        amplitude * (self.stiffness().sqrt() * secs).cos()
    }

    /// The state after a step of `secs` by the classical Runge–Kutta method (Kutta 1901).
    pub fn step(&self, swing: Swing, secs: f64) -> Swing {
        let half = 0.5 * secs;
        let at = |by: f64, rate: Swing| Swing {
            angle: swing.angle + by * rate.angle,
            speed: swing.speed + by * rate.speed,
        };
        let rate =
            |swing: Swing| Swing { angle: swing.speed, speed: self.acceleration(swing.angle) };
        let first = rate(swing);
        let second = rate(at(half, first));
        let third = rate(at(half, second));
        let fourth = rate(at(secs, third));
        let mean = |part: fn(Swing) -> f64| {
            (part(first) + 2.0 * (part(second) + part(third)) + part(fourth)) / 6.0
        };
        at(secs, Swing { angle: mean(|s| s.angle), speed: mean(|s| s.speed) })
    }

    /// The time in s from `swing` to the bottom, within a step of `secs` over which the angle
    /// changes sign, by Newton's method on steps shortened to end there.
    pub(crate) fn crossing_secs(&self, swing: Swing, secs: f64) -> f64 {
        let mut within = 0.5 * secs;
        for _ in 0..8 {
            let there = self.step(swing, within);
            within = (within - there.angle / there.speed).clamp(0.0, secs);
        }
        within
    }
}

/// The latest zero crossings of a swing in one direction, which measure its period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossings {
    /// Times in s of the last two passages of the bottom towards the left.
    falls: [Option<f64>; 2],
}

impl Crossings {
    /// Examines the step that begins at `from_secs` in the state `before`.
    pub fn look(&mut self, simple: &Simple, from_secs: f64, before: Swing, step_secs: f64) {
        let after = simple.step(before, step_secs);
        if before.angle > 0.0 && after.angle <= 0.0 && after.speed < 0.0 {
            let at = from_secs + simple.crossing_secs(before, step_secs);
            self.falls = [self.falls[1], Some(at)];
        }
    }

    /// The measured period in s, once two crossings have been seen.
    pub fn period_secs(&self) -> Option<f64> {
        Some(self.falls[1]? - self.falls[0]?)
    }
}

/// The arithmetic–geometric mean of two non-negative numbers.
fn agm(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 4.0 * f64::EPSILON * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        if b == 0.0 {
            return 0.0;
        }
    }
    a
}

/// The largest amplitude for which a period is plotted: a hundredth of a radian below the top.
pub const MAX_AMPLITUDE: f64 = PI - 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    const METRE: Simple = Simple { length: 1.0, gravity: 9.81 };

    #[test]
    fn known_periods() {
        assert!((METRE.small_period_secs() - 2.006_066_680_710_2).abs() < 1e-9);
        // T(π/2)/T(0) = 2 K(1/√2) / π.
        let ratio = METRE.period_secs(PI / 2.0) / METRE.small_period_secs();
        assert!((ratio - 1.180_340_599_016_096).abs() < 1e-14, "{ratio}");
        assert!(METRE.period_secs(1e-4) / METRE.small_period_secs() - 1.0 < 1e-9);
        assert_eq!(METRE.period_secs(PI).is_finite(), agm(1.0, (PI / 2.0).cos()) > 0.0);
    }

    #[test]
    fn measured_periods_are_the_known_ones() {
        for amplitude in [0.1, 1.0, 2.0, 3.0] {
            let (mut swing, mut crossings) =
                (Swing { angle: amplitude, speed: 0.0 }, Crossings::default());
            let step = 1.0 / 2000.0;
            for k in 0..20_000 {
                crossings.look(&METRE, f64::from(k) * step, swing, step);
                swing = METRE.step(swing, step);
            }
            let (measured, known) =
                (crossings.period_secs().unwrap(), METRE.period_secs(amplitude));
            assert!((measured - known).abs() < 1e-9, "{amplitude}: {measured} for {known}");
        }
    }

    #[test]
    fn the_ghost_keeps_the_time_of_small_swings() {
        let period = METRE.small_period_secs();
        assert!((METRE.ghost(2.0, period) - 2.0).abs() < 1e-12);
        assert!(METRE.ghost(2.0, 0.25 * period).abs() < 1e-12);
    }
}
