//! A frame, painted from the colours of its patches.
//!
//! A pixel is the mean of several points in it. Each point is looked up in two levels of the mip,
//! the one whose samples lie about as close as the points and the next finer one, and the two are
//! mixed by where the frame's scale lies between them (Williams, Pyramidal parametrics, 1983).
//! Everything thus changes gradually as the camera moves on: nothing pops where levels meet.

use std::collections::HashMap;
use std::io;

use rayon::prelude::*;

use super::Mip;
use super::colours::HIGHEST;
use super::lit_frame::LitFrame;
use super::mip::{HEIGHT, Light};
use crate::output::{CurveBand, blended};
use crate::scene::palette::encoded;

use crate::scene::Turn;
use crate::scene::film::Shot;
use crate::scene::lattice::Cell;
use crate::scene::palette::{Ground, Relief, Rgb};
use crate::scene::{Grid, PictureTable, Scene};
use crate::tiles::patches::{PATCH_SIDE, SLACK, Sight, offset_rad, patch_pitch_rad};

/// Colour of starts that have not flipped yet while the clock runs.
pub const WAITING: Rgb = [0x16, 0x18, 0x1d];

/// The light of white.
const MOST_LIGHT: f32 = 65535.0;

/// Paints frames from a mip.
pub struct FramePainter {
    size: [u32; 2],
    samples: u32,
    /// The colour of the energy curve, if it is drawn.
    curve: Option<Rgb>,
    /// The light from the side, if there is any.
    relief: Option<Relief>,
    /// The sRGB value of every linear light.
    encode: Vec<u8>,
    /// Light of the cells that the previous frame used.
    used: HashMap<Cell, Light>,
}

/// The cells of one level around a frame.
struct Layer {
    level: u32,
    /// Offset from the frame's centre to the lower left corner of the first cell, in samples.
    origin: [f64; 2],
    columns: usize,
    cells: Vec<Option<Entry>>,
    /// Number of numbers per sample.
    channels: usize,
}

/// Place of a cell's samples: in its own colours, or in those of a coarser patch around it.
struct Entry {
    light: Light,
    shift: u32,
    first: [u32; 2],
}

impl FramePainter {
    /// A painter of frames of this size.
    pub fn new(size: [u32; 2], picture: &PictureTable) -> Self {
        let encode = (0..=u16::MAX).map(|light| encoded(f64::from(light) / 65535.0)).collect();
        let curve = Ground::of(picture).ok().filter(|_| picture.curve).map(|ground| ground.curve);
        let (samples, relief) = (picture.samples.along(), Relief::of(picture));
        FramePainter { size, samples, curve, relief, encode, used: HashMap::new() }
    }

    /// Forgets the previous frame's colours, because other colours follow.
    pub fn forget(&mut self) {
        self.used.clear();
    }

    /// Paints the pixels of a frame, three bytes each, rows from the top.
    pub fn paint(&mut self, shot: &Shot, mip: &mut Mip) -> io::Result<Vec<u8>> {
        let sight = Sight::new(&shot.scene, self.size, self.samples);
        let level = sight.level();
        let fine_share = fine_share(&sight, level);
        let mut now = HashMap::new();
        let layers = [level, level + 1].map(|level| self.layer(&shot.scene, level, mip, &mut now));
        let [coarse, fine] = layers;
        let (coarse, fine) = (coarse?, fine?);
        self.used = now;
        let grid = Grid::new(&shot.scene, self.size);
        let curve = self.curve.filter(|_| shot.scene.build.pendulum().q > 0.0);
        let layers = [&coarse, &fine];
        let height = |pixel| self.height(pixel, &grid, layers, fine_share);
        let lit = self.relief.map(|relief| LitFrame::new(relief, self.size, height));
        let mut bytes = vec![0; 3 * self.size[0] as usize * self.size[1] as usize];
        bytes.par_chunks_mut(3 * self.size[0] as usize).enumerate().for_each(|(row, bytes)| {
            let curve = curve.map(|rgb| (rgb, CurveBand::around(&grid, row as u32)));
            for (column, rgb) in bytes.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                let light = self.light([column, row], &grid, layers, fine_share);
                let factor = lit.as_ref().map_or(1.0, |lit| lit.factor([column, row]));
                *rgb =
                    light.map(|light| self.encode[(light * factor + 0.5).min(MOST_LIGHT) as usize]);
                if let Some((colour, band)) = &curve {
                    *rgb = blended(*rgb, *colour, band.cover(&grid, column as u32, row as u32));
                }
            }
        });
        Ok(bytes)
    }

    /// The mean light of a pixel.
    fn light(
        &self,
        [column, row]: [usize; 2],
        grid: &Grid,
        [coarse, fine]: [&Layer; 2],
        fine_share: f32,
    ) -> [f32; 3] {
        let along = self.samples;
        let mut sum = [0.0; 3];
        for point in 0..along * along {
            let within =
                [point % along, point / along].map(|k| (f64::from(k) + 0.5) / f64::from(along));
            let from_center = self.offset_of([column, row], within, grid);
            let light = coarse.light(from_center).unwrap_or_default();
            let finer = fine.light(from_center).unwrap_or(light);
            for channel in 0..3 {
                sum[channel] += light[channel] + (finer[channel] - light[channel]) * fine_share;
            }
        }
        sum.map(|sum| sum / (along * along) as f32)
    }

    /// The height of a pixel's middle, from 0 to 1; none where a sample has none.
    fn height(
        &self,
        pixel: [usize; 2],
        grid: &Grid,
        [coarse, fine]: [&Layer; 2],
        fine_share: f32,
    ) -> Option<f32> {
        let from_center = self.offset_of(pixel, [0.5; 2], grid);
        let height = coarse.height(from_center)?;
        let finer = fine.height(from_center).unwrap_or(height);
        Some(height + (finer - height) * fine_share)
    }

    /// The offset in rad from the frame's centre to a place in a pixel, given in pixels from its
    /// upper left corner.
    fn offset_of(&self, [column, row]: [usize; 2], within: [f64; 2], grid: &Grid) -> [f64; 2] {
        let [right, up] = grid.pixel_axes();
        let across = column as f64 + within[0] - 0.5 * f64::from(self.size[0]);
        let above = 0.5 * f64::from(self.size[1]) - row as f64 - within[1];
        [0, 1].map(|i| across * right[i] + above * up[i])
    }

    /// The cells of a level that a frame touches, with their colours.
    fn layer(
        &self,
        scene: &Scene,
        level: u32,
        mip: &mut Mip,
        now: &mut HashMap<Cell, Light>,
    ) -> io::Result<Layer> {
        let [right, up] = Grid::new(scene, self.size).pixel_axes();
        let pitch = patch_pitch_rad(level);
        let center = scene.view.center_rad().map(Turn::from_theta);
        let middle = Cell::at(center, level);
        let corner = offset_rad([middle.x, middle.y], center).map(|rad| rad / pitch);
        let half = [0, 1].map(|i| {
            let extent =
                f64::from(self.size[0]) * right[i].abs() + f64::from(self.size[1]) * up[i].abs();
            0.5 * extent / pitch + 1.0
        });
        let cells_to =
            |i: usize, samples: f64| ((samples - corner[i]) / f64::from(PATCH_SIDE)).floor() as i64;
        let [x, y] = [0, 1].map(|i| cells_to(i, -half[i])..=cells_to(i, half[i]));
        let mut cells = Vec::new();
        for row in y.clone() {
            for column in x.clone() {
                let cell = moved(&middle, [column, row]);
                cells.push(self.entry(cell, mip, now)?);
            }
        }
        let origin = [(0, &x), (1, &y)]
            .map(|(i, range)| corner[i] + (*range.start() * i64::from(PATCH_SIDE)) as f64);
        Ok(Layer { level, origin, columns: x.count(), cells, channels: mip.channels() })
    }

    /// Finds the colours for a cell: its own, or those of the patch in which it lies.
    fn entry(
        &self,
        cell: Cell,
        mip: &mut Mip,
        now: &mut HashMap<Cell, Light>,
    ) -> io::Result<Option<Entry>> {
        let levels = (0..=cell.level).rev();
        let known = |level: u32| Some(cell.ancestor(level)).filter(|at| mip.is_patch(at).is_some());
        let Some(holder) = levels.into_iter().find_map(known) else { return Ok(None) };
        let shift = cell.level - holder.level;
        // A coarser cell that is not a patch is found only where no frame looks.
        if shift > 0 && mip.is_patch(&holder) == Some(false) {
            return Ok(None);
        }
        let light = match now.get(&holder).or_else(|| self.used.get(&holder)) {
            Some(light) => light.clone(),
            None => mip.light(&holder)?,
        };
        now.insert(holder, light.clone());
        let first = cell.index_in(&holder).map(|sides| (sides * f64::from(PATCH_SIDE)) as u32);
        Ok(Some(Entry { light, shift, first }))
    }
}

impl Layer {
    /// The light at a place in rad from the frame's centre, interpolated between four samples.
    fn light(&self, from_center: [f64; 2]) -> Option<[f32; 3]> {
        let mut sum = [0.0; 3];
        for (sample, weight) in self.around(from_center)? {
            for (sum, number) in sum.iter_mut().zip(sample) {
                *sum += weight * f32::from(*number);
            }
        }
        Some(sum)
    }

    /// The height at such a place, from 0 to 1; none beside a sample without one.
    fn height(&self, from_center: [f64; 2]) -> Option<f32> {
        let mut sum = 0.0;
        for (sample, weight) in self.around(from_center)? {
            let steps = sample.get(HEIGHT)?.checked_sub(1)?;
            sum += weight * f32::from(steps);
        }
        Some(sum / HIGHEST as f32)
    }

    /// The four samples around such a place, with their weights.
    fn around(&self, from_center: [f64; 2]) -> Option<[(&[u16], f32); 4]> {
        let pitch = patch_pitch_rad(self.level);
        let at = [0, 1].map(|i| from_center[i] / pitch - self.origin[i] - 0.5);
        let first = at.map(f64::floor);
        let [across, above] = [0, 1].map(|i| (at[i] - first[i]) as f32);
        let [x, y] = first.map(|index| index as i64);
        Some([
            (self.sample([x, y])?, (1.0 - across) * (1.0 - above)),
            (self.sample([x + 1, y])?, across * (1.0 - above)),
            (self.sample([x, y + 1])?, (1.0 - across) * above),
            (self.sample([x + 1, y + 1])?, across * above),
        ])
    }

    /// The sample at a place, counted from the lower left corner.
    fn sample(&self, [x, y]: [i64; 2]) -> Option<&[u16]> {
        let side = i64::from(PATCH_SIDE);
        let [column, row] = [x, y].map(|at| usize::try_from(at.div_euclid(side)));
        let column = column.ok().filter(|column| *column < self.columns)?;
        let entry = self.cells.get(row.ok()? * self.columns + column)?.as_ref()?;
        let within =
            |at: i64, first: u32| ((at.rem_euclid(side) as u32 + first) >> entry.shift) as usize;
        let (column, below) = (within(x, entry.first[0]), within(y, entry.first[1]));
        let place = (PATCH_SIDE as usize - 1 - below) * PATCH_SIDE as usize + column;
        entry.light.get(place * self.channels..(place + 1) * self.channels)
    }
}

/// The cell so many cells to the right and up.
fn moved(cell: &Cell, by: [i64; 2]) -> Cell {
    let far = by.map(|by| Turn::side(cell.level).times(by as f64));
    Cell::at([cell.x + far[0], cell.y + far[1]], cell.level)
}

/// Share of the finer of two levels in the mix: none where the coarser one's samples lie as close
/// together as they ever do for a frame that begins with it, all where they lie as far apart.
fn fine_share(sight: &Sight, level: u32) -> f32 {
    let closer = (SLACK * sight.pitch_rad() / patch_pitch_rad(level)).log2();
    (1.0 - closer).clamp(0.0, 1.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Sampling, View};
    use crate::tiles::patches::{PATCH_SAMPLES, patches};

    const SIZE: [u32; 2] = [96, 64];
    const SAMPLES_ALONG: u32 = 2;

    fn shot(width: f64, rotate: f64) -> Shot {
        let center = ["-1.66".to_string(), "0.1".to_string()];
        let view = View { center, width: width.to_string(), rotate, ..View::default() };
        Shot { scene: Scene { view, ..Scene::default() }, clock_secs: None }
    }

    /// A mip of waves over the plane in the first channel, whose phase turns 1 rad in `wave_rad`.
    fn waves(shots: &[Shot], wave_rad: f64) -> Mip {
        let sights: Vec<Sight> =
            shots.iter().map(|shot| Sight::new(&shot.scene, SIZE, SAMPLES_ALONG)).collect();
        let cells = patches(&sights);
        let mut next = cells.iter();
        let mut light = || {
            let grid = next.next().expect("a patch").grid(&Scene::default(), PATCH_SIDE);
            let numbers = (0..PATCH_SAMPLES as u32).flat_map(|place| {
                let angle =
                    grid.angle_from_pixel(place % PATCH_SIDE, place / PATCH_SIDE).map(|a| a.hi);
                [(65535.0 * wave(angle, wave_rad)) as u16, 0, 0]
            });
            Ok::<Light, io::Error>(numbers.collect())
        };
        let folder = tempfile::tempdir().unwrap();
        Mip::build(&cells, 3, folder.path(), &mut light).unwrap()
    }

    fn wave([theta1, theta2]: [f64; 2], wave_rad: f64) -> f64 {
        0.5 + 0.25 * ((theta1 / wave_rad).sin() + (theta2 / wave_rad).cos())
    }

    fn painter() -> FramePainter {
        let picture = PictureTable {
            samples: Sampling::Square(SAMPLES_ALONG),
            curve: false,
            ..PictureTable::default()
        };
        FramePainter::new(SIZE, &picture)
    }

    #[test]
    fn a_frame_is_the_plane_it_shows() {
        for rotate in [0.0, 40.0] {
            let shots = [shot(1.0, rotate), shot(0.4, rotate), shot(0.1, rotate)];
            let mut mip = waves(&shots, 0.05);
            for shot in &shots[1..] {
                let rgb = painter().paint(shot, &mut mip).unwrap();
                let grid = Grid::new(&shot.scene, SIZE);
                for (place, rgb) in (0..).zip(rgb.as_chunks::<3>().0) {
                    let [column, row] = [place % SIZE[0], place / SIZE[0]];
                    let angle = grid.angle_from_pixel(column, row).map(|a| a.hi);
                    let expected = encoded(wave(angle, 0.05));
                    assert!(rgb[0].abs_diff(expected) <= 4, "{column} {row}: {rgb:?} {expected}");
                }
            }
        }
    }

    #[test]
    fn nothing_pops_where_levels_meet() {
        let level = |width: f64| Sight::new(&shot(width, 0.0).scene, SIZE, SAMPLES_ALONG).level();
        // The width at which the level changes, to the last digits.
        let (mut above, mut below) = (0.6, 0.3);
        assert_eq!(level(above) + 1, level(below));
        while above - below > 1e-9 {
            let middle = 0.5 * (above + below);
            *(if level(middle) == level(0.6) { &mut above } else { &mut below }) = middle;
        }
        // The film goes on, so that the middle is finer still; a wave is three pixels long.
        let shots = [shot(above, 0.0), shot(below, 0.0), shot(0.02, 0.0)];
        let mut mip = waves(&shots, 0.5 * above / 96.0);
        let [a, b] = [0, 1].map(|k: usize| painter().paint(&shots[k], &mut mip).unwrap());
        let most = a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most <= Some(1), "{most:?}");
    }
}
