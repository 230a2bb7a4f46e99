//! The states in which the pendulums of a job begin.

use rayon::prelude::*;

use super::pace::Pace;
use super::start::phase_at;
use super::{IntegratorState, Question};
use crate::physics::phase::Phase;
use crate::physics::tangents::TangentMap;
use crate::physics::{Dd, Launch};
use crate::scene::ExactPlane;
use crate::scene::lattice::Cell;

/// The states in which the pendulums of a job begin.
#[derive(Clone, Debug, PartialEq)]
pub enum Starts {
    /// Released from rest at these angles (rad), each within (−π, π].
    Rest(Vec<[Dd; 2]>),
    /// Released from rest at angles that many starts share.
    Upright(Upright),
    /// Thrown from angles (rad, each within (−π, π]) with speeds (rad/s).
    Thrown(Vec<Launch>),
    /// Resumed from the states in which an earlier job left them; its question may differ in the
    /// budget only.
    Resumed {
        /// Their states.
        states: Vec<IntegratorState>,
        /// True if they were thrown, not released from rest.
        thrown: bool,
    },
    /// Already in motion: the continuation of those [`Starts::Deep`] that start maps do not settle.
    Moving(MovingStarts),
    /// Starts at places too close together for the number types of engines; only
    /// [`super::depth::DepthEngine`] can begin them.
    Deep(Deep),
}

/// Starts from rest of an upright picture, each at the angles of its column and of its row.
#[derive(Clone, Debug, PartialEq)]
pub struct Upright {
    /// Angles of the columns and of the rows (rad, within (−π, π]).
    pub angles: [Vec<Dd>; 2],
    /// The place of each start: its column, and its row times the number of columns.
    pub places: Vec<u32>,
}

impl Upright {
    /// The angles of each start in rad.
    pub fn listed(&self) -> Vec<[Dd; 2]> {
        let [columns, rows] = &self.angles;
        let angle = |&place: &u32| {
            let place = place as usize;
            [columns[place % columns.len()], rows[place / columns.len()]]
        };
        self.places.par_iter().map(angle).collect()
    }
}

/// Starts grouped by the leaves of the lattice in which they lie.
#[derive(Clone, Debug, PartialEq)]
pub struct Deep {
    /// The leaves, all of one level.
    pub leaves: Vec<Leaf>,
    /// The plane in which they lie.
    pub plane: Box<ExactPlane>,
    /// True if they are followed with other cuts than usual and smaller errors, as a check.
    pub strict: bool,
}

/// Starts in one cell of the lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// The cell of the lattice.
    pub cell: Cell,
    /// Positions in the cell, in [−1, 1]²: along the plane's first axis, and its second.
    pub points: Vec<[f64; 2]>,
}

/// Pendulums that set out at about the same time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovingStarts {
    /// Reduced time at which their tolerance begins to rise.
    pub since: f64,
    /// Reduced time at which the budget ends, if the tolerance may depend on how soon that is:
    /// unless answers are checked, whose expected errors are those of a tolerance from `since` on.
    pub end: Option<f64>,
    /// Their states.
    pub states: Vec<Moving>,
}

/// A pendulum in motion, in reduced units.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving {
    /// Time since the release, and the remainder that rounding took from it.
    pub time: [f64; 2],
    /// Unit vectors along the rods, and momenta.
    pub phase: Phase<f64>,
    /// Length of the first step to try, short enough to be safe.
    pub step: f64,
    /// Clearance so far, see [`super::End::clearance`].
    pub clearance: f64,
    /// Growth so far, see [`super::End::grown`].
    pub grown: f64,
    /// Whole turns of each bob so far.
    pub turns: [i32; 2],
    /// Tangent map so far, where growth is requested.
    pub nudges: Option<Box<TangentMap>>,
}

impl Starts {
    /// Number of pendulums.
    pub fn len(&self) -> usize {
        match self {
            Starts::Rest(angles) => angles.len(),
            Starts::Upright(upright) => upright.places.len(),
            Starts::Thrown(launches) => launches.len(),
            Starts::Resumed { states, .. } => states.len(),
            Starts::Moving(moving) => moving.states.len(),
            Starts::Deep(deep) => deep.leaves.iter().map(|leaf| leaf.points.len()).sum(),
        }
    }

    /// The same starts, with the angles of each one that is released from rest.
    pub fn listed(self) -> Self {
        match self {
            Starts::Upright(upright) => Starts::Rest(upright.listed()),
            other => other,
        }
    }

    /// Returns true if the pendulums had speeds when they set out.
    pub fn are_thrown(&self) -> bool {
        matches!(self, Starts::Thrown(_) | Starts::Resumed { thrown: true, .. })
    }

    /// Returns true if there are no pendulums.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Share by which the energy of a pendulum in motion may lie above that of the highest release from
/// rest before it counts as thrown: errors of coarse steps change the energy, too.
const ABOVE_REST: f64 = 0.05;

/// The greatest reduced angular velocity of starts that may move faster than after any release from
/// rest; none where no start does. Those that come from cells are known by their energy.
pub(super) fn fastest(question: &Question, pace: &Pace, starts: &Starts) -> Option<f64> {
    let (reduced, unit_secs) = question.reduced();
    let greatest = |speed: [f64; 2]| speed[0].abs().max(speed[1].abs());
    let highest = (1.0 + ABOVE_REST) * (reduced.p + reduced.q);
    let thrown = |phase: Phase<f64>| {
        (reduced.energy_of(&phase) > highest).then(|| greatest(reduced.speeds(&phase)))
    };
    match starts {
        Starts::Thrown(launches) => {
            let speeds = launches.iter().map(|launch| launch.speed.map(|w| w.hi * unit_secs));
            Some(speeds.map(greatest).fold(0.0, f64::max))
        }
        Starts::Resumed { states, thrown: true } => {
            let speeds = |state| reduced.speeds(&phase_at(&reduced, pace, state));
            Some(states.iter().map(speeds).map(greatest).fold(0.0, f64::max))
        }
        Starts::Moving(moving) => {
            moving.states.iter().filter_map(|moving| thrown(moving.phase)).reduce(f64::max)
        }
        Starts::Rest(_) | Starts::Upright(_) | Starts::Resumed { .. } | Starts::Deep(_) => None,
    }
}
