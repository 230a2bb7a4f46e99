//! The loop from a scene to finished tiles.

use std::collections::{BTreeSet, VecDeque};
use std::ops::Range;
use std::sync::Arc;

use super::adaptive::PlainPixels;
use super::feasible::follows_cells;
use super::in_flight::{FinishedBatch, InFlightJobs, NextTile, TileSource};
use super::open_tile::OpenTile;
use super::plan::{Tile, plan};
use super::reader::Reader;
use super::samples::{Counts, Samples};
use super::saved_pixels::{SavedPixel, SavedPixels};
use flipmap_engine::clock::Instant;
use flipmap_engine::{Assurance, Cells, Engine, EngineError, EventSpec, IntegratorConfig, Wait};
use flipmap_pendulum::Status;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Grid, Sampling, Scene};

/// A tile and the samples of its pixels, in the order of [`Tile::pixels`].
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedTile {
    /// Position and size of the tile.
    pub tile: Tile,
    /// Samples of its pixels.
    pub samples: Samples,
}

/// The computation of a picture.
pub struct Work {
    grid: Grid,
    question: EventSpec,
    ask: QuestionName,
    config: IntegratorConfig,
    cells: Cells,
    mirrored: bool,
    waiting: VecDeque<Tile>,
    in_flight: InFlightJobs<Tile>,
    finished: Vec<FinishedTile>,
    counts: Counts,
    /// Pixels known from an earlier run, and those that a later one will need.
    kept: Option<SavedPixels>,
    /// Pixels whose samples are all known, if the rest of the picture gets several each.
    plain: Option<Arc<PlainPixels>>,
}

/// Number of tiles, where pixels are saved, in place of one.
const KEPT_TILES: usize = 8;

/// Maximum size in bytes of a mirrored half, whose samples wait until its rows are due.
const MIRROR_BYTES: u64 = 320 << 20;

/// Returns the size in bytes of the half of a symmetric map of these columns and rows, which is not
/// computed but waits until its rows are due; `None` if all is computed.
pub fn mirrored_bytes(scene: &Scene, [columns, rows]: [u32; 2]) -> Option<u64> {
    let half = u64::from(columns) * u64::from(rows) / 2;
    let bytes = half * Samples::bytes(scene.question.ask.kind().channels.len()) as u64;
    (scene.is_symmetric() && bytes <= MIRROR_BYTES).then_some(bytes)
}

/// Largest number of pixels of a deep tile that is as high as its leaves. Lower bands would follow
/// each leaf several times.
const MAX_DEEP_PIXELS: usize = 1 << 20;

impl Work {
    /// Creates the work for a checked scene as a picture of `size` pixels, in tiles of about
    /// `tile_pixels` pixels.
    pub fn new(
        scene: &Scene,
        size: [u32; 2],
        config: IntegratorConfig,
        tile_pixels: usize,
    ) -> Self {
        Work::sampled(scene, (size, Sampling::SINGLE), config, tile_pixels)
    }

    /// Creates the work for a picture whose pixels are sampled by `sampling`.
    pub(crate) fn sampled(
        scene: &Scene,
        (size, sampling): ([u32; 2], Sampling),
        config: IntegratorConfig,
        tile_pixels: usize,
    ) -> Self {
        let [columns, rows] = sampling.grid_size(size);
        let mirrored = mirrored_bytes(scene, [columns, rows]).is_some();
        let rows = if mirrored { rows.div_ceil(2) } else { rows };
        Work { mirrored, ..Work::of_rows(scene, (size, sampling), config, tile_pixels, 0..rows) }
    }

    /// Creates the work for some rows of samples, without their mirror image.
    pub(crate) fn of_rows(
        scene: &Scene,
        (size, sampling): ([u32; 2], Sampling),
        config: IntegratorConfig,
        tile_pixels: usize,
        rows: Range<u32>,
    ) -> Self {
        let grid = Grid::sampled(scene, size, sampling);
        let width = grid.size()[0];
        let is_deep = config.is_deep(grid.pixel_rad());
        let leaves = ((config.leaf_pixels() * width) as usize).min(MAX_DEEP_PIXELS);
        let tile_pixels = if is_deep { tile_pixels.max(leaves) } else { tile_pixels };
        Work {
            grid,
            question: EventSpec::from(scene),
            ask: scene.question.ask,
            config,
            cells: Cells::Auto,
            mirrored: false,
            waiting: plan(width, rows, tile_pixels).into(),
            in_flight: InFlightJobs::default(),
            finished: Vec::new(),
            counts: Counts::default(),
            kept: None,
            plain: None,
        }
    }

    /// Uses the leaves of the same scene in `size` pixels, a larger picture that is computed next,
    /// so both follow the same references.
    pub fn before(mut self, scene: &Scene, size: [u32; 2]) -> Self {
        self.grid = self.grid.in_leaves_of(&Grid::new(scene, size));
        self
    }

    /// Sets the starts that are followed as cells; the default is [`Cells::Auto`].
    pub fn with_cells(mut self, cells: Cells) -> Self {
        self.cells = cells;
        self
    }

    /// Continues from the pixels that an earlier run saved, and saves those that a later one needs.
    /// Takes smaller tiles, of which less is lost in a stop.
    pub(crate) fn keeping(mut self, kept: SavedPixels) -> Self {
        if let (Some(first), Some(last)) = (self.waiting.front(), self.waiting.back()) {
            let rows = first.origin[1]..last.origin[1] + last.size[1];
            let [width, height] = first.size.map(|side| side as usize);
            let smaller = (width * height / KEPT_TILES).max(1);
            self.waiting = plan(self.grid.size()[0], rows, smaller).into();
        }
        self.kept = Some(kept);
        self
    }

    /// Waits until the tiles in flight have come back, so that their pixels are saved, or until
    /// `deadline`; does nothing if pixels are not saved.
    pub(crate) fn save_in_flight(
        &mut self,
        engine: &mut dyn Engine,
        deadline: Instant,
    ) -> Result<(), EngineError> {
        while self.kept.is_some() && !self.in_flight.is_empty() && Instant::now() < deadline {
            self.collect(engine, Wait::Until(deadline))?;
        }
        Ok(())
    }

    /// Takes the samples of plain pixels as known; the run that found them counts as work.
    pub(crate) fn sparing(self, plain: Arc<PlainPixels>) -> Self {
        Work { plain: Some(plain), ..self }
    }

    /// Returns the saved pixels, which are complete once all is done.
    pub(crate) fn into_kept(self) -> Option<SavedPixels> {
        self.kept
    }

    /// Works until tiles have finished or `deadline` has come, and returns the finished tiles.
    /// Without a deadline, an empty result means that all is done.
    pub fn work(
        &mut self,
        engine: &mut dyn Engine,
        deadline: Option<Instant>,
    ) -> Result<Vec<FinishedTile>, EngineError> {
        while self.finished.is_empty() && !self.is_done() {
            // Tiles of very wide pictures take long to prepare.
            let is_late = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
            self.submit(engine, |work| !work.finished.is_empty() || is_late())?;
            if self.in_flight.is_empty() {
                continue;
            }
            self.collect(engine, deadline.map_or(Wait::UntilFinished, Wait::Until))?;
            if is_late() {
                break;
            }
        }
        Ok(std::mem::take(&mut self.finished))
    }

    /// Number of channels of each sample.
    pub(crate) fn channels(&self) -> usize {
        self.ask.kind().channels.len()
    }

    /// Returns true if no tile is waiting or in flight.
    pub fn is_done(&self) -> bool {
        self.waiting.is_empty() && self.in_flight.is_empty()
    }

    /// Returns the counts of the samples so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Returns the counts of the picture, with all the work for it, once all is done.
    pub(crate) fn totals(&self) -> Counts {
        self.plain.as_ref().map_or(self.counts, |plain| plain.counts_with(self.counts))
    }

    /// Returns the pixels of an earlier run that need not be computed again. Pixels of deep views
    /// must be, because the last digits of answers from a line of samples depend on the budget.
    fn saved(&self) -> Option<&SavedPixels> {
        self.kept.as_ref().filter(|_| !self.follows_cells())
    }

    /// Returns true if the pixels are followed as cells.
    fn follows_cells(&self) -> bool {
        follows_cells(&self.grid, &self.config, self.cells)
    }

    /// Sorts the pixels of a tile into known samples and starts.
    fn open(&self, tile: &Tile) -> OpenTile {
        let is_free = self.saved().is_none() && !self.follows_cells();
        match (is_free.then(|| OpenTile::of_upright(&self.grid, tile)).flatten(), &self.plain) {
            (Some(open), Some(plain)) => open.sparing(|place| plain.known(tile.pixel(place))),
            (Some(open), None) => open,
            (None, _) => {
                let pixels: Vec<_> = tile.pixels().collect();
                let known = |pixel| self.known(pixel);
                OpenTile::of_pixels(&self.grid, self.config, self.cells, &pixels, known)
            }
        }
    }

    fn known(&self, pixel: [u32; 2]) -> Option<(SavedPixel, Assurance)> {
        if let Some(plain) = &self.plain {
            return plain
                .known(pixel)
                .map(|(outcome, assurance)| (SavedPixel::Over(outcome), assurance));
        }
        let saved = self.saved().and_then(|saved| saved.known(self.index(pixel)))?;
        Some((saved, Assurance::default()))
    }

    /// Returns the index of a pixel in the picture, row by row from the top.
    fn index(&self, [x, y]: [u32; 2]) -> u64 {
        u64::from(y) * u64::from(self.grid.size()[0]) + u64::from(x)
    }

    fn keep(&mut self, finished: &FinishedBatch<Tile>) {
        let Some(mut kept) = self.kept.take() else { return };
        let pixels: Vec<[u32; 2]> = finished.tile.pixels().collect();
        let paused: BTreeSet<u32> = finished.unfinished.iter().map(|(place, _)| *place).collect();
        for &place in finished.computed.iter().filter(|place| !paused.contains(place)) {
            let status = finished.samples.get(place as usize).status;
            // Deep pixels have no state from which they could go on.
            let is_event = status == Status::Answered && !self.ask.kind().at_a_time;
            if is_event || status == Status::Failed {
                let values = finished.samples.values(place as usize);
                kept.finish(self.index(pixels[place as usize]), status, values);
            }
        }
        for (place, state) in &finished.unfinished {
            kept.pause(self.index(pixels[*place as usize]), state.clone());
        }
        self.kept = Some(kept);
    }

    /// Counts a tile and its mirror image, if there is one, and queues them to be returned.
    fn finish(&mut self, tile: Tile, samples: Samples) {
        let image = if self.mirrored { self.mirror_of(&tile, &samples) } else { None };
        for part in [Some(FinishedTile { tile, samples }), image].into_iter().flatten() {
            self.counts.add(&part.samples);
            self.finished.push(part);
        }
    }

    /// Returns the mirror image, in the lower half, of a band in the upper half, without a middle
    /// row that is its own image; `None` if no rows remain.
    fn mirror_of(&self, tile: &Tile, samples: &Samples) -> Option<FinishedTile> {
        let [width, height] = self.grid.size();
        let own_image = (tile.origin[1] + tile.size[1]) * 2 > height;
        let rows = tile.size[1] - u32::from(own_image);
        if rows == 0 {
            return None;
        }
        let image = samples.image(rows as usize * width as usize);
        let origin = [0, height - tile.origin[1] - rows];
        let tile = Tile { origin, size: [width, rows] };
        Some(FinishedTile { tile, samples: image })
    }
}

impl TileSource for Work {
    type Tile = Tile;

    fn in_flight(&mut self) -> &mut InFlightJobs<Tile> {
        &mut self.in_flight
    }

    fn next_tile(&mut self, _job_size: usize) -> Option<NextTile<Tile>> {
        let tile = self.waiting.pop_front()?;
        let mut open = self.open(&tile);
        let keeps_states = self.kept.is_some();
        let (ask, question, config) = (self.ask, self.question, self.config);
        let phase = |place: usize| {
            let [x, y] = tile.pixel(place as u32);
            self.grid.phase_at_first_pass(x, y)
        };
        open.samples = Reader::new(ask, &question).complete(open.samples, phase);
        if let Some(kept) = self.saved() {
            for (place, pixel) in tile.pixels().enumerate() {
                if let Some(values) = kept.values(self.index(pixel)) {
                    open.samples.set_values(place, Status::Answered, values);
                }
            }
        }
        Some(NextTile { tile, open, question, config, keeps_states, ask })
    }

    fn take(&mut self, batch: FinishedBatch<Tile>) {
        batch.count_work(&mut self.counts);
        self.keep(&batch);
        self.finish(batch.tile, batch.samples);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::mock::MockEngine;
    use flipmap_engine::{Method, Precision};
    use flipmap_scene::{Fate, View};

    const CONFIG: IntegratorConfig =
        IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };

    fn scene(center: [&str; 2]) -> Scene {
        let view = View { center: center.map(str::to_string), ..View::default() };
        Scene { view, ..Scene::default() }.checked().unwrap()
    }

    /// Runs the work to its end and returns every pixel's outcome.
    fn picture(scene: &Scene, size: [u32; 2], engine: &mut MockEngine) -> (Samples, Counts) {
        let mut work = Work::new(scene, size, CONFIG, 64);
        let mut samples = Samples::unflipped((size[0] * size[1]) as usize);
        let mut seen = vec![false; samples.len()];
        loop {
            let finished = work.work(engine, None).unwrap();
            if finished.is_empty() {
                break;
            }
            for part in finished {
                for ([x, y], outcome) in part.tile.pixels().zip(part.samples.iter()) {
                    let index = (y * size[0] + x) as usize;
                    assert!(!std::mem::replace(&mut seen[index], true), "({x}, {y}) came twice");
                    samples.set(index, outcome);
                }
            }
        }
        assert!(seen.iter().all(|&seen| seen));
        (samples, work.counts())
    }

    fn expected(scene: &Scene, size: [u32; 2]) -> Samples {
        let grid = Grid::new(scene, size);
        let mut samples = Samples::unflipped((size[0] * size[1]) as usize);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let outcome = match grid.fate(x, y) {
                    Fate::Open(angle) => MockEngine::answer(&EventSpec::from(scene), angle),
                    Fate::Known(outcome) => outcome,
                    Fate::BesideTop(moments) => {
                        MockEngine::answer(&EventSpec::from(scene), moments.angle)
                    }
                    Fate::Thrown(_) => unreachable!("starts at rest"),
                };
                samples.set((y * size[0] + x) as usize, outcome);
            }
        }
        samples
    }

    #[test]
    fn the_order_of_answers_does_not_change_the_picture() {
        let scene = scene(["1", "0.5"]);
        let truth = expected(&scene, [37, 23]);
        for backwards in [false, true] {
            let mut engine = MockEngine { backwards, ..MockEngine::default() };
            let (samples, counts) = picture(&scene, [37, 23], &mut engine);
            assert_eq!(samples, truth);
            assert_eq!(counts.pixels, 37 * 23);
            assert_eq!(counts.simulated as usize, engine.answered);
            assert!(engine.max_in_flight <= engine.slots());
        }
    }

    #[test]
    fn forbidden_pixels_cost_nothing_and_a_mirror_halves_the_rest() {
        const PI: &str = "3.14159265358979323846264338327950288";
        let centers = [["0", "0"], [PI, "0"], [PI, PI]];
        let sizes = [[40, 30], [31, 31], [5, 1]];
        for (center, size) in centers.into_iter().flat_map(|c| sizes.map(|size| (c, size))) {
            let mut engine = MockEngine::default();
            let scene = scene(center);
            let (samples, counts) = picture(&scene, size, &mut engine);
            assert_eq!(samples, expected(&scene, size), "{center:?} {size:?}");
            let open = counts.pixels - counts.forbidden;
            let middle_row = if size[1] % 2 == 1 { u64::from(size[0]) } else { 0 };
            assert!(engine.answered as u64 <= open / 2 + middle_row, "{size:?}");
            let last = samples.len() - 1;
            // Rows below the middle are images, so they repeat the upper half in reverse order.
            for index in 0..samples.len() / 2 - middle_row as usize / 2 {
                assert_eq!(samples.get(index), samples.get(last - index));
            }
        }
    }

    #[test]
    fn the_longest_sides_have_no_overflow_and_no_mirror_that_fills_memory() {
        let home = scene(["0", "0"]);
        for (size, mirrored) in [
            ([1_000_000, 67], true),
            ([1_000_000, 68], false),
            ([60_000, 60_000], false),
            ([1_000_000, 1_000_000], false),
            ([1_000_000, 8_000_000], false),
        ] {
            let mut work = Work::new(&home, size, CONFIG, 1 << 15);
            assert_eq!(work.mirrored, mirrored, "{size:?}");
            let finished = work.work(&mut MockEngine::default(), None).unwrap();
            let tops: Vec<u32> = finished.iter().map(|part| part.tile.origin[1]).collect();
            assert_eq!(tops, if mirrored { vec![0, size[1] - 1] } else { vec![0] }, "{size:?}");
            assert_eq!(work.index([size[0] - 1, size[1] - 1]) + 1, pixels(size), "{size:?}");
        }
    }

    fn pixels(size: [u32; 2]) -> u64 {
        u64::from(size[0]) * u64::from(size[1])
    }

    #[test]
    fn bands_of_deep_pictures_are_as_high_as_leaves() {
        let mut deep = scene(["1.186731", "2.044025"]);
        let rows = |scene: &Scene, width| {
            Work::new(scene, [width, 64], CONFIG, 1 << 15).waiting[0].size[1]
        };
        assert_eq!(rows(&deep, 40_000), 1);
        deep.view.width = "1e-9".to_string();
        assert_eq!([1000, 40_000, 500_000].map(|width| rows(&deep, width)), [32, 16, 2]);
    }

    #[test]
    fn a_deadline_ends_a_call_and_loses_nothing() {
        let (scene, size) = (scene(["1", "0.5"]), [40, 40]);
        let mut engine = MockEngine::default();
        let mut work = Work::new(&scene, size, CONFIG, 64);
        let mut pixels = 0;
        while !work.is_done() {
            for part in work.work(&mut engine, Some(Instant::now())).unwrap() {
                pixels += part.samples.len();
            }
        }
        assert_eq!(pixels, 1600);
    }

    #[test]
    fn an_engine_that_fails_is_reported() {
        let mut engine = MockEngine { fail_at: Some(3), ..MockEngine::default() };
        let mut work = Work::new(&scene(["1", "0"]), [64, 64], CONFIG, 64);
        let error = (0..10).find_map(|_| work.work(&mut engine, None).err());
        assert!(error.unwrap().to_string().contains("MiB"));
    }
}
