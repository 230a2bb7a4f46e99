//! When an answer is sure.
//!
//! A start has been computed several times, by runs whose error scales differ by known factors.
//! The finest of them, f, is to be right within a tolerance; how far the others are off it is
//! known. While errors grow linearly, a run c that is K times coarser is some K times farther from
//! the truth than f. So if f were wrong by more than the tolerance τ, c would be about Kτ away
//! from it, and that it is only d away would be an accident: its error, of known size and unknown
//! sign, happened to lie within d of f's. The chance of that is about d/(Kτ): measured, it is
//! that down to the rarest cases that could be counted. Runs with errors of their own multiply
//! their chances, and an answer is sure when the product is below [`MOST_CHANCE`].
//!
//! The tolerance is not only that of the flip's time. Errors in the state must be far below the
//! height by which any earlier turn missed the top, and below that by which the flip itself was
//! no near miss: then no run can have taken a miss for a pass. Where a pendulum does not flip,
//! only that counts.
//!
//! At least one of the runs that agree must be of another method with another test for passes, and
//! where a run is far off, growth as the others show it must explain that.

use super::ladder::Run;
use crate::engine::{End, Question};
use crate::physics::embedded::{dop853, plus};
use crate::physics::flip::right_secs;
use crate::physics::phase::Phase;
use crate::physics::{Outcome, Pendulum, Status};

/// An answer and where it came to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    pub outcome: Outcome,
    pub end: End,
}

/// Share of what is allowed that errors may use, for what the argument leaves out.
const SAFETY: f64 = 0.25;
/// Likewise of the height by which a turn missed the top.
const OF_CLEARANCE: f64 = 0.1;
/// States this far apart are no longer near enough for errors to grow linearly.
const LINEAR: f64 = 0.05;
/// An unflipped pendulum's state need not be known better than this.
const UNFLIPPED: f64 = 1e-2;
/// Errors this many times larger than the growth of others explains are none that just grew.
const UNLIKELY: f64 = 1e3;
/// How probable it may be that an answer which is called right is wrong, if the finest run is.
const MOST_CHANCE: f64 = 1e-6;

/// An answer with its error scale.
type Scaled<'a> = (f64, &'a (Run, Answer));

/// What answers to a question are judged by.
pub struct Judge {
    pendulum: Pendulum<f64>,
    inverse_scale: [f64; 2],
    /// Errors in a flip's time that are no matter, reduced.
    tolerance: f64,
    /// Half the side of the leaves of start maps, rad.
    leaf_half_rad: f64,
}

impl Judge {
    /// Of deep starts with the sides of their leaves halved, rad; of others that does not matter.
    pub fn new(question: &Question, leaf_half_rad: f64) -> Self {
        let (pendulum, unit_secs) = question.reduced();
        let inverse_scale = pendulum.momentum_scale().map(|scale| 1.0 / scale);
        let tolerance = SAFETY * right_secs(unit_secs) / unit_secs;
        Judge { pendulum, inverse_scale, tolerance, leaf_half_rad }
    }

    /// The finest of some answers, and whether it is sure by what the others are.
    pub fn verdict(&self, answers: &[(Run, Answer)]) -> (Outcome, bool) {
        let scale =
            |(run, answer): &(Run, Answer)| run.error_scale(&answer.end, self.leaf_half_rad);
        let mut scaled: Vec<_> = answers.iter().map(|answer| (scale(answer), answer)).collect();
        scaled.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (finest, others) = scaled.split_first().expect("the first rung has all starts");
        (finest.1.1.outcome, self.is_sure(finest, others))
    }

    /// Whether the first of these answers with their error scales, the finest, is sure by what the
    /// others are.
    fn is_sure(&self, finest: &Scaled, others: &[Scaled]) -> bool {
        let (finest_scale, (run, answer)) = finest;
        match answer.outcome.status {
            // Proved, of deep starts on two maps.
            Status::Forbidden => {
                let forbidden = |other: &Answer| other.outcome.status == Status::Forbidden;
                return others.iter().all(|(_, (_, other))| forbidden(other));
            }
            Status::Failed => return false,
            Status::Flipped | Status::Unflipped => {}
        }
        let allowed = self.allowed(answer);
        let (mut chance, mut independent) = (1.0, false);
        let (mut growth, mut finest_far) = (0f64, f64::INFINITY);
        for (scale, (other, theirs)) in others {
            let apart = self.distance(answer, theirs);
            if apart > LINEAR {
                finest_far = finest_far.min(*scale);
                continue;
            }
            growth = growth.max(apart / scale);
            chance *= (apart.max(*scale) * finest_scale / (scale * allowed)).min(1.0);
            independent |= other.is_independent_of(run);
        }
        let explained = finest_far.is_infinite() || finest_far * growth * UNLIKELY > LINEAR;
        independent && chance <= MOST_CHANCE && explained
    }

    /// How far off an answer's state may be.
    pub fn allowed(&self, answer: &Answer) -> f64 {
        let clearance = OF_CLEARANCE * answer.end.clearance;
        match answer.outcome.status {
            Status::Flipped => self.tolerance.min(clearance).min(self.beyond(&answer.end.phase)),
            _ => UNFLIPPED.min(clearance),
        }
    }

    /// The share of it that counts of the height to which a bob that is at the top would rise
    /// beyond it, if nothing but its own weight turned it round.
    fn beyond(&self, phase: &Phase<f64>) -> f64 {
        let [x1, y1, x2, y2, ..] = *phase;
        let speed = self.pendulum.speeds(phase);
        let pull = self.pendulum.acceleration_towards([(y1, x1), (y2, x2)], speed);
        // The bob at the top is the one whose sine vanishes there.
        let bob = usize::from(x1 > 0.0 || (x2 < 0.0 && y2.abs() < y1.abs()));
        OF_CLEARANCE * speed[bob].powi(2) / (2.0 * pull[bob].abs()).max(1e-300)
    }

    /// How far apart two answers are: in time (reduced) and in unit vectors and scaled momenta,
    /// whichever is more; infinitely, if one has flipped and the other has not.
    pub fn distance(&self, a: &Answer, b: &Answer) -> f64 {
        match (a.outcome.status, b.outcome.status) {
            (Status::Flipped, Status::Flipped) => {
                let between = self.between(&a.end.phase, &b.end.phase);
                between.max((a.end.time - b.end.time).abs())
            }
            (Status::Unflipped, Status::Unflipped) => {
                let (early, late) = if a.end.time <= b.end.time { (a, b) } else { (b, a) };
                let caught_up = self.moved(&early.end.phase, late.end.time - early.end.time);
                self.between(&caught_up, &late.end.phase)
            }
            _ => f64::INFINITY,
        }
    }

    fn between(&self, a: &Phase<f64>, b: &Phase<f64>) -> f64 {
        let unit = |i: usize| if i < 4 { 1.0 } else { self.inverse_scale[i - 4] };
        (0..6).map(|i| (a[i] - b[i]).abs() * unit(i)).fold(0.0, f64::max)
    }

    /// A state so much later.
    fn moved(&self, phase: &Phase<f64>, by: f64) -> Phase<f64> {
        let (mut phase, mut left, mut step) = (*phase, by, FIRST_STEP);
        for _ in 0..MOST_STEPS {
            if left <= 0.0 {
                break;
            }
            let length = left.min(step);
            let trial = dop853(&self.pendulum, self.inverse_scale, &phase, length);
            let excess = trial.error_squared.sqrt() / STEP_TOLERANCE;
            if excess <= 1.0 {
                phase = plus(&phase, &trial.change);
                left -= length;
            }
            step = length * (0.8 * excess.max(1e-12).powf(-1.0 / 8.0)).clamp(0.2, 4.0);
        }
        phase
    }
}

/// Of what brings two states to one time.
const STEP_TOLERANCE: f64 = 1e-13;
const FIRST_STEP: f64 = 0.1;
const MOST_STEPS: u32 = 1000;
