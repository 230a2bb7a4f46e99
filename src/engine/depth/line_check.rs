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
//! Where the line itself changes that quickly, the corner proves nothing.

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
/// Distance of the ends before and after a corner's place below which the line is steady there.
const NEAR: f64 = 0.01;
/// Distance of a corner's end from the line's where that is steady, above which the two differ.
const FAR: f64 = 0.1;

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

    /// Returns true unless a corner contradicts the line; `sample` returns the end of a pendulum of
    /// the check.
    pub(super) fn holds(&self, sample: impl Fn(CheckPlace) -> Sample) -> bool {
        (0..CORNERS.len()).all(|corner| {
            let ends = Role::ALL.map(|role| sample(CheckPlace { corner, role }));
            self.agree(self.point(corner), ends)
        })
    }

    /// Returns true if the start at a corner ends as its place on the line does, or if the line
    /// changes too quickly there for a comparison.
    fn agree(&self, point: CurvePoint, [off, before, after]: [Sample; 3]) -> bool {
        let most_secs = SHARE * right_secs(self.unit_secs);
        let [late, early] = [after.outcome.time, before.outcome.time];
        if before.distance(&after) > NEAR || (late - early).abs() > most_secs {
            return true;
        }
        let expected_secs = match before.outcome.status {
            Status::Flipped => 0.5 * (early + late) - point.ahead * self.unit_secs,
            _ => 0.0,
        };
        off.distance(&before) <= FAR && (off.outcome.time - expected_secs).abs() <= most_secs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::End;
    use crate::physics::flip::Rule;
    use crate::physics::{Outcome, Pendulum};

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
            Sample { outcome: Outcome::flipped(time), end: End::NOWHERE }
        })
    }

    #[test]
    fn a_corner_that_flips_at_another_time_contradicts_its_line() {
        assert!(holds(7.0, 7.0001, 6.9999));
        assert!(!holds(7.002, 7.0001, 6.9999));
        // A line that changes that quickly says nothing about its corners.
        assert!(holds(9.0, 7.1, 6.9));
    }
}
