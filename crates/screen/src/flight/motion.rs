//! The complete motion of one pendulum, stored as a polynomial for each step, so that any moment
//! can be shown at once.

use flipmap_numbers::Dd;
use flipmap_numbers::polynomial::evaluate;
use flipmap_pendulum::State;
use flipmap_pendulum::taylor::TaylorStep;

/// One step of the integrator, in f64 and without the terms too small to be seen.
#[derive(Clone, Debug)]
struct MotionPiece {
    start_secs: f64,
    end_secs: f64,
    /// Coefficients of θ1 and θ2, rad/sᵏ; the speeds are their derivatives.
    angle: [Box<[f64]>; 2],
}

/// Contribution to an angle at the end of a step, in rad, below which a term is dropped.
const UNSEEN_RAD: f64 = 1e-16;

impl MotionPiece {
    fn new(step: &TaylorStep<Dd>, end_secs: f64) -> Self {
        let length_secs = end_secs - step.start.hi;
        let seen = |terms: &[Dd]| {
            let adds = |k: usize| terms[k].hi.abs() * length_secs.powi(k as i32) > UNSEEN_RAD;
            let count = (1..terms.len()).rev().find(|&k| adds(k)).map_or(1, |k| k + 1);
            terms[..count].iter().map(|term| term.hi).collect()
        };
        MotionPiece {
            start_secs: step.start.hi,
            end_secs,
            angle: [0, 1].map(|i| seen(&step.angle[i])),
        }
    }

    fn state_at(&self, secs: f64) -> State<f64> {
        let tau = secs - self.start_secs;
        State {
            angle: [0, 1].map(|i| evaluate(&self.angle[i], tau)),
            speed: [0, 1].map(|i| slope(&self.angle[i], tau)),
        }
    }
}

/// Returns the derivative of Σ cₖ xᵏ, by Horner's rule.
fn slope(coefficients: &[f64], x: f64) -> f64 {
    let terms = coefficients.iter().enumerate().skip(1).rev();
    terms.fold(0.0, |sum, (k, c)| sum.mul_add(x, k as f64 * c))
}

/// A motion from the release to the end of the time for which it is known.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    pieces: Vec<MotionPiece>,
}

impl Motion {
    /// Appends a step, cut off at `until_secs`.
    pub(crate) fn push(&mut self, step: &TaylorStep<Dd>, until_secs: f64) {
        self.pieces.push(MotionPiece::new(step, step.end().hi.min(until_secs)));
    }

    /// Appends a later part of the same motion.
    pub(crate) fn append(&mut self, mut later: Motion) {
        self.pieces.append(&mut later.pieces);
    }

    /// Number of steps stored.
    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// Seconds from the release to the end of the known motion.
    pub fn end_secs(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.end_secs)
    }

    /// Returns the state `secs` after the release; none outside the known motion.
    pub fn state_at(&self, secs: f64) -> Option<State<f64>> {
        let after = self.pieces.partition_point(|piece| piece.start_secs <= secs);
        let piece = self.pieces.get(after.checked_sub(1)?)?;
        (secs <= piece.end_secs).then(|| piece.state_at(secs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::taylor::Orbit;
    use flipmap_scene::PendulumSpec;

    fn recorded(angle: [f64; 2], until_secs: f64) -> (Orbit<Dd>, Motion) {
        let pendulum = PendulumSpec::default().pendulum_in::<Dd>();
        let start = State::rest(angle.map(Dd::new));
        let (mut orbit, mut motion) = (Orbit::new(pendulum, start), Motion::default());
        while orbit.time().hi < until_secs {
            let step = orbit.step();
            motion.push(&step, until_secs);
        }
        (Orbit::new(pendulum, start), motion)
    }

    #[test]
    fn the_record_is_the_orbit_at_every_moment() {
        let (mut orbit, motion) = recorded([2.2, 1.4], 5.0);
        for i in 0..=500 {
            let secs = f64::from(i) / 100.0;
            let (truth, kept) = (orbit.state_at(Dd::new(secs)), motion.state_at(secs).unwrap());
            for bob in 0..2 {
                assert!((truth.angle[bob].hi - kept.angle[bob]).abs() < 1e-13, "θ at {secs}");
                assert!((truth.speed[bob].hi - kept.speed[bob]).abs() < 1e-11, "ω at {secs}");
            }
        }
    }

    #[test]
    fn nothing_is_known_outside_it() {
        let (_, motion) = recorded([2.2, 1.4], 1.0);
        assert_eq!(motion.end_secs(), 1.0);
        assert!(motion.state_at(-1e-9).is_none() && motion.state_at(1.0 + 1e-9).is_none());
        assert!(Motion::default().state_at(0.0).is_none());
    }

    #[test]
    fn a_piece_keeps_no_more_terms_than_f64_can_show() {
        let (_, motion) = recorded([2.2, 1.4], 5.0);
        let terms: usize = motion.pieces.iter().flat_map(|p| &p.angle).map(|c| c.len()).sum();
        let mean = terms as f64 / (2 * motion.len()) as f64;
        assert!((8.0..24.0).contains(&mean), "{mean} terms");
        let (_, still) = recorded([0.0, 0.0], 5.0);
        assert_eq!(still.pieces[0].angle[0].len(), 1);
    }
}
