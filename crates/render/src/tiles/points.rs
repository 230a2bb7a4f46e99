//! Answers at chosen pixels of any grids: points that are scattered over a region, and small groups of
//! points around them.

use std::time::Duration;

use super::in_flight::{FinishedBatch, InFlightJobs, NextTile, TileSource};
use super::open_tile::OpenTile;
use super::reader::Reader;
use super::{Renderer, Samples};
use crate::Watch;
use flipmap_engine::clock::Instant;
use flipmap_engine::{EngineError, EventSpec, IntegratorConfig, Wait};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Grid, Scene};

/// Pixels of several grids of one scene, in the order of their answers.
#[derive(Clone, Debug, Default)]
pub struct Points {
    /// The grids.
    pub grids: Vec<Grid>,
    /// Index of the grid of each pixel, with its column and row.
    pub pixels: Vec<(u32, [u32; 2])>,
}

impl Points {
    /// Adds all pixels of a grid, row by row.
    pub fn push_all(&mut self, grid: Grid) {
        let (index, [width, height]) = (self.grids.len() as u32, grid.size());
        let pixels = (0..height).flat_map(|row| (0..width).map(move |column| [column, row]));
        self.pixels.extend(pixels.map(|pixel| (index, pixel)));
        self.grids.push(grid);
    }
}

/// Largest number of points of a job. A batch is sorted on all cores before its job begins.
const MOST_POINTS: usize = 1 << 15;
/// Longest wait for the engine before the watch is asked again.
const PATIENCE: Duration = Duration::from_millis(50);

/// The computation of points: a tile is the place of its first point, and their number.
struct PointWork<'a> {
    points: &'a Points,
    question: EventSpec,
    config: IntegratorConfig,
    ask: QuestionName,
    next: usize,
    in_flight: InFlightJobs<(usize, usize)>,
    samples: Samples,
    done: usize,
}

impl TileSource for PointWork<'_> {
    type Tile = (usize, usize);

    fn next_tile(&mut self, job_size: usize) -> Option<NextTile<Self::Tile>> {
        let first = self.next;
        let count = job_size.min(MOST_POINTS).min(self.points.pixels.len() - first);
        if count == 0 {
            return None;
        }
        self.next += count;
        let mut open = OpenTile::of_points(self.points, first..first + count);
        let (question, config, ask) = (self.question, self.config, self.ask);
        let phase = |place: usize| {
            let (grid, [x, y]) = self.points.pixels[first + place];
            self.points.grids[grid as usize].phase_at_first_pass(x, y)
        };
        open.samples = Reader::new(ask, &question).complete(open.samples, phase);
        Some(NextTile { tile: (first, count), open, question, config, keeps_states: false, ask })
    }

    fn take(&mut self, batch: FinishedBatch<Self::Tile>) {
        let (first, count) = batch.tile;
        self.samples.copy(first, &batch.samples, 0..count);
        self.done += count;
    }

    fn in_flight(&mut self) -> &mut InFlightJobs<Self::Tile> {
        &mut self.in_flight
    }
}

impl Renderer {
    /// Returns the samples of a checked scene at some points, or `None` if `watch` stops it.
    pub fn answers_at(
        &mut self,
        scene: &Scene,
        points: &Points,
        watch: &dyn Watch,
    ) -> Result<Option<Samples>, EngineError> {
        let scene = scene.clone().settled();
        let (ask, count) = (scene.question.ask, points.pixels.len());
        let mut work = PointWork {
            points,
            question: EventSpec::from(&scene),
            config: self.config(),
            ask,
            next: 0,
            in_flight: InFlightJobs::default(),
            samples: Samples::unanswered(count, ask.kind().channels.len()),
            done: 0,
        };
        let engine = self.engine();
        while work.done < count {
            if !watch.keep_going(work.done as u64, count as u64) {
                work.in_flight.cancel(engine);
                return Ok(None);
            }
            work.submit(engine, |_| false)?;
            work.collect(engine, Wait::Until(Instant::now() + PATIENCE))?;
        }
        Ok(Some(work.samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::EngineKind;
    use flipmap_engine::choice::EngineRequest;
    use flipmap_numbers::Scalar;
    use flipmap_scene::{Document, View};

    fn renderer() -> Renderer {
        let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
        Renderer::new(&request).unwrap()
    }

    #[test]
    fn points_have_the_answers_of_a_picture() {
        let scene = Document::parse("").unwrap().scene().checked().unwrap();
        let (size, mut renderer) = ([24, 24], renderer());
        let picture = renderer.render(&scene, size).unwrap();
        let mut points = Points::default();
        points.push_all(Grid::new(&scene, size));
        let all = renderer.answers_at(&scene, &points, &|_, _| true).unwrap().unwrap();
        let outcomes = |samples: &Samples| samples.iter().collect::<Vec<_>>();
        assert_eq!(outcomes(&all), outcomes(&picture));
        assert!(renderer.answers_at(&scene, &points, &|_, _| false).unwrap().is_none());
    }

    #[test]
    fn a_grid_around_a_pixel_begins_there_and_turns_with_the_view() {
        let center = ["1.25".into(), "-0.5".into()];
        let view = View { center, width: "0.5".into(), rotate: 30.0, ..View::default() };
        let scene = Scene { view, ..Scene::default() }.checked().unwrap();
        let grid = Grid::new(&scene, [1 << 20, 1 << 20]);
        let pixel = [700_001, 90_000];
        let one = grid.around(pixel, [1e-14; 2], [1, 1]);
        let (own, there) = (one.angle_from_pixel(0, 0), grid.angle_from_pixel(pixel[0], pixel[1]));
        assert!((0..2).all(|i| (own[i] - there[i]).abs().hi < 1e-31), "{own:?} for {there:?}");
        let two = grid.around(pixel, [1e-14; 2], [2, 1]);
        let [left, right] = [0, 1].map(|column| two.angle_from_pixel(column, 0));
        let apart = [0, 1].map(|i| (right[i] - left[i]).to_f64() / 1e-14);
        let turned = [30f64.to_radians().cos(), 30f64.to_radians().sin()];
        assert!((0..2).all(|i| (apart[i] - turned[i]).abs() < 1e-12), "{apart:?}");
    }
}
