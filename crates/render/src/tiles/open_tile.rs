//! The known samples of a tile before its job, and the starts of its other pixels.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use super::plan::Tile;
use super::points::Points;
use super::samples::{RowMut, Samples};
use super::saved_pixels::SavedPixel;
use super::stride::Stride;
use flipmap_engine::{
    Assurance, Cells, Deep, IntegratorConfig, IntegratorState, Leaf, Separable, StartList, Starts,
    Trust,
};
use flipmap_pendulum::Outcome;
use flipmap_scene::lattice::Cell;
use flipmap_scene::{ExactPlane, Fate, Grid, Grouped, Scene, SeparableGrid};

/// A pixel of an earlier run, and the assurance of its outcome.
pub(super) type Known = (SavedPixel, Assurance);

/// A tile before its job: the known samples, and the starts of the other pixels.
#[derive(Debug)]
pub(super) struct OpenTile {
    pub samples: Samples,
    /// Index of the sample of each start.
    pub places: Vec<u32>,
    pub starts: Starts,
}

impl OpenTile {
    /// Creates a tile of some pixels of a grid; `known` returns an earlier run's result for a
    /// pixel.
    pub(super) fn of_pixels(
        grid: &Grid,
        config: IntegratorConfig,
        cells: Cells,
        pixels: &[[u32; 2]],
        known: impl Fn([u32; 2]) -> Option<Known> + Sync,
    ) -> Self {
        let plane = grid.cell_plane().filter(|_| cells.are_followed(&config, grid.pixel_rad()));
        let Some(plane) = plane else {
            let pixel = |place: u32| (grid, pixels[place as usize], known(pixels[place as usize]));
            return OpenTile::sorted(pixels.len() as u32, None, pixel);
        };
        let samples = Samples::unflipped(pixels.len());
        let mut tile = OpenTile { samples, places: Vec::new(), starts: Starts::Rest(Vec::new()) };
        // Known pixels are not grouped at all: of the corners of pixels, most are known.
        let open = (0..).zip(pixels.iter().copied()).filter(|(place, pixel)| match known(*pixel) {
            Some((SavedPixel::Over(outcome), assurance)) => {
                tile.set(*place, outcome, assurance);
                false
            }
            _ => true,
        });
        let groups = grid.grouped(config.leaf_pixels(), open);
        tile.fill_deep(plane, groups, |place| known_deep((grid, pixels[place as usize], None)));
        tile
    }

    /// Creates a tile of some of the points.
    pub(super) fn of_points(points: &Points, some: Range<usize>) -> Self {
        let pixel = |place: u32| {
            let (grid, pixel) = points.pixels[some.start + place as usize];
            (&points.grids[grid as usize], pixel, None)
        };
        OpenTile::sorted(some.len() as u32, None, pixel)
    }

    /// Creates a tile of an upright grid of which nothing is known beforehand, on all cores; `None`
    /// if a start does not have the angles of its column and row.
    pub(super) fn of_upright(grid: &Grid, tile: &Tile) -> Option<Self> {
        let ([x, y], [width, height]) = (tile.origin, tile.size);
        let upright = grid.upright(x..x + width, y..y + height)?;
        let mut samples = Samples::unflipped((width * height) as usize);
        let rows = samples.rows_mut(width as usize).enumerate();
        let open = rows
            .map(|(row, mut samples)| open_runs(grid, &upright, tile, row as u32, &mut samples));
        let open: Vec<Vec<Range<u32>>> = open.collect::<Option<_>>()?;
        let places = joined(&open);
        let starts = Separable { angles: upright.angles, places: places.clone() };
        Some(OpenTile { samples, places, starts: Starts::Upright(starts) })
    }

    /// Creates a tile of samples of cells of one level, cell after cell; `known` takes the index of
    /// a cell and the column and row of a sample in it.
    pub(super) fn of_cells(
        scene: &Scene,
        config: IntegratorConfig,
        cells: &[Cell],
        spacing: Spacing,
        known: impl Fn(usize, [u32; 2]) -> Option<Known> + Sync,
    ) -> Self {
        let Spacing { side, stride, .. } = spacing;
        let in_cell = stride.count(side);
        let grids: Vec<Grid> = cells.iter().map(|cell| cell.grid(scene, side)).collect();
        let pixel = |index: u32| {
            let (k, place) = ((index / in_cell) as usize, stride.place(index % in_cell, side));
            (&grids[k], place, known(k, place))
        };
        let deep = grids.first().filter(|grid| config.is_deep(grid.pixel_rad()));
        let plane = deep.and_then(Grid::cell_plane);
        let groups = plane.map(|plane| (plane, spacing.leaves_of(cells)));
        OpenTile::sorted(cells.len() as u32 * in_cell, groups, pixel)
    }

    /// Sorts `count` pixels into known samples and starts. `pixel` returns the grid of a pixel, its
    /// column and row, and what is known of it; `groups` holds deep pixels by leaf, with the plane
    /// of the leaves.
    fn sorted<'a>(
        count: u32,
        groups: Option<(ExactPlane, Grouped)>,
        pixel: impl Fn(u32) -> (&'a Grid, [u32; 2], Option<Known>) + Sync,
    ) -> Self {
        let samples = Samples::unflipped(count as usize);
        let mut tile = OpenTile { samples, places: Vec::new(), starts: Starts::Rest(Vec::new()) };
        match groups {
            Some((plane, groups)) => {
                tile.fill_deep(plane, groups, |place| known_deep(pixel(place)));
            }
            None => tile.fill(count, |place| {
                let (grid, [x, y], known) = pixel(place);
                (grid.fate(x, y), known)
            }),
        }
        tile
    }

    /// Removes the starts of an upright tile whose samples are known.
    pub(super) fn sparing(mut self, known: impl Fn(u32) -> Option<(Outcome, Assurance)>) -> Self {
        let mut places = std::mem::take(&mut self.places);
        places.retain(|&place| match known(place) {
            Some((outcome, assurance)) => {
                self.set(place, outcome, assurance);
                false
            }
            None => true,
        });
        if let Starts::Upright(upright) = &mut self.starts {
            upright.places.clone_from(&places);
        }
        OpenTile { places, ..self }
    }

    /// Returns true if there is nothing to compute.
    pub(super) fn is_settled(&self) -> bool {
        self.places.is_empty()
    }

    /// Sorts `count` pixels into known samples and starts, on all cores. Resumed and new starts
    /// never share a job.
    fn fill(&mut self, count: u32, pixel: impl Fn(u32) -> (Fate, Option<Known>) + Sync) {
        let places: Vec<u32> = (0..count).step_by(SHARE as usize).collect();
        let sorted = |&first: &u32| Sorted::new(first..count.min(first + SHARE), &pixel);
        let parts: Vec<Sorted> = places.par_iter().map(sorted).collect();
        let mut all = Sorted::default();
        for part in parts {
            for (place, outcome, assurance) in part.known {
                self.set(place, outcome, assurance);
            }
            self.places.extend(part.places);
            all.starts.append(part.starts);
            all.resumed.extend(part.resumed);
            all.thrown |= part.thrown;
        }
        debug_assert!(
            all.resumed.is_empty() || all.starts.is_empty(),
            "places of new starts had no samples"
        );
        self.starts = if all.resumed.is_empty() {
            all.starts.into_starts()
        } else {
            Starts::Resumed { states: all.resumed, thrown: all.thrown }
        };
    }

    /// Sorts deep pixels, grouped by leaf, into known samples and starts.
    fn fill_deep(
        &mut self,
        plane: ExactPlane,
        groups: Grouped,
        known: impl Fn(u32) -> Option<(Outcome, Assurance)>,
    ) {
        let mut leaves = Vec::new();
        for (cell, pixels) in groups {
            let mut points = Vec::with_capacity(pixels.len());
            for (place, point) in pixels {
                if let Some((outcome, assurance)) = known(place) {
                    self.set(place, outcome, assurance);
                } else {
                    self.places.push(place);
                    points.push(point);
                }
            }
            if !points.is_empty() {
                leaves.push(Leaf { cell, points });
            }
        }
        self.starts = Starts::Deep(Deep { leaves, plane: Box::new(plane), strict: false });
    }

    fn set(&mut self, place: u32, outcome: Outcome, assurance: Assurance) {
        self.samples.set(place as usize, outcome);
        self.samples.assure(place as usize, assurance);
    }
}

/// Returns the places of all runs of all rows, in their order.
fn joined(rows: &[Vec<Range<u32>>]) -> Vec<u32> {
    let count = |row: &[Range<u32>]| row.iter().map(ExactSizeIterator::len).sum::<usize>();
    let mut places = vec![0; rows.iter().map(|row| count(row)).sum()];
    let (mut parts, mut rest) = (Vec::with_capacity(rows.len()), &mut places[..]);
    for row in rows {
        let (part, later) = rest.split_at_mut(count(row));
        parts.push((row, part));
        rest = later;
    }
    parts.into_par_iter().for_each(|(row, mut part)| {
        for run in row {
            let (own, later) = part.split_at_mut(run.len());
            own.iter_mut().zip(run.clone()).for_each(|(own, place)| *own = place);
            part = later;
        }
    });
    places
}

/// Fills in the known samples of a row of an upright grid's tile, and returns the runs of its other
/// places; `None` if a start does not have the angles of its column and row.
fn open_runs(
    grid: &Grid,
    upright: &SeparableGrid,
    tile: &Tile,
    row: u32,
    samples: &mut RowMut,
) -> Option<Vec<Range<u32>>> {
    let width = tile.size[0];
    let fate = |column: u32| upright.is_forbidden(column as usize, row as usize);
    let mut open = Vec::new();
    let mut column = 0;
    while column < width {
        let first = row * width + column;
        if let Some(is_forbidden) = fate(column) {
            let same = |column: &u32| fate(*column) == Some(is_forbidden);
            let length = (column..width).take_while(same).count() as u32;
            if is_forbidden {
                samples.forbid(column as usize..(column + length) as usize);
            } else {
                open.push(first..first + length);
            }
            column += length;
            continue;
        }
        match grid.fate(tile.origin[0] + column, tile.origin[1] + row) {
            Fate::Known(outcome) => {
                samples.set(column as usize, outcome, Trust::of_proved(&outcome).into());
            }
            Fate::Open(angle) if angle == upright.angle(column as usize, row as usize) => {
                open.push(first..first + 1);
            }
            Fate::Open(_) | Fate::Thrown(_) | Fate::BesideTop(_) => return None,
        }
        column += 1;
    }
    Some(open)
}

/// Number of pixels that a thread sorts at a time.
const SHARE: u32 = 1 << 12;

/// Some pixels of a tile, sorted into known samples and starts in their order.
#[derive(Default)]
struct Sorted {
    known: Vec<(u32, Outcome, Assurance)>,
    /// Index of the sample of each start.
    places: Vec<u32>,
    starts: StartList,
    resumed: Vec<IntegratorState>,
    /// True if resumed pendulums were thrown.
    thrown: bool,
}

impl Sorted {
    fn new(places: Range<u32>, pixel: &impl Fn(u32) -> (Fate, Option<Known>)) -> Self {
        let mut sorted = Sorted::default();
        for place in places {
            match pixel(place) {
                (Fate::Known(outcome), _) => {
                    sorted.known.push((place, outcome, Trust::of_proved(&outcome).into()));
                    continue;
                }
                (_, Some((SavedPixel::Over(outcome), assurance))) => {
                    sorted.known.push((place, outcome, assurance));
                    continue;
                }
                (fate, Some((SavedPixel::Unfinished(state), _))) => {
                    sorted.thrown |= match fate {
                        Fate::Thrown(_) => true,
                        Fate::BesideTop(moments) => !moments.is_at_rest(),
                        _ => false,
                    };
                    sorted.resumed.push(state);
                }
                (Fate::Open(angle), None) => sorted.starts.push_at_rest(angle),
                (Fate::Thrown(launch), None) => sorted.starts.push_thrown(launch),
                (Fate::BesideTop(moments), None) => sorted.starts.push_beside_top(moments),
            }
            sorted.places.push(place);
        }
        sorted
    }
}

/// Returns the outcome of a deep pixel if it needs no integration. An unfinished pixel has no state
/// of its own: with a larger budget, it starts again.
fn known_deep(
    (grid, [x, y], known): (&Grid, [u32; 2], Option<Known>),
) -> Option<(Outcome, Assurance)> {
    match known {
        Some((SavedPixel::Over(outcome), assurance)) => Some((outcome, assurance)),
        _ => grid.outcome_beside_top(x, y).map(|outcome| (outcome, Trust::Agreed.into())),
    }
}

/// The samples of cells, and how they are grouped by leaf where they are deep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spacing {
    /// Number of places along a side of a cell.
    pub side: u32,
    /// Stride of the samples.
    pub stride: Stride,
    /// Number of places along a side of a leaf.
    pub leaf_pixels: u32,
}

impl Spacing {
    /// Returns the leaves of cells, with the indices of their points among all samples of the
    /// cells.
    fn leaves_of(self, cells: &[Cell]) -> Grouped {
        let Spacing { side, stride, leaf_pixels } = self;
        // A leaf may hold several cells.
        let mut groups = BTreeMap::<Cell, Vec<_>>::new();
        for (k, cell) in (0..).zip(cells) {
            let first = k * stride.count(side);
            let sample = |(place, point): (u32, [f64; 2])| {
                let index = stride.index([place % side, place / side], side)?;
                Some((first + index, point))
            };
            for (leaf, points) in cell.leaves(side, leaf_pixels) {
                groups.entry(leaf).or_default().extend(points.into_iter().filter_map(sample));
            }
        }
        groups.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::level::BALANCED;
    use flipmap_scene::{BuiltIn, View};

    #[test]
    fn an_upright_tile_is_sorted_as_pixel_by_pixel() {
        let home = BuiltIn::home().document().scene();
        let top = View {
            center: ["0".into(), "3.141592653589793".into()],
            width: "1e-9".into(),
            ..View::default()
        };
        for size in [[64, 50], [40, 33]] {
            let scene = &home;
            let grid = Grid::new(&scene.clone().checked().unwrap(), size);
            let tile = Tile { origin: [0, 7], size: [size[0], 20] };
            let upright = OpenTile::of_upright(&grid, &tile).expect("not turned");
            let pixels: Vec<_> = tile.pixels().collect();
            let each = OpenTile::of_pixels(&grid, BALANCED, Cells::Never, &pixels, |_| None);
            assert_eq!((&upright.samples, &upright.places), (&each.samples, &each.places));
            assert_eq!(upright.starts.listed(), each.starts);
        }
        let beside_the_top = Scene { view: top, ..Scene::default() };
        let grid = Grid::new(&beside_the_top.checked().unwrap(), [64, 50]);
        let tile = Tile { origin: [0, 7], size: [64, 20] };
        assert!(OpenTile::of_upright(&grid, &tile).is_none());
    }

    #[test]
    fn a_column_whose_angle_depends_on_the_row_is_not_upright() {
        // The middle of this picture is a column at the top, on either side of which rows begin.
        let home = BuiltIn::home().document().scene();
        let grid = Grid::new(&home, [41, 41]);
        let whole = Tile { origin: [0, 0], size: [41, 41] };
        assert!(OpenTile::of_upright(&grid, &whole).is_none());
        let [left, right] = [0, 21].map(|x| Tile { origin: [x, 0], size: [20, 41] });
        assert!([left, right].iter().all(|half| OpenTile::of_upright(&grid, half).is_some()));
    }

    #[test]
    fn runs_are_joined_row_by_row() {
        let rows = [vec![0..3, 5..6], Vec::new(), vec![20..22, 30..31]];
        assert_eq!(joined(&rows), [0, 1, 2, 5, 20, 21, 30]);
        assert!(joined(&[]).is_empty());
    }
}
