//! The trajectory along which a patch of starts is followed, in as many digits as the depth of the
//! zoom needs.
//!
//! Only the middle of a patch must be known to all digits: the states around it are stored as
//! differences from it, which keep their own leading digits in f64. As the differences grow, the
//! middle needs fewer digits, and integrating with fewer takes a fraction of the time, so a
//! reference drops digits as it goes.

use crate::phase::Phase;
use crate::taylor::{Orbit, TaylorStep};
use crate::{Pendulum, State};
use flipmap_numbers::fixed::limbs_for;
use flipmap_numbers::polynomial::evaluate;
use flipmap_numbers::real::Scalar;
use flipmap_numbers::{Exact, Fixed};

/// A trajectory known to more digits than f64 holds, in reduced units.
pub trait Reference: Send {
    /// Time from the present moment up to which the trajectory is known; always positive.
    fn reach(&mut self) -> f64;
    /// Unit vectors and momenta at the time `after` from the present moment, which must not exceed
    /// the reach.
    fn phase(&self, after: f64) -> Phase<f64>;
    /// The sine of `bob`'s angle where it turns round, close to the top, near the time `after`.
    fn turn(&self, bob: usize, after: f64) -> f64;
    /// Advances the present moment by `by`.
    fn advance(&mut self, by: f64);
    /// Lets errors grow to about 2^−`bits` from the next step on. Returns the same trajectory in
    /// shorter numbers if these have enough bits.
    fn with_fewer_digits(&mut self, bits: u32) -> Option<Box<dyn Reference>>;
}

/// A [`Reference`] in fixed-point numbers.
struct FixedReference<const N: usize> {
    pendulum: Pendulum<Fixed<N>>,
    orbit: Orbit<Fixed<N>>,
    step: TaylorStep<Fixed<N>>,
    /// Time from the beginning of the step to the present moment.
    into: Fixed<N>,
}

/// Bits of a trajectory beyond those that its differences need, to absorb rounding errors.
const GUARD_BITS: u32 = 10;
/// Further bits that are kept when digits are dropped, as differences may shrink again for a while.
const SPARE_BITS: u32 = 16;

/// Least number of bits after the point: a phase in f64 has nearly as many.
const MIN_BITS: u32 = 56;

/// Number of bits after the point that a trajectory needs for differences of 2^−`size` from it to
/// keep the digits of f64.
pub fn bits_for(size: u32) -> u32 {
    size + f64::MANTISSA_DIGITS + GUARD_BITS
}

/// Number of decimal digits after the point in the numbers used for errors of at most 2^−`bits`.
pub fn digits_for(bits: u32) -> u32 {
    (f64::from(64 * (limbs_for(bits) as u32 - 1)) * std::f64::consts::LOG10_2) as u32
}

/// Computes the trajectory of a pendulum from a start, both in reduced units, with errors of about
/// 2^−`bits`.
pub fn reference(
    pendulum: &Pendulum<Exact>,
    start: &State<Exact>,
    bits: u32,
) -> Box<dyn Reference> {
    from(pendulum, start, bits)
}

/// Drops the digits that a reference no longer needs when its neighbours are `spread` away.
pub(crate) fn drop_digits(reference: &mut Box<dyn Reference>, spread: f64) {
    let size = (-spread.log2()).ceil().max(0.0) as u32;
    if let Some(coarser) = reference.with_fewer_digits(bits_for(size) + SPARE_BITS) {
        *reference = coarser;
    }
}

fn from<const M: usize>(
    pendulum: &Pendulum<Fixed<M>>,
    state: &State<Fixed<M>>,
    bits: u32,
) -> Box<dyn Reference> {
    match limbs_for(bits) {
        2 => Box::new(FixedReference::<2>::new(pendulum, state, bits)),
        3 => Box::new(FixedReference::<3>::new(pendulum, state, bits)),
        4 => Box::new(FixedReference::<4>::new(pendulum, state, bits)),
        5 => Box::new(FixedReference::<5>::new(pendulum, state, bits)),
        6 => Box::new(FixedReference::<6>::new(pendulum, state, bits)),
        7 => Box::new(FixedReference::<7>::new(pendulum, state, bits)),
        _ => Box::new(FixedReference::<8>::new(pendulum, state, bits)),
    }
}

impl<const N: usize> FixedReference<N> {
    fn new<const M: usize>(
        pendulum: &Pendulum<Fixed<M>>,
        state: &State<Fixed<M>>,
        bits: u32,
    ) -> Self {
        let pendulum = pendulum.map(Fixed::resized);
        let (angle, speed) = (state.angle.map(Fixed::resized), state.speed.map(Fixed::resized));
        let mut orbit = Orbit::with_bits(pendulum, State { angle, speed }, bits.max(MIN_BITS));
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
        let mut tau = (self.into + Fixed::from_f64(after)) * self.step.per_sec;
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

    fn with_fewer_digits(&mut self, bits: u32) -> Option<Box<dyn Reference>> {
        self.orbit.lower_bits(bits.max(MIN_BITS));
        (limbs_for(bits) < N).then(|| from(&self.pendulum, &self.step.state(self.into), bits))
    }
}
