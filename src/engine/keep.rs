//! The states that a job returns along with its outcomes.

#[cfg(doc)]
use super::End;
use super::{EngineError, IntegratorConfig, Method, Precision};
use crate::question::Needs;

/// A selection of the pendulums' states that a job returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Keep {
    /// The ends of all pendulums.
    pub ends: Ends,
    /// True for the states of pendulums unflipped at the end of the budget, so that they can be
    /// continued.
    pub states: bool,
}

/// The ends of pendulums (see [`End`]) that a job returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ends {
    /// No ends.
    #[default]
    None,
    /// Plain ends, so that answers can be compared.
    Plain,
    /// Ends with the growth of nudges, for which tangents are carried along.
    Growth,
    /// Ends with the nearest return to the start.
    Return,
}

impl Keep {
    /// No states.
    pub const NOTHING: Keep = Keep { ends: Ends::None, states: false };
    /// The states of pendulums unflipped at the end of the budget.
    pub const STATES: Keep = Keep { ends: Ends::None, states: true };
    /// The end of each pendulum.
    pub const ENDS: Keep = Keep { ends: Ends::Plain, states: false };
}

impl Ends {
    /// Returns true if pendulums take numbers along for them (see [`super::Carried`]).
    pub fn are_carried(self) -> bool {
        matches!(self, Ends::Growth | Ends::Return)
    }

    /// Returns an error if an integrator config cannot compute them.
    pub fn check(self, config: &IntegratorConfig) -> Result<(), EngineError> {
        let IntegratorConfig { method, precision } = config;
        let is_pair = matches!(method, Method::Dopri5 { .. } | Method::Dop853 { .. });
        let has_tangents = is_pair || matches!(method, Method::Rk4 { .. });
        let is_plain = matches!(precision, Precision::F32 | Precision::F64);
        let why = match self {
            Ends::Growth if !has_tangents || !is_plain => {
                "growth is computed by --method rk4, dopri5 or dop853 in f32 or f64"
            }
            Ends::Return if !is_pair || *precision != Precision::F64 => {
                "returns are found by --method dopri5 or dop853 in f64: use --accuracy balanced"
            }
            _ => return Ok(()),
        };
        Err(EngineError::Unsupported(why.to_string()))
    }
}

impl From<Needs> for Ends {
    fn from(needs: Needs) -> Ends {
        match needs {
            Needs::Outcome => Ends::None,
            Needs::End => Ends::Plain,
            Needs::Growth => Ends::Growth,
            Needs::Return => Ends::Return,
        }
    }
}
