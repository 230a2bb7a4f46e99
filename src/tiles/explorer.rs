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

mod known;
mod morphing;

use std::collections::{HashSet, VecDeque};
use std::time::Instant;

use super::cache::{Cache, SampleSet};
use super::in_flight::{FinishedBatch, InFlightJobs, NextTile, TileSource};
use super::open_tile::OpenTile;
use super::order::{self, CellPass, Wanted};
use super::reader::Reader;
use super::refinement::{Refinement, quarter_of};
use super::samples::{Counts, Samples};
use super::view_target::{Physics, ViewTarget};
use crate::engine::{DepthStats, Engine, EngineError, IntegratorState, Wait};
use crate::scene::lattice::{Cell, SAMPLES, SIDE};

/// The progress of the newest target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ViewProgress {
    /// Level of the target.
    pub level: u32,
    /// Number of cells of that level in view.
    pub wanted: usize,
    /// Number of those cells that are computed to the budget.
    pub done: usize,
    /// True if every cell in view or one of its ancestors is known.
    pub covered: bool,
    /// True if nothing is left to do, not even around the view, except finer samples at edges.
    pub idle: bool,
    /// True if these are being computed.
    pub refines: bool,
}

/// Maximum number of cells of a level that are drawn at once.
pub const MOST_CELLS: usize = 1500;
/// Maximum number of cells in a job, which fill a large graphics card.
const MOST_IN_JOB: usize = 64;

/// Cells of one job in flight, with the key of their physics and their budget.
#[derive(Debug)]
pub(super) struct Batch {
    set: SampleSet,
    budget_secs: f64,
    cells: Vec<Cell>,
}

impl Batch {
    fn keys(&self) -> impl Iterator<Item = (SampleSet, Cell)> {
        self.cells.iter().map(|cell| (self.set, *cell))
    }
}

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
    /// Moment at which that physics became the target's.
    key_since: Option<Instant>,
    /// Key of the latest earlier physics that was known all over the view and answers the same question.
    before: Option<usize>,
    /// Cells of the target that are still to be computed, canonical, in order.
    waiting: VecDeque<Wanted>,
    refinement: Refinement,
    in_flight: InFlightJobs<Batch>,
    /// True if at most half of the jobs in flight are of use to the target.
    stale: bool,
    /// True if the target is of another view, of which no job has been submitted yet.
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

    /// Replaces the target; one that differs in the pendulum alone follows as soon as the current one
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
        // A physics that was passed so quickly that little of it is known cannot stand in.
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
            Refinement::of(target, MOST_CELLS.min(self.cache.room(channels) / 2), begun);
        // A pointer has no order to change where nothing waits.
        if !(is_same_view && self.is_done()) {
            self.plan();
        }
        self.refine();
    }

    /// Begins the next finer level once nothing else is left to do.
    fn refine(&mut self) {
        while self.is_done() && self.refinement.begin_next() {
            self.plan();
        }
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
        // Cells seen closer before are as good as finer ones.
        let sets = [false, true].map(|refined| self.set(refined));
        self.cache.want(wanted.iter().flat_map(|&(_, cell)| sets.map(|set| (set, cell))));
        // Cells in flight to a smaller budget are resumed when they have finished.
        let jobs = self.in_flight.tiles();
        let jobs: HashSet<_> = jobs.flat_map(Batch::keys).collect();
        self.waiting = cells
            .into_iter()
            .filter(|wanted| !jobs.contains(&self.cache_key(wanted)) && self.needs(*wanted))
            .collect();
        let useful = |batch: &&Batch| batch.keys().any(|key| wanted.contains(&key));
        let useful = self.in_flight.tiles().filter(useful).count();
        self.stale = !self.in_flight.is_empty() && 2 * useful <= self.in_flight.len();
    }

    /// Returns true if a cell has to be computed. A coarse one does not if its parent or all of its
    /// quarters are known, which are nearly as fine and stand in; a finer one only if its parent has
    /// edges there.
    fn needs(&self, Wanted { cell, pass }: Wanted) -> bool {
        let is_known = |cell: Cell| self.peek(cell).is_some();
        let is_known_to_budget = |cell: Cell| {
            let budget_secs = self.target.as_ref().map_or(0.0, |target| target.budget_secs);
            self.peek(cell).is_some_and(|known| known.budget_secs >= budget_secs)
        };
        match pass {
            CellPass::Coarse => {
                let mut quarters = cell.children().into_iter();
                !(is_known(cell) || cell.parent().is_some_and(is_known) || quarters.all(is_known))
            }
            CellPass::Own => !is_known_to_budget(cell),
            CellPass::Finer => self.peek_finer(cell).is_none() && self.has_edges(cell),
        }
    }

    /// Returns true if the parent of a cell has edges where the cell lies.
    fn has_edges(&self, cell: Cell) -> bool {
        let Some(parent) = cell.parent() else { return false };
        let (_, mirrored) = parent.computed(self.mirrors(self.key));
        let quarter = quarter_of(&cell, &parent, mirrored);
        self.peek_finer(parent).is_some_and(|parent| parent.edges()[quarter])
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
    /// With a deadline, [`Explorer::work`] may stop there, among cells known without an engine.
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

    /// Takes the next cells that can share a job from the queue: cells of one level and set, either
    /// all new or all to be resumed.
    fn next_cells(&mut self, most: usize) -> Option<(SampleSet, Vec<Cell>)> {
        let traits = |wanted: &Wanted| {
            let (set, cell) = self.cache_key(wanted);
            let known = self.cache.peek(set, cell);
            let continues = known.is_some_and(|known| !known.unfinished.is_empty());
            (set, cell.level, continues)
        };
        let first = traits(self.waiting.front()?);
        let alike = |wanted: &&Wanted| traits(wanted) == first;
        let count = self.waiting.iter().take(most).take_while(alike).count();
        Some((first.0, self.waiting.drain(..count).map(|wanted| wanted.cell).collect()))
    }

    /// Counts a batch's samples and stores them in the cache, cell by cell.
    fn keep(&mut self, batch: &Batch, samples: &Samples, unfinished: &[(u32, IntegratorState)]) {
        self.counts.add(samples);
        for (k, cell) in batch.cells.iter().enumerate() {
            let places = k * SAMPLES..(k + 1) * SAMPLES;
            let first = places.start as u32;
            let unfinished = unfinished
                .iter()
                .filter(|(place, _)| places.contains(&(*place as usize)))
                .map(|(place, state)| (place - first, state.clone()))
                .collect();
            let samples = samples.part(places.clone());
            self.cache.insert(batch.set, *cell, samples, batch.budget_secs, unfinished);
        }
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
        let target = self.target.clone()?;
        let most = (job_size / (2 * SAMPLES)).clamp(1, MOST_IN_JOB);
        let (set, cells) = self.next_cells(most)?;
        let coarser = if set.refined { self.coarser(&cells) } else { Vec::new() };
        let batch = Batch { set, budget_secs: target.budget_secs, cells };
        let (config, ask) = (target.physics.config, target.physics.question.ask);
        // Only times of flips stay the same when the budget grows.
        let continues = ask.is_time();
        let before = |k: usize, place| match &coarser[..] {
            _ if !continues => None,
            [] => self.cache.peek(batch.set, batch.cells[k])?.known(place),
            coarser => coarser[k].as_ref()?.known(place),
        };
        let (scene, question) = (target.scene(), target.question());
        let level = batch.cells[0].level;
        let sizes = (SIDE, order::leaf_pixels(config.leaf_pixels(), target.level, level));
        let mut open = OpenTile::of_cells(&scene, config, &batch.cells, sizes, before);
        if !ask.is_time() {
            let grids: Vec<_> = batch.cells.iter().map(|cell| cell.grid(&scene, SIDE)).collect();
            let start = |place: usize| {
                let (cell, place) = (place / SAMPLES, (place % SAMPLES) as u32);
                grids[cell].angle_from_pixel(place % SIDE, place / SIDE)
            };
            open.samples = Reader::new(ask, &question).complete(open.samples, start);
        }
        let keeps_states = target.physics.keeps_states() && !set.refined;
        Some(NextTile { tile: batch, open, question, config, keeps_states, ask })
    }

    fn take(&mut self, finished: FinishedBatch<Batch>) {
        finished.count_work(&mut self.counts);
        if !finished.computed.is_empty() {
            self.depth = finished.effort.depth;
        }
        let FinishedBatch { tile: batch, samples, unfinished, .. } = finished;
        self.keep(&batch, &samples, &unfinished);
        // The budget has been raised since the job was submitted.
        if self.target.as_ref().is_some_and(|target| batch.budget_secs < target.budget_secs) {
            self.plan();
        }
    }
}
