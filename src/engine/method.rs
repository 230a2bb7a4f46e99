//! Methods, precisions, and the numbers that a method needs before a job can run.

use std::fmt;
use std::str::FromStr;

use super::{EngineError, IntegratorConfig, Question};
use crate::physics::control::Control;
use crate::physics::embedded::{DOP853_ORDER, DOPRI5_ORDER};
use crate::physics::trig::Turning;
use crate::physics::{Outcome, Status, extrapolation, series};

/// The method by which a pixel is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The classical Runge–Kutta method with a fixed step in seconds.
    Rk4 {
        /// Length of the step in seconds.
        step_secs: f64,
    },
    /// Dormand and Prince's pair of orders 5 and 4: small coefficients, for f32.
    Dopri5 {
        /// Tolerance of one step just after the release; it rises from there (see
        /// `physics::control`).
        tolerance: f64,
    },
    /// Dormand and Prince's pair of order 8, for everything finer.
    Dop853 {
        /// Tolerance of one step, which rises as for [`Method::Dopri5`].
        tolerance: f64,
    },
    /// Taylor expansions to the precision of the number type: the check of the other methods, and
    /// the method for `dd`.
    Taylor {
        /// Tolerance of one step, the same at all times.
        tolerance: f64,
    },
    /// Extrapolated midpoint rules: the check of expansions in `dd`. Users cannot ask for it by
    /// name.
    Extrapolation {
        /// Tolerance of one step, the same at all times, for the result without the last of its
        /// rules.
        tolerance: f64,
    },
}

impl Method {
    /// The lesson's method: RK4 with 120 steps per second.
    pub const LESSON: Method = Method::Rk4 { step_secs: 1.0 / 120.0 };

    /// Names of the methods that users can ask for.
    pub const NAMES: [&str; 4] = ["rk4", "dopri5", "dop853", "taylor"];

    /// Name of the method.
    pub fn name(self) -> &'static str {
        match self {
            Method::Rk4 { .. } => "rk4",
            Method::Dopri5 { .. } => "dopri5",
            Method::Dop853 { .. } => "dop853",
            Method::Taylor { .. } => "taylor",
            Method::Extrapolation { .. } => "extrapolation",
        }
    }

    /// Returns true if steps are taken by Taylor expansions.
    pub fn is_series(self) -> bool {
        matches!(self, Method::Taylor { .. })
    }

    /// The method's step or tolerance as text, for people and files.
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

    /// Right-hand sides per step; for an expansion, its order.
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

    /// Least tolerance that this method can keep in `precision`, if the two go together.
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
    /// Returns true if pixels whose angles change by `pixel_rad` (rad) from one to the next are
    /// deep: closer than [`IntegratorConfig::deep_below`].
    pub fn is_deep(&self, pixel_rad: f64) -> bool {
        pixel_rad < self.deep_below()
    }

    /// Approximate number of pixels along the side of a leaf of a deep picture. With fewer, pixels
    /// begin later and f32 errs less; with more, fewer cells are followed (measured).
    pub fn leaf_pixels(&self) -> u32 {
        if self.precision == Precision::F32 { 16 } else { 64 }
    }

    /// Distance between starts, in rad, below which they are followed as cells and integrated from
    /// where the cells end. Adaptive methods benefit from cells early; fixed steps run from the
    /// release as long as their number type can tell the starts apart.
    pub fn deep_below(&self) -> f64 {
        match (self.method, self.precision) {
            (_, Precision::Dd) => 1e-22,
            (Method::Rk4 { .. }, Precision::F32) => 1e-6,
            (Method::Rk4 { .. }, _) => 1e-13,
            // Starts rounded to 1e-7 are soon far from where they should be.
            (_, Precision::F32) => 5e-4,
            _ => DEEP_BELOW,
        }
    }
}

/// Distance between starts, in rad, below which polynomials save more than they cost (measured).
const DEEP_BELOW: f64 = 1e-4;

/// Number of midpoint rules that an extrapolation combines: enough for long steps at the tolerances
/// used in double-double.
pub const COLUMNS: usize = 9;

/// The number type in which a pixel is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// Single precision, 24 bits, with a compensated state where the device can be trusted with it.
    F32,
    /// Two f32: 48 bits, on devices whose compilers keep error terms.
    Df32,
    /// Double precision, 53 bits.
    F64,
    /// Two f64: 106 bits, on the processor.
    Dd,
}

impl Precision {
    /// Every precision with its name.
    pub const ALL: [(&'static str, Precision); 4] = [
        ("f32", Precision::F32),
        ("df32", Precision::Df32),
        ("f64", Precision::F64),
        ("dd", Precision::Dd),
    ];

    /// Unit roundoff: half the distance from 1 to the next number.
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
    pub fn new(question: &Question, config: &IntegratorConfig) -> Result<Self, EngineError> {
        let adaptive = |tolerance: f64, order: u32| {
            Ok(Pace::Adaptive(Adaptive::new(question, Control::new(tolerance, order))))
        };
        match config.method {
            Method::Rk4 { step_secs } => {
                Steps::new(question, step_secs, config.precision).map(Pace::Fixed)
            }
            Method::Dopri5 { tolerance } => adaptive(tolerance, DOPRI5_ORDER),
            Method::Dop853 { tolerance } => adaptive(tolerance, DOP853_ORDER),
            Method::Taylor { tolerance } => adaptive(tolerance, series::ORDER_F64 as u32),
            Method::Extrapolation { tolerance } => {
                let control = Control::new(tolerance, extrapolation::order(COLUMNS)).steady();
                Ok(Pace::Adaptive(Adaptive::new(question, control)))
            }
        }
    }

    /// The same pace in steps of one tolerance at all times, whose error falls with this order.
    pub(super) fn steady(self, method: Method, order: u32) -> Self {
        match (self, method) {
            (Pace::Adaptive(adaptive), Method::Taylor { tolerance }) => {
                let control = Control::new(tolerance, order).steady();
                Pace::Adaptive(Adaptive { control, ..adaptive })
            }
            (pace, _) => pace,
        }
    }

    /// Approximate number of steps of a pendulum that does not flip.
    pub fn typical_steps(&self) -> f64 {
        match self {
            Pace::Fixed(steps) => f64::from(steps.count),
            // Measured on the home map at the tolerances of `balanced`.
            Pace::Adaptive(adaptive) => adaptive.budget * 12.0,
        }
    }

    /// Number of steps after which a pendulum is stopped; for fixed steps, of those that begin
    /// within the budget.
    pub fn most_steps(&self) -> u32 {
        match self {
            Pace::Fixed(steps) => steps.count,
            Pace::Adaptive(adaptive) => adaptive.most_steps,
        }
    }

    /// The same for pendulums that are followed to the very end of the budget: of fixed steps, the
    /// last one is short, and may be cut in two by rounding.
    pub fn most_steps_to_end(&self) -> u32 {
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
    pub fn new(question: &Question, control: Control) -> Self {
        let (reduced, unit_secs) = question.reduced();
        let budget = question.budget_secs / unit_secs;
        // The fastest rotation that the energy allows takes about a hundred steps per turn.
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

    /// The same steps, with their greatest number raised for pendulums that set out with reduced
    /// angular velocities up to `fastest`.
    #[must_use]
    pub(super) fn for_launches(self, question: &Question, fastest: f64) -> Self {
        let (reduced, _) = question.reduced();
        // A speed of one bob may pass to the other, in proportion to the roots of their inertias.
        let ratio = (reduced.a.max(reduced.b) / reduced.least_det).sqrt().max(1.0);
        let more = 20.0 * self.budget * fastest * ratio * 2.0;
        let most_steps = (f64::from(self.most_steps) + more).min(f64::from(MOST_STEPS)) as u32;
        Adaptive { most_steps, ..self }
    }

    /// The outcome of a pendulum that crosses the top at a reduced `time`.
    pub fn outcome_of_pass(&self, time: f64) -> Outcome {
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
        // The rounded step is the one that runs; its seconds follow from it, so no time is lost.
        let length_secs = step_secs * (length / ideal);
        // Rounding may add a step that begins at the budget's end; no flip is lost or gained.
        let count = (question.budget_secs / length_secs).ceil();
        if count > f64::from(MOST_STEPS) {
            return Err(EngineError::Unsupported(format!(
                "a budget of {} s is {count:.1e} steps of {step_secs} s; at most {MOST_STEPS} \
                 are possible, so use a longer `step` or a shorter `budget`",
                question.budget_secs
            )));
        }
        let (count, budget_secs) = (count as u32, question.budget_secs);
        Ok(Steps { length, length_secs, count, thrown: false, budget_secs })
    }

    /// Reduced time at which the budget ends.
    pub fn budget(&self) -> f64 {
        self.budget_secs / self.length_secs * self.length
    }

    /// The same steps for pendulums that may be faster than after any release.
    #[must_use]
    pub(super) fn for_launches(self) -> Self {
        Steps { thrown: true, ..self }
    }

    /// The outcome of a pendulum that crosses the top `fraction` into the step that follows `steps`
    /// whole ones: a flip if that is within the budget, its end included.
    pub fn outcome_of_pass(&self, steps: u32, fraction: f64) -> Outcome {
        outcome_at((f64::from(steps) + fraction) * self.length_secs, self.budget_secs)
    }

    /// The way in which the stages of a step find their directions, chosen by the greatest turn
    /// that the scene's energy allows in one step.
    pub fn turning(&self, question: &Question, precision: Precision) -> Turning {
        if self.thrown {
            return Turning::Fresh;
        }
        let most = question.build.pendulum().greatest_speed() * self.length_secs;
        Turning::within(most, precision.epsilon())
    }
}

/// Largest number of steps: kernels count them in 32 bits.
const MOST_STEPS: u32 = 1 << 30;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Rule;
    use crate::scene::Build;

    fn question(budget_secs: f64) -> Question {
        Question { build: Build::default(), rule: Rule::Second, budget_secs, passes: 1 }
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
        assert!(error.to_string().contains("`step`"), "{error}");
    }

    #[test]
    fn settings_read_well() {
        assert_eq!(Method::LESSON.setting(), "step 1/120");
        assert_eq!(Method::Rk4 { step_secs: 0.3 }.setting(), "step 0.3");
    }
}
