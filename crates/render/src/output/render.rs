//! The loop that turns a picture's work into files, shared by the command line and the window.
//!
//! Samples are painted, compressed and written on a thread of their own while the next ones are
//! computed:
//!
//! ```text
//! engine ──► work ──► rows from the top ──► [a few bands] ──► paint ──► files
//! ```

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::time::Duration;

use super::failure::{OutputError, RenderError};
use super::{RowOrder, SinkPass, Sinks};
use crate::tiles::{Counts, PlainPixels, Renderer, Samples, Work};
use flipmap_engine::clock::Instant;
use flipmap_engine::{Cells, Engine};
use flipmap_scene::palette::AnswerColours;
use flipmap_scene::{Document, Sampling};

/// Time spent on a render.
#[derive(Clone, Copy, Debug, Default)]
pub struct RenderClock {
    /// Time spent before the first sample: on checks, and on pixels that are integrated directly.
    pub setup: Duration,
    /// Time spent on computing samples.
    pub compute: Duration,
    /// Time spent on painting and writing samples, most of it while others are computed.
    pub output: Duration,
}

/// Longest time for which a stop waits for tiles in flight whose pixels are saved.
const GRACE: Duration = Duration::from_secs(10);
/// Interval between checks for a request to stop.
const PATIENCE: Duration = Duration::from_millis(50);
/// Interval at which bands are offered again to a writer that is behind.
const PAUSE: Duration = Duration::from_millis(2);
/// Largest number of bands that wait for the writer.
const AHEAD: usize = 2;

/// Returns the numbers of samples of a pass over a picture of `size` pixels: in the pixels'
/// middles, which adaptive sampling computes first (otherwise 0), and in the pass itself.
pub(crate) fn pass_samples(document: &Document, size: [u32; 2], pass: &SinkPass) -> [u64; 2] {
    let count = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
    let middles = if is_adaptive(document, pass) { count(size) } else { 0 };
    [middles, count(pass.sampling.grid_size(size))]
}

/// Returns true if only some pixels get more samples than the one in their middle.
fn is_adaptive(document: &Document, pass: &SinkPass) -> bool {
    let several = pass.sampling.along() > 1 && document.picture.is_adaptive(document.question.ask);
    several || pass.sampling == Sampling::Corners
}

/// Returns the work of a pass over a picture of `size` pixels. Adaptive sampling first runs over
/// the pixels' middles, with counts of its own; that run fails as stopped once `keep_going` returns
/// false.
pub fn pass_work(
    renderer: &mut Renderer,
    (document, cells): (&Document, Cells),
    size: [u32; 2],
    (sinks, pass): (&mut Sinks, &SinkPass),
    clock: &mut RenderClock,
    keep_going: &dyn Fn(&Counts) -> bool,
) -> Result<Work, RenderError> {
    let (scene, picture) = (document.scene(), &document.picture);
    let work = renderer.sampled_work(&scene, size, pass.sampling).with_cells(cells);
    if !is_adaptive(document, pass) {
        return Ok(work);
    }
    let colours = AnswerColours::new(&scene, picture).map_err(OutputError::from)?;
    let (what, how) = ((&scene, cells), (&colours, pass.sampling));
    let computing = Instant::now();
    let plain = PlainPixels::find(renderer, what, size, how, keep_going);
    clock.compute += computing.elapsed();
    let plain = Arc::new(plain?.ok_or(RenderError::Stopped)?);
    if pass.sampling == Sampling::Corners {
        sinks.write_middles(pass, &plain)?;
    }
    Ok(work.sparing(plain))
}

/// Runs one pass and feeds its samples to `sinks`, rows from the top. `keep_going` takes the counts
/// so far, at least every few hundredths of a second, and returns false to stop.
pub fn render_pass(
    work: &mut Work,
    engine: &mut dyn Engine,
    sinks: &mut Sinks,
    pass: &SinkPass,
    clock: &mut RenderClock,
    keep_going: &mut dyn FnMut(&Counts) -> bool,
) -> Result<(), RenderError> {
    let (bands, taken) = sync_channel(AHEAD);
    std::thread::scope(|scope| {
        let writer = scope.spawn(move || write(sinks, pass, &taken));
        let computed = compute(work, engine, bands, clock, keep_going);
        let (output, written) = writer.join().unwrap_or_else(|panic| resume_unwind(panic));
        clock.output += output;
        // A failed writer also ends the computation; its error is the one to report.
        written?;
        computed
    })
}

/// Writes bands as they come, until there are no more, and returns the time that writing took.
fn write(
    sinks: &mut Sinks,
    pass: &SinkPass,
    bands: &Receiver<Samples>,
) -> (Duration, Result<(), OutputError>) {
    let mut busy = Duration::ZERO;
    for samples in bands {
        let writing = Instant::now();
        let written = sinks.write(pass, &samples);
        busy += writing.elapsed();
        if written.is_err() {
            return (busy, written);
        }
    }
    (busy, Ok(()))
}

/// Computes all samples and passes them on, rows from the top, until the writer is gone.
fn compute(
    work: &mut Work,
    engine: &mut dyn Engine,
    bands: SyncSender<Samples>,
    clock: &mut RenderClock,
    keep_going: &mut dyn FnMut(&Counts) -> bool,
) -> Result<(), RenderError> {
    let done = compute_rows(work, engine, &bands, clock, keep_going);
    if matches!(done, Err(RenderError::Stopped)) {
        work.save_in_flight(engine, Instant::now() + GRACE)?;
    }
    done
}

/// Computes samples and passes them on until all are done or a stop is asked for.
fn compute_rows(
    work: &mut Work,
    engine: &mut dyn Engine,
    bands: &SyncSender<Samples>,
    clock: &mut RenderClock,
    keep_going: &mut dyn FnMut(&Counts) -> bool,
) -> Result<(), RenderError> {
    let mut rows = RowOrder::default();
    while !work.is_done() {
        let computing = Instant::now();
        let finished = work.work(engine, Some(computing + PATIENCE))?;
        clock.compute += computing.elapsed();
        let mut heed =
            || if keep_going(&work.counts()) { Ok(()) } else { Err(RenderError::Stopped) };
        for samples in finished.into_iter().flat_map(|tile| rows.push(tile)) {
            if !pass_on(bands, samples, &mut heed)? {
                return Ok(());
            }
        }
        heed()?;
    }
    Ok(())
}

/// Passes a band on once there is room; returns false if the writer is gone.
fn pass_on(
    bands: &SyncSender<Samples>,
    mut samples: Samples,
    heed: &mut dyn FnMut() -> Result<(), RenderError>,
) -> Result<bool, RenderError> {
    loop {
        heed()?;
        match bands.try_send(samples) {
            Ok(()) => return Ok(true),
            Err(TrySendError::Disconnected(_)) => return Ok(false),
            Err(TrySendError::Full(back)) => samples = back,
        }
        std::thread::sleep(PAUSE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Paths;
    use flipmap_engine::mock::MockEngine;
    use flipmap_engine::{IntegratorConfig, Method, Precision};
    use flipmap_scene::Document;

    const CONFIG: IntegratorConfig =
        IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };

    /// Renders the home map to a file until `keep_going` says no.
    fn render(
        path: &str,
        keep_going: &mut dyn FnMut(&Counts) -> bool,
    ) -> (Result<(), RenderError>, Counts) {
        let paths = Paths { raw: Some(path.into()), ..Paths::default() };
        let (document, size) = (Document::default(), [200, 200]);
        let mut engine = MockEngine { job_size: 200, ..MockEngine::default() };
        let mut sinks = Sinks::open(&paths, &document, size).unwrap();
        let pass = sinks.passes(Sampling::SINGLE).remove(0);
        let mut work = Work::new(&document.scene(), size, CONFIG, 200);
        let clock = &mut RenderClock::default();
        let done = render_pass(&mut work, &mut engine, &mut sinks, &pass, clock, keep_going);
        (done, work.counts())
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_that_cannot_be_written_ends_the_computation() {
        let (done, counts) = render("/dev/full", &mut |_| true);
        assert!(matches!(done, Err(RenderError::Output(OutputError::Write { .. }))), "{done:?}");
        assert!(counts.pixels < 200 * 200, "all has been computed for nothing");
    }

    #[test]
    fn a_request_to_stop_is_heeded_between_bands() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.npy");
        let (done, counts) = render(path.to_str().unwrap(), &mut |counts| counts.pixels < 2000);
        assert!(matches!(done, Err(RenderError::Stopped)), "{done:?}");
        assert!((2000..20_000).contains(&counts.pixels), "{}", counts.pixels);
    }
}
