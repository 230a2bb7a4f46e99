//! The coordinates of a cell's starts along its curve, as polynomials in the position of the start:
//! three polynomials tell all that a line needs to know of a start, and its state is not needed.

use pulp::{Arch, Simd, WithSimd};

use super::curve::{CurvePoint, NEWTON_STEPS, PatchCurve};
use super::{Dynamics, FlowPatch};
use crate::physics::jet::Jet;

/// The place on the curve of every start of a cell.
#[derive(Clone, Debug)]
pub struct CurveCoordinates {
    s: Jet,
    ahead: Jet,
    /// Square of the distance that remains.
    aside_squared: Jet,
}

/// Number of starts that are evaluated together.
const LANES: usize = 8;
/// Largest difference from the place of a single state at which the polynomials stand for all.
const AGREES: f64 = 1e-9;

impl FlowPatch {
    /// The coordinates along the patch's curve; none where they are no polynomials, which shows at
    /// the rim.
    pub fn coordinates(&self, dynamics: &Dynamics, curve: &PatchCurve) -> Option<CurveCoordinates> {
        let pendulum = &dynamics.jets;
        let mut s = curve.first_guess(dynamics, &self.phase);
        let mut step = curve.approach(dynamics, pendulum, &self.phase, s);
        for _ in 1..NEWTON_STEPS {
            s = s + step.by;
            step = curve.approach(dynamics, pendulum, &self.phase, s);
        }
        let rest = step.rest.map(|rest| rest * rest).into_iter().reduce(|sum, rest| sum + rest)?;
        let aside_squared = rest / step.slope_squared;
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
    /// The points on the curve of the starts at some places in the cell.
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
