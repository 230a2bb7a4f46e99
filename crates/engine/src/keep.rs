//! The states that a job returns along with its outcomes.

#[cfg(doc)]
use super::FinalState;
use super::{EngineError, IntegratorConfig, Method, Precision};
use flipmap_pendulum::extremum::Extremum;
use flipmap_scene::question::Needs;

/// A selection of the pendulums' states that a job returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Keep {
    /// The ends of all pendulums.
    pub ends: WantedEnds,
    /// True if the job returns the states of pendulums that have not flipped by the end of the
    /// budget, so that they can be continued.
    pub states: bool,
}

/// The ends of pendulums (see [`FinalState`]) that a job returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WantedEnds {
    /// No ends.
    #[default]
    None,
    /// Ends without growth or an extreme.
    Plain,
    /// Ends with the growth of nudges, for which tangents are carried along.
    Growth,
    /// Ends with the extreme of a quantity along the motion.
    Extremum(Extremum),
}

impl Keep {
    /// Neither ends nor states.
    pub const NOTHING: Keep = Keep { ends: WantedEnds::None, states: false };
    /// The states of pendulums unflipped at the end of the budget.
    pub const STATES: Keep = Keep { ends: WantedEnds::None, states: true };
    /// The end of each pendulum.
    pub const ENDS: Keep = Keep { ends: WantedEnds::Plain, states: false };

    /// Returns an error if an integrator config cannot compute what is kept.
    pub fn check(self, config: &IntegratorConfig) -> Result<(), EngineError> {
        if self.states && self.ends.are_carried() && config.precision == Precision::Dd {
            // Carried quantities are kept in f64.
            let why = "what a question gathers along the way in dd cannot be resumed, so it cannot be saved";
            return Err(EngineError::Unsupported(why.to_string()));
        }
        self.ends.check(config)
    }
}

impl WantedEnds {
    /// Returns true if pendulums carry numbers along for these ends (see [`super::Carried`]).
    pub fn are_carried(self) -> bool {
        matches!(self, WantedEnds::Growth | WantedEnds::Extremum(_))
    }

    /// Returns true if extremes are looked for.
    pub fn are_extremes(self) -> bool {
        matches!(self, WantedEnds::Extremum(_))
    }

    /// Returns an error if an integrator config cannot compute these ends.
    pub fn check(self, config: &IntegratorConfig) -> Result<(), EngineError> {
        let refuse = |why: &str| Err(EngineError::Unsupported(why.to_string()));
        match config.method {
            Method::Extrapolation { .. } if self.are_extremes() => {
                refuse("extremes along the way are not computed by midpoint rules")
            }
            Method::Embedded { pair, .. }
                if self == WantedEnds::Growth
                    && config.precision == Precision::Df32
                    && !pair.data().carries_tangents_in_df32 =>
            {
                refuse("growth in df32 is computed by the method dopri5")
            }
            Method::Rk4 { .. }
            | Method::Embedded { .. }
            | Method::Taylor { .. }
            | Method::Extrapolation { .. } => Ok(()),
        }
    }
}

impl From<Needs> for WantedEnds {
    fn from(needs: Needs) -> WantedEnds {
        match needs {
            Needs::Outcome => WantedEnds::None,
            Needs::End => WantedEnds::Plain,
            Needs::Growth => WantedEnds::Growth,
            Needs::Extremum(extremum) => WantedEnds::Extremum(extremum),
        }
    }
}
