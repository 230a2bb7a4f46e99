//! The trajectory along which a patch of starts is followed, in as many digits as its depth needs.
//!
//! Only the middle of a patch must be known to all digits: the states around it are differences,
//! and those keep their own leading digits in f64.

use super::phase::Phase;
use super::polynomial::evaluate;
use super::real::Scalar;
use super::taylor::{Orbit, TaylorStep};
use super::{Fixed, Pendulum, State, Theta};

/// A trajectory known to more digits than f64 holds, in reduced units.
pub trait Reference: Send {
    /// Time from now up to which the trajectory is known; always positive.
    fn reach(&mut self) -> f64;
    /// Unit vectors and momenta at the time `after` from now, which is at most the reach.
    fn phase(&self, after: f64) -> Phase<f64>;
    /// The sine of `bob`'s angle where it turns round near `after`, close to the top.
    fn turn(&self, bob: usize, after: f64) -> f64;
    /// Advances the present moment by `by`.
    fn advance(&mut self, by: f64);
}

/// A [`Reference`] in fixed-point numbers.
struct FixedReference<const N: usize> {
    pendulum: Pendulum<Fixed<N>>,
    orbit: Orbit<Fixed<N>>,
    step: TaylorStep<Fixed<N>>,
    /// Time from the beginning of the step to the present moment.
    into: Fixed<N>,
}

/// Number of decimal digits after the point in the numbers whose errors are at most 2^−`bits`.
pub fn digits_for(bits: u32) -> u32 {
    (f64::from(64 * bits.div_ceil(64).clamp(2, 7)) * std::f64::consts::LOG10_2) as u32
}

/// Computes the trajectory of a pendulum in reduced units, released from rest at `angle` (rad),
/// with errors of about 2^−`bits`.
pub fn reference(pendulum: &Pendulum<Theta>, angle: [Theta; 2], bits: u32) -> Box<dyn Reference> {
    match bits.div_ceil(64) {
        0..=2 => Box::new(FixedReference::<3>::new(pendulum, angle)),
        3 => Box::new(FixedReference::<4>::new(pendulum, angle)),
        4 => Box::new(FixedReference::<5>::new(pendulum, angle)),
        5 => Box::new(FixedReference::<6>::new(pendulum, angle)),
        6 => Box::new(FixedReference::<7>::new(pendulum, angle)),
        _ => Box::new(FixedReference::<8>::new(pendulum, angle)),
    }
}

impl<const N: usize> FixedReference<N> {
    fn new(pendulum: &Pendulum<Theta>, angle: [Theta; 2]) -> Self {
        let pendulum = pendulum.map(Fixed::resized);
        let mut orbit = Orbit::new(pendulum, State::rest(angle.map(Fixed::resized)));
        let step = orbit.step();
        FixedReference { pendulum, orbit, step, into: Fixed::ZERO }
    }
}

impl<const N: usize> Reference for FixedReference<N> {
    fn reach(&mut self) -> f64 {
        let mut left = (self.step.length - self.into).to_f64();
        if left <= 0.0 {
            self.into = self.into - self.step.length;
            self.step = self.orbit.step();
            left = (self.step.length - self.into).to_f64();
        }
        left
    }

    fn phase(&self, after: f64) -> Phase<f64> {
        let state = self.step.state(self.into + Fixed::from_f64(after));
        let angle = state.angle.map(Fixed::wrapped);
        self.pendulum.phase(&State { angle, ..state }).map(Fixed::to_f64)
    }

    fn turn(&self, bob: usize, after: f64) -> f64 {
        let unit = self.step.unit_secs;
        let mut tau = (self.into + Fixed::from_f64(after)) / Fixed::from_f64(unit);
        let (speed, angle) = (&self.step.speed[bob], &self.step.angle[bob]);
        let slope: Vec<Fixed<N>> =
            (1..speed.len()).map(|k| speed[k] * Fixed::from_f64(k as f64)).collect();
        let mut good = 30;
        while good < Fixed::<N>::BITS {
            tau = tau - evaluate(speed, tau) / evaluate(&slope, tau);
            good *= 2;
        }
        let highest = evaluate(angle, tau).wrapped();
        let from_top = (Fixed::<N>::pi() - highest.abs()).to_f64().sin();
        if highest.is_negative() { -from_top } else { from_top }
    }

    fn advance(&mut self, by: f64) {
        self.into = self.into + Fixed::from_f64(by);
    }
}
