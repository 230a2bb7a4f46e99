//! Checks of lines: some starts at the edges of a patch, which lie as far from its line as any,
//! are integrated in full and have to flip at the times that the line gives.
//!
//! ```text
//!   ┌─────────────┐
//!   │ ○         ○ │    ○  start at an edge, integrated from its own state
//!   │─────────────│ s  ─  line; integrated at that start's s, and a little after it
//!   │ ○         ○ │
//!   └─────────────┘
//! ```
//!
//! The steeper the line, the more a start's residual shifts its flip, and the greater the
//! difference that is allowed. Where the line jumps, a start proves nothing, and others are
//! integrated. A line that jumps at nearly all of these starts is not used.

use super::line_interval::Sample;
use flipmap_pendulum::Status;
use flipmap_pendulum::flip::right_secs;
use flipmap_pendulum::flow_patch::{CurvePoint, Dynamics, FlowPatch, PatchCurve};
use flipmap_pendulum::phase::Phase;

/// The starts of each round of a check, in coordinates of the patch. A round is needed only if the
/// rounds before it have not decided.
const EDGES: [[[f64; 2]; 4]; ROUNDS] = [
    [[-0.6, -0.9], [-0.6, 0.9], [0.6, -0.9], [0.6, 0.9]],
    [[-0.35, -0.9], [-0.1, 0.9], [0.15, -0.9], [0.4, 0.9]],
    [[-0.8, -0.9], [-0.45, 0.9], [0.5, -0.9], [0.75, 0.9]],
];
/// Largest number of rounds.
const ROUNDS: usize = 3;
/// Distance along the line from a start's place to the place after it.
const BESIDE: f64 = 1e-4;
/// Largest difference between a start and its line, as a share of the largest error of a right
/// answer.
const SHARE: f64 = 0.5;
/// Distance between the ends at a start's place and just after it, above which the line is taken to
/// jump there.
const JUMP: f64 = 0.05;
/// Distance of a start's end from the line's end, beyond the effect of its residual, above which
/// the two contradict each other.
const FAR: f64 = 0.1;
/// Ratio of the largest effect of a residual to that of an equal distance along the line (2.5 was
/// measured). Starts whose residual could matter are integrated alone, so it adds no error.
const RESIDUAL: f64 = 4.0;
/// Least number of starts that have to confirm a line.
const MIN_CONFIRMATIONS: usize = 2;

/// A pendulum of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct CheckPlace {
    round: usize,
    start: usize,
    role: Role,
}

/// The part that a pendulum has in a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Role {
    /// The start at the edge.
    Edge,
    /// The start on the line at the same place.
    Line,
    /// The start on the line, a little further along.
    After,
}

impl Role {
    const ALL: [Role; 3] = [Role::Edge, Role::Line, Role::After];
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
    /// All pendulums of one round.
    fn of_round(round: usize) -> impl Iterator<Item = CheckPlace> {
        let of_start = move |start| Role::ALL.map(|role| CheckPlace { round, start, role });
        (0..EDGES[round].len()).flat_map(of_start)
    }
}

/// The result of checking a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum LineVerdict {
    /// Enough starts confirm it.
    Confirmed,
    /// A start contradicts it, or too few prove anything.
    Refused,
    /// No result yet, because these pendulums are missing.
    Missing(Vec<CheckPlace>),
}

impl LineCheck<'_> {
    fn edge(&self, place: CheckPlace) -> Phase<f64> {
        self.patch.phase.map(|jet| jet.at(EDGES[place.round][place.start]))
    }

    /// Returns the point on the line that belongs to a check's start. If there is none, returns the
    /// middle of the line, so that the comparison fails.
    fn point(&self, place: CheckPlace) -> CurvePoint {
        let nowhere = CurvePoint { s: 0.0, ahead: 0.0, aside: 0.0 };
        self.curve.point(self.dynamics, &self.edge(place)).unwrap_or(nowhere)
    }

    /// The state in which a pendulum of the check begins.
    pub(super) fn state(&self, place: CheckPlace) -> Phase<f64> {
        match place.role {
            Role::Edge => self.edge(place),
            Role::Line => self.curve.at(self.point(place).s),
            Role::After => self.curve.at(self.point(place).s + BESIDE),
        }
    }

    /// Judges the line round by round; `sample` returns the end of a pendulum of the check, if it
    /// is known.
    pub(super) fn verdict(&self, sample: impl Fn(CheckPlace) -> Option<Sample>) -> LineVerdict {
        let mut confirming = 0;
        for (round, starts) in EDGES.iter().enumerate() {
            let missing: Vec<CheckPlace> =
                CheckPlace::of_round(round).filter(|place| sample(*place).is_none()).collect();
            if !missing.is_empty() {
                return LineVerdict::Missing(missing);
            }
            for start in 0..starts.len() {
                let places = Role::ALL.map(|role| CheckPlace { round, start, role });
                let ends = places.map(|place| sample(place).expect("none is missing"));
                match self.confirms(self.point(places[0]), ends) {
                    Some(true) => confirming += 1,
                    Some(false) => return LineVerdict::Refused,
                    None => {}
                }
            }
            if confirming >= MIN_CONFIRMATIONS {
                return LineVerdict::Confirmed;
            }
        }
        LineVerdict::Refused
    }

    /// Returns true if a start at an edge ends as its place on the line does, up to the effect of
    /// its residual; `None` if the line jumps there.
    fn confirms(&self, point: CurvePoint, [off, line, after]: [Sample; 3]) -> Option<bool> {
        let apart = line.distance(&after);
        if apart.is_nan() || apart > JUMP {
            return None;
        }
        let expected_secs = match line.outcome.status {
            Status::Answered => line.outcome.time - point.ahead * self.unit_secs,
            _ => 0.0,
        };
        let residual = RESIDUAL * point.aside / BESIDE;
        let steep_secs = (after.outcome.time - line.outcome.time).abs();
        let max_secs = SHARE * right_secs(self.unit_secs) + residual * steep_secs;
        let is_near = off.distance(&line) <= FAR + residual * apart;
        Some(is_near && (off.outcome.time - expected_secs).abs() <= max_secs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FinalState;
    use flipmap_pendulum::flip::Rule;
    use flipmap_pendulum::{Outcome, Pendulum};

    const END: FinalState = FinalState { phase: [1.0; 6], ..FinalState::NOWHERE };

    /// Judges the line of a small cell in which starts at edges, on the line and a little after
    /// them flip at the times (s) that `secs` returns for a round.
    fn verdict(secs: impl Fn(usize) -> [f64; 3]) -> LineVerdict {
        let dynamics = Dynamics::new(Pendulum::points([1.0; 2], [1.0; 2], 9.81), Rule::Second);
        let mut patch = FlowPatch::release(&dynamics, [-1.6601f64, 0.1003].map(f64::sin_cos), 1e-8);
        patch.follow(&dynamics, 90.0, 1e-12, None);
        let curve = patch.curve(&dynamics, 1e-4).expect("one direction has grown");
        let check = LineCheck { dynamics: &dynamics, patch: &patch, curve: &curve, unit_secs: 1.0 };
        check.verdict(|place| {
            let [edge, line, after] = secs(place.round);
            let time = match place.role {
                Role::Edge => edge - check.point(place).ahead,
                Role::Line => line,
                Role::After => after,
            };
            Some(Sample { outcome: Outcome::flipped(time), end: FinalState { time, ..END } })
        })
    }

    fn holds(edge: f64, line: f64, after: f64) -> bool {
        verdict(|_| [edge, line, after]) == LineVerdict::Confirmed
    }

    #[test]
    fn a_start_that_flips_at_another_time_contradicts_its_line() {
        assert!(holds(7.0, 7.0, 6.9999));
        assert!(!holds(7.002, 7.0, 6.9999));
    }

    #[test]
    fn a_steep_line_is_checked_too() {
        // 5 ms over a ten-thousandth of the line.
        assert!(holds(7.0, 7.0, 6.995));
        assert!(!holds(7.04, 7.0, 6.995));
        assert!(!holds(9.0, 7.0, 6.995));
    }

    #[test]
    fn a_line_that_jumps_everywhere_is_not_confirmed() {
        assert!(!holds(7.0, 7.0, 6.9));
        assert!(!holds(9.0, 7.0, 6.9));
    }

    #[test]
    fn where_a_line_jumps_other_starts_decide() {
        let smooth = [7.0, 7.0, 6.9999];
        let later = |first: [f64; 3], then: [f64; 3]| {
            verdict(|round| if round == 0 { first } else { then })
        };
        assert_eq!(later([7.0, 7.0, 6.9], smooth), LineVerdict::Confirmed);
        assert_eq!(later([7.0, 7.0, 6.9], [7.002, 7.0, 6.9999]), LineVerdict::Refused);
        // Other starts do not save a line that the first starts contradict.
        assert_eq!(later([7.002, 7.0, 6.9999], smooth), LineVerdict::Refused);
    }
}
