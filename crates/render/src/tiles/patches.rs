//! The patches of a film, which sample every place once, as finely as its closest frame needs.
//!
//! A [`Patch`](Cell) is a cell of the lattice with [`PATCH_SIDE`] × [`PATCH_SIDE`] samples. Where
//! any frame comes so close that these lie too far apart, the cell's quarters are patches instead.
//! The samples of a place are therefore the same in every frame that shows it, and nothing pops.

use std::collections::HashSet;

use flipmap_scene::lattice::{Cell, DEEPEST, side_rad};
use flipmap_scene::{Grid, Scene, Turn};

/// Samples along each side of a patch.
pub(crate) const PATCH_SIDE: u32 = 16;
/// Samples in a patch.
pub(crate) const PATCH_SAMPLES: usize = (PATCH_SIDE * PATCH_SIDE) as usize;
/// Factor by which samples may lie farther apart than required. Levels differ by a factor of two,
/// so samples lie farther apart than required as often as closer.
pub(crate) const SLACK: f64 = std::f64::consts::SQRT_2;
/// Width in pixels of the margin around a frame that counts as seen.
const MARGIN_PIXELS: f64 = 1.5;

/// Distance between a level's samples in rad.
pub(crate) fn patch_pitch_rad(level: u32) -> f64 {
    side_rad(level) / f64::from(PATCH_SIDE)
}

/// The part of the plane that a frame shows, and the distance between samples that it requires.
#[derive(Clone, Debug)]
pub(crate) struct Sight {
    center: [Turn; 2],
    /// Unit vectors to the right and up.
    axes: [[f64; 2]; 2],
    /// Half the extent along each axis in rad, margin included.
    half_rad: [f64; 2],
    /// Required distance between samples in rad.
    pitch_rad: f64,
}

impl Sight {
    /// Creates the sight of a frame of `size` pixels, each with `samples` × `samples` samples.
    pub(crate) fn new(scene: &Scene, size: [u32; 2], samples: u32) -> Self {
        let [right, up] = Grid::new(scene, size).pixel_axes();
        let length = |by: [f64; 2]| by[0].hypot(by[1]);
        let unit = |by: [f64; 2]| by.map(|part| part / length(by));
        let half = |side: u32, by| (0.5 * f64::from(side) + MARGIN_PIXELS) * length(by);
        Sight {
            center: scene.view.center_rad().map(Turn::from_theta),
            axes: [unit(right), unit(up)],
            half_rad: [half(size[0], right), half(size[1], up)],
            pitch_rad: (length(right) * length(up)).sqrt() / f64::from(samples),
        }
    }

    /// Required distance between samples in rad.
    pub(crate) fn pitch_rad(&self) -> f64 {
        self.pitch_rad
    }

    /// Returns true if a level's samples lie too far apart for the frame.
    fn wants_finer(&self, level: u32) -> bool {
        patch_pitch_rad(level) > SLACK * self.pitch_rad
    }

    /// Returns the level whose samples lie as close as required, neither much farther apart nor
    /// much closer.
    pub(crate) fn level(&self) -> u32 {
        (0..DEEPEST).find(|level| !self.wants_finer(*level)).unwrap_or(DEEPEST)
    }

    /// Returns true if part of a cell may be in the frame.
    fn sees(&self, cell: &Cell) -> bool {
        let reach = self.half_rad[0].hypot(self.half_rad[1]);
        if reach > 3.0 * std::f64::consts::PI {
            return true;
        }
        let offset = offset_rad(cell.middle(), self.center);
        let turns: &[f64] = if reach > 1.0 { &[-1.0, 0.0, 1.0] } else { &[0.0] };
        let moved = |i: usize, turns: f64| offset[i] + std::f64::consts::TAU * turns;
        let half = 0.5 * side_rad(cell.level);
        turns.iter().any(|x| turns.iter().any(|y| self.touches([moved(0, *x), moved(1, *y)], half)))
    }

    /// Returns true if a square may touch the frame; squares that just miss a corner count too.
    /// `middle` is the square's offset from the frame's centre, `half` half its side, rad.
    fn touches(&self, middle: [f64; 2], half: f64) -> bool {
        [0, 1].iter().all(|&i| {
            let axis = self.axes[i];
            let along = (axis[0] * middle[0] + axis[1] * middle[1]).abs();
            along <= self.half_rad[i] + half * (axis[0].abs() + axis[1].abs())
        })
    }
}

/// Returns the shortest offset on the torus from one place to another, rad.
pub(crate) fn offset_rad(to: [Turn; 2], from: [Turn; 2]) -> [f64; 2] {
    let half = Turn::from_f64(0.5);
    [0, 1].map(|i| ((to[i] - from[i] + half).wrapped() - half).to_f64() * std::f64::consts::TAU)
}

/// Returns the patches of a film's frames, depth first in the order of [`Cell::children`].
pub(crate) fn patches(sights: &[Sight]) -> Vec<Cell> {
    let mut found = Vec::new();
    descend(Cell::WHOLE, &sights.iter().collect::<Vec<_>>(), sights, &mut found);
    found
}

fn descend(cell: Cell, near: &[&Sight], all: &[Sight], found: &mut Vec<Cell>) {
    let finer = |sight: &&&Sight| sight.wants_finer(cell.level) && sight.sees(&cell);
    let finer: Vec<&Sight> = near.iter().filter(finer).copied().collect();
    if !finer.is_empty() && cell.level < DEEPEST {
        return cell.children().into_iter().for_each(|child| descend(child, &finer, all, found));
    }
    if all.iter().any(|sight| sight.sees(&cell)) {
        found.push(cell);
    }
}

/// Returns the patches that have to be computed: only one of each cell and its mirror image.
pub(crate) fn canonical(patches: &[Cell]) -> Vec<Cell> {
    let mut seen = HashSet::new();
    let canonical = patches.iter().map(|cell| cell.canonical().0);
    canonical.filter(|cell| seen.insert(*cell)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::Exact;
    use flipmap_numbers::Scalar;
    use flipmap_scene::View;

    fn scene(center: [f64; 2], width: f64) -> Scene {
        let center = center.map(|angle| angle.to_string());
        let view = View { center, width: width.to_string(), ..View::default() };
        Scene { view, ..Scene::default() }
    }

    fn zoom(to: f64, frames: i32) -> Vec<Sight> {
        let width = |k: i32| 6.0 * (to / 6.0).powf(f64::from(k) / f64::from(frames - 1));
        (0..frames).map(|k| Sight::new(&scene([-1.66, 0.1], width(k)), [128, 128], 2)).collect()
    }

    #[test]
    fn every_place_of_a_frame_is_in_exactly_one_patch_that_is_fine_enough() {
        let sights = zoom(1e-3, 40);
        let patches = patches(&sights);
        for k in 0..patches.len() {
            let ancestors = (0..patches[k].level).map(|level| patches[k].ancestor(level));
            assert!(ancestors.into_iter().all(|above| !patches.contains(&above)), "{k} twice");
        }
        for (across, above) in [(-0.49, -0.49), (0.3, 0.4), (0.001, 0.0), (0.49, -0.2)] {
            for (k, sight) in sights.iter().enumerate() {
                let width = 6.0 * (1e-3f64 / 6.0).powf(k as f64 / 39.0);
                let at = [-1.66 + across * width, 0.1 + above * width].map(Exact::from_f64);
                let holds = |cell: &&Cell| Cell::around(at, cell.level) == **cell;
                let patch = patches.iter().find(holds).expect("a patch");
                assert!(patch_pitch_rad(patch.level) <= SLACK * sight.pitch_rad, "frame {k}");
            }
        }
    }

    #[test]
    fn a_zoom_costs_a_few_frames_an_octave() {
        // Ten decades are 33 octaves; a frame is 128 × 128 pixels of 2 × 2 samples.
        let patches = patches(&zoom(6e-10, 600));
        let frames = (patches.len() * PATCH_SAMPLES) as f64 / (4.0 * 128.0 * 128.0);
        assert!((30.0..110.0).contains(&frames), "{frames}");
    }

    #[test]
    fn what_no_frame_shows_is_not_sampled() {
        let sights = [Sight::new(&scene([1.0, 0.5], 1e-2), [64, 64], 1)];
        let patches = patches(&sights);
        assert!(patches.len() < 20, "{}", patches.len());
        assert!(patches.iter().all(|cell| cell.level == sights[0].level()));
    }

    #[test]
    fn mirrored_patches_are_computed_once() {
        let patches = patches(&[Sight::new(&scene([0.0, 0.0], 6.0), [128, 128], 1)]);
        assert!(canonical(&patches).len() <= patches.len() / 2 + 4);
    }
}
