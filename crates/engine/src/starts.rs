//! The states in which the pendulums of a job begin.

use rayon::prelude::*;

use super::pace::Pace;
use super::start::phase_at;
use super::{EventSpec, IntegratorState};
use flipmap_numbers::Dd;
use flipmap_pendulum::Launch;
use flipmap_pendulum::first_moments::FirstMoments;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::tangents::TangentMap;
use flipmap_scene::ExactPlane;
use flipmap_scene::lattice::Cell;

/// The states in which the pendulums of a job begin.
#[derive(Clone, Debug, PartialEq)]
pub enum Starts {
    /// Released from rest at these angles (rad), each within (−π, π].
    Rest(Vec<[Dd; 2]>),
    /// Released from rest at angles that many starts share.
    Upright(Separable),
    /// Thrown from angles (rad, each within (−π, π]) with speeds (rad/s).
    Thrown(Vec<Launch>),
    /// Launches mixed with starts beside the top, which are integrated from the end of their first
    /// moments.
    Mixed {
        /// The starts.
        starts: Vec<Onset>,
        /// True if their plane has speeds.
        thrown: bool,
    },
    /// Resumed from the states in which an earlier job left them; its question may differ in the
    /// budget only.
    Resumed {
        /// Their states.
        states: Vec<IntegratorState>,
        /// True if they were thrown, not released from rest.
        thrown: bool,
    },
    /// Already in motion: the continuations of those [`Starts::Deep`] that start maps do not
    /// settle.
    Moving(MovingStarts),
    /// Starts at places too close together for the number types of engines; only
    /// [`super::depth::DepthEngine`] can begin them.
    Deep(Deep),
}

/// The point at which the integration of a pendulum begins.
#[derive(Clone, Debug, PartialEq)]
pub enum Onset {
    /// The launch, at rest or with speeds.
    Launch(Launch),
    /// The end of the first moments after a launch beside the top.
    BesideTop(Box<FirstMoments>),
}

/// Starts of one plane, gathered in order.
#[derive(Clone, Debug, Default)]
pub struct StartList {
    /// Starts from rest, as long as there are no others.
    at_rest: Vec<[Dd; 2]>,
    others: Vec<Onset>,
    thrown: bool,
    beside_top: bool,
}

/// Starts from rest of an upright picture, each at the angles of its column and of its row.
#[derive(Clone, Debug, PartialEq)]
pub struct Separable {
    /// Angles of the columns and of the rows (rad, within (−π, π]).
    pub angles: [Vec<Dd>; 2],
    /// The place of each start: its column, and its row times the number of columns.
    pub places: Vec<u32>,
}

impl Separable {
    /// The angles of each start in rad.
    pub(crate) fn listed(&self) -> Vec<[Dd; 2]> {
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
    /// True if, as a check, they are followed with other cuts and smaller errors than usual.
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
    /// Reduced time at which the budget ends, if the tolerance may depend on how soon that is.
    /// `None` if answers are checked, because the expected errors assume a tolerance that rises
    /// from `since` on.
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
    /// Clearance so far, see [`super::FinalState::clearance`].
    pub clearance: f64,
    /// Growth so far, see [`super::FinalState::grown`].
    pub grown: f64,
    /// Error of the start map, see [`super::FinalState::map_error`].
    pub map_error: f64,
    /// Whole turns of each bob so far.
    pub turns: [i32; 2],
    /// Tangent map so far, where growth is requested.
    pub nudges: Option<Box<TangentMap>>,
}

impl Onset {
    /// Both angles of the launch, rad.
    pub(crate) fn angle(&self) -> [Dd; 2] {
        match self {
            Onset::Launch(launch) => launch.angle,
            Onset::BesideTop(moments) => moments.angle,
        }
    }

    /// The launch, to the precision of double-double.
    fn launch(&self, unit_secs: f64) -> Launch {
        match self {
            Onset::Launch(launch) => *launch,
            Onset::BesideTop(moments) => moments.launch(Dd::new(unit_secs)),
        }
    }

    /// Returns the same start with both angles moved by `by` (rad).
    #[must_use]
    pub(crate) fn moved_by(&self, by: [f64; 2]) -> Self {
        match self {
            Onset::Launch(launch) => Onset::Launch(launch.moved_by(by.map(Dd::new))),
            Onset::BesideTop(moments) => Onset::BesideTop(Box::new(moments.moved_by(by))),
        }
    }
}

impl StartList {
    /// Returns true if the list has no starts.
    pub fn is_empty(&self) -> bool {
        self.at_rest.is_empty() && self.others.is_empty()
    }

    /// Adds a start from rest, angles in rad.
    pub fn push_at_rest(&mut self, angle: [Dd; 2]) {
        if self.others.is_empty() {
            self.at_rest.push(angle);
        } else {
            self.others.push(Onset::Launch(Launch::at_rest(angle)));
        }
    }

    /// Adds a start on a plane with speeds.
    pub fn push_thrown(&mut self, launch: Launch) {
        self.thrown = true;
        self.others.push(Onset::Launch(launch));
    }

    /// Adds a start beside the top.
    pub fn push_beside_top(&mut self, moments: Box<FirstMoments>) {
        self.thrown |= !moments.is_at_rest();
        self.beside_top = true;
        self.list_others();
        self.others.push(Onset::BesideTop(moments));
    }

    /// Moves the starts from rest to the end of the others.
    fn list_others(&mut self) {
        let angles = std::mem::take(&mut self.at_rest);
        self.others.extend(angles.into_iter().map(|angle| Onset::Launch(Launch::at_rest(angle))));
    }

    /// Adds the starts of another list after those of this one.
    pub fn append(&mut self, mut more: StartList) {
        if self.others.is_empty() && more.others.is_empty() {
            return self.at_rest.append(&mut more.at_rest);
        }
        self.list_others();
        more.list_others();
        self.others.append(&mut more.others);
        self.thrown |= more.thrown;
        self.beside_top |= more.beside_top;
    }

    /// The starts.
    pub fn into_starts(self) -> Starts {
        let StartList { at_rest, others, thrown, beside_top } = self;
        if others.is_empty() {
            return Starts::Rest(at_rest);
        }
        if beside_top {
            return Starts::Mixed { starts: others, thrown };
        }
        // The unit of time matters only to starts beside the top, and there are none.
        Starts::Thrown(others.into_iter().map(|start| start.launch(1.0)).collect())
    }
}

impl Starts {
    /// Number of pendulums.
    pub fn len(&self) -> usize {
        match self {
            Starts::Rest(angles) => angles.len(),
            Starts::Upright(upright) => upright.places.len(),
            Starts::Thrown(launches) => launches.len(),
            Starts::Mixed { starts, .. } => starts.len(),
            Starts::Resumed { states, .. } => states.len(),
            Starts::Moving(moving) => moving.states.len(),
            Starts::Deep(deep) => deep.leaves.iter().map(|leaf| leaf.points.len()).sum(),
        }
    }

    /// Returns the same starts, with [`Starts::Upright`] expanded to the angles of each start.
    pub fn listed(self) -> Self {
        match self {
            Starts::Upright(upright) => Starts::Rest(upright.listed()),
            other => other,
        }
    }

    /// Returns true if the pendulums had speeds when they set out.
    pub fn are_thrown(&self) -> bool {
        match self {
            Starts::Thrown(_) => true,
            Starts::Mixed { thrown, .. } | Starts::Resumed { thrown, .. } => *thrown,
            _ => false,
        }
    }

    /// Returns true if there are no pendulums.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Share by which the energy of a pendulum in motion may lie above that of the highest release from
/// rest before it counts as thrown: errors of coarse steps change the energy, too.
const ABOVE_REST: f64 = 0.05;

/// Returns the greatest reduced angular velocity of starts that may move faster than after any
/// release from rest, or `None` if there are no such starts. Starts that come from cells are
/// recognised by their energy.
pub(super) fn fastest(question: &EventSpec, pace: &Pace, starts: &Starts) -> Option<f64> {
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
        Starts::Mixed { starts, thrown: true } => {
            let speeds = |start: &Onset| start.launch(unit_secs).speed.map(|w| w.hi * unit_secs);
            Some(starts.iter().map(speeds).map(greatest).fold(0.0, f64::max))
        }
        Starts::Resumed { states, thrown: true } => {
            let speeds = |state| reduced.speeds(&phase_at(&reduced, pace, state));
            Some(states.iter().map(speeds).map(greatest).fold(0.0, f64::max))
        }
        Starts::Moving(moving) => {
            moving.states.iter().filter_map(|moving| thrown(moving.phase)).reduce(f64::max)
        }
        Starts::Rest(_)
        | Starts::Upright(_)
        | Starts::Mixed { .. }
        | Starts::Resumed { .. }
        | Starts::Deep(_) => None,
    }
}
