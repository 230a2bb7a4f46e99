//! The curve along which the states of a small cell lie once one direction has grown beyond all
//! others.

use super::{Dynamics, FlowPatch};
use crate::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::jet::{DEGREE, Jet};
use flipmap_numbers::real::Real;

/// The states P(s) = Φ(s·u) of the starts on a line through the middle of a cell.
#[derive(Clone, Debug)]
pub struct PatchCurve {
    /// The polynomials of P's components, by powers of s.
    powers: Phase<[f64; DEGREE + 1]>,
    /// P′ in the middle over its squared length, in weighted components: the product with a state's
    /// offset is s to first order.
    across: Phase<f64>,
    middle: Phase<f64>,
}

/// A state written as a point of the curve moved along the flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Position on the curve; the cell reaches from about −1 to 1.
    pub s: f64,
    /// Reduced time by which the state is ahead of the curve.
    pub ahead: f64,
    /// Remaining distance of the state from that moved point, in units of s.
    pub aside: f64,
}

/// One iteration of the search for a state's place on a curve.
pub(super) struct CurveStep<T> {
    /// Change of s.
    pub by: T,
    /// Reduced time by which the state is ahead of the curve.
    pub ahead: T,
    /// Remaining difference of the state, in weighted components.
    pub rest: Phase<T>,
    /// Squared length of the curve's slope.
    pub slope_squared: T,
    flow_squared: T,
    /// Squared area of the parallelogram of slope and flow.
    det: T,
}

/// Number of Newton iterations for a point; the polynomials are nearly linear.
pub(super) const NEWTON_STEPS: usize = 4;
/// Change of s below which a point has been found.
const FOUND: f64 = 1e-9;
/// Least sine of the angle between curve and flow at which the two can be told apart.
const MIN_ANGLE: f64 = 1e-3;

impl FlowPatch {
    /// The direction in which the patch's states differ most, as an angle in its frame.
    pub fn growing_angle(&self, dynamics: &Dynamics) -> f64 {
        growing_angle(dynamics, &self.phase)
    }

    /// Returns the curve of the patch's states if the middle and the rim lie within `most_aside`,
    /// in units of s, of points of the curve moved along the flow; otherwise `None`. Starts that
    /// flipped in a graze are continued as if they had not.
    pub fn curve(&self, dynamics: &Dynamics, most_aside: f64) -> Option<PatchCurve> {
        let curve = PatchCurve::through(dynamics, &self.phase);
        let lies = |at: [f64; 2]| {
            let point = curve.point(dynamics, &self.phase.map(|jet| jet.at(at)));
            point.is_some_and(|point| point.aside <= most_aside)
        };
        FlowPatch::rim().into_iter().all(lies).then_some(curve)
    }

    /// Eight places on the rim of a cell, and its middle.
    pub(super) fn rim() -> [[f64; 2]; 9] {
        std::array::from_fn(|k| [k % 3, k / 3].map(|third| third as f64 - 1.0))
    }
}

/// The direction in the cell in which states differ most: that of the first right singular vector
/// of the linear part.
fn growing_angle(dynamics: &Dynamics, phase: &Phase<Jet>) -> f64 {
    let weight = dynamics.weights();
    let linear = phase.map(|jet| jet.gradient());
    let product = |a: usize, b: usize| -> f64 {
        (0..6).map(|i| weight[i] * weight[i] * linear[i][a] * linear[i][b]).sum()
    };
    0.5 * (2.0 * product(0, 1)).atan2(product(0, 0) - product(1, 1))
}

impl PatchCurve {
    /// The curve through the middle, whether or not the other states lie on it.
    pub(super) fn through(dynamics: &Dynamics, phase: &Phase<Jet>) -> Self {
        let weight = dynamics.weights();
        let (sin, cos) = growing_angle(dynamics, phase).sin_cos();
        let powers = phase.map(|jet| jet.along([cos, sin]));
        let length: f64 = (0..6).map(|i| (weight[i] * powers[i][1]).powi(2)).sum();
        let across = std::array::from_fn(|i| weight[i] * powers[i][1] / length);
        PatchCurve { powers, across, middle: phase.map(|jet| jet.middle()) }
    }

    /// The state at `s`.
    pub fn at<T: Real>(&self, s: T) -> Phase<T> {
        self.powers.map(|c| c.iter().rev().fold(s.lit(0.0), |sum, c| sum * s + s.lit(*c)))
    }

    /// The derivative P′(s).
    fn slope<T: Real>(&self, s: T) -> Phase<T> {
        self.powers
            .map(|c| (1..=DEGREE).rev().fold(s.lit(0.0), |sum, k| sum * s + s.lit(k as f64 * c[k])))
    }

    /// The place of a state on the curve to first order.
    pub(super) fn first_guess<T: Real>(&self, dynamics: &Dynamics, phase: &Phase<T>) -> T {
        let weight = dynamics.weights();
        let part = |i: usize| {
            let off = phase[i] - phase[i].lit(self.middle[i]);
            off * off.lit(weight[i]) * off.lit(self.across[i])
        };
        (1..6).fold(part(0), |sum, i| sum + part(i))
    }

    /// Takes one Gauss–Newton step from `s` towards the place on the curve nearest to a state: the
    /// state is written as the one at `s`, moved along the curve and along the flow.
    pub(super) fn approach<T: Real>(
        &self,
        dynamics: &Dynamics,
        pendulum: &Pendulum<T>,
        phase: &Phase<T>,
        s: T,
    ) -> CurveStep<T> {
        let weight = dynamics.weights();
        let weighted = |state: Phase<T>| -> Phase<T> {
            std::array::from_fn(|i| state[i] * state[i].lit(weight[i]))
        };
        let there = self.at(s);
        let off = weighted(std::array::from_fn(|i| phase[i] - there[i]));
        let slope = weighted(self.slope(s));
        let flow = weighted(pendulum.derivative(&there));
        let (ss, sf, ff) = (dot(&slope, &slope), dot(&slope, &flow), dot(&flow, &flow));
        let det = ss * ff - sf * sf;
        let (os, of) = (dot(&off, &slope), dot(&off, &flow));
        let (by, ahead) = ((os * ff - of * sf) / det, (of * ss - os * sf) / det);
        let rest = std::array::from_fn(|i| off[i] - by * slope[i] - ahead * flow[i]);
        CurveStep { by, ahead, rest, slope_squared: ss, flow_squared: ff, det }
    }

    /// Writes a state as the nearest point of the curve moved along the flow, by distance in unit
    /// vectors and scaled momenta. `None` if curve and flow cannot be told apart there, or if the
    /// search does not converge.
    pub fn point(&self, dynamics: &Dynamics, phase: &Phase<f64>) -> Option<CurvePoint> {
        let mut s = self.first_guess(dynamics, phase);
        for _ in 0..NEWTON_STEPS {
            let CurveStep { by, ahead, rest, slope_squared, flow_squared, det } =
                self.approach(dynamics, &dynamics.pendulum, phase, s);
            if det <= MIN_ANGLE * MIN_ANGLE * slope_squared * flow_squared {
                return None;
            }
            s += by;
            if by.abs() < FOUND {
                let aside = (dot(&rest, &rest) / slope_squared).sqrt();
                return Some(CurvePoint { s, ahead, aside });
            }
        }
        None
    }
}

impl CurvePoint {
    /// Returns true if none of its coordinates differs from the other point's by more than `most`.
    pub(super) fn is_near(&self, other: &CurvePoint, most: f64) -> bool {
        let apart = [self.s - other.s, self.ahead - other.ahead, self.aside - other.aside];
        apart.iter().all(|apart| apart.abs() <= most)
    }
}

/// The scalar product.
pub(super) fn dot<T: Real>(a: &Phase<T>, b: &Phase<T>) -> T {
    (1..6).fold(a[0] * b[0], |sum, i| sum + a[i] * b[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pendulum;
    use crate::flip::Rule;

    #[test]
    fn states_of_a_narrow_cell_lie_on_the_curve() {
        let pendulum = Pendulum::points([1.0; 2], [1.0; 2], 9.81);
        let dynamics = Dynamics::new(pendulum, Rule::Second);
        let starts = [-1.6601f64, 0.1003].map(f64::sin_cos);
        let mut patch = FlowPatch::release(&dynamics, starts, 1e-8);
        let end = patch.follow(&dynamics, 90.0, 1e-12, None);
        assert!(matches!(end, crate::flow_patch::PatchEnd::Spread), "{end:?}");
        let curve = patch.curve(&dynamics, 1e-4).expect("one direction has grown");
        for at in [[0.3, -0.7], [-1.0, 0.2], [0.9, 0.9]] {
            let phase = patch.phase.map(|jet| jet.at(at));
            let point = curve.point(&dynamics, &phase).unwrap();
            let there = curve.at(point.s);
            let flow = pendulum.derivative(&there);
            let length: f64 = curve.slope(point.s).iter().map(|x| x * x).sum::<f64>().sqrt();
            for i in 0..6 {
                let off = phase[i] - flow[i].mul_add(point.ahead, there[i]);
                assert!(off.abs() < 20.0 * point.aside * length + 1e-13, "{i}: {off}");
            }
            assert!(point.s.abs() < 1.5 && point.aside < 1e-4);
        }
        // At rest a cell has two directions.
        let patch = FlowPatch::release(&dynamics, starts, 1e-2);
        assert!(patch.curve(&dynamics, 1e-4).is_none());
    }
}
