//! Flips: what counts as one, what a pixel stores of it, and where inside a step it happens.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::pendulum::{Pendulum, State};
use flipmap_numbers::polynomial::{first_rise, quintic_hermite};
use flipmap_numbers::real::Scalar;

/// The rule that says which bob is watched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rule {
    /// The second, outer bob.
    #[default]
    Second,
    /// The first, inner bob.
    First,
    /// Both bobs, whichever flips first.
    Either,
    /// No bob: the pendulum is followed for the whole budget, and its turns are counted. Questions
    /// may use this rule, scenes may not.
    #[serde(skip)]
    Neither,
}

impl Rule {
    /// The rules of scenes, each with its name.
    pub const ALL: [(&'static str, Rule); 3] =
        [("second", Rule::Second), ("first", Rule::First), ("either", Rule::Either)];

    /// The indices of the watched bobs.
    pub fn watched(self) -> &'static [usize] {
        match self {
            Rule::First => &[0],
            Rule::Second => &[1],
            Rule::Either => &[0, 1],
            Rule::Neither => &[],
        }
    }

    /// Returns true for each bob that is watched.
    pub fn watches(self) -> [bool; 2] {
        [0, 1].map(|bob| self.watched().contains(&bob))
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = Self::ALL.iter().find(|(_, rule)| rule == self);
        f.write_str(known.map_or("neither", |(word, _)| word))
    }
}

/// The way in which a pixel's simulation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Status {
    /// No flip within the budget.
    Unflipped = 0,
    /// The question was answered, for example by a flip at the outcome's time. Files keep the name
    /// of the first question, `Flipped`.
    #[serde(rename = "Flipped")]
    Answered = 1,
    /// A flip proved impossible by energy conservation; never simulated.
    Forbidden = 2,
    /// A failure: the numbers stopped being finite, or the step limit was reached.
    Failed = 3,
}

/// The default pendulum's unit of time, √(1 m / 9.81 m/s²), in s.
const DEFAULT_UNIT_SECS: f64 = 0.319_275_428_540_718_2;

/// Greatest error in s with which a flip time counts as right: 1 ms or, for a pendulum faster than
/// the default one, the same share of its unit of time.
pub fn right_secs(unit_secs: f64) -> f64 {
    1e-3 * (unit_secs / DEFAULT_UNIT_SECS).min(1.0)
}

/// The convention for a bob that begins exactly at the top, at rest or thrown: it counts as being
/// on the side on which its first motion leads inward, so it has not passed the top.
///
/// Returns the sign of its angle, ±π, from the first non-zero coefficient of its motion's power
/// series; `None` if nothing moves it.
pub(crate) fn side_at_top<T: Scalar>(first_motion: Option<T>) -> Option<T> {
    first_motion.map(|motion| T::from_f64(if motion > T::zero() { -1.0 } else { 1.0 }))
}

/// The outcome of a pixel: its status and, if it flipped, the time (s; otherwise 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome<T = f64> {
    /// Status at the end of the simulation.
    pub status: Status,
    /// Simulated seconds from the release to the flip.
    pub time: T,
}

impl<T: Scalar> Outcome<T> {
    /// An outcome without a time.
    pub fn without_time(status: Status) -> Self {
        let time = T::zero();
        Outcome { status, time }
    }

    /// The outcome of a flip at `time`. No bob flips before its release, so a negative or NaN time
    /// is a failure of whatever computed it.
    pub fn flipped(time: T) -> Self {
        if time >= T::zero() {
            Outcome { status: Status::Answered, time }
        } else {
            Outcome::without_time(Status::Failed)
        }
    }
}

/// The fraction in (0, 1] of a step of `step` seconds at which `bob` first reaches the top moving
/// outward, from the states at both ends: the root of the quintic that has the angle, speed and
/// acceleration of both ends. It also finds passes that fall back inside the step.
///
/// A cheap test comes first; the accelerations are only computed where a pass is possible.
#[inline]
pub fn fraction_of_step<T: Scalar>(
    pendulum: &Pendulum<T>,
    bob: usize,
    before: &State<T>,
    after: &State<T>,
    step: T,
) -> Option<T> {
    if !may_pass(before, after, bob, step) {
        return None;
    }
    let side = if after.angle[bob] < T::zero() { -T::from_f64(1.0) } else { T::from_f64(1.0) };
    let end = |state: &State<T>| {
        let alpha = pendulum.acceleration(state)[bob];
        [
            side * state.angle[bob] - T::pi(),
            side * state.speed[bob] * step,
            side * alpha * step * step,
        ]
    };
    first_rise(&quintic_hermite(end(before), end(after)))
}

/// Returns true if `bob` can have been at the top in this step: it ends beyond the top, or it
/// turned back within a step's travel of it.
#[inline(always)]
pub fn may_pass<T: Scalar>(before: &State<T>, after: &State<T>, bob: usize, step: T) -> bool {
    // A bob released from rest may turn round at once.
    let turned = before.speed[bob] * after.speed[bob] <= T::zero();
    let far = before.angle[bob].abs().max(after.angle[bob].abs());
    let travel = step * before.speed[bob].abs().max(after.speed[bob].abs());
    after.angle[bob].abs() >= T::pi() || (turned && far + travel >= T::pi())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_printed() {
        for (word, rule) in Rule::ALL {
            assert_eq!(rule.to_string(), word);
        }
    }
}
