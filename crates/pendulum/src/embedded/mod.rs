//! The embedded Runge–Kutta pairs: trial steps, each with an estimate of its own error, and what the
//! program knows of every pair.
//!
//! A pair is a file beside this one and an entry of [`Pair`]. The coefficients are data from the papers
//! cited. The stages are written out, because code for SIMD lanes and for shaders has to be
//! straight-line.

mod dop853;
mod dopri5;
mod stages;

pub use dop853::Dop853;
pub(crate) use dop853::dop853_factor;
pub use dopri5::Dopri5;
pub use stages::plus;

use stages::square;

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

/// The pairs that pixels can be integrated by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pair {
    /// Dormand and Prince's pair of orders 5 and 4: small coefficients, for f32.
    Dopri5,
    /// Dormand and Prince's pair of order 8, for everything finer.
    Dop853,
}

/// What the program knows of a pair.
#[derive(Debug)]
pub struct PairData {
    /// Name for options and files.
    pub name: &'static str,
    /// The power of the step with which the estimated error falls.
    pub order: u32,
    /// True if the pair provides [`Trial::bow`].
    pub has_bow: bool,
    /// Right-hand sides of a step.
    pub rhs_per_step: u64,
    /// Error of a run from the release, as a multiple of the tolerance: an error of the release.
    pub error_scale: f64,
    /// Error of a run after a start map, as a multiple of the tolerance: an error of the state with
    /// which it begins.
    pub error_scale_after_map: f64,
    /// True if the kernel that carries tangents in pairs of f32 compiles within minutes.
    pub carries_tangents_in_df32: bool,
    /// Name of the check of orbits by this pair on graphics adapters.
    pub orbit_check: &'static str,
    /// Number of its colour in charts.
    pub colour: usize,
}

/// An embedded pair, generic over the number type: two methods that share their stages, so that
/// the difference of their results estimates the error.
pub trait EmbeddedPair {
    /// The power of the step with which the estimated error falls.
    const ORDER: u32;
    /// True if the pair provides [`Trial::bow`], so that passes of the top are found on the motion
    /// inside its steps.
    const HAS_BOW: bool = false;

    /// Computes a step that may be taken or not. `inverse_scale` is 1 over the scale of each
    /// momentum.
    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T>;
}

/// Work that is written for any pair.
pub trait WithPair {
    /// The result of the work.
    type Output;

    /// Does the work with a pair.
    fn with<P: EmbeddedPair>(self) -> Self::Output;
}

impl Pair {
    /// Every pair, in the order in which they are listed.
    pub const ALL: [Pair; 2] = [Pair::Dopri5, Pair::Dop853];

    /// Returns what the program knows of the pair.
    pub const fn data(self) -> &'static PairData {
        match self {
            Pair::Dopri5 => &dopri5::DATA,
            Pair::Dop853 => &dop853::DATA,
        }
    }

    /// Does work that is compiled for each pair.
    #[inline(always)]
    pub fn run<W: WithPair>(self, work: W) -> W::Output {
        match self {
            Pair::Dopri5 => work.with::<Dopri5>(),
            Pair::Dop853 => work.with::<Dop853>(),
        }
    }

    /// Computes a step of the pair (see [`EmbeddedPair::trial`]).
    pub fn trial<T: Real>(
        self,
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T> {
        self.run(TrialStep { pendulum, inverse_scale, phase, step })
    }
}

/// A trial step of whichever pair.
struct TrialStep<'a, T> {
    pendulum: &'a Pendulum<T>,
    inverse_scale: [T; 2],
    phase: &'a Phase<T>,
    step: T,
}

impl<T: Real> WithPair for TrialStep<'_, T> {
    type Output = Trial<T>;

    fn with<P: EmbeddedPair>(self) -> Trial<T> {
        P::trial(self.pendulum, self.inverse_scale, self.phase, self.step)
    }
}

/// The control points of the quartic that [`Dopri5`] gives for a value over its step (Hairer,
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
            let trial = Pair::Dopri5.trial(&unit, scale, &start, step);
            let end = plus(&start, &trial.change);
            let (rate, rate_after) = (unit.derivative(&start), unit.derivative(&end));
            let rises = [rate[3] * step, rate_after[3] * step];
            let control = quartic([start[3], end[3]], rises, trial.bow[1]);
            let off = |share: f64| {
                let truth = Dop853::trial(&unit, scale, &start, step * share).change[3] + start[3];
                (value(control, share) - truth).abs()
            };
            (1..10).map(|k| off(f64::from(k) / 10.0)).fold(0.0, f64::max)
        };
        let order = (error(0.1) / error(0.05)).log2();
        assert!((order - 5.0).abs() < 0.3 && error(0.1) < 2e-5, "{order} {}", error(0.1));
    }

    #[test]
    fn every_pair_has_the_order_that_it_claims_and_data_that_fit_it() {
        struct Claims;
        impl WithPair for Claims {
            type Output = (u32, bool);
            fn with<P: EmbeddedPair>(self) -> (u32, bool) {
                (P::ORDER, P::HAS_BOW)
            }
        }
        let unit = Pendulum::points([1.0, 2.0], [1.0, 0.6], 1.0);
        let scale = unit.momentum_scale().map(|scale| 1.0 / scale);
        let start = unit.phase(&State { angle: [1.0, 2.6], speed: [0.5, 1.5] });
        for pair in Pair::ALL {
            let data = pair.data();
            assert_eq!((data.order, data.has_bow), pair.run(Claims), "{}", data.name);
            let at = |step: f64| pair.trial(&unit, scale, &start, step);
            let order = 0.5 * (at(0.1).error_squared / at(0.05).error_squared).log2();
            assert!((order - f64::from(data.order)).abs() < 0.4, "{}: {order}", data.name);
            assert_eq!(at(0.1).bow != [0.0; 2], data.has_bow, "{}", data.name);
            // A step and two of half its length differ by the error of the method, which is smaller
            // than the estimate.
            let twice = |half: f64| {
                let middle = plus(&start, &at(half).change);
                let second = pair.trial(&unit, scale, &middle, half);
                plus(&middle, &second.change)
            };
            let whole = plus(&start, &at(0.1).change);
            let off = (0..6).map(|i| (whole[i] - twice(0.05)[i]).abs()).fold(0.0, f64::max);
            let estimate = at(0.1).error_squared.sqrt();
            assert!(off < 4.0 * estimate, "{}: {off:e} and {estimate:e}", data.name);
        }
    }
}
