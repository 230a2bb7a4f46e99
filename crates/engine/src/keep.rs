//! The states that a job returns along with its outcomes.

use super::{EngineError, IntegratorConfig, Method, Precision};
use flipmap_scene::question::Needs;

/// A selection of the pendulums' states that a job returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Keep {
    /// What the job returns of all pendulums beside their outcomes: their ends (see
    /// [`super::FinalState`]), and what they gathered.
    pub ends: Needs,
    /// True if the job returns the states of pendulums that have not flipped by the end of the
    /// budget, so that they can be continued.
    pub states: bool,
}

impl Keep {
    /// Neither ends nor states.
    pub const NOTHING: Keep = Keep { ends: Needs::Outcome, states: false };
    /// The states of pendulums unflipped at the end of the budget.
    pub const STATES: Keep = Keep { ends: Needs::Outcome, states: true };
    /// The end of each pendulum.
    pub const ENDS: Keep = Keep { ends: Needs::End, states: false };

    /// Returns an error if an integrator config cannot compute what is kept.
    pub fn check(self, config: &IntegratorConfig) -> Result<(), EngineError> {
        if self.states && self.ends.are_carried() && config.precision == Precision::Dd {
            // Carried quantities are kept in f64.
            let why = "what a question gathers along the way in dd cannot be resumed, so it cannot be saved";
            return Err(EngineError::Unsupported(why.to_string()));
        }
        config.check_needs(self.ends)
    }
}

impl IntegratorConfig {
    /// Returns an error if no pendulum can gather what is needed by this method and precision.
    pub fn check_needs(&self, needs: Needs) -> Result<(), EngineError> {
        match self.method {
            Method::Embedded { pair, .. }
                if needs == Needs::Growth
                    && self.precision == Precision::Df32
                    && !pair.data().carries_tangents_in_df32 =>
            {
                let why = "growth in df32 is computed by the method dopri5";
                Err(EngineError::Unsupported(why.to_string()))
            }
            Method::Rk4 { .. }
            | Method::Embedded { .. }
            | Method::Taylor { .. }
            | Method::Extrapolation { .. } => Ok(()),
        }
    }
}
