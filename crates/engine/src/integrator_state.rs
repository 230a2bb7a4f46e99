//! States of pendulums between two jobs.

use serde::{Deserialize, Serialize};

use flipmap_pendulum::Accumulators;
use flipmap_pendulum::phase::Phase;
use flipmap_scene::question::Needs;

/// Largest number of values in a pendulum's state (see [`super::start`]).
pub const NUMBERS: usize = 15;

/// An unfinished pendulum between two jobs, exactly as the kernel left it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IntegratorState {
    /// Number of steps taken; for adaptive methods, of steps tried.
    pub steps: u32,
    /// The state in the kernel's units and in the order that [`super::start`] gives; exact for
    /// every precision.
    pub numbers: [f64; NUMBERS],
    /// Quantities that the pendulum carries along with its state, if the question needs any.
    pub carried: Option<Box<Carried>>,
}

/// Quantities that a pendulum carries along with its state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Carried {
    /// Turns and passes counted since the release.
    Counts(Accumulators),
    /// The search for an extreme.
    Extremum(Sought),
    /// Derivatives of unit vectors and momenta with respect to the four numbers of the start.
    Tangents {
        /// The derivatives, scaled down so that none overflows.
        slopes: [[f64; 4]; 6],
        /// Natural logarithm of the factor by which they were scaled down.
        log_scale: f64,
    },
}

/// The search for an extreme of a quantity along a motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sought {
    /// The start, in reduced units.
    pub start: Phase<f64>,
    /// True once an extreme counts.
    pub counts: bool,
    /// The extreme so far, and the reduced time at which it occurred.
    pub best: [f64; 2],
}

impl Sought {
    /// The search of a pendulum of which nothing is asked.
    const NOTHING: Sought =
        Sought { start: [0.0; 6], counts: false, best: Accumulators::NONE.extremum };
}

/// Names of the derivatives of unit vectors and momenta with respect to the four numbers of the
/// start.
pub(crate) const SLOPES: [[&str; 4]; 6] = [
    ["x1_a", "x1_b", "x1_c", "x1_d"],
    ["y1_a", "y1_b", "y1_c", "y1_d"],
    ["x2_a", "x2_b", "x2_c", "x2_d"],
    ["y2_a", "y2_b", "y2_c", "y2_d"],
    ["p1_a", "p1_b", "p1_c", "p1_d"],
    ["p2_a", "p2_b", "p2_c", "p2_d"],
];
/// Name of the logarithm of the factor by which slopes were scaled down.
pub(crate) const LOG_SCALE: &str = "log_scale";
/// Names of the unit vectors and momenta of the start.
pub(crate) const STARTS: [&str; 6] =
    ["x1_start", "y1_start", "x2_start", "y2_start", "p1_start", "p2_start"];
/// Names of the state of the search for an extreme: 1 once extremes count, the extreme so far, and
/// its time.
pub(crate) const SEARCH: [&str; 3] = ["counts", "best", "best_time"];

/// Largest number of values that a pendulum can carry along.
pub(crate) const MAX_CARRIED_NUMBERS: usize = 25;

/// Returns the names of the numbers that pendulums carry along for `ends`, in the order in which
/// devices keep them.
pub(crate) fn carried_names(ends: Needs) -> Vec<&'static str> {
    match ends {
        Needs::Outcome | Needs::End => Vec::new(),
        Needs::Growth => [SLOPES.as_flattened(), &[LOG_SCALE]].concat(),
        Needs::Extremum(_) => [&STARTS[..], &SEARCH].concat(),
    }
}

impl Carried {
    /// Returns the number at `place` in the order of [`carried_names`].
    fn number(&self, place: usize) -> f64 {
        match self {
            Carried::Counts(_) => 0.0,
            Carried::Tangents { slopes, log_scale } => {
                slopes.as_flattened().get(place).copied().unwrap_or(*log_scale)
            }
            Carried::Extremum(Sought { start, counts, best }) => match place {
                0..6 => start[place],
                6 => f64::from(u8::from(*counts)),
                _ => best[place - 7],
            },
        }
    }

    /// Reads the quantities from their numbers; returns `None` if pendulums carry none along for
    /// `ends`.
    fn from_numbers(ends: Needs, numbers: &[f64]) -> Option<Self> {
        match ends {
            Needs::Outcome | Needs::End => None,
            Needs::Growth => {
                let (slopes, rest) = numbers.as_chunks::<4>();
                let slopes = slopes.try_into().ok()?;
                Some(Carried::Tangents { slopes, log_scale: *rest.first()? })
            }
            Needs::Extremum(_) => {
                let &[.., counts, value, time] = numbers else { return None };
                let start = numbers.get(..6)?.try_into().ok()?;
                let best = [value, time];
                Some(Carried::Extremum(Sought { start, counts: counts > 0.0, best }))
            }
        }
    }
}

impl IntegratorState {
    /// Creates a state from all its numbers: its own, then those that it carries along for `ends`.
    pub(crate) fn from_numbers(steps: u32, all: &[f64], ends: Needs) -> Self {
        let (own, carried) = all.split_at(NUMBERS);
        let mut numbers = [0.0; NUMBERS];
        numbers.copy_from_slice(own);
        let carried = Carried::from_numbers(ends, carried).map(Box::new);
        IntegratorState { steps, numbers, carried }
    }

    /// Returns the number at `place`: the state's own come first, then those that it carries along.
    pub(crate) fn number(&self, place: usize) -> f64 {
        let carried = || self.carried.as_deref().map(|carried| carried.number(place - NUMBERS));
        self.numbers.get(place).copied().or_else(carried).unwrap_or(0.0)
    }

    /// Creates a state that carries nothing along.
    pub fn new(steps: u32, numbers: [f64; NUMBERS]) -> Self {
        IntegratorState { steps, numbers, carried: None }
    }

    /// Returns the slopes that the state carries along, or zeros if it has no tangents.
    pub(crate) fn slopes(&self) -> [[f64; 4]; 6] {
        match self.carried.as_deref() {
            Some(Carried::Tangents { slopes, .. }) => *slopes,
            _ => [[0.0; 4]; 6],
        }
    }

    /// Natural logarithm of the factor by which the slopes were scaled down.
    pub(crate) fn log_scale(&self) -> f64 {
        match self.carried.as_deref() {
            Some(Carried::Tangents { log_scale, .. }) => *log_scale,
            _ => 0.0,
        }
    }

    /// The search for an extreme that the state carries along, or one that has found nothing.
    pub(crate) fn sought(&self) -> Sought {
        match self.carried.as_deref() {
            Some(Carried::Extremum(sought)) => *sought,
            _ => Sought::NOTHING,
        }
    }

    /// The turns and passes counted so far.
    pub(crate) fn counts(&self) -> Accumulators {
        match self.carried.as_deref() {
            Some(Carried::Counts(gathered)) => *gathered,
            _ => Accumulators::NONE,
        }
    }
}
