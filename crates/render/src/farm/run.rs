//! Computes what is missing, and saves it as it comes.

use std::cell::RefCell;
use std::ops::Range;
use std::time::Duration;

use super::task::{FrameTask, TaskKind, WorkPiece};
use super::{PartError, PartWriter, Task};
use crate::Watch;
use crate::output::RowOrder;
use crate::tiles::moments::Moments;
use crate::tiles::patch_work::PatchWork;
use crate::tiles::{Counts, Renderer, Samples, Work};
use flipmap_engine::clock::Instant;
use flipmap_engine::{Cells, Engine, EngineError};
use flipmap_scene::lattice::Cell;

/// Reasons why not everything was computed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A part could not be written.
    #[error("what was finished is kept: fix this, then run again to go on")]
    Part(#[from] PartError),
    /// A request to stop.
    #[error("stopped; what was finished is kept: run again to go on")]
    Stopped,
}

/// Interval between checks for a request to stop.
const PATIENCE: Duration = Duration::from_millis(50);
/// Number of samples at which a part is written.
const PART_SAMPLES: usize = 1 << 18;
/// Shortest interval between writes of finished samples.
const MIN_WAIT: Duration = Duration::from_millis(500);
/// Divisor of the elapsed time that gives the interval of long runs, which write fewer and larger
/// parts.
const WAIT_SHARE: u32 = 60;

/// Computes pieces of a task; if the renderer checks pixels, it first integrates some pixels of
/// each still directly. Every shard takes the same pixels, so all shards mark the same views.
pub fn compute(
    task: &Task,
    pieces: &[WorkPiece],
    renderer: &mut Renderer,
    watch: &dyn Watch,
) -> Result<Counts, RunError> {
    let total = samples_of(task, pieces);
    let mut counts = Counts::default();
    let scene_of = |piece: &WorkPiece| task.still(piece).map(|(scene, _)| scene);
    for pieces in pieces.chunk_by(|a, b| scene_of(a) == scene_of(b)) {
        let before = counts.pixels;
        let watch_piece = |done: u64, _| watch.keep_going(before + done, total);
        if let Some((scene, pass)) = task.still(&pieces[0]) {
            let goes_on = || watch_piece(0, total);
            let opinion = renderer.second_opinion(&scene, pass.pixels(), Cells::Auto, &goes_on)?;
            opinion.iter().for_each(|opinion| watch.hear(opinion));
        }
        counts += run(task, pieces, renderer.engine(), &watch_piece)?;
    }
    Ok(counts)
}

fn samples_of(task: &Task, pieces: &[WorkPiece]) -> u64 {
    pieces.iter().map(|piece| piece.samples(task)).sum()
}

/// Computes pieces of a task with an engine; finished samples are saved even if `watch` stops it.
pub fn run(
    task: &Task,
    pieces: &[WorkPiece],
    engine: &mut dyn Engine,
    watch: &dyn Watch,
) -> Result<Counts, RunError> {
    let total = samples_of(task, pieces);
    let mut counts = Counts::default();
    let begun = Instant::now();
    for piece in pieces {
        let before = counts;
        let mut keep_going = |now: Counts| {
            counts = before;
            counts += now;
            watch.keep_going(counts.pixels, total)
        };
        match (piece, &task.work) {
            (WorkPiece::Motion(moved, rows), TaskKind::Frames(_, frames)) => {
                let moved: Vec<_> = moved.iter().map(|frame| &frames[*frame]).collect();
                motion(task, &moved, rows.clone(), engine, &mut keep_going)?;
            }
            _ => drive(
                open(task, piece, engine.job_size())?.as_mut(),
                engine,
                begun,
                &mut keep_going,
            )?,
        }
    }
    Ok(counts)
}

/// A piece being computed.
trait PieceInProgress {
    /// Advances until `deadline` at most.
    fn work(&mut self, engine: &mut dyn Engine, deadline: Instant) -> Result<(), EngineError>;
    /// Returns true if everything is computed.
    fn is_done(&self) -> bool;
    /// Returns the counts of the work so far.
    fn counts(&self) -> Counts;
    /// Returns the number of samples that are computed but not saved yet.
    fn loose(&self) -> usize;
    /// Saves those samples as a part.
    fn keep(&mut self) -> Result<(), PartError>;
}

fn open<'a>(
    task: &'a Task,
    piece: &'a WorkPiece,
    job_size: usize,
) -> Result<Box<dyn PieceInProgress + 'a>, PartError> {
    Ok(match (piece, &task.work) {
        (WorkPiece::Rows(_, rows), _) => {
            let (scene, pass) = task.still(piece).ok_or(PartError::Gone)?;
            let of = (pass.pixels(), pass.sampling);
            Box::new(PendingRows {
                writer: PartWriter::open(&task.folder, &pass.of)?,
                width: pass.size[0],
                first: rows.start,
                order: RowOrder::from(rows.start),
                work: Work::of_rows(&scene, of, task.config, job_size, rows.clone()),
                loose: Samples::default(),
            })
        }
        (WorkPiece::Patches(group, cells), TaskKind::Film(_, groups)) => {
            let (group, first) = (&groups[*group], cells.first().ok_or(PartError::Gone)?);
            let mut scenes = group.group.scenes();
            let scene = scenes.nth(group.group.scene_index(first)).ok_or(PartError::Gone)?;
            Box::new(Patches {
                writer: PartWriter::open(&task.folder, group.of(first))?,
                work: PatchWork::new(&scene, task.config, cells.iter().cloned()),
                cells: Vec::new(),
                loose: Samples::default(),
            })
        }
        _ => return Err(PartError::Gone),
    })
}

/// Computes a piece until it is done or stopped, and saves finished samples now and then.
fn drive(
    piece: &mut dyn PieceInProgress,
    engine: &mut dyn Engine,
    begun: Instant,
    keep_going: &mut dyn FnMut(Counts) -> bool,
) -> Result<(), RunError> {
    let mut kept = Instant::now();
    loop {
        let worked = piece.work(engine, Instant::now() + PATIENCE);
        let going = keep_going(piece.counts()) && worked.is_ok();
        let wait = MIN_WAIT.max(begun.elapsed() / WAIT_SHARE);
        let full = piece.loose() >= PART_SAMPLES || kept.elapsed() >= wait;
        if piece.loose() > 0 && (full || piece.is_done() || !going) {
            piece.keep()?;
            kept = Instant::now();
        }
        worked?;
        if piece.is_done() {
            return Ok(());
        }
        if !going {
            engine.cancel();
            return Err(RunError::Stopped);
        }
    }
}

/// Saves rows from `first` on, in parts of limited size.
fn keep_rows(
    writer: &PartWriter,
    width: u32,
    first: u32,
    samples: &Samples,
) -> Result<(), PartError> {
    let in_part = (PART_SAMPLES / width as usize).max(1) * width as usize;
    (0..samples.len()).step_by(in_part).try_for_each(|from| {
        let part = samples.part(from..(from + in_part).min(samples.len()));
        writer.rows(width, first + (from / width as usize) as u32, part)
    })
}

/// Computes the same rows of several frames in order of time, and saves each frame's as they come.
fn motion(
    task: &Task,
    frames: &[&FrameTask],
    rows: Range<u32>,
    engine: &mut dyn Engine,
    keep_going: &mut dyn FnMut(Counts) -> bool,
) -> Result<(), RunError> {
    let [first, ..] = frames else { return Ok(()) };
    let (size, job_size) = (first.pass.size, engine.job_size());
    let mut moments =
        Moments::of_rows(&first.shot.scene, size, task.config, job_size, rows.clone());
    let (mut counts, keep_going) = (Counts::default(), RefCell::new(keep_going));
    for FrameTask { shot, pass } in frames {
        let goes_on = || (keep_going.borrow_mut())(counts);
        let at_secs = shot.scene.question.end_secs();
        let Some(samples) = moments.at(engine, at_secs, &goes_on)? else {
            return Err(RunError::Stopped);
        };
        keep_rows(&PartWriter::open(&task.folder, &pass.of)?, size[0], rows.start, samples)?;
        counts.pixels += samples.len() as u64;
        counts.simulated += moments.moving() as u64;
        if !(keep_going.borrow_mut())(counts) {
            return Err(RunError::Stopped);
        }
    }
    Ok(())
}

struct PendingRows {
    writer: PartWriter,
    width: u32,
    /// The first row that is not saved yet.
    first: u32,
    order: RowOrder,
    work: Work,
    loose: Samples,
}

impl PieceInProgress for PendingRows {
    fn work(&mut self, engine: &mut dyn Engine, deadline: Instant) -> Result<(), EngineError> {
        for tile in self.work.work(engine, Some(deadline))? {
            self.order.push(tile).into_iter().for_each(|samples| self.loose.append(samples));
        }
        Ok(())
    }

    fn is_done(&self) -> bool {
        self.work.is_done()
    }

    fn counts(&self) -> Counts {
        self.work.counts()
    }

    fn loose(&self) -> usize {
        self.loose.len()
    }

    fn keep(&mut self) -> Result<(), PartError> {
        let count = (self.loose.len() / self.width as usize) as u32;
        self.writer.rows(self.width, self.first, std::mem::take(&mut self.loose))?;
        self.first += count;
        Ok(())
    }
}

struct Patches {
    writer: PartWriter,
    work: PatchWork,
    cells: Vec<Cell>,
    loose: Samples,
}

impl PieceInProgress for Patches {
    fn work(&mut self, engine: &mut dyn Engine, deadline: Instant) -> Result<(), EngineError> {
        for (cell, samples) in self.work.work(engine, deadline)? {
            self.cells.push(cell);
            self.loose.append(samples);
        }
        Ok(())
    }

    fn is_done(&self) -> bool {
        self.work.is_done()
    }

    fn counts(&self) -> Counts {
        self.work.counts()
    }

    fn loose(&self) -> usize {
        self.loose.len()
    }

    fn keep(&mut self) -> Result<(), PartError> {
        let cells = std::mem::take(&mut self.cells);
        self.writer.patches(&cells, std::mem::take(&mut self.loose))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::farm::{PartForm, PartForms, Parts};

    #[test]
    fn many_rows_are_kept_in_several_parts() {
        let folder = tempfile::tempdir().unwrap();
        let (width, rows) = (1 << 16, 9);
        let samples = Samples::unflipped(width as usize * rows as usize);
        let of = "f".repeat(64);
        let writer = PartWriter::open(folder.path(), &of).unwrap();
        keep_rows(&writer, width, 3, &samples).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "of four rows at most");
        let form = PartForm::Rows { width, rows: 12, channels: 1 };
        let parts = Parts::scan(folder.path(), PartForms::from([(of.clone(), form)])).unwrap();
        let missing = parts.missing_rows(&of, 0..12);
        assert_eq!(missing, std::slice::from_ref(&(0..3)));
    }
}
