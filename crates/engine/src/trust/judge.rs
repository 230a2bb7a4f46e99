//! The criterion by which an answer is sure.
//!
//! A start has been computed several times, by runs whose error scales differ by known factors. The
//! finest of them, f, must be right within a tolerance; the distances of the others from it are
//! known. While errors grow linearly, a run c that is K times coarser is some K times farther from
//! the truth than f. So if f were wrong by more than the tolerance τ, c would be about Kτ away from
//! it, and a distance of only d would be an accident: c's error, of known size and unknown sign,
//! happened to lie within d of f's. The chance of that is about d/(Kτ); measurements confirm this
//! down to the rarest cases that could be counted. The chances of runs with independent errors
//! multiply, and an answer is sure when the product is below [`MAX_ERROR_PROBABILITY`].
//!
//! The tolerance applies to more than the time of the flip. Errors in the state must also be far
//! below the height by which any earlier turn missed the top, and below the height by which the
//! flip itself cleared it: then no run can have taken a miss for a crossing. For a pendulum that
//! does not flip, only the missed turns count.
//!
//! At least one of the runs that agree must use another method with another test for crossings, and
//! if a run is far off, the growth that the other runs show must explain it.

use super::ladder::Run;
use crate::{EventSpec, FinalState};
use flipmap_pendulum::crossing::{StepState, bob_at_top, height_beyond};
use flipmap_pendulum::flip::right_secs;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::transport::transported;
use flipmap_pendulum::{Outcome, Pendulum, Rule, Status};
use flipmap_scene::question::Needs;

/// An outcome, and the end of its integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RunResult {
    pub outcome: Outcome,
    pub end: FinalState,
}

/// The finest answer to a start, and what the other answers make of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JudgedAnswer {
    pub answer: RunResult,
    /// True if the other answers make the finest sure.
    pub is_sure: bool,
    /// Estimated error of a flip's time in s, infinite if no other run agrees; `None` if the answer
    /// is not a flip's time.
    pub error_secs: Option<f64>,
}

/// Share of the allowed error in a flip's time that is used; the rest is a margin for what the
/// argument leaves out.
const SAFETY: f64 = 0.25;
/// Share of the height by which a turn missed the top that errors may reach.
const OF_CLEARANCE: f64 = 0.1;
/// Distance between states from which on errors can no longer be taken to grow linearly.
const LINEAR: f64 = 0.05;
/// Largest error allowed in the state of an unflipped pendulum, or of one whose growth or return is
/// the answer.
const UNFLIPPED: f64 = 1e-2;
/// Largest error allowed in the state of a pendulum if the state is the answer.
const STATE: f64 = SAFETY * 1e-3;
/// Largest factor by which an error may exceed what the growth of the other runs explains.
const UNLIKELY: f64 = 1e3;
/// Factor from the growth that two runs show to that which an estimate assumes: two errors may have
/// nearly the same size and sign, so that the chance that the true error is N times the shown one
/// is about 1/N. Of the home map's flips, 0.4 % are farther off than estimated with this factor.
const GROWTH_MARGIN: f64 = 30.0;
/// Largest accepted probability that an answer of the finest run is called right though it is
/// wrong.
const MAX_ERROR_PROBABILITY: f64 = 1e-6;

/// An answer with its error scale.
type Scaled<'a> = (f64, &'a (Run, RunResult));

/// The judge of the answers to a question.
pub(super) struct Judge {
    pendulum: Pendulum<f64>,
    inverse_scale: [f64; 2],
    /// Error allowed in a flip's time, reduced.
    tolerance: f64,
    /// Error allowed in the state of a pendulum that has not flipped.
    unflipped: f64,
    /// Half the side of the leaves of start maps in rad.
    leaf_half_rad: f64,
    /// Seconds in a unit of reduced time.
    unit_secs: f64,
    /// True if the time of a flip is asked for.
    asks_time: bool,
}

impl Judge {
    /// Creates a judge of answers that need `ends`; `leaf_half_rad` is half the side of the leaves
    /// for deep starts, and unused for others.
    pub(super) fn new(question: &EventSpec, ends: Needs, leaf_half_rad: f64) -> Self {
        let (pendulum, unit_secs) = question.reduced();
        let inverse_scale = pendulum.momentum_scale().map(|scale| 1.0 / scale);
        let tolerance = SAFETY * right_secs(unit_secs) / unit_secs;
        // Where growth or a return is asked for, the state at the end only shows how far errors
        // grew.
        let is_answer = question.rule == Rule::Neither && !ends.are_carried();
        let unflipped = if is_answer { STATE } else { UNFLIPPED };
        let asks_time = question.rule != Rule::Neither;
        Judge { pendulum, inverse_scale, tolerance, unflipped, leaf_half_rad, unit_secs, asks_time }
    }

    /// Returns the finest of some answers, and what the others make of it.
    pub(super) fn judge(&self, answers: &[(Run, RunResult)]) -> JudgedAnswer {
        let scale =
            |(run, answer): &(Run, RunResult)| run.error_scale(&answer.end, self.leaf_half_rad);
        let mut scaled: Vec<_> = answers.iter().map(|answer| (scale(answer), answer)).collect();
        scaled.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (finest, others) = scaled.split_first().expect("the first rung has all starts");
        let (_, (_, answer)) = finest;
        let is_sure = self.is_sure(finest, others) && Self::is_confirmed(finest, others);
        let is_time = self.asks_time && answer.outcome.status == Status::Answered;
        let error_secs = is_time.then(|| self.unit_secs * self.estimated_error(finest, others));
        JudgedAnswer { answer: *answer, is_sure, error_secs }
    }

    /// Returns the estimated error of the finest answer: the growth that the others show, times its
    /// error scale. Errors of runs that are far off have stopped growing, so that they show less
    /// growth than there is; if all are, nothing is known.
    fn estimated_error(&self, (finest_scale, (_, answer)): &Scaled, others: &[Scaled]) -> f64 {
        let aparts = others.iter().map(|(scale, (_, other))| (scale, self.distance(answer, other)));
        let near = aparts.filter(|(_, apart)| *apart <= LINEAR);
        let growth = near.map(|(scale, apart)| apart / scale).max_by(f64::total_cmp);
        growth.map_or(f64::INFINITY, |growth| GROWTH_MARGIN * growth * finest_scale)
    }

    /// Returns true if a run of another method gathered the same along the motion, even if it ended
    /// elsewhere: what was gathered depends little on the last part of the motion.
    fn is_confirmed((_, (run, answer)): &Scaled, others: &[Scaled]) -> bool {
        let gathered = &answer.end.gathered;
        others.iter().any(|(_, (other, theirs))| {
            let agrees = gathered.agrees_with(&theirs.end.gathered);
            agrees && other.config.method.name() != run.config.method.name()
        })
    }

    /// Returns true if the `others`, each with its error scale, make `finest` sure.
    fn is_sure(&self, finest: &Scaled, others: &[Scaled]) -> bool {
        let (finest_scale, (run, answer)) = finest;
        match answer.outcome.status {
            // Proved; for deep starts, on two maps.
            Status::Forbidden => {
                let forbidden = |other: &RunResult| other.outcome.status == Status::Forbidden;
                return others.iter().all(|(_, (_, other))| forbidden(other));
            }
            Status::Failed => return false,
            Status::Answered | Status::Unflipped => {}
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
        independent && chance <= MAX_ERROR_PROBABILITY && explained
    }

    /// Error allowed in an answer's state.
    pub(super) fn allowed(&self, answer: &RunResult) -> f64 {
        let clearance = OF_CLEARANCE * answer.end.clearance;
        match answer.outcome.status {
            Status::Answered => self.tolerance.min(clearance).min(self.beyond(&answer.end.phase)),
            _ => self.unflipped.min(clearance),
        }
    }

    /// The share [`OF_CLEARANCE`] of the height to which a bob that crosses the top would rise
    /// beyond it, if its acceleration there turned it round.
    fn beyond(&self, phase: &Phase<f64>) -> f64 {
        let top = StepState { phase: *phase, speed: self.pendulum.speeds(phase) };
        OF_CLEARANCE * height_beyond(&self.pendulum, &top, bob_at_top(phase))
    }

    /// Distance between two answers: in time (reduced) or in unit vectors and scaled momenta,
    /// whichever is larger; 0 if both are forbidden, infinite if their statuses differ.
    pub(super) fn distance(&self, a: &RunResult, b: &RunResult) -> f64 {
        match (a.outcome.status, b.outcome.status) {
            (Status::Answered, Status::Answered) => {
                let between = self.between(&a.end.phase, &b.end.phase);
                between.max((a.end.time - b.end.time).abs())
            }
            (Status::Unflipped, Status::Unflipped) => {
                let (early, late) = if a.end.time <= b.end.time { (a, b) } else { (b, a) };
                let caught_up =
                    transported(&self.pendulum, &early.end.phase, late.end.time - early.end.time);
                self.between(&caught_up, &late.end.phase)
            }
            (Status::Forbidden, Status::Forbidden) => 0.0,
            _ => f64::INFINITY,
        }
    }

    fn between(&self, a: &Phase<f64>, b: &Phase<f64>) -> f64 {
        let unit = |i: usize| if i < 4 { 1.0 } else { self.inverse_scale[i - 4] };
        (0..6).map(|i| (a[i] - b[i]).abs() * unit(i)).fold(0.0, f64::max)
    }
}
