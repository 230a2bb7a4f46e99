//! The growth of small differences along one pendulum's motion, over any number of decades.
//!
//! The motion itself is followed in enough digits that its error, which grows as the differences
//! do, stays far below them; its tangents need no more than f64. As growth proceeds, digits are
//! dropped.

use crate::embedded::{Dop853, EmbeddedPair, dop853_factor, plus};
use crate::phase::Phase;
use crate::reference::{Reference, reference};
use crate::{Pendulum, State};
use flipmap_numbers::Exact;
use flipmap_numbers::dual::Dual;

/// A state with its derivatives with respect to both angles of the start.
type Tangents = Phase<Dual<2>>;

/// Largest error of a step in the state, which the reference corrects; the tangents' relative
/// errors are about as large.
const TOLERANCE: f64 = 1e-9;
/// Maximum length of a step in reduced time.
const MAX_STEP: f64 = 0.5;
/// Bits of the trajectory beyond those that the remaining growth demands.
const SPARE_BITS: f64 = 40.0;

/// The reduced time after which a small difference between starts near `angle` (rad) has first
/// grown by `decades`, measured in unit vectors and scaled momenta; `None` if that takes longer
/// than `most`. The pendulum is in reduced units.
pub fn time_to_grow(
    pendulum: &Pendulum<Exact>,
    angle: [Exact; 2],
    decades: f64,
    most: f64,
) -> Option<f64> {
    let mut motion = TangentMotion::released(pendulum, angle, bits(decades));
    while motion.time < most {
        let left = decades - motion.decades();
        if left <= 0.0 {
            return Some(motion.time);
        }
        if let Some(coarser) = motion.reference.with_fewer_digits(bits(left)) {
            motion.reference = coarser;
        }
        motion.advance();
    }
    None
}

/// Number of bits after the point that the trajectory needs while `decades` of growth remain.
fn bits(decades: f64) -> u32 {
    (decades * std::f64::consts::LOG2_10 + SPARE_BITS).max(0.0) as u32
}

/// A pendulum with its tangents in motion.
struct TangentMotion {
    dynamics: Pendulum<Dual<2>>,
    inverse_scale: [f64; 2],
    reference: Box<dyn Reference>,
    state: Tangents,
    time: f64,
    /// Length of the next step to try.
    step: f64,
}

impl TangentMotion {
    fn released(pendulum: &Pendulum<Exact>, angle: [Exact; 2], bits: u32) -> Self {
        let reference = reference(pendulum, &State::rest(angle), bits);
        let phase = reference.phase(0.0);
        let [x1, y1, x2, y2, ..] = phase;
        let slopes = [[-y1, 0.0], [x1, 0.0], [0.0, -y2], [0.0, x2], [0.0; 2], [0.0; 2]];
        let state = std::array::from_fn(|i| Dual { value: phase[i], slope: slopes[i] });
        let pendulum = pendulum.to_f64();
        TangentMotion {
            dynamics: pendulum.map(Dual::new),
            inverse_scale: pendulum.momentum_scale().map(|scale| 1.0 / scale),
            reference,
            state,
            time: 0.0,
            step: super::control::FIRST,
        }
    }

    /// The decades by which differences have grown so far: the Frobenius norm of the tangents.
    fn decades(&self) -> f64 {
        let [p1, p2] = self.inverse_scale;
        let weights = [1.0, 1.0, 1.0, 1.0, p1, p2];
        let square = |slope: [f64; 2], weight: f64| {
            slope.iter().map(|part| (part * weight).powi(2)).sum::<f64>()
        };
        let sum: f64 = (0..6).map(|i| square(self.state[i].slope, weights[i])).sum();
        0.5 * sum.log10()
    }

    /// Takes a step, at most as far as the reference is known.
    fn advance(&mut self) {
        let scale = self.inverse_scale.map(Dual::new);
        let mut length = self.step.min(MAX_STEP).min(self.reference.reach());
        loop {
            let trial = Dop853::trial(&self.dynamics, scale, &self.state, Dual::new(length));
            let error = trial.error_squared.value.sqrt();
            let factor = dop853_factor(error, TOLERANCE);
            // A step cut short by the reference says little about the next one.
            let next = length * factor.clamp(0.2, 3.0);
            if error <= TOLERANCE {
                self.step = if length < self.step { next.max(self.step) } else { next };
                let known = self.reference.phase(length);
                let after = plus(&self.state, &trial.change);
                self.state = std::array::from_fn(|i| Dual { value: known[i], ..after[i] });
                self.reference.advance(length);
                self.time += length;
                return;
            }
            (length, self.step) = (next, next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;
    use crate::taylor::Orbit;
    use flipmap_numbers::{Dd, Scalar};

    fn unit<T: Scalar>() -> Pendulum<T> {
        let one = T::from_f64(1.0);
        Pendulum::points([one; 2], [one; 2], one)
    }

    #[test]
    fn an_upright_pendulum_grows_at_its_exponent() {
        // λ² = 2 + √2 is the larger eigenvalue of the linear motion about (π, π).
        let exponent = (2.0 + 2f64.sqrt()).sqrt();
        let time = |decades| time_to_grow(&unit(), [Exact::pi(); 2], decades, 1e3).unwrap();
        let apart = (time(70.0) - time(20.0)) / 50.0;
        let expected = std::f64::consts::LN_10 / exponent;
        assert!((apart / expected - 1.0).abs() < 0.01, "{apart} {expected}");
    }

    #[test]
    fn neighbours_are_apart_when_it_says_so() {
        let angle = [1.1867, 2.0438].map(Exact::from_f64);
        let time = time_to_grow(&unit(), angle, 5.0, 200.0).unwrap();
        let state = |by: f64| {
            let start = State::rest([1.1867, 2.0438].map(|angle| Dd::new(angle) + Dd::new(by)));
            Orbit::new(unit(), start).state_at(Dd::new(time))
        };
        let (here, there) = (state(0.0), state(1e-9));
        let apart = [0, 1].map(|i| (here.angle[i] - there.angle[i]).hi);
        let decades = (apart[0].hypot(apart[1]) / 1e-9).log10();
        assert!((3.5..6.0).contains(&decades), "{decades}");
    }

    #[test]
    fn a_small_swing_never_grows() {
        let angle = [Exact::from_f64(0.1); 2];
        assert_eq!(time_to_grow(&unit(), angle, 6.0, 100.0), None);
    }
}
