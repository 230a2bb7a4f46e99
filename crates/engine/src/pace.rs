//! The pace of a job: its fixed steps or its step size control, chosen before the job runs.

use super::method::COLUMNS;
use super::{EngineError, EventSpec, IntegratorConfig, Method, Precision};
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::control::Control;
use flipmap_pendulum::{Outcome, Status, extrapolation, series};

/// The steps of a job: all of one length, or adaptive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Steps of one length.
    Fixed(Steps),
    /// Steps whose length follows the error.
    Adaptive(Adaptive),
}

impl Pace {
    /// The pace of a configuration over a question's budget.
    pub fn new(question: &EventSpec, config: &IntegratorConfig) -> Result<Self, EngineError> {
        let adaptive = |tolerance: f64, order: u32| {
            Ok(Pace::Adaptive(Adaptive::new(question, Control::new(tolerance, order))))
        };
        match config.method {
            Method::Rk4 { step_secs } => {
                Steps::new(question, step_secs, config.precision).map(Pace::Fixed)
            }
            Method::Embedded { pair, tolerance } => adaptive(tolerance, pair.data().order),
            Method::Taylor { tolerance } => adaptive(tolerance, series::ORDER_F64 as u32),
            Method::Extrapolation { tolerance } => {
                let control = Control::new(tolerance, extrapolation::order(COLUMNS)).steady();
                Ok(Pace::Adaptive(Adaptive::new(question, control)))
            }
        }
    }

    /// Approximate number of steps of a pendulum that does not flip.
    pub(crate) fn typical_steps(&self) -> f64 {
        match self {
            Pace::Fixed(steps) => f64::from(steps.count),
            // Measured on the home map at the tolerances of `balanced`.
            Pace::Adaptive(adaptive) => adaptive.budget * 12.0,
        }
    }

    /// Number of steps after which a pendulum is stopped; for fixed steps, the number of those that
    /// begin within the budget.
    pub(crate) fn most_steps(&self) -> u32 {
        match self {
            Pace::Fixed(steps) => steps.count,
            Pace::Adaptive(adaptive) => adaptive.most_steps,
        }
    }

    /// Number of steps after which a pendulum that is followed to the very end of the budget is
    /// stopped. The last fixed step is short, and rounding may cut it in two.
    pub(crate) fn most_steps_to_end(&self) -> u32 {
        match self {
            Pace::Fixed(steps) => steps.count + 2,
            Pace::Adaptive(adaptive) => adaptive.most_steps,
        }
    }
}

/// Adaptive steps over a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive {
    /// The step size control.
    pub control: Control,
    /// Reduced time after which a pendulum takes no further step.
    pub budget: f64,
    /// Number of tried steps beyond which a pendulum has failed.
    pub most_steps: u32,
    pub(super) unit_secs: f64,
    pub(super) budget_secs: f64,
}

impl Adaptive {
    /// The steps over a question's budget under a step size control.
    pub(crate) fn new(question: &EventSpec, control: Control) -> Self {
        let (reduced, unit_secs) = question.reduced();
        let budget = question.budget_secs / unit_secs;
        // The fastest rotation that the energy allows takes about a hundred steps per turn.
        let most = 1e5 + 20.0 * budget * reduced.greatest_speed();
        Adaptive {
            control,
            // A little more than the budget, so that f32 does not stop before it.
            budget: budget * (1.0 + 1e-6),
            most_steps: most.min(f64::from(MAX_STEPS)) as u32,
            unit_secs,
            budget_secs: question.budget_secs,
        }
    }

    /// Allows more steps, for pendulums that set out with reduced angular velocities up to
    /// `fastest`.
    #[must_use]
    pub(super) fn for_launches(self, question: &EventSpec, fastest: f64) -> Self {
        let (reduced, _) = question.reduced();
        // A speed of one bob may pass to the other, in proportion to the roots of their inertias.
        let ratio = (reduced.a.max(reduced.b) / reduced.least_det).sqrt().max(1.0);
        let more = 20.0 * self.budget * fastest * ratio * 2.0;
        let most_steps = (f64::from(self.most_steps) + more).min(f64::from(MAX_STEPS)) as u32;
        Adaptive { most_steps, ..self }
    }

    /// The outcome of a pendulum that crosses the top at a reduced `time`.
    pub(crate) fn outcome_of_pass(&self, time: f64) -> Outcome {
        outcome_at(time * self.unit_secs, self.budget_secs)
    }
}

/// A flip at `time` (s) if that is within the budget, its end included; otherwise unflipped.
fn outcome_at(time: f64, budget_secs: f64) -> Outcome {
    if time <= budget_secs {
        Outcome::flipped(time)
    } else {
        Outcome::without_time(Status::Unflipped)
    }
}

/// Fixed steps over a budget, in the reduced units of the kernels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// The step in reduced time units, as the kernel's number type holds it.
    pub length: f64,
    /// Length of the step in seconds.
    pub length_secs: f64,
    /// Number of steps that begin before the end of the budget.
    pub count: u32,
    /// True if pendulums may be faster than after any release from rest.
    pub thrown: bool,
    budget_secs: f64,
}

impl Steps {
    /// The steps of `step_secs` that cover a question's budget.
    pub(crate) fn new(
        question: &EventSpec,
        step_secs: f64,
        precision: Precision,
    ) -> Result<Self, EngineError> {
        let (_, unit_secs) = question.reduced();
        let ideal = step_secs / unit_secs;
        let length = match precision {
            Precision::F32 => f64::from(ideal as f32),
            _ => ideal,
        };
        // The rounded step is the one that runs; its seconds follow from it, so no time is lost.
        let length_secs = step_secs * (length / ideal);
        // Rounding may add a step that begins at the budget's end; no flip is lost or gained.
        let count = (question.budget_secs / length_secs).ceil();
        if count > f64::from(MAX_STEPS) {
            return Err(EngineError::Unsupported(format!(
                "a budget of {} s is {count:.1e} steps of {step_secs} s; at most {MAX_STEPS} \
                 are possible, so use a longer step or a shorter budget",
                question.budget_secs
            )));
        }
        let (count, budget_secs) = (count as u32, question.budget_secs);
        Ok(Steps { length, length_secs, count, thrown: false, budget_secs })
    }

    /// Reduced time at which the budget ends.
    pub(crate) fn budget(&self) -> f64 {
        self.budget_secs / self.length_secs * self.length
    }

    /// The same steps for pendulums that may be faster than after any release.
    #[must_use]
    pub(super) fn for_launches(self) -> Self {
        Steps { thrown: true, ..self }
    }

    /// The outcome of a pendulum that crosses the top `fraction` into the step that follows `steps`
    /// whole ones: a flip if that is within the budget, its end included.
    pub(crate) fn outcome_of_pass(&self, steps: u32, fraction: f64) -> Outcome {
        outcome_at((f64::from(steps) + fraction) * self.length_secs, self.budget_secs)
    }

    /// Chooses the way in which the stages of a step find their directions, by the greatest turn
    /// that the scene's energy allows in one step.
    pub(crate) fn turning(&self, question: &EventSpec, precision: Precision) -> Turning {
        if self.thrown {
            return Turning::Fresh;
        }
        let most = question.build.pendulum().greatest_speed() * self.length_secs;
        Turning::within(most, precision.epsilon())
    }
}

/// Largest number of steps: kernels count them in 32 bits.
const MAX_STEPS: u32 = 1 << 30;

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::Rule;
    use flipmap_scene::PendulumSpec;

    fn question(budget_secs: f64) -> EventSpec {
        EventSpec { build: PendulumSpec::default(), rule: Rule::Second, budget_secs, passes: 1 }
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
        assert_eq!(steps.outcome_of_pass(1, 0.49).status, Status::Answered);
        assert_eq!(steps.outcome_of_pass(1, 0.51).status, Status::Unflipped);
    }

    #[test]
    fn too_many_steps_are_refused() {
        let error = Steps::new(&question(1e9), 1e-6, Precision::F64).unwrap_err();
        assert!(error.to_string().contains("a longer step"), "{error}");
    }
}
