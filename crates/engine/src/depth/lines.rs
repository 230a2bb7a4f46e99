//! Lines: patches whose starts differ in one coordinate only.
//!
//! Energy is conserved, so differences within a small patch grow exponentially in one direction
//! only. By the time at which its polynomials end, its states lie along a curve, to within a
//! residual that shrinks with the patch. Everything that happens later then depends on the place
//! along the curve:
//!
//! ```text
//!   starts in the patch         their states               flip times
//!   ┌───────────┐                                          T(s) │    ╭──╮
//!   │ · · · · · │  Φ(x, y)     ···──•──•──•──···P(s)            │───╯  │  ╭─
//!   │ · · · · · │ ─────────▶                      ─────────▶    │      ╰──╯
//!   └───────────┘              s along the curve                └────────── s
//! ```
//!
//! P(s) = Φ(s·u) is the curve through the patch's middle in the direction u that grows most, the
//! first right singular vector of Φ's linear part. Every start is written as P(s) moved along the
//! flow by a time τ, with a residual; it flips τ earlier than the start at s. So a strip of a
//! thousand pixels needs as many integrations as the function T(s) has features.
//!
//! T(s) is sampled on dyadic intervals. An interval is *smooth* if a polynomial of degree 4 goes
//! through its five samples and no bob came so near the top that a start between them could have
//! flipped there. Other intervals are halved, which narrows jumps down. Starts in intervals that
//! stay rough or are full of jumps, and starts whose residual could shift their flip, are
//! integrated one by one. Before a line is used, some starts off it are integrated too; if one of
//! them contradicts the line, all of the patch's starts are integrated one by one.
//!
//! Intervals, samples and all decisions belong to the patch, never to the request, so an answer
//! depends on nothing but its place in the lattice. Jobs share the samples.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

use super::finished_patch::{FinishedPatch, PartKey};
use super::line_check::{CheckPlace, LineCheck, LineVerdict};
use super::line_interval::{COARSEST, FINEST, Interval, IntervalVerdict, SAMPLES, Sample};
use super::part::PlacedStart;
use super::stats::DepthStats;
use crate::{EventSpec, IntegratorConfig, Job, JobResult, Moving};
use flipmap_pendulum::Outcome;
use flipmap_pendulum::flow_patch::Dynamics;

/// Binary logarithm of the number of sample places in half a patch.
const PLACES: i32 = FINEST + 2;

/// The place of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Place {
    /// A place on the line, in units of 2^−[`PLACES`].
    On(i32),
    /// A pendulum that checks the line.
    Check(CheckPlace),
}

/// The samples of lines that have been taken or requested, for one question and configuration.
pub(super) struct LineSamples {
    question: EventSpec,
    config: IntegratorConfig,
    lines: HashMap<PartKey, HashMap<Place, Sample>>,
    asked: HashSet<(PartKey, Place)>,
    count: usize,
}

/// The lines of a job's patches.
pub(super) struct Lines {
    pub dynamics: Dynamics,
    /// The reduced unit of time in s.
    unit_secs: f64,
    samples: u64,
    lines: Vec<Line>,
    /// Starts whose outcome is known, with their index in the job.
    pub known: Vec<(usize, Outcome)>,
    /// Indices of the starts that have to be integrated one by one.
    pub alone: Vec<usize>,
}

/// The next need of a job's lines.
pub(super) enum Need {
    /// Samples, by their places, with the pendulums that have to be integrated to their ends.
    Samples(Vec<((PartKey, Place), Moving)>),
    /// Samples that other jobs have requested.
    Others,
    /// No more samples.
    Nothing,
}

/// The line of a patch, with the intervals that have not been judged.
struct Line {
    patch: Arc<FinishedPatch>,
    open: Vec<Interval>,
    /// True once starts off the line have confirmed it.
    is_confirmed: bool,
}

impl LineSamples {
    /// Creates an empty set of samples.
    fn new(question: EventSpec, config: IntegratorConfig) -> Self {
        let (lines, asked) = (HashMap::new(), HashSet::new());
        LineSamples { question, config, lines, asked, count: 0 }
    }

    fn are_of(&self, question: &EventSpec, config: &IntegratorConfig) -> bool {
        self.question == *question && self.config == *config
    }

    /// Forgets samples that were requested and will not come.
    pub(super) fn cancel(&mut self) {
        self.asked.clear();
    }

    /// Takes the results of samples that were requested.
    pub(super) fn insert(&mut self, places: Vec<(PartKey, Place)>, results: &JobResult) {
        self.count += places.len();
        let samples = results.outcomes.iter().zip(&results.ends);
        for ((key, place), (outcome, end)) in places.into_iter().zip(samples) {
            self.asked.remove(&(key, place));
            let sample = Sample { outcome: *outcome, end: *end };
            self.lines.entry(key).or_default().insert(place, sample);
        }
    }
}

/// Largest number of samples that are kept for one question and configuration.
const MAX_SAMPLES: usize = 1 << 19;
/// Largest number of questions and configurations whose samples are kept.
const MAX_QUESTIONS: usize = 4;

/// Returns the samples for a job's question and configuration, emptied first if there are too many.
pub(super) fn samples_of<'a>(all: &'a mut Vec<LineSamples>, job: &Job) -> &'a mut LineSamples {
    let known = all.iter().position(|samples| samples.are_of(&job.question, &job.config));
    let mut samples = match known {
        Some(index) => all.remove(index),
        None => LineSamples::new(job.question, job.config),
    };
    if samples.count > MAX_SAMPLES && samples.asked.is_empty() {
        samples = LineSamples::new(job.question, job.config);
    }
    if all.len() >= MAX_QUESTIONS {
        all.remove(0);
    }
    all.push(samples);
    let last = all.len() - 1;
    &mut all[last]
}

impl Lines {
    /// Creates an empty set of lines.
    pub(super) fn new(dynamics: Dynamics, unit_secs: f64) -> Self {
        Lines {
            dynamics,
            unit_secs,
            samples: 0,
            lines: Vec::new(),
            known: Vec::new(),
            alone: Vec::new(),
        }
    }

    /// Adds those starts of a patch whose outcomes it does not give. Returns false if the patch is
    /// not a line.
    pub(super) fn add(&mut self, patch: &Arc<FinishedPatch>, starts: &[PlacedStart]) -> bool {
        let dynamics = &self.dynamics;
        let Some(curve) = patch.curve(dynamics) else { return false };
        let places: Vec<[f64; 2]> = starts.iter().map(|start| start.at).collect();
        let mut open: HashMap<i32, Interval> = HashMap::new();
        for (start, point) in starts.iter().zip(patch.points(dynamics, curve, &places)) {
            let Some(point) = point else {
                self.alone.push(start.index);
                continue;
            };
            let interval = Interval::around(COARSEST, point.s);
            open.entry(interval.place).or_insert(interval).starts.push((start.index, point));
        }
        let (patch, open) = (patch.clone(), open.into_values().collect());
        self.lines.push(Line { patch, open, is_confirmed: false });
        true
    }

    /// Decides as much as the samples allow, and returns what is needed next.
    pub(super) fn ask(&mut self, samples: &mut LineSamples) -> Need {
        let mut wanted = Vec::new();
        for line in &mut self.lines {
            let patch = line.patch.clone();
            let Some(curve) = patch.curve(&self.dynamics) else { continue };
            let (dynamics, unit_secs) = (&self.dynamics, self.unit_secs);
            let check = LineCheck { dynamics, patch: &patch.patch, curve, unit_secs };
            let taken = samples.lines.entry(patch.key).or_default();
            let mut missing: BTreeSet<Place> = line
                .confirm(&check, taken, &mut self.alone)
                .into_iter()
                .map(Place::Check)
                .collect();
            missing.extend(line.refine(taken, unit_secs, &mut self.known, &mut self.alone));
            for place in missing {
                if samples.asked.insert((patch.key, place)) {
                    let state = match place {
                        Place::On(place) => curve.at(f64::from(place) / f64::from(1 << PLACES)),
                        Place::Check(place) => check.state(place),
                    };
                    let clearance = patch.patch.clearance_outside_grazes();
                    wanted.push(((patch.key, place), patch.moving(dynamics, state, clearance)));
                }
            }
        }
        self.lines.retain(|line| !line.open.is_empty());
        self.samples += wanted.len() as u64;
        match (wanted.is_empty(), self.lines.is_empty()) {
            (false, _) => Need::Samples(wanted),
            (true, false) => Need::Others,
            (true, true) => Need::Nothing,
        }
    }

    /// Adds the counts of the lines to statistics in which every start counts as integrated.
    pub(super) fn counted(&self, depth: DepthStats) -> DepthStats {
        let told = self.known.len() as u64;
        let integrated = depth.integrated - told + self.samples;
        DepthStats { integrated, line_samples: self.samples, told_by_lines: told, ..depth }
    }
}

impl Line {
    /// Judges the line by the starts that check it, and returns those that are missing. If they
    /// refuse the line, all its starts have to be integrated one by one.
    fn confirm(
        &mut self,
        check: &LineCheck,
        taken: &HashMap<Place, Sample>,
        alone: &mut Vec<usize>,
    ) -> Vec<CheckPlace> {
        if self.is_confirmed {
            return Vec::new();
        }
        match check.verdict(|place| taken.get(&Place::Check(place)).copied()) {
            LineVerdict::Missing(missing) => return missing,
            LineVerdict::Confirmed => self.is_confirmed = true,
            LineVerdict::Refused => {
                log::info!("starts off a line refuse it: {:?}", self.patch.key);
                let starts = self.open.drain(..).flat_map(|interval| interval.starts);
                alone.extend(starts.map(|(index, _)| index));
            }
        }
        Vec::new()
    }

    /// Judges intervals and halves those that are rough, as far as the samples allow. Adds the
    /// starts whose outcome is known now, and those that have to be integrated alone; returns the
    /// places of the samples that are missing.
    fn refine(
        &mut self,
        taken: &HashMap<Place, Sample>,
        unit_secs: f64,
        known: &mut Vec<(usize, Outcome)>,
        alone: &mut Vec<usize>,
    ) -> BTreeSet<Place> {
        let mut missing = BTreeSet::new();
        let mut waiting = std::mem::take(&mut self.open);
        while let Some(interval) = waiting.pop() {
            let places = interval.places(PLACES).map(Place::On);
            missing.extend(places.iter().filter(|place| !taken.contains_key(place)));
            let samples = places.map(|place| taken.get(&place));
            if !self.is_confirmed || samples.contains(&None) {
                self.open.push(interval);
                continue;
            }
            let samples: [&Sample; SAMPLES] =
                samples.map(|sample| sample.expect("none is missing"));
            match IntervalVerdict::on(samples, unit_secs) {
                IntervalVerdict::Rough(jumps) if interval.can_be_halved(jumps, self.patch.area) => {
                    waiting.extend(interval.halves());
                }
                IntervalVerdict::Rough(_) => {
                    alone.extend(interval.starts.iter().map(|(index, _)| index))
                }
                smooth => {
                    let since_secs = self.patch.patch.time.0 * unit_secs;
                    interval.settle(&smooth, [since_secs, unit_secs], known, alone);
                }
            }
        }
        missing
    }
}
