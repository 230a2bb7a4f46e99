//! The coordinates of a cell's starts along its curve, as polynomials in the position of the start:
//! three polynomials give all that a line needs of a start, without its state.

use pulp::{Arch, Simd, WithSimd};

use super::curve::{CurvePoint, NEWTON_STEPS, PatchCurve, dot};
use super::{Dynamics, FlowPatch};
use flipmap_numbers::jet::Jet;

/// The place on the curve of every start of a cell.
#[derive(Clone, Debug)]
pub struct CurveCoordinates {
    s: Jet,
    ahead: Jet,
    /// Square of [`CurvePoint::aside`].
    aside_squared: Jet,
}

/// Number of starts that are evaluated together.
const LANES: usize = 8;
/// Largest difference from the places of single states at which the polynomials are accepted.
const AGREES: f64 = 1e-9;

impl FlowPatch {
    /// Returns the coordinates of the starts along the patch's `curve`, or `None` if polynomials do
    /// not give the places of the states at the rim.
    pub fn coordinates(&self, dynamics: &Dynamics, curve: &PatchCurve) -> Option<CurveCoordinates> {
        let pendulum = &dynamics.jets;
        let mut s = curve.first_guess(dynamics, &self.phase);
        let mut step = curve.approach(dynamics, pendulum, &self.phase, s);
        for _ in 1..NEWTON_STEPS {
            s = s + step.by;
            step = curve.approach(dynamics, pendulum, &self.phase, s);
        }
        let aside_squared = dot(&step.rest, &step.rest) / step.slope_squared;
        let found = CurveCoordinates { s: s + step.by, ahead: step.ahead, aside_squared };
        let places = FlowPatch::rim();
        let agrees = |(at, by_polynomials): ([f64; 2], CurvePoint)| {
            let exact = curve.point(dynamics, &self.phase.map(|jet| jet.at(at)));
            exact.is_some_and(|exact| exact.is_near(&by_polynomials, AGREES))
        };
        places.into_iter().zip(found.points(&places)).all(agrees).then_some(found)
    }
}

impl CurveCoordinates {
    /// The curve points of the starts at `places` in the cell.
    pub fn points(&self, places: &[[f64; 2]]) -> Vec<CurvePoint> {
        let mut points = Vec::with_capacity(places.len());
        Arch::new().dispatch(Evaluation { coordinates: self, places, points: &mut points });
        points
    }
}

/// The evaluation of the polynomials, compiled for the widest registers of the processor.
struct Evaluation<'a> {
    coordinates: &'a CurveCoordinates,
    places: &'a [[f64; 2]],
    points: &'a mut Vec<CurvePoint>,
}

impl WithSimd for Evaluation<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let CurveCoordinates { s, ahead, aside_squared } = self.coordinates;
        for places in self.places.chunks(LANES) {
            let mut at = [[0.0; LANES]; 2];
            for (lane, place) in places.iter().enumerate() {
                (at[0][lane], at[1][lane]) = (place[0], place[1]);
            }
            let [s, ahead, square] = [s, ahead, aside_squared].map(|jet| jet.values(&at));
            self.points.extend((0..places.len()).map(|lane| {
                let aside = square[lane].max(0.0).sqrt();
                CurvePoint { s: s[lane], ahead: ahead[lane], aside }
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pendulum;
    use crate::flip::Rule;

    fn dynamics() -> Dynamics {
        Dynamics::new(Pendulum::points([1.0; 2], [1.0; 2], 9.81), Rule::Second)
    }

    fn release(half: f64) -> FlowPatch {
        FlowPatch::release(&dynamics(), [-1.6601f64, 0.1003].map(f64::sin_cos), half)
    }

    #[test]
    fn polynomials_place_starts_where_their_states_are() {
        let (dynamics, mut patch) = (dynamics(), release(1e-8));
        patch.follow(&dynamics, 90.0, 1e-12, None);
        let curve = patch.curve(&dynamics, 1e-4).expect("one direction has grown");
        let coordinates = patch.coordinates(&dynamics, &curve).expect("polynomials");
        let places: Vec<[f64; 2]> =
            (0..21).map(|k| [0.09 * f64::from(k) - 0.9, (1.7 * f64::from(k)).sin()]).collect();
        let points = coordinates.points(&places);
        assert_eq!(points.len(), places.len());
        for (at, point) in places.into_iter().zip(points) {
            let exact = curve.point(&dynamics, &patch.phase.map(|jet| jet.at(at))).unwrap();
            assert!(exact.is_near(&point, 1e-10), "{exact:?} {point:?}");
        }
        // Another strip gives different points.
        let mut other = release(0.5e-8);
        other.follow(&dynamics, 90.0, 1e-12, None);
        let elsewhere = other.curve(&dynamics, 1e-4).expect("one direction has grown");
        let exact = elsewhere.point(&dynamics, &patch.phase.map(|jet| jet.at([0.5; 2])));
        let point = coordinates.points(&[[0.5; 2]])[0];
        assert!(exact.is_none_or(|exact| !exact.is_near(&point, 1e-10)));
    }

    #[test]
    fn states_too_far_apart_have_no_such_polynomials() {
        let (dynamics, mut patch) = (dynamics(), release(0.2));
        for _ in 0..8 {
            patch.phase = dynamics.carried(&patch.phase, Jet::constant(0.3));
        }
        let curve = PatchCurve::through(&dynamics, &patch.phase);
        assert!(patch.coordinates(&dynamics, &curve).is_none());
    }
}
