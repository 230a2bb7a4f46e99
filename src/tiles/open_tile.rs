//! The known samples of a tile before its job, and the starts of its other pixels.

use super::samples::Samples;
use super::saved_pixels::SavedPixel;
use crate::engine::{Deep, IntegratorConfig, IntegratorState, Leaf, Starts, Trust};
use crate::physics::Outcome;
use crate::scene::lattice::Cell;
use crate::scene::{Fate, Grid, Grouped, Scene};

/// A pixel of an earlier run, and the trust of its outcome.
pub(super) type Known = (SavedPixel, Trust);

/// A tile before its job: the known samples, and the starts of the other pixels.
#[derive(Debug)]
pub(super) struct OpenTile {
    pub samples: Samples,
    /// Index of the sample of each start.
    pub places: Vec<u32>,
    pub starts: Starts,
}

impl OpenTile {
    /// Creates a tile of some pixels of a grid; `known` returns what an earlier run found out about
    /// a pixel.
    pub(super) fn of_pixels(
        grid: &Grid,
        config: IntegratorConfig,
        pixels: &[[u32; 2]],
        known: impl Fn([u32; 2]) -> Option<Known>,
    ) -> Self {
        let mut tile = OpenTile::unflipped(pixels.len());
        if config.is_deep(grid.pixel_rad()) {
            tile.fill_deep(grid.grouped(pixels.iter().copied()), |place| {
                let pixel = pixels[place as usize];
                known_deep(grid, pixel, known(pixel))
            });
        } else {
            let all = (0..).zip(pixels);
            tile.fill(all.map(|(k, &[x, y])| (k, grid.fate(x, y), known([x, y]))));
        }
        tile
    }

    /// Creates a tile of all samples of cells of one level, `side` × `side` each, cell after cell;
    /// `known` takes the index of a cell and the place of a sample in it.
    pub(super) fn of_cells(
        scene: &Scene,
        config: IntegratorConfig,
        cells: &[Cell],
        side: u32,
        known: impl Fn(usize, u32) -> Option<Known>,
    ) -> Self {
        let in_cell = side * side;
        let grids: Vec<Grid> = cells.iter().map(|cell| cell.grid(scene, side)).collect();
        let pixel = |place: u32| {
            let (k, place) = ((place / in_cell) as usize, place % in_cell);
            (&grids[k], [place % side, place / side], known(k, place))
        };
        let count = cells.len() as u32 * in_cell;
        let mut tile = OpenTile::unflipped(count as usize);
        if grids.first().is_some_and(|grid| config.is_deep(grid.pixel_rad())) {
            tile.fill_deep(leaves_of(cells, side), |place| {
                let (grid, pixel, known) = pixel(place);
                known_deep(grid, pixel, known)
            });
        } else {
            tile.fill((0..count).map(|place| {
                let (grid, [x, y], known) = pixel(place);
                (place, grid.fate(x, y), known)
            }));
        }
        tile
    }

    fn unflipped(count: usize) -> Self {
        let samples = Samples::unflipped(count);
        OpenTile { samples, places: Vec::new(), starts: Starts::Rest(Vec::new()) }
    }

    /// Returns true if there is nothing to compute.
    pub(super) fn is_settled(&self) -> bool {
        self.places.is_empty()
    }

    /// Sorts pixels into known samples and starts. Resumed and new starts never share a job.
    fn fill(&mut self, pixels: impl Iterator<Item = (u32, Fate, Option<Known>)>) {
        let (mut angles, mut resumed) = (Vec::new(), Vec::<IntegratorState>::new());
        for (place, fate, known) in pixels {
            match (fate, known) {
                (Fate::Known(outcome), _) => self.set(place, outcome, Trust::of_proved(&outcome)),
                (Fate::Open(_), Some((SavedPixel::Over(outcome), trust))) => {
                    self.set(place, outcome, trust);
                }
                (Fate::Open(_), Some((SavedPixel::Unfinished(state), _))) => {
                    self.places.push(place);
                    resumed.push(state);
                }
                (Fate::Open(angle), None) => {
                    self.places.push(place);
                    angles.push(angle);
                }
            }
        }
        self.starts =
            if resumed.is_empty() { Starts::Rest(angles) } else { Starts::Resumed(resumed) };
    }

    /// Sorts deep pixels, grouped by leaf, into known samples and starts.
    fn fill_deep(&mut self, groups: Grouped, known: impl Fn(u32) -> Option<(Outcome, Trust)>) {
        let mut leaves = Vec::new();
        for (cell, pixels) in groups {
            let mut points = Vec::with_capacity(pixels.len());
            for (place, point) in pixels {
                if let Some((outcome, trust)) = known(place) {
                    self.set(place, outcome, trust);
                } else {
                    self.places.push(place);
                    points.push(point);
                }
            }
            if !points.is_empty() {
                leaves.push(Leaf { cell, points });
            }
        }
        self.starts = Starts::Deep(Deep { leaves, strict: false });
    }

    fn set(&mut self, place: u32, outcome: Outcome, trust: Trust) {
        self.samples.set(place as usize, outcome);
        self.samples.set_trust(place as usize, trust);
    }
}

/// Returns the outcome of a deep pixel if it needs no integration. An unfinished pixel has no state
/// of its own: a larger budget begins it anew.
fn known_deep(grid: &Grid, [x, y]: [u32; 2], known: Option<Known>) -> Option<(Outcome, Trust)> {
    match known {
        Some((SavedPixel::Over(outcome), trust)) => Some((outcome, trust)),
        _ => grid.opening(x, y).map(|outcome| (outcome, Trust::Agreed)),
    }
}

/// Returns the leaves of cells, with the places of their points among all samples of the cells.
fn leaves_of(cells: &[Cell], side: u32) -> Grouped {
    let moved = |first: u32| move |(place, point)| (first + place, point);
    let leaves = |(k, cell): (u32, &Cell)| {
        let shift = moved(k * side * side);
        cell.leaves(side)
            .into_iter()
            .map(move |(leaf, points)| (leaf, points.into_iter().map(shift).collect()))
    };
    (0..).zip(cells).flat_map(leaves).collect()
}
