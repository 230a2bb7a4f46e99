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
use super::layer::{Layer, UsedLight};
use super::lit_frame::LitFrame;
use super::mip::Light;
use crate::denoise::Denoiser;
use crate::output::{CurveBand, blended};
use crate::tiles::patches::{SLACK, Sight, patch_pitch_rad};
use flipmap_scene::film::Shot;
use flipmap_scene::palette::{Ground, Relief, Rgb, encoded};
use flipmap_scene::{Grid, PictureTable};

/// Colour of starts that have not flipped yet while the clock runs.
pub(crate) const WAITING: Rgb = [0x16, 0x18, 0x1d];

/// The light of white.
const MAX_LIGHT: f32 = 65535.0;

/// Paints frames from a mip.
pub(crate) struct FramePainter {
    size: [u32; 2],
    samples: u32,
    denoiser: Option<Denoiser>,
    /// The colour of the energy curve, if it is drawn.
    curve: Option<Rgb>,
    /// The light from the side, if there is any.
    relief: Option<Relief>,
    /// The sRGB value of every linear light.
    encode: Vec<u8>,
    /// Light that the previous frame used, by its index in the mip.
    used: HashMap<u32, Light>,
}

/// The two levels whose samples a frame mixes.
struct LayerPair {
    coarse: Layer,
    fine: Layer,
    fine_share: f32,
}

impl FramePainter {
    /// Creates a painter of frames of this size.
    pub(crate) fn new(size: [u32; 2], picture: &PictureTable) -> Self {
        let encode = (0..=u16::MAX).map(|light| encoded(f64::from(light) / 65535.0)).collect();
        let ground = Ground::of(picture).ok();
        let curve = ground.filter(|_| picture.curve).map(|ground| ground.curve);
        let denoiser = ground.filter(|_| picture.denoises());
        let denoiser = denoiser.map(|ground| Denoiser::new(size[0] as usize, &ground));
        let (samples, relief) = (picture.samples.along(), Relief::of(picture));
        FramePainter { size, samples, denoiser, curve, relief, encode, used: HashMap::new() }
    }

    /// Forgets the previous frame's light; called before frames that use another mip.
    pub(crate) fn forget(&mut self) {
        self.used.clear();
    }

    /// Paints the pixels of a frame, three bytes each, rows from the top.
    pub(crate) fn paint(&mut self, shot: &Shot, mip: &mut Mip) -> io::Result<Vec<u8>> {
        let sight = Sight::new(&shot.scene, self.size, self.samples);
        let level = sight.level();
        let mut used = UsedLight { before: &self.used, now: HashMap::new() };
        let grid = Grid::new(&shot.scene, self.size);
        let coarse = Layer::around(&shot.scene.view, &grid, level, mip, &mut used)?;
        let fine = coarse.finer(mip, &mut used)?;
        self.used = used.now;
        let layers = LayerPair { coarse, fine, fine_share: fine_share(&sight, level) };
        let mut colours = self.colours(&layers);
        if let Some(denoiser) = &self.denoiser {
            colours = denoiser.colours(&colours);
        }
        if let Some(curve) = self.curve.filter(|_| shot.scene.build.pendulum().q > 0.0) {
            self.draw_curve(curve, &grid, &mut colours);
        }
        Ok(colours.into_flattened())
    }

    /// Returns the colours of all pixels under light from the side.
    fn colours(&self, layers: &LayerPair) -> Vec<Rgb> {
        let [width, height] = self.size.map(|side| side as usize);
        let height_at = |pixel: [usize; 2]| layers.height(pixel.map(|at| at as f64 + 0.5));
        let lit = self.relief.map(|relief| LitFrame::new(relief, self.size, height_at));
        let mut colours = vec![Rgb::default(); width * height];
        colours.par_chunks_mut(width).enumerate().for_each(|(row, colours)| {
            for (column, colour) in colours.iter_mut().enumerate() {
                let light = self.light([column, row], layers);
                let factor = lit.as_ref().map_or(1.0, |lit| lit.factor([column, row]));
                *colour =
                    light.map(|light| self.encode[(light * factor + 0.5).min(MAX_LIGHT) as usize]);
            }
        });
        colours
    }

    /// Draws the energy curve over a frame.
    fn draw_curve(&self, curve: Rgb, grid: &Grid, colours: &mut [Rgb]) {
        let rows = colours.par_chunks_mut(self.size[0] as usize).enumerate();
        rows.for_each(|(row, colours)| {
            let band = CurveBand::around(grid, row as u32);
            for (column, colour) in colours.iter_mut().enumerate() {
                *colour = blended(*colour, curve, band.cover(grid, column as u32, row as u32));
            }
        });
    }

    /// Returns the mean light of a pixel's points.
    fn light(&self, pixel: [usize; 2], layers: &LayerPair) -> [f32; 3] {
        let along = self.samples;
        let mut sum = [0.0; 3];
        for point in 0..along * along {
            let within =
                [point % along, point / along].map(|k| (f64::from(k) + 0.5) / f64::from(along));
            let light = layers.light([0, 1].map(|i| pixel[i] as f64 + within[i]));
            for (sum, light) in sum.iter_mut().zip(light) {
                *sum += light;
            }
        }
        sum.map(|sum| sum / (along * along) as f32)
    }
}

impl LayerPair {
    /// Returns the light at a place of the frame, in pixels from its upper left corner.
    fn light(&self, place: [f64; 2]) -> [f32; 4] {
        let light = self.coarse.light(place).unwrap_or_default();
        let finer = self.fine.light(place).unwrap_or(light);
        std::array::from_fn(|i| light[i] + (finer[i] - light[i]) * self.fine_share)
    }

    /// Returns the height at a place as in [`Self::light`], from 0 to 1; `None` if a sample has
    /// none.
    fn height(&self, place: [f64; 2]) -> Option<f32> {
        let height = self.coarse.height(place)?;
        let finer = self.fine.height(place).unwrap_or(height);
        Some(height + (finer - height) * self.fine_share)
    }
}

/// Returns the finer level's share in the mix: from 0, where the coarser level's samples are as
/// close together as a frame of that level allows, to 1, where they are as far apart as it allows.
fn fine_share(sight: &Sight, level: u32) -> f32 {
    let closer = (SLACK * sight.pitch_rad() / patch_pitch_rad(level)).log2();
    (1.0 - closer).clamp(0.0, 1.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Looks;
    use crate::tiles::patches::{PATCH_SAMPLES, PATCH_SIDE, patches};
    use flipmap_scene::{Sampling, Scene, View};

    const SIZE: [u32; 2] = [96, 64];
    const SAMPLES_ALONG: u32 = 2;

    fn shot(width: f64, rotate: f64) -> Shot {
        let center = ["-1.66".to_string(), "0.1".to_string()];
        let view = View { center, width: width.to_string(), rotate, ..View::default() };
        Shot { scene: Scene { view, ..Scene::default() }, clock_secs: None }
    }

    /// Builds a mip of waves over the plane in the first channel, whose phase advances by 1 rad in
    /// `wave_rad`.
    fn waves(shots: &[Shot], wave_rad: f64) -> Mip {
        let sights: Vec<Sight> =
            shots.iter().map(|shot| Sight::new(&shot.scene, SIZE, SAMPLES_ALONG)).collect();
        let cells = patches(&sights);
        let mut next = cells.iter();
        let mut looks = || {
            let grid = next.next().expect("a patch").grid(&Scene::default(), PATCH_SIDE);
            let samples = (0..PATCH_SAMPLES as u32).map(|place| {
                let angle =
                    grid.angle_from_pixel(place % PATCH_SIDE, place / PATCH_SIDE).map(|a| a.hi);
                [(65535.0 * wave(angle, wave_rad)) as u16, 0, 0, 0]
            });
            let light: Light = samples.collect();
            Ok::<Looks, io::Error>(std::array::from_fn(|_| light.clone()))
        };
        let folder = tempfile::tempdir().unwrap();
        Mip::build(&cells, false, folder.path(), &mut looks).unwrap()
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
        // The film continues, so the middle is finer still; a wave is three pixels long.
        let shots = [shot(above, 0.0), shot(below, 0.0), shot(0.02, 0.0)];
        let mut mip = waves(&shots, 0.5 * above / 96.0);
        let [a, b] = [0, 1].map(|k: usize| painter().paint(&shots[k], &mut mip).unwrap());
        let most = a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most <= Some(1), "{most:?}");
    }
}
