//! Lines: leaves whose starts differ in one coordinate only.
//!
//! Energy is conserved, so of the differences within a small leaf one direction alone grows
//! exponentially. By the time at which the leaf's polynomials end, its states lie along a curve,
//! to within a residual that shrinks with the leaf, and with it everything that happens later:
//!
//! ```text
//!   starts in the leaf          their states               flip times
//!   ┌───────────┐                                          T(s) │    ╭──╮
//!   │ · · · · · │  Φ(x, y)     ···──•──•──•──···P(s)            │───╯  │  ╭─
//!   │ · · · · · │ ─────────▶                      ─────────▶    │      ╰──╯
//!   └───────────┘              s along the curve                └────────── s
//! ```
//!
//! P(s) = Φ(s·u) is the curve through the leaf's middle in the direction u that grows most, the first
//! right singular vector of Φ's linear part. Every start is written as P(s) moved along the flow by
//! a time τ, with a residual; it flips τ earlier than the start at s. So a leaf of a thousand pixels
//! needs as many integrations as the function T(s) has features.
//!
//! T(s) is sampled on dyadic intervals. An interval is *smooth* if a polynomial of degree 4 goes
//! through its five samples and no bob came so near the top that a start between them could have
//! flipped there. Others are halved; starts in those that stay rough, and starts whose residual could
//! shift their flip, are integrated one by one as everywhere else.
//!
//! Intervals, samples and all decisions belong to the leaf, never to the request, so an answer
//! depends on nothing but its place in the lattice.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use super::line_interval::{FINEST, Interval, SAMPLES, Sample, Verdict};
use super::start_map::FinishedPatch;
use super::stats::DepthStats;
use crate::engine::{JobResult, Moving};
use crate::physics::Outcome;
use crate::physics::flow_patch::{Curve, Dynamics};

/// Binary logarithm of the number of sample places in half a leaf.
const PLACES: i32 = FINEST + 2;
/// Largest residual, in half leaves along the line, of a leaf that is taken for a line.
const MOST_ASIDE: f64 = 1e-4;

/// The lines of a job's leaves.
pub(super) struct Lines {
    dynamics: Dynamics,
    /// The reduced unit of time in s.
    unit_secs: f64,
    samples: u64,
    leaves: Vec<LeafLine>,
    /// Samples that were asked for: the index of their leaf, and their place.
    asked: Vec<(usize, i32)>,
    /// Starts whose outcome is known, with their index in the job.
    pub known: Vec<(usize, Outcome)>,
    /// Indices of the starts that have to be integrated one by one.
    pub alone: Vec<usize>,
}

/// A leaf with the samples taken along its line.
struct LeafLine {
    patch: Arc<FinishedPatch>,
    curve: Curve,
    samples: HashMap<i32, Sample>,
    open: Vec<Interval>,
}

impl Lines {
    /// No lines yet.
    pub(super) fn new(dynamics: Dynamics, unit_secs: f64) -> Self {
        Lines {
            dynamics,
            unit_secs,
            samples: 0,
            leaves: Vec::new(),
            asked: Vec::new(),
            known: Vec::new(),
            alone: Vec::new(),
        }
    }

    /// Adds some starts of the leaf of `patch`, by their indices in the job and their states when the
    /// patch ends. If the leaf is no line, they have to be integrated one by one.
    pub(super) fn add(&mut self, patch: &Arc<FinishedPatch>, starts: &[(usize, Moving)]) {
        let dynamics = &self.dynamics;
        let Some(curve) = patch.curve(dynamics, MOST_ASIDE) else {
            return self.alone.extend(starts.iter().map(|(index, _)| index));
        };
        let mut open: Vec<Interval> = Vec::new();
        for (index, moving) in starts {
            let index = *index;
            let Some(point) = curve.point(dynamics, &moving.phase) else {
                self.alone.push(index);
                continue;
            };
            let place = point.s.floor() as i32;
            match open.iter_mut().find(|interval| interval.place == place) {
                Some(interval) => interval.starts.push((index, point)),
                None => open.push(Interval { level: 0, place, starts: vec![(index, point)] }),
            }
        }
        let samples = HashMap::new();
        self.leaves.push(LeafLine { patch: patch.clone(), curve, samples, open });
    }

    /// Decides as much as the samples allow, and returns the pendulums of the samples that are
    /// needed next; none once everything is decided.
    pub(super) fn ask(&mut self) -> Vec<Moving> {
        let mut wanted = Vec::new();
        for (leaf, line) in self.leaves.iter_mut().enumerate() {
            let (known, missing) = line.refine(self.unit_secs, &mut self.alone);
            self.known.extend(known);
            for place in missing {
                let s = f64::from(place) / f64::from(1 << PLACES);
                let clearance = line.patch.patch.clearance([0.0; 2]);
                wanted.push(line.patch.moving(&self.dynamics, line.curve.at(s), clearance));
                self.asked.push((leaf, place));
            }
        }
        self.samples += wanted.len() as u64;
        wanted
    }

    /// Adds the counts of the lines to statistics in which every start counts as integrated.
    pub(super) fn counted(&self, depth: DepthStats) -> DepthStats {
        let told = self.known.len() as u64;
        let integrated = depth.integrated - told + self.samples;
        DepthStats { integrated, told_by_lines: told, ..depth }
    }

    /// Takes the results of the samples that were asked for.
    pub(super) fn answer(&mut self, results: &JobResult) {
        for (k, (leaf, place)) in std::mem::take(&mut self.asked).into_iter().enumerate() {
            let sample = Sample { outcome: results.outcomes[k], end: results.ends[k] };
            self.leaves[leaf].samples.insert(place, sample);
        }
    }
}

impl LeafLine {
    /// Judges intervals and halves those that are rough, as far as the samples allow. Returns the
    /// starts whose outcome is known now, and the places of the samples that are missing.
    fn refine(
        &mut self,
        unit_secs: f64,
        alone: &mut Vec<usize>,
    ) -> (Vec<(usize, Outcome)>, BTreeSet<i32>) {
        let (mut known, mut missing) = (Vec::new(), BTreeSet::new());
        let mut waiting = std::mem::take(&mut self.open);
        while let Some(interval) = waiting.pop() {
            let places = interval.places(PLACES);
            let samples = places.map(|place| self.samples.get(&place));
            if samples.contains(&None) {
                missing.extend(places.iter().filter(|place| !self.samples.contains_key(place)));
                self.open.push(interval);
                continue;
            }
            let samples: [&Sample; SAMPLES] =
                samples.map(|sample| sample.expect("none is missing"));
            match Verdict::on(samples, unit_secs) {
                Verdict::Rough if interval.level < FINEST => waiting.extend(interval.halves()),
                Verdict::Rough => alone.extend(interval.starts.iter().map(|(index, _)| index)),
                smooth => interval.settle(&smooth, unit_secs, &mut known, alone),
            }
        }
        (known, missing)
    }
}
