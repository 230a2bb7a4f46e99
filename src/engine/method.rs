//! Methods and precisions, and the numbers a method needs before a job can run.

use std::fmt;
use std::str::FromStr;

use super::{EngineError, IntegratorConfig, Question};
use crate::physics::control::Control;
use crate::physics::trig::Turning;
use crate::physics::{Outcome, Status, extrapolation, series};

/// How a pixel is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The classical Runge–Kutta method with a fixed step in seconds.
    Rk4 {
        /// Seconds.
        step_secs: f64,
    },
    /// Dormand and Prince's pair of orders 5 and 4: small coefficients, for f32.
    Dopri5 {
        /// Of one step just after the release; it rises from there (see `physics::control`).
        tolerance: f64,
    },
    /// Dormand and Prince's pair of order 8, for everything finer.
    Dop853 {
        /// The same.
        tolerance: f64,
    },
    /// Taylor expansions to the precision of the number type: the check, and the way to `dd`.
    Taylor {
        /// Of one step, whenever.
        tolerance: f64,
    },
    /// Extrapolated midpoint rules: what checks expansions in `dd`. Nobody asks for it by name.
    Extrapolation {
        /// Of one step, whenever, if the last of its rules were left out.
        tolerance: f64,
    },
}

impl Method {
    /// The lesson's: 120 steps a second.
    pub const LESSON: Method = Method::Rk4 { step_secs: 1.0 / 120.0 };

    /// Every method's word.
    pub const NAMES: [&str; 4] = ["rk4", "dopri5", "dop853", "taylor"];

    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Method::Rk4 { .. } => "rk4",
            Method::Dopri5 { .. } => "dopri5",
            Method::Dop853 { .. } => "dop853",
            Method::Taylor { .. } => "taylor",
            Method::Extrapolation { .. } => "extrapolation",
        }
    }

    /// Its step or tolerance as text, for people and files.
    pub fn setting(self) -> String {
        match self {
            Method::Rk4 { step_secs } => {
                let per_second = 1.0 / step_secs;
                if (per_second - per_second.round()).abs() < 1e-9 * per_second {
                    format!("step 1/{per_second:.0}")
                } else {
                    format!("step {step_secs}")
                }
            }
            Method::Dopri5 { tolerance }
            | Method::Dop853 { tolerance }
            | Method::Taylor { tolerance }
            | Method::Extrapolation { tolerance } => format!("tolerance {tolerance:e}"),
        }
    }

    /// Right-hand sides in one step; of an expansion, its order.
    pub fn rhs_per_step(self, precision: Precision) -> u64 {
        match self {
            Method::Rk4 { .. } => 4,
            Method::Dopri5 { .. } => 7,
            Method::Dop853 { .. } => 12,
            Method::Taylor { .. } if precision == Precision::Dd => series::ORDER_DD as u64,
            Method::Taylor { .. } => series::ORDER_F64 as u64,
            Method::Extrapolation { .. } => extrapolation::rhs_per_step(COLUMNS) as u64,
        }
    }

    /// The least tolerance that this method keeps in `precision`, if the two go together.
    pub fn least_tolerance(self, precision: Precision) -> Option<f64> {
        match (self, precision) {
            (Method::Rk4 { .. } | Method::Dopri5 { .. } | Method::Dop853 { .. }, Precision::Dd)
            | (Method::Taylor { .. }, Precision::F32 | Precision::Df32) => None,
            (Method::Extrapolation { .. }, precision) => {
                (precision == Precision::Dd).then_some(1e-27)
            }
            (Method::Rk4 { .. }, _) => (precision != Precision::Df32).then_some(0.0),
            (_, Precision::F32) => Some(1e-8),
            (_, Precision::Df32) => Some(1e-13),
            (_, Precision::F64) => Some(1e-15),
            (_, Precision::Dd) => Some(1e-28),
        }
    }
}

impl IntegratorConfig {
    /// Starts this close to each other (rad) are followed as cells, and integrated from where the
    /// cells end. Adaptive methods gain by it early; explicit ones stay what they are as long as
    /// their number type can tell the starts apart.
    pub fn deep_below(&self) -> f64 {
        match (self.method, self.precision) {
            (_, Precision::Dd) => 1e-22,
            (Method::Rk4 { .. }, Precision::F32) => 1e-6,
            (Method::Rk4 { .. }, _) => 1e-13,
            // Starts that round to 1e-7 are soon far from where they should be.
            (_, Precision::F32) => 5e-4,
            _ => DEEP_BELOW,
        }
    }
}

/// The distance of starts from which on polynomials save more than they cost, rad (measured).
const DEEP_BELOW: f64 = 1e-4;

/// Midpoint rules that an extrapolation combines (measured: the fewest right-hand sides for what
/// double-double is asked for).
pub const COLUMNS: usize = 9;

/// The number type a pixel is integrated in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 24 bits, with a compensated state where the device can be trusted with it.
    F32,
    /// Two f32: 48 bits, on devices whose error terms survive.
    Df32,
    /// 53 bits.
    F64,
    /// Two f64: 106 bits, on the processor.
    Dd,
}

impl Precision {
    /// Every precision with its word.
    pub const ALL: [(&'static str, Precision); 4] = [
        ("f32", Precision::F32),
        ("df32", Precision::Df32),
        ("f64", Precision::F64),
        ("dd", Precision::Dd),
    ];

    /// Half the distance from 1 to the next number: what a rounding may cost.
    pub fn epsilon(self) -> f64 {
        match self {
            Precision::F32 => f64::from(f32::EPSILON) / 2.0,
            Precision::Df32 => f64::from(f32::EPSILON).powi(2) / 2.0,
            Precision::F64 => f64::EPSILON / 2.0,
            Precision::Dd => f64::EPSILON.powi(2) / 2.0,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, _) = Self::ALL[Self::ALL.iter().position(|(_, p)| p == self).unwrap_or(0)];
        f.write_str(word)
    }
}

impl FromStr for Precision {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .iter()
            .find(|(word, _)| *word == text)
            .map(|(_, precision)| *precision)
            .ok_or_else(|| {
                format!("unknown precision '{text}'; the precisions are f32, df32, f64, dd")
            })
    }
}

/// What a job's steps are measured by: fixed ones, or such as choose themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Steps of one length.
    Fixed(Steps),
    /// Steps that follow the error.
    Adaptive(Adaptive),
}

impl Pace {
    /// The pace of a config over a question's budget.
    pub fn new(question: &Question, config: &IntegratorConfig) -> Result<Self, EngineError> {
        let adaptive = |tolerance: f64, order: u32| {
            Ok(Pace::Adaptive(Adaptive::new(question, Control::new(tolerance, order))))
        };
        match config.method {
            Method::Rk4 { step_secs } => {
                Steps::new(question, step_secs, config.precision).map(Pace::Fixed)
            }
            Method::Dopri5 { tolerance } => adaptive(tolerance, 5),
            Method::Dop853 { tolerance } => adaptive(tolerance, 8),
            Method::Taylor { tolerance } => adaptive(tolerance, series::ORDER_F64 as u32),
            Method::Extrapolation { tolerance } => {
                let control = Control::new(tolerance, 2 * COLUMNS as u32 - 1).steady();
                Ok(Pace::Adaptive(Adaptive::new(question, control)))
            }
        }
    }

    /// About how many steps a pendulum takes that does not flip.
    pub fn typical_steps(&self) -> f64 {
        match self {
            Pace::Fixed(steps) => f64::from(steps.count),
            // Measured on the home map at the tolerances of `balanced`.
            Pace::Adaptive(adaptive) => adaptive.budget * 12.0,
        }
    }

    /// Steps after which a pendulum is over: of fixed ones those that begin within the budget.
    pub fn most_steps(&self) -> u32 {
        match self {
            Pace::Fixed(steps) => steps.count,
            Pace::Adaptive(adaptive) => adaptive.most_steps,
        }
    }
}

/// Steps that choose their length, over a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive {
    /// How they choose it.
    pub control: Control,
    /// Reduced time at which a pendulum's last step has ended.
    pub budget: f64,
    /// A pendulum that tries more steps has failed.
    pub most_steps: u32,
    pub(super) unit_secs: f64,
    pub(super) budget_secs: f64,
}

impl Adaptive {
    fn new(question: &Question, control: Control) -> Self {
        let (reduced, unit_secs) = question.reduced();
        let budget = question.budget_secs / unit_secs;
        // The fastest whip the energy allows takes a hundred steps a turn.
        let most = 1e5 + 20.0 * budget * reduced.greatest_speed();
        Adaptive {
            control,
            // A little more than the budget, so that f32 does not stop before it.
            budget: budget * (1.0 + 1e-6),
            most_steps: most.min(f64::from(MOST_STEPS)) as u32,
            unit_secs,
            budget_secs: question.budget_secs,
        }
    }

    /// The outcome of a pendulum that passes the top at a reduced `time`.
    pub fn outcome_of_pass(&self, time: f64) -> Outcome {
        outcome_at(time * self.unit_secs, self.budget_secs)
    }
}

/// A flip at `time`, if that is within the budget, its end included.
fn outcome_at(time: f64, budget_secs: f64) -> Outcome {
    if time <= budget_secs {
        Outcome::flipped(time)
    } else {
        Outcome::without_time(Status::Unflipped)
    }
}

/// A fixed step laid over a budget, in the reduced units of the kernels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// The step in reduced time units, as the kernel's number type holds it.
    pub length: f64,
    /// The same in seconds.
    pub length_secs: f64,
    /// Steps that begin before the end of the budget.
    pub count: u32,
    budget_secs: f64,
}

impl Steps {
    /// The steps of `step_secs` that cover a question's budget.
    pub fn new(
        question: &Question,
        step_secs: f64,
        precision: Precision,
    ) -> Result<Self, EngineError> {
        let (_, unit_secs) = question.reduced();
        let ideal = step_secs / unit_secs;
        let length = match precision {
            Precision::F32 => f64::from(ideal as f32),
            _ => ideal,
        };
        // The rounded step is what runs; its seconds follow from it, so no time is lost.
        let length_secs = step_secs * (length / ideal);
        // Rounding may add a step that begins at the budget's end; no flip is lost or gained.
        let count = (question.budget_secs / length_secs).ceil();
        if count > f64::from(MOST_STEPS) {
            return Err(EngineError::Unsupported(format!(
                "a budget of {} s is {count:.1e} steps of {step_secs} s; at most {MOST_STEPS} \
                 are possible, so use a longer --step or a shorter --budget",
                question.budget_secs
            )));
        }
        Ok(Steps { length, length_secs, count: count as u32, budget_secs: question.budget_secs })
    }

    /// The outcome of a pendulum that passes the top `fraction` into the step that follows
    /// `steps` whole ones: a flip if that is within the budget, its end included.
    pub fn outcome_of_pass(&self, steps: u32, fraction: f64) -> Outcome {
        outcome_at((f64::from(steps) + fraction) * self.length_secs, self.budget_secs)
    }

    /// How the stages of a step find their directions: from the greatest turn that the scene's
    /// energy allows in one step.
    pub fn turning(&self, question: &Question, precision: Precision) -> Turning {
        let most = question.build.pendulum().greatest_speed() * self.length_secs;
        Turning::within(most, precision.epsilon())
    }
}

/// A kernel counts steps in 32 bits.
const MOST_STEPS: u32 = 1 << 30;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Rule;
    use crate::scene::Build;

    fn question(budget_secs: f64) -> Question {
        Question { build: Build::default(), rule: Rule::Second, budget_secs }
    }

    #[test]
    fn steps_cover_the_whole_budget() {
        for precision in [Precision::F32, Precision::F64] {
            let steps = Steps::new(&question(30.0), 1.0 / 120.0, precision).unwrap();
            assert!((3600..=3601).contains(&steps.count));
            assert!(f64::from(steps.count) * steps.length_secs >= 30.0);
        }
    }

    #[test]
    fn the_last_step_may_be_used_in_part() {
        let steps = Steps::new(&question(0.0125), 1.0 / 120.0, Precision::F64).unwrap();
        assert_eq!(steps.count, 2);
        assert_eq!(steps.outcome_of_pass(1, 0.49).status, Status::Flipped);
        assert_eq!(steps.outcome_of_pass(1, 0.51).status, Status::Unflipped);
    }

    #[test]
    fn too_many_steps_are_refused() {
        let error = Steps::new(&question(1e9), 1e-6, Precision::F64).unwrap_err();
        assert!(error.to_string().contains("--step"), "{error}");
    }

    #[test]
    fn settings_read_well() {
        assert_eq!(Method::LESSON.setting(), "step 1/120");
        assert_eq!(Method::Rk4 { step_secs: 0.3 }.setting(), "step 0.3");
    }
}
