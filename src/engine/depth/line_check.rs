//! Checks of lines: some starts at the corners of a patch, which lie as far from its line as any,
//! are integrated in full and have to flip at the times that the line gives.
//!
//! ```text
//!   ┌─────────────┐
//!   │ ○         ○ │    ○  start at a corner, integrated from its own state
//!   │─────────────│ s  ─  line; integrated a little before and after the corner's s
//!   │ ○         ○ │
//!   └─────────────┘
//! ```
//!
//! The steeper the line, the more a corner's residual shifts its flip; it is allowed that much. Where
//! the line jumps, a corner proves nothing, and a line that jumps at most of its corners is not used.

use super::line_interval::Sample;
use crate::physics::Status;
use crate::physics::flip::right_secs;
use crate::physics::flow_patch::{CurvePoint, Dynamics, FlowPatch, PatchCurve};
use crate::physics::phase::Phase;

/// The corners, in coordinates of the patch.
const CORNERS: [[f64; 2]; 4] = [[-0.6, -0.9], [-0.6, 0.9], [0.6, -0.9], [0.6, 0.9]];
/// Distance along the line from a corner's place to the places before and after it.
const BESIDE: f64 = 1e-4;
/// Largest difference between a corner and its line, as a share of the error with which an answer
/// is still right.
const SHARE: f64 = 0.5;
/// Distance of the ends before and after a corner's place above which the line jumps there.
const JUMP: f64 = 0.1;
/// Distance of a corner's end from the line's, beyond what steepness explains, above which the two
/// differ.
const FAR: f64 = 0.1;
/// Ratio of the largest effect of a residual to that of as long a way along the line (2.5 was
/// measured). Starts whose residual could count are integrated alone, so that this is no error.
const RESIDUAL: f64 = 4.0;
/// Least number of corners that have to confirm a line.
const LEAST_CONFIRMING: usize = 2;

/// A pendulum of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct CheckPlace {
    corner: usize,
    role: Role,
}

/// The part that a pendulum has in a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Role {
    /// The start at the corner.
    Corner,
    /// The start on the line, a little before.
    Before,
    /// The start on the line, a little after.
    After,
}

impl Role {
    const ALL: [Role; 3] = [Role::Corner, Role::Before, Role::After];
}

/// The check of one line.
pub(super) struct LineCheck<'a> {
    pub dynamics: &'a Dynamics,
    pub patch: &'a FlowPatch,
    pub curve: &'a PatchCurve,
    /// The reduced unit of time in s.
    pub unit_secs: f64,
}

impl CheckPlace {
    /// All pendulums of a check.
    pub(super) fn all() -> impl Iterator<Item = CheckPlace> {
        (0..CORNERS.len()).flat_map(|corner| Role::ALL.map(|role| CheckPlace { corner, role }))
    }
}

impl LineCheck<'_> {
    fn corner(&self, corner: usize) -> Phase<f64> {
        self.patch.phase.map(|jet| jet.at(CORNERS[corner]))
    }

    /// The place of a corner on the line. A corner without one is compared with the middle, which
    /// contradicts it.
    fn point(&self, corner: usize) -> CurvePoint {
        let nowhere = CurvePoint { s: 0.0, ahead: 0.0, aside: 0.0 };
        self.curve.point(self.dynamics, &self.corner(corner)).unwrap_or(nowhere)
    }

    /// The state in which a pendulum of the check begins.
    pub(super) fn state(&self, place: CheckPlace) -> Phase<f64> {
        match place.role {
            Role::Corner => self.corner(place.corner),
            Role::Before => self.curve.at(self.point(place.corner).s - BESIDE),
            Role::After => self.curve.at(self.point(place.corner).s + BESIDE),
        }
    }

    /// Returns true if enough corners confirm the line and none contradicts it; `sample` returns
    /// the end of a pendulum of the check.
    pub(super) fn holds(&self, sample: impl Fn(CheckPlace) -> Sample) -> bool {
        let mut confirming = 0;
        for corner in 0..CORNERS.len() {
            let ends = Role::ALL.map(|role| sample(CheckPlace { corner, role }));
            match self.confirms(self.point(corner), ends) {
                Some(true) => confirming += 1,
                Some(false) => return false,
                None => {}
            }
        }
        confirming >= LEAST_CONFIRMING
    }

    /// Returns true if the start at a corner ends as its place on the line does, up to the effect of
    /// its residual; `None` if the line jumps there.
    fn confirms(&self, point: CurvePoint, [off, before, after]: [Sample; 3]) -> Option<bool> {
        let apart = before.distance(&after);
        if apart.is_nan() || apart > JUMP {
            return None;
        }
        let [late, early] = [after.outcome.time, before.outcome.time];
        let expected_secs = match before.outcome.status {
            Status::Flipped => 0.5 * (early + late) - point.ahead * self.unit_secs,
            _ => 0.0,
        };
        let residual = RESIDUAL * point.aside / (2.0 * BESIDE);
        let most_secs = SHARE * right_secs(self.unit_secs) + residual * (late - early).abs();
        let most_apart = FAR + (1.0 + residual) * apart;
        let is_near = off.distance(&before) <= most_apart;
        Some(is_near && (off.outcome.time - expected_secs).abs() <= most_secs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::End;
    use crate::physics::flip::Rule;
    use crate::physics::{Outcome, Pendulum};

    const END: End = End { phase: [1.0; 6], ..End::NOWHERE };

    /// Judges the line of a small cell whose corners and line flip at these times (s).
    fn holds(corner: f64, before: f64, after: f64) -> bool {
        let dynamics = Dynamics::new(Pendulum::points([1.0; 2], [1.0; 2], 9.81), Rule::Second);
        let mut patch = FlowPatch::release([-1.6601f64, 0.1003].map(f64::sin_cos), 1e-8);
        patch.follow(&dynamics, 90.0, 1e-12, None);
        let curve = patch.curve(&dynamics, 1e-4).expect("one direction has grown");
        let check = LineCheck { dynamics: &dynamics, patch: &patch, curve: &curve, unit_secs: 1.0 };
        check.holds(|place| {
            let time = match place.role {
                Role::Corner => corner - check.point(place.corner).ahead,
                Role::Before => before,
                Role::After => after,
            };
            Sample { outcome: Outcome::flipped(time), end: End { time, ..END } }
        })
    }

    #[test]
    fn a_corner_that_flips_at_another_time_contradicts_its_line() {
        assert!(holds(7.0, 7.0001, 6.9999));
        assert!(!holds(7.002, 7.0001, 6.9999));
    }

    #[test]
    fn a_steep_line_is_checked_too() {
        // 10 ms over a five-thousandth of the line.
        assert!(holds(7.0, 7.005, 6.995));
        assert!(!holds(7.04, 7.005, 6.995));
        assert!(!holds(9.0, 7.005, 6.995));
    }

    #[test]
    fn a_line_that_jumps_at_its_corners_is_not_confirmed() {
        assert!(!holds(7.0, 7.1, 6.9));
        assert!(!holds(9.0, 7.1, 6.9));
    }
}
