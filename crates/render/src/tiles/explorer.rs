//! The window's scheduler, which chooses the cells of the lattice to compute next.
//!
//! A [`ViewTarget`] names the physics, the budget and the part of the plane in view. The cells that
//! it needs are queued in the order of `order.rs`, except those already known or in flight. Each
//! new target replaces the queue; if at most half of the jobs in flight still serve it, all of them
//! are cancelled.
//!
//! Finished cells go into a [`Cache`] by physics, so that a view seen before is drawn at once. When
//! the budget grows, unflipped pixels are resumed, unless they are deep or checked.
//!
//! The window calls [`Explorer::work`] with a deadline and draws between the calls; a test without
//! a window calls it without a deadline.

mod batch;
mod known;
mod morphing;
mod needs;

use std::collections::{HashMap, HashSet, VecDeque};

use self::batch::{Batch, BatchCell};
use super::cache::{Cache, SampleSet};
use super::in_flight::{FinishedBatch, InFlightJobs, NextTile, TileSource};
use super::open_tile::{OpenTile, Spacing};
use super::order::{self, Wanted};
use super::reader::Reader;
use super::refinement::Refinement;
use super::samples::Counts;
use super::stride::Stride;
use super::view_target::{Physics, ViewTarget};
use flipmap_engine::clock::Instant;
use flipmap_engine::{DepthStats, Engine, EngineError, Wait};
use flipmap_scene::lattice::{Cell, SIDE};

/// The progress of the newest target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewProgress {
    /// Level of the target.
    pub level: u32,
    /// Number of cells of that level in view.
    pub wanted: usize,
    /// Number of those cells that are computed to the budget.
    pub done: usize,
    /// Share of all samples of those cells that are computed to the budget, 0 to 1.
    pub share: f64,
    /// Share of the way to rest that is covered, 0 to 1: the samples of the view are one half of it
    /// and the finer samples at edges, if any are wanted, the other.
    pub way: f64,
    /// True if every cell in view or one of its ancestors is known.
    pub covered: bool,
    /// True if nothing is left to do, except finer samples at edges.
    pub idle: bool,
    /// True if finer samples at edges are being computed.
    pub refines: bool,
}

impl ViewProgress {
    /// Returns true if every cell in view is computed to the budget; finer samples at edges may
    /// still come.
    pub fn is_complete(&self) -> bool {
        self.wanted > 0 && self.done == self.wanted
    }
}

/// Maximum number of cells of a level that are drawn at once.
pub const MAX_CELLS: usize = 6000;
/// Maximum number of cells in a job, which fill a large graphics card.
const MAX_CELLS_IN_JOB: usize = 256;

/// A physics viewed before, and whether the mirror images of its cells have equal samples.
#[derive(Debug)]
struct KnownPhysics {
    physics: Physics,
    mirrors: bool,
}

/// The cells of a window: those computed so far, those in flight and those still to be computed.
#[derive(Debug)]
pub struct Explorer {
    cache: Cache,
    /// All physics viewed so far; the index of each is its key.
    physics: Vec<KnownPhysics>,
    target: Option<ViewTarget>,
    /// Target that follows once the current one is known coarsely.
    next: Option<ViewTarget>,
    /// Key of the target's physics.
    key: usize,
    /// Moment at which the target's physics last changed.
    key_since: Option<Instant>,
    /// Key of the latest earlier physics that was known all over the view and answers the same
    /// question.
    before: Option<usize>,
    /// Cells of the target that are still to be computed, canonical, in order.
    waiting: VecDeque<Wanted>,
    refinement: Refinement,
    in_flight: InFlightJobs<Batch>,
    /// True if at most half of the jobs in flight are of use to the target.
    stale: bool,
    /// True if the target has a new view, for which no job has been submitted yet.
    begins: bool,
    counts: Counts,
    depth: Option<DepthStats>,
}

impl Explorer {
    /// Creates an explorer without a target that keeps about `cache_bytes` bytes of cells.
    pub fn new(cache_bytes: usize) -> Self {
        Explorer {
            cache: Cache::new(cache_bytes),
            physics: Vec::new(),
            target: None,
            next: None,
            key: 0,
            key_since: None,
            before: None,
            waiting: VecDeque::new(),
            refinement: Refinement::default(),
            in_flight: InFlightJobs::default(),
            stale: false,
            begins: false,
            counts: Counts::default(),
            depth: None,
        }
    }

    /// Replaces the target; a target that differs only in the pendulum waits until the current one
    /// is known coarsely.
    pub fn target(&mut self, target: &ViewTarget) {
        self.next = None;
        if self.target.as_ref() == Some(target) {
            return;
        }
        if self.holds(target) {
            self.next = Some(target.clone());
            return;
        }
        let is_same_view = self.target.as_ref().is_some_and(|last| last.is_same_view(target));
        let key = self.key_of(&target.physics);
        // A physics that was replaced so quickly that little of it is known cannot stand in.
        if key != self.key && self.progress().covered {
            self.before = Some(self.key);
        }
        if key != self.key || self.key_since.is_none() {
            self.key_since = Some(Instant::now());
        }
        // Samples with other channels have no colour in this question's picture.
        let ask = |key: usize| self.physics[key].physics.question.ask;
        self.before = self.before.filter(|&before| ask(before) == ask(key));
        self.key = key;
        let begun = if is_same_view { self.refinement.begun } else { 0 };
        self.begins |= !is_same_view;
        self.target = Some(target.clone());
        // Finer samples take at most half of the room: views seen before are worth as much.
        let channels = target.physics.question.ask.kind().channels.len();
        self.refinement =
            Refinement::of(target, MAX_CELLS.min(self.cache.room(channels) / 2), begun);
        // A moved pointer changes no order if nothing waits.
        if !(is_same_view && self.is_done()) {
            self.plan();
        }
        self.refine();
    }

    /// Begins the next finer level once nothing else is left to do.
    fn refine(&mut self) {
        while self.is_done() && self.refinement.begin_next() {
            self.plan();
            self.refinement.expect(self.left());
        }
    }

    /// Returns the number of cells that wait or are in flight.
    fn left(&self) -> usize {
        let flying: usize = self.in_flight.tiles().map(|batch| batch.keys().count()).sum();
        self.waiting.len() + flying
    }

    /// Returns the key of a physics, which is added to the list if it is new.
    fn key_of(&mut self, physics: &Physics) -> usize {
        let known = self.physics.iter().position(|other| other.physics == *physics);
        known.unwrap_or_else(|| {
            let (physics, mirrors) = (physics.clone(), physics.mirrors());
            self.physics.push(KnownPhysics { physics, mirrors });
            self.physics.len() - 1
        })
    }

    /// Queues the cells that the target needs and that are neither known nor in flight.
    fn plan(&mut self) {
        let Some(target) = &self.target else { return };
        let channels = target.physics.question.ask.kind().channels.len();
        let mut cells = order::wanted(target, self.cache.room(channels));
        cells.extend(order::finer(target, self.refinement.begun));
        let wanted: HashSet<_> = cells.iter().map(|wanted| self.cache_key(wanted)).collect();
        // Cells computed for a closer view serve as well as refined ones.
        let sets = [false, true].map(|refined| self.set(refined));
        self.cache.want(wanted.iter().flat_map(|&(_, cell)| sets.map(|set| (set, cell))));
        // Cells in flight to a smaller budget are resumed when they have finished.
        let jobs = self.in_flight.tiles();
        let jobs: HashMap<_, _> =
            jobs.flat_map(|batch| batch.keys().map(|key| (key, batch.stride))).collect();
        let flies = |wanted: &Wanted| {
            let stride = jobs.get(&self.cache_key(wanted));
            stride.is_some_and(|stride| *stride <= wanted.pass.stride())
        };
        let budget_secs = target.budget_secs;
        self.waiting = cells
            .into_iter()
            .filter(|wanted| !flies(wanted) && self.needs(*wanted, budget_secs))
            .collect();
        let useful = |batch: &&Batch| batch.keys().any(|key| wanted.contains(&key));
        let useful = self.in_flight.tiles().filter(useful).count();
        self.stale = !self.in_flight.is_empty() && 2 * useful <= self.in_flight.len();
    }

    /// Submits waiting cells to the engine and collects finished ones. With a deadline it never
    /// waits, and stops preparing jobs when the deadline has passed; without one it returns when
    /// all is done. Returns true if anything new can be drawn.
    pub fn work(
        &mut self,
        engine: &mut dyn Engine,
        deadline: Option<Instant>,
    ) -> Result<bool, EngineError> {
        let mut news = false;
        loop {
            self.follow();
            if std::mem::take(&mut self.stale) {
                self.in_flight.cancel(engine);
                self.plan();
            }
            if std::mem::take(&mut self.begins) {
                engine.begin_picture();
            }
            news |= self.submit_until(engine, deadline)?;
            let wait = deadline.map_or(Wait::UntilFinished, |_| Wait::Until(Instant::now()));
            news |= self.collect(engine, wait)?;
            self.refine();
            if let Some(deadline) = deadline {
                if Instant::now() < deadline {
                    news |= self.submit_until(engine, Some(deadline))?;
                }
                return Ok(news);
            }
            if self.is_done() {
                return Ok(news);
            }
        }
    }

    fn submit_until(
        &mut self,
        engine: &mut dyn Engine,
        deadline: Option<Instant>,
    ) -> Result<bool, EngineError> {
        let late = |_: &Self| deadline.is_some_and(|deadline| Instant::now() >= deadline);
        let submitted = self.submit(engine, late);
        if submitted.is_err() {
            // Cells that the engine refused are no longer in the queue.
            self.plan();
        }
        submitted
    }

    /// Returns true if cells are waiting but no job is in flight whose end would wake the caller.
    /// With a deadline, [`Explorer::work`] may return in this state after cells that need no
    /// engine.
    pub fn is_waiting(&self) -> bool {
        self.target.is_some() && self.in_flight.is_empty() && !self.waiting.is_empty()
    }

    /// Returns true if no cell is waiting or in flight, and no target waits for the current one.
    pub fn is_done(&self) -> bool {
        self.waiting.is_empty() && self.in_flight.is_empty() && self.next.is_none()
    }

    /// Forgets the jobs in flight of an engine that is gone; nothing that was computed is lost.
    pub fn ground(&mut self) {
        self.in_flight.forget();
        self.plan();
    }

    /// Returns the budget of a cell's pass: that of the target, or of an earlier pass of the cell
    /// if that was larger, because a cell has only one budget, from which its states are resumed.
    fn pass_budget_secs(&self, key: (SampleSet, Cell), target: &ViewTarget) -> f64 {
        let known = self.cache.peek(key.0, key.1);
        known.map_or(target.budget_secs, |known| known.budget_secs.max(target.budget_secs))
    }

    /// Takes the next cells that can share a job from the queue: cells of one level, set, stride
    /// and budget, either all new or all to be resumed. Cells in flight stay queued until their
    /// results are known.
    fn next_cells(&mut self, target: &ViewTarget, job_size: usize) -> Option<(Wanted, Vec<Cell>)> {
        let flying: HashSet<_> = self.in_flight.tiles().flat_map(Batch::keys).collect();
        let waits = |wanted: &Wanted| flying.contains(&self.cache_key(wanted));
        let traits = |wanted: &Wanted| {
            let (set, cell) = self.cache_key(wanted);
            let (known, stride) = (self.cache.peek(set, cell), wanted.pass.stride());
            let continues =
                known.is_some_and(|known| known.stride == stride && !known.unfinished.is_empty());
            let budget_secs = self.pass_budget_secs((set, cell), target);
            (set, stride, cell.level, budget_secs, continues)
        };
        let first = *self.waiting.iter().find(|wanted| !waits(wanted))?;
        let group = traits(&first);
        let alike = |wanted: &Wanted| !waits(wanted) && traits(wanted) == group;
        let stride = first.pass.stride();
        let most = (job_size / (2 * stride.count(SIDE) as usize)).clamp(1, MAX_CELLS_IN_JOB);
        let mut cells = Vec::new();
        let mut is_left = |wanted: &Wanted| {
            let is_taken = cells.len() < most && alike(wanted);
            cells.extend(is_taken.then_some(wanted.cell));
            !is_taken
        };
        let left = self.waiting.iter().filter(|wanted| is_left(wanted)).copied().collect();
        self.waiting = left;
        Some((first, cells))
    }

    /// Returns the counts of all that has been computed so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Returns the statistics of the batch computed last; `None` if its cells were not deep.
    pub fn depth(&self) -> Option<DepthStats> {
        self.depth
    }

    /// Number of bytes of cells held.
    pub fn bytes(&self) -> usize {
        self.cache.bytes()
    }

    /// Changes the number of bytes to keep.
    pub fn set_cache_bytes(&mut self, bytes: usize) {
        self.cache.set_budget(bytes);
        self.plan();
    }
}

impl TileSource for Explorer {
    type Tile = Batch;

    fn in_flight(&mut self) -> &mut InFlightJobs<Batch> {
        &mut self.in_flight
    }

    fn next_tile(&mut self, job_size: usize) -> Option<NextTile<Batch>> {
        let mut target = self.target.clone()?;
        let (first, cells) = self.next_cells(&target, job_size)?;
        target.budget_secs = self.pass_budget_secs(self.cache_key(&first), &target);
        let (set, stride) = (self.cache_key(&first).0, first.pass.stride());
        let coarser = if set.refined { self.coarser(&cells) } else { Vec::new() };
        let (config, ask) = (target.physics.config, target.physics.question.ask);
        let before = |k: usize, place| match &coarser[..] {
            // Budgets of other questions than times belong to the physics: they never grow.
            [] => self.cache.peek(set, cells[k])?.known(place, target.budget_secs),
            coarser if ask.is_time() => coarser[k].as_ref()?.known(place),
            _ => None,
        };
        let (scene, question) = (target.scene(), target.question());
        let leaf_pixels = order::leaf_pixels(config.leaf_pixels(), target.level, cells[0].level);
        let spacing = Spacing { side: SIDE, stride, leaf_pixels };
        let mut open = OpenTile::of_cells(&scene, config, &cells, spacing, before);
        if !ask.is_time() {
            let grids: Vec<_> = cells.iter().map(|cell| cell.grid(&scene, SIDE)).collect();
            let in_cell = stride.count(SIDE);
            let phase = |index: usize| {
                let (k, index) = (index / in_cell as usize, index as u32 % in_cell);
                let [column, row] = stride.place(index, SIDE);
                grids[k].phase_at_first_pass(column, row)
            };
            open.samples = Reader::new(ask, &question).complete(open.samples, phase);
        }
        let keeps_states = target.physics.keeps_states() && !set.refined;
        let batched = |cell| BatchCell::new(cell, self.cache.peek(set, cell), stride);
        let cells = cells.into_iter().map(batched).collect();
        let batch = Batch { set, budget_secs: target.budget_secs, stride, cells };
        Some(NextTile { tile: batch, open, question, config, keeps_states, ask })
    }

    fn take(&mut self, finished: FinishedBatch<Batch>) {
        finished.count_work(&mut self.counts);
        if !finished.computed.is_empty() {
            self.depth = finished.effort.depth;
        }
        // The budget may have been raised since the job was submitted.
        let target = self.target.as_ref();
        let is_late = target.is_some_and(|to| finished.tile.budget_secs < to.budget_secs);
        let all_kept = self.keep(finished);
        if is_late || !all_kept {
            self.plan();
        }
    }
}
