//! Computing what is missing, kept as it comes.

use std::time::{Duration, Instant};

use super::task::{Pass, Piece, Reel, Wanted};
use super::{PartError, PartWriter, Task};
use crate::engine::{Engine, EngineError};
use crate::output::RowOrder;
use crate::scene::Document;
use crate::scene::lattice::Cell;
use crate::tiles::patch_work::PatchWork;
use crate::tiles::{Counts, Samples, Work};

/// Why not all was computed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A part could not be kept.
    #[error("{0}; what was finished is kept, run again when there is room")]
    Part(#[from] PartError),
    /// It was asked to stop.
    #[error("stopped; what was finished is kept, run again to go on")]
    Stopped,
}

/// How often a stop is looked for.
const PATIENCE: Duration = Duration::from_millis(50);
/// Samples in a part at most.
const MOST: usize = 1 << 18;
/// What is finished is kept after this time at the latest …
const LEAST_WAIT: Duration = Duration::from_millis(500);
/// … or after this share of the time gone, so that long runs have fewer and larger parts.
const WAIT_SHARE: u32 = 60;

/// Computes pieces of a task. `go_on` hears what has been counted, and answers whether to go on;
/// what is finished is kept then too.
pub fn run(
    task: &Task,
    pieces: Vec<Piece>,
    engine: &mut dyn Engine,
    go_on: &mut dyn FnMut(&Counts) -> bool,
) -> Result<Counts, RunError> {
    let mut run = Run { task, engine, go_on, counts: Counts::default(), begun: Instant::now() };
    for piece in pieces {
        match (piece, &task.work) {
            (Piece::Rows(pass, rows), Wanted::Still(document, passes)) => {
                run.rows(document, &passes[pass], rows)?;
            }
            (Piece::Patches(reel, cells), Wanted::Film(_, reels)) => {
                run.patches(&reels[reel], cells)?;
            }
            _ => {}
        }
    }
    Ok(run.counts)
}

struct Run<'a> {
    task: &'a Task,
    engine: &'a mut dyn Engine,
    go_on: &'a mut dyn FnMut(&Counts) -> bool,
    counts: Counts,
    begun: Instant,
}

impl Run<'_> {
    fn rows(
        &mut self,
        document: &Document,
        pass: &Pass,
        rows: std::ops::Range<u32>,
    ) -> Result<(), RunError> {
        let writer = PartWriter::open(&self.task.folder, &pass.of)?;
        let before = self.counts;
        let (width, mut first) = (pass.size[0], rows.start);
        let tile = self.engine.job_size();
        let mut order = RowOrder::from(rows.start);
        let mut work = Work::of_rows(&document.scene(), pass.size, self.task.recipe, tile, rows);
        let (mut kept, mut last) = (Samples::default(), Instant::now());
        loop {
            for tile in work.work(self.engine, Some(Instant::now() + PATIENCE))? {
                order.push(tile).into_iter().for_each(|samples| kept.append(samples));
            }
            self.counts = before;
            self.counts += work.counts();
            let go_on = (self.go_on)(&self.counts);
            if self.is_time(kept.len(), last, work.is_done() || !go_on) {
                let count = (kept.len() / width as usize) as u32;
                writer.rows(width, first, std::mem::take(&mut kept))?;
                (first, last) = (first + count, Instant::now());
            }
            if work.is_done() {
                return Ok(());
            }
            if !go_on {
                self.engine.cancel();
                return Err(RunError::Stopped);
            }
        }
    }

    fn patches(&mut self, reel: &Reel, cells: Vec<Cell>) -> Result<(), RunError> {
        let writer = PartWriter::open(&self.task.folder, &reel.of)?;
        let before = self.counts;
        let mut work = PatchWork::new(&reel.sheet.scene, self.task.recipe, cells.into_iter());
        let (mut kept, mut last) = ((Vec::new(), Samples::default()), Instant::now());
        loop {
            for (cell, samples) in work.work(self.engine, Instant::now() + PATIENCE)? {
                kept.0.push(cell);
                kept.1.append(samples);
            }
            self.counts = before;
            self.counts += work.counts();
            let go_on = (self.go_on)(&self.counts);
            if self.is_time(kept.1.len(), last, work.is_done() || !go_on) {
                let (cells, samples) = std::mem::take(&mut kept);
                writer.patches(&cells, samples)?;
                last = Instant::now();
            }
            if work.is_done() {
                return Ok(());
            }
            if !go_on {
                self.engine.cancel();
                return Err(RunError::Stopped);
            }
        }
    }

    /// Whether what is finished is to be kept now.
    fn is_time(&self, samples: usize, last: Instant, ending: bool) -> bool {
        let wait = LEAST_WAIT.max(self.begun.elapsed() / WAIT_SHARE);
        samples > 0 && (ending || samples >= MOST || last.elapsed() >= wait)
    }
}
