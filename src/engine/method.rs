//! Methods and precisions, and the numbers a method needs before a job can run.

use std::fmt;
use std::str::FromStr;

use super::{EngineError, Question};
use crate::physics::{Outcome, Status};

/// How a pixel is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The classical Runge–Kutta method with a fixed step in seconds.
    Rk4 {
        /// Seconds.
        step_secs: f64,
    },
}

impl Method {
    /// The lesson's: 120 steps a second.
    pub const LESSON: Method = Method::Rk4 { step_secs: 1.0 / 120.0 };

    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Method::Rk4 { .. } => "rk4",
        }
    }

    /// Its step as text, for people and files.
    pub fn setting(self) -> String {
        let Method::Rk4 { step_secs } = self;
        let per_second = 1.0 / step_secs;
        if (per_second - per_second.round()).abs() < 1e-9 * per_second {
            format!("step 1/{per_second:.0}")
        } else {
            format!("step {step_secs}")
        }
    }
}

/// The number type a pixel is integrated in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 24 bits, with a compensated state where the device can be trusted with it.
    F32,
    /// 53 bits.
    F64,
}

impl Precision {
    /// Every precision with its word.
    pub const ALL: [(&'static str, Precision); 2] =
        [("f32", Precision::F32), ("f64", Precision::F64)];

    /// Half the distance from 1 to the next number: what a rounding may cost.
    pub fn epsilon(self) -> f64 {
        match self {
            Precision::F32 => f64::from(f32::EPSILON) / 2.0,
            Precision::F64 => f64::EPSILON / 2.0,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
        })
    }
}

impl FromStr for Precision {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .iter()
            .find(|(word, _)| *word == text)
            .map(|(_, precision)| *precision)
            .ok_or_else(|| format!("unknown precision '{text}'; the precisions are f32, f64"))
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
        let (_, unit_secs) = question.pendulum.reduced();
        let ideal = step_secs / unit_secs;
        let length = match precision {
            Precision::F32 => f64::from(ideal as f32),
            Precision::F64 => ideal,
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
        let time = (f64::from(steps) + fraction) * self.length_secs;
        if time <= self.budget_secs {
            Outcome::flipped(time)
        } else {
            Outcome::without_time(Status::Unflipped)
        }
    }
}

/// A kernel counts steps in 32 bits.
const MOST_STEPS: u32 = 1 << 30;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Pendulum, Rule};

    fn question(budget_secs: f64) -> Question {
        Question {
            pendulum: Pendulum::points([1.0; 2], [1.0; 2], 9.81),
            rule: Rule::Second,
            budget_secs,
        }
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
