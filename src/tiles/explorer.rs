//! The window's scheduler: which cells of the lattice are computed next.
//!
//! An [`Aim`] says what is looked at. The cells it wants are queued, what is known or on its way
//! left out. The newest target replaces the queue, and where most of what flies serves it no longer,
//! that is dropped. The window calls [`Explorer::work`] with a deadline and draws between; a test
//! without a window calls it with none.

use std::collections::{HashSet, VecDeque};
use std::time::Instant;

use super::cache::{Cache, CachedCell};
use super::in_flight::{FinishedBatch, InFlightJobs, OpenTile};
use super::order;
use super::samples::{Counts, Samples};
use super::saved_pixels;
use super::view_target::{Physics, ViewTarget};
use crate::engine::{DepthStats, Engine, EngineError, IntegratorState, Keep, Trust, Wait};
use crate::physics::{Outcome, Status};
use crate::scene::lattice::{Cell, SAMPLES, SIDE};
use crate::scene::{Grid, Grouped, Scene};

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
struct Batch {
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
            news |= self.submit(engine, deadline)?;
            let wait = deadline.map_or(Wait::UntilFinished, |_| Wait::Until(Instant::now()));
            for finished in self.in_flight.poll(engine, wait)? {
                self.take(finished);
                news = true;
            }
            if let Some(deadline) = deadline {
                if Instant::now() < deadline {
                    news |= self.submit(engine, Some(deadline))?;
                }
                return Ok(news);
            }
            if self.is_done() {
                return Ok(news);
            }
        }
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

    fn submit(
        &mut self,
        engine: &mut dyn Engine,
        deadline: Option<Instant>,
    ) -> Result<bool, EngineError> {
        let Some(target) = self.target else { return Ok(false) };
        let in_job = (engine.job_size() / (2 * SAMPLES)).clamp(1, MOST_IN_JOB);
        let mut news = false;
        while self.in_flight.len() < engine.slots() && !self.waiting.is_empty() {
            let cells = self.next_cells(in_job);
            let batch = Batch { physics: self.key, budget_secs: target.budget_secs, cells };
            news |= self.send(engine, &target, batch)?;
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                break;
            }
        }
        Ok(news)
    }

    /// Sends a batch to the engine; without an open pixel it is known at once, and this says so.
    fn send(
        &mut self,
        engine: &mut dyn Engine,
        target: &ViewTarget,
        batch: Batch,
    ) -> Result<bool, EngineError> {
        let open = self.open(target, &batch);
        if open.is_settled() {
            self.keep(&batch, &open.into_samples(), Vec::new());
            return Ok(true);
        }
        let asked = (target.question(), target.physics.config);
        // Checks begin at the release, so checked pixels cannot be continued.
        let keep = if target.physics.verified { Keep::Nothing } else { Keep::Unfinished };
        let sent = self.in_flight.submit(engine, batch, open, asked, keep);
        if sent.is_err() {
            // The batch is gone from the queue, and nobody computes it.
            self.plan();
        }
        sent.map(|()| false)
    }

    /// The next cells that can share a job: all new, or all to be continued.
    fn next_cells(&mut self, most: usize) -> Vec<Cell> {
        let continues = |cell: &Cell| {
            self.cache.peek(self.key, *cell).is_some_and(|known| !known.paused.is_empty())
        };
        let Some(first) = self.waiting.front().map(continues) else { return Vec::new() };
        let level = self.waiting.front().map(|cell| cell.level);
        let alike = |cell: &&Cell| continues(cell) == first && Some(cell.level) == level;
        let count = self.waiting.iter().take(most).take_while(alike).count();
        self.waiting.drain(..count).collect()
    }

    /// What is known of the cells beforehand.
    fn open(&self, target: &ViewTarget, batch: &Batch) -> OpenTile {
        if batch.cells.first().is_some_and(|cell| target.is_deep_at(cell.level)) {
            return self.open_deep(&target.scene(), batch);
        }
        let scene = target.scene();
        OpenTile::new(batch.cells.iter().flat_map(|cell| {
            let grid = cell.grid(&scene, SIDE);
            let known = self.cache.peek(batch.physics, *cell);
            let mut states = known.map_or(&[][..], |known| &known.paused).iter().peekable();
            (0..SAMPLES as u32).map(move |place| {
                let fate = grid.fate(place % SIDE, place / SIDE);
                let state = states.next_if(|(at, _)| *at == place).map(|(_, state)| *state);
                (fate, known.and_then(|known| known_of(known, place, state)))
            })
        }))
    }

    /// Likewise of cells too deep for angles in any number type of an engine's.
    fn open_deep(&self, scene: &Scene, batch: &Batch) -> OpenTile {
        let grids: Vec<Grid> = batch.cells.iter().map(|cell| cell.grid(scene, SIDE)).collect();
        let mut groups = Grouped::new();
        for (k, cell) in (0..).zip(&batch.cells) {
            let moved = |(place, point)| (k * SAMPLES as u32 + place, point);
            groups.extend(
                cell.leaves(SIDE)
                    .into_iter()
                    .map(|(leaf, points)| (leaf, points.into_iter().map(moved).collect())),
            );
        }
        let known = |place: u32| {
            let (k, place) = (place as usize / SAMPLES, place % SAMPLES as u32);
            let before = self.cache.peek(batch.physics, batch.cells[k]);
            let before = before.map(|known| known.at(place as usize));
            before.filter(|(outcome, _)| outcome.status != Status::Unflipped).or_else(|| {
                let outcome = grids[k].opening(place % SIDE, place / SIDE)?;
                Some((outcome, Trust::Agreed))
            })
        };
        OpenTile::deep(batch.cells.len() * SAMPLES, groups, known)
    }

    fn take(&mut self, finished: FinishedBatch<Batch>) {
        self.counts.simulated += finished.computed.len() as u64;
        self.counts.effort += finished.effort;
        self.depth = finished.effort.depth;
        let FinishedBatch { tile: batch, samples, paused, .. } = finished;
        self.keep(&batch, &samples, paused);
        // The budget has been raised since.
        if self.target.is_some_and(|target| batch.budget_secs < target.budget_secs) {
            self.plan();
        }
    }

    /// Puts a batch's samples where they belong.
    fn keep(&mut self, batch: &Batch, samples: &Samples, paused: Vec<(u32, IntegratorState)>) {
        self.counts.add(samples);
        for (k, cell) in batch.cells.iter().enumerate() {
            let places = k * SAMPLES..(k + 1) * SAMPLES;
            let first = places.start as u32;
            let paused = paused
                .iter()
                .filter(|(place, _)| places.contains(&(*place as usize)))
                .map(|(place, state)| (place - first, *state))
                .collect();
            let samples = samples.part(places.clone());
            self.cache.insert(batch.physics, *cell, samples, batch.budget_secs, paused);
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

/// What is known of one pixel of a tile that had a smaller budget.
fn known_of(
    known: &CachedCell,
    place: u32,
    state: Option<IntegratorState>,
) -> Option<(saved_pixels::SavedPixel, Trust)> {
    let outcome: Outcome = known.samples.get(place as usize);
    let trust = known.samples.trust(place as usize);
    if outcome.status != Status::Unflipped {
        return Some((saved_pixels::SavedPixel::Over(outcome), trust));
    }
    state.map(|state| (saved_pixels::SavedPixel::Unfinished(state), trust))
}
