//! The outcomes of pixels that are known before any step is taken.

use super::Grid;
use flipmap_numbers::{Dd, Exact, Scalar};
use flipmap_pendulum::first_moments::{FirstMoments, FirstPass};
use flipmap_pendulum::opening::from_top;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::{Launch, Outcome, Rule, State, Status, oracle};

/// The outcome of a pixel if it is known before any step is taken, or else its start.
#[derive(Clone, Debug, PartialEq)]
pub enum Fate {
    /// The whole outcome is known: energy conservation forbids the flip, the pendulum stays
    /// balanced, or it passes the top in its first moments.
    Known(Outcome),
    /// The pixel has to be simulated from these angles, in [−π, π] (rad), at rest.
    Open([Dd; 2]),
    /// The pixel has to be simulated from this start, with its speeds.
    Thrown(Launch),
    /// The pixel has to be simulated from the end of its first moments.
    BesideTop(Box<FirstMoments>),
}

impl Grid {
    /// Returns what is known of a pixel's outcome before any step is taken.
    pub fn fate(&self, column: u32, row: u32) -> Fate {
        let forbidden = Fate::Known(Outcome::without_time(Status::Forbidden));
        let Some(launch) = self.launch(column, row) else { return forbidden };
        if self.rule != Rule::Neither && self.is_forbidden(&launch, column, row) {
            return forbidden;
        }
        if let Some(moments) = self.first_moments(&launch, column, row) {
            return self.fate_beside_top(moments, column, row);
        }
        if self.rule != Rule::Neither && launch.is_at_rest() && oracle::is_balanced(launch.angle) {
            return Fate::Known(Outcome::without_time(Status::Unflipped));
        }
        if self.plane.is_at_rest { Fate::Open(launch.angle) } else { Fate::Thrown(launch) }
    }

    /// Returns true if this start is so near the top that its first moments must be computed
    /// separately.
    fn concerns_opening(&self, launch: &Launch) -> bool {
        let unit_secs = self.reduced.1.to_f64();
        let speed = launch.speed.map(|speed| speed.hi * unit_secs);
        self.opening.concerns(launch.angle.map(|angle| from_top(angle).hi), speed)
    }

    /// Computes the first moments of a pixel whose start is near the top, and returns `None` for
    /// any other start.
    fn first_moments(&self, launch: &Launch, column: u32, row: u32) -> Option<FirstMoments> {
        if !self.concerns_opening(launch) {
            return None;
        }
        Some(self.opening.first_moments(&self.exact_reduced(column, row)?))
    }

    /// Returns the fate of a pixel that starts near the top.
    fn fate_beside_top(&self, moments: FirstMoments, column: u32, row: u32) -> Fate {
        if let Some(pass) = moments.passes.get(self.passes as usize - 1)
            && self.rule != Rule::Neither
        {
            return Fate::Known(self.outcome_of(pass));
        }
        let is_balanced = |start: State<Exact>| oracle::is_balanced(start.angle);
        if self.rule != Rule::Neither
            && moments.is_at_rest()
            && self.exact_start(column, row).is_some_and(is_balanced)
        {
            return Fate::Known(Outcome::without_time(Status::Unflipped));
        }
        match (moments.is_plain(), self.plane.is_at_rest) {
            (true, true) => Fate::Open(moments.angle),
            (true, false) => Fate::Thrown(moments.launch(self.reduced.1.to_dd())),
            (false, _) => Fate::BesideTop(Box::new(moments)),
        }
    }

    /// Returns the outcome of a pass in the first moments.
    fn outcome_of(&self, pass: &FirstPass) -> Outcome {
        let secs = pass.time.hi * self.reduced.1.to_f64();
        if secs <= self.budget_secs {
            Outcome::flipped(secs)
        } else {
            Outcome::without_time(Status::Unflipped)
        }
    }

    /// Returns the pass over the top that ends the simulation if it falls in the pixel's first
    /// moments, together with these moments.
    fn first_pass(&self, column: u32, row: u32) -> Option<(FirstPass, FirstMoments)> {
        if self.rule == Rule::Neither {
            return None;
        }
        let moments = self.first_moments(&self.launch(column, row)?, column, row)?;
        Some((*moments.passes.get(self.passes as usize - 1)?, moments))
    }

    /// Returns the outcome of a pixel that passes the top in its first moments or stays balanced
    /// there, and `None` for any other pixel.
    pub fn outcome_beside_top(&self, column: u32, row: u32) -> Option<Outcome> {
        if self.rule == Rule::Neither {
            return None;
        }
        let moments = self.first_moments(&self.launch(column, row)?, column, row)?;
        match self.fate_beside_top(moments, column, row) {
            Fate::Known(outcome) => Some(outcome),
            _ => None,
        }
    }

    /// Returns true if a pixel starts so near the top that its first moments are computed
    /// separately.
    pub fn is_beside_top(&self, column: u32, row: u32) -> bool {
        self.launch(column, row).is_some_and(|launch| self.concerns_opening(&launch))
    }

    /// Returns the unit vectors and momenta (reduced) of a pixel as it passes the top in its first
    /// moments.
    pub fn phase_at_first_pass(&self, column: u32, row: u32) -> Option<Phase<f64>> {
        let (pass, moments) = self.first_pass(column, row)?;
        Some(moments.phase_at(&pass, &self.reduced.0.to_f64()))
    }
}
