//! The window's scheduler: which cells of the lattice are computed next.
//!
//! An [`Aim`] says what is looked at. The cells it wants are queued, what is known or on its way
//! left out. The newest target replaces the queue, and where most of what flies serves it no longer,
//! that is dropped. The window calls [`Explorer::work`] with a deadline and draws between; a test
//! without a window calls it with none.

use std::collections::{HashSet, VecDeque};
use std::time::Instant;

use super::cache::{Cache, CachedCell};
use super::in_flight::{FinishedBatch, InFlightJobs, NextTile, TileSource};
use super::open_tile::OpenTile;
use super::order;
use super::samples::{Counts, Samples};
use super::view_target::{Physics, ViewTarget};
use crate::engine::{DepthStats, Engine, EngineError, IntegratorState, Keep, Wait};
use crate::scene::lattice::{Cell, SAMPLES, SIDE};

/// How far the newest target is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ViewProgress {
    /// The level aimed at.
    pub level: u32,
    /// Cells of that level in view.
    pub wanted: usize,
    /// Those among them that are computed to the budget.
    pub done: usize,
    /// Whether something is known for every cell in view.
    pub covered: bool,
    /// Whether nothing is left to do, not even around the view.
    pub idle: bool,
}

/// More cells of a level are never drawn at once.
pub const MOST_CELLS: usize = 1500;
/// Tiles in a job at most.
const MOST_IN_JOB: usize = 16;

/// Cells on their way: of which physics, to which budget.
#[derive(Debug)]
pub(super) struct Batch {
    physics: usize,
    budget_secs: f64,
    cells: Vec<Cell>,
}

/// The cells of a window.
#[derive(Debug)]
pub struct Explorer {
    cache: Cache,
    /// Every physics looked at so far; its place is its key.
    physics: Vec<Physics>,
    target: Option<ViewTarget>,
    /// The key of the aim's physics.
    key: usize,
    /// The key of the one that was last known all over the view before it.
    before: Option<usize>,
    /// Cells of the target to compute, canonical, first first.
    waiting: VecDeque<Cell>,
    in_flight: InFlightJobs<Batch>,
    /// Most of what flies is of no use to the target.
    stale: bool,
    counts: Counts,
    depth: Option<DepthStats>,
}

impl Explorer {
    /// One that keeps about as many bytes.
    pub fn new(cache_bytes: usize) -> Self {
        Explorer {
            cache: Cache::new(cache_bytes),
            physics: Vec::new(),
            target: None,
            key: 0,
            before: None,
            waiting: VecDeque::new(),
            in_flight: InFlightJobs::default(),
            stale: false,
            counts: Counts::default(),
            depth: None,
        }
    }

    /// Replaces what is looked at.
    pub fn target(&mut self, target: ViewTarget) {
        if self.target == Some(target) {
            return;
        }
        let key = self.key_of(&target.physics);
        // One that was passed over so fast that little of it is known cannot stand in.
        if key != self.key && self.progress().covered {
            self.before = Some(self.key);
        }
        self.key = key;
        self.target = Some(target);
        self.plan();
    }

    /// The place of a physics in the list.
    fn key_of(&mut self, physics: &Physics) -> usize {
        let known = self.physics.iter().position(|other| other == physics);
        known.unwrap_or_else(|| {
            self.physics.push(*physics);
            self.physics.len() - 1
        })
    }

    /// Queues what the target wants and nobody computes yet.
    fn plan(&mut self) {
        let Some(target) = self.target else { return };
        let cells = order::wanted(&target, self.cache.room());
        self.cache.want(self.key, cells.iter().map(|(cell, _)| *cell));
        // What flies to a smaller budget is continued when it has finished.
        let jobs = self.in_flight.tiles().filter(|batch| batch.physics == self.key);
        let jobs: HashSet<Cell> = jobs.flat_map(|batch| batch.cells.iter().copied()).collect();
        let wanted: HashSet<Cell> = cells.iter().map(|(cell, _)| *cell).collect();
        self.waiting = cells
            .into_iter()
            .filter(|(cell, finest)| !jobs.contains(cell) && self.needs(*cell, *finest))
            .map(|(cell, _)| cell)
            .collect();
        let useful = |batch: &&Batch| {
            batch.physics == self.key && batch.cells.iter().any(|cell| wanted.contains(cell))
        };
        let useful = self.in_flight.tiles().filter(useful).count();
        self.stale = !self.in_flight.is_empty() && 2 * useful <= self.in_flight.len();
    }

    /// Whether a cell has to be computed; a coarse one not if something nearly as fine stands in.
    fn needs(&self, cell: Cell, finest: bool) -> bool {
        let known = |cell: Cell| self.cache.peek(self.key, cell.canonical().0);
        if let Some(known) = known(cell) {
            return finest
                && self.target.is_some_and(|target| known.budget_secs < target.budget_secs);
        }
        let instead = |cell: Cell| known(cell).is_some();
        finest || !(cell.parent().is_some_and(instead) || cell.children().into_iter().all(instead))
    }

    /// Hands open cells to the engine and takes back what has come. With a deadline it never
    /// waits, and stops preparing when the deadline has passed; without one it returns when all
    /// is done. Says whether anything new can be drawn.
    pub fn work(
        &mut self,
        engine: &mut dyn Engine,
        deadline: Option<Instant>,
    ) -> Result<bool, EngineError> {
        if std::mem::take(&mut self.stale) {
            self.in_flight.cancel(engine);
            self.plan();
        }
        let mut news = false;
        loop {
            news |= self.submit_until(engine, deadline)?;
            let wait = deadline.map_or(Wait::UntilFinished, |_| Wait::Until(Instant::now()));
            news |= self.collect(engine, wait)?;
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
            // Cells that the engine refused are in no queue any more.
            self.plan();
        }
        submitted
    }

    /// Whether cells wait and nothing flies whose landing would wake anybody: with a deadline,
    /// [`Explorer::work`] may end so among cells that are known without an engine.
    pub fn is_waiting(&self) -> bool {
        self.target.is_some() && self.in_flight.is_empty() && !self.waiting.is_empty()
    }

    /// Whether there is nothing to compute.
    pub fn is_done(&self) -> bool {
        self.waiting.is_empty() && self.in_flight.is_empty()
    }

    /// Forgets what flies, for an engine that is gone; nothing that was computed is lost.
    pub fn ground(&mut self) {
        self.in_flight.forget();
        self.plan();
    }

    /// The next cells that can share a job: all new, or all to be continued.
    fn next_cells(&mut self, most: usize) -> Vec<Cell> {
        let continues = |cell: &Cell| {
            self.cache.peek(self.key, *cell).is_some_and(|known| !known.unfinished.is_empty())
        };
        let Some(first) = self.waiting.front().map(continues) else { return Vec::new() };
        let level = self.waiting.front().map(|cell| cell.level);
        let alike = |cell: &&Cell| continues(cell) == first && Some(cell.level) == level;
        let count = self.waiting.iter().take(most).take_while(alike).count();
        self.waiting.drain(..count).collect()
    }

    /// Puts a batch's samples where they belong.
    fn keep(&mut self, batch: &Batch, samples: &Samples, unfinished: &[(u32, IntegratorState)]) {
        self.counts.add(samples);
        for (k, cell) in batch.cells.iter().enumerate() {
            let places = k * SAMPLES..(k + 1) * SAMPLES;
            let first = places.start as u32;
            let unfinished = unfinished
                .iter()
                .filter(|(place, _)| places.contains(&(*place as usize)))
                .map(|(place, state)| (place - first, *state))
                .collect();
            let samples = samples.part(places.clone());
            self.cache.insert(batch.physics, *cell, samples, batch.budget_secs, unfinished);
        }
    }

    /// What is known of a cell of the target, given canonically or not, and whether the samples
    /// are its image's, in opposite order.
    pub fn known(&mut self, cell: Cell) -> Option<(&CachedCell, bool)> {
        self.target?;
        self.look(self.key, cell)
    }

    /// Likewise of the physics that was aimed at before: while nothing of the aim's is known,
    /// this is still drawn.
    pub fn known_before(&mut self, cell: Cell) -> Option<(&CachedCell, bool)> {
        self.look(self.before?, cell)
    }

    fn look(&mut self, key: usize, cell: Cell) -> Option<(&CachedCell, bool)> {
        let (canonical, mirrored) = cell.canonical();
        self.cache.get(key, canonical).map(|known| (known, mirrored))
    }

    /// How far the newest target is.
    pub fn progress(&self) -> ViewProgress {
        let Some(target) = self.target else { return ViewProgress::default() };
        let known = |cell: Cell| self.cache.peek(self.key, cell.canonical().0);
        let placed = target.region.cells(target.level, MOST_CELLS);
        let fine =
            |cell: Cell| known(cell).is_some_and(|known| known.budget_secs >= target.budget_secs);
        let drawn = |cell: Cell| {
            std::iter::successors(Some(cell), Cell::parent).any(|cell| known(cell).is_some())
        };
        ViewProgress {
            level: target.level,
            wanted: placed.len(),
            done: placed.iter().filter(|placed| fine(placed.cell)).count(),
            covered: !placed.is_empty() && placed.iter().all(|placed| drawn(placed.cell)),
            idle: self.is_done(),
        }
    }

    /// What has been computed so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// What following the cells that came last has shown; nothing where they were not deep.
    pub fn depth(&self) -> Option<DepthStats> {
        self.depth
    }

    /// Bytes of tiles held.
    pub fn bytes(&self) -> usize {
        self.cache.bytes()
    }

    /// Changes how many bytes are kept.
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
        let target = self.target?;
        let cells = self.next_cells((job_size / (2 * SAMPLES)).clamp(1, MOST_IN_JOB));
        if cells.is_empty() {
            return None;
        }
        let batch = Batch { physics: self.key, budget_secs: target.budget_secs, cells };
        let config = target.physics.config;
        let before = |k: usize, place| self.cache.peek(batch.physics, batch.cells[k])?.known(place);
        let open = OpenTile::of_cells(&target.scene(), config, &batch.cells, SIDE, before);
        // Checks begin at the release, so checked pixels cannot be continued.
        let keep = if target.physics.verified { Keep::Nothing } else { Keep::Unfinished };
        Some(NextTile { tile: batch, open, question: target.question(), config, keep })
    }

    fn take(&mut self, finished: FinishedBatch<Batch>) {
        finished.count_work(&mut self.counts);
        if !finished.computed.is_empty() {
            self.depth = finished.effort.depth;
        }
        let FinishedBatch { tile: batch, samples, unfinished, .. } = finished;
        self.keep(&batch, &samples, &unfinished);
        // The budget has been raised since.
        if self.target.is_some_and(|target| batch.budget_secs < target.budget_secs) {
            self.plan();
        }
    }
}
