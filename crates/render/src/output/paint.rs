//! Colours samples: palette, light from the side, mean of several samples per pixel, grain, energy
//! curve, legend, caption.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::caption::caption;
use super::corner_rows::CornerRows;
use super::curve::CurveBand;
use super::inset::Inset;
use super::legend::legend;
use super::lit_rows::LitRows;
use crate::denoise::DenoisedRows;
use crate::tiles::{PlainPixels, Samples};
use flipmap_pendulum::Status;
use flipmap_scene::palette::{
    AnswerColours, Relief, Rgb, Tint, channel_of, light_of, rounded, tint_of,
};
use flipmap_scene::{Grid, PictureTable, Scene, SceneError};

/// Paints bands of a picture from the top.
pub struct RowPainter {
    colours: AnswerColours,
    /// True where the energy curve is drawn.
    curve: bool,
    /// The legend and the caption, if they are wanted.
    insets: Vec<Inset>,
    lit: Option<LitRows>,
    samples_along: u32,
    /// The pixels, if the samples to be painted are those of their corners.
    corners: Option<CornerRows>,
    denoised: Option<DenoisedRows>,
    grid: Grid,
    next_row: u32,
    /// Samples of a row of pixels that is not yet complete.
    pending: Vec<Tint>,
    /// The pixels painted last; their memory is reused for the next ones.
    fresh: Vec<Tint>,
}

impl RowPainter {
    /// Creates a painter of a `size` picture of a checked scene; refuses settings that cannot be
    /// painted.
    pub fn new(scene: &Scene, size: [u32; 2], picture: &PictureTable) -> Result<Self, SceneError> {
        let colours = AnswerColours::new(scene, picture)?;
        let legend =
            picture.legend.then(|| legend(&colours, scene.question.ask, size)).transpose()?;
        let caption = picture.caption.then(|| caption(scene, None, size)).transpose()?;
        let caption = caption.map(|caption| caption.clear_of(legend.as_ref()));
        let samples_along = picture.samples.along();
        let fine = size.map(|side| side * samples_along);
        let relief = Relief::of(picture).filter(|_| colours.times().is_some());
        let grid = Grid::new(scene, size);
        let denoised = picture.denoises().then(|| DenoisedRows::new(size, &colours.ground()));
        let curve = picture.curve && scene.build.pendulum().q > 0.0;
        Ok(RowPainter {
            insets: legend.into_iter().chain(caption).collect(),
            lit: relief.map(|relief| LitRows::new(relief, fine)),
            colours,
            curve,
            samples_along,
            corners: None,
            denoised,
            grid,
            next_row: 0,
            pending: Vec::new(),
            fresh: Vec::new(),
        })
    }

    /// Takes the pixels with known middles; all samples that follow are those of their corners.
    pub(crate) fn paint_corners(&mut self, plain: Arc<PlainPixels>) {
        self.corners = Some(CornerRows::new(plain, self.grid.size()[0] as usize));
    }

    /// Paints the next samples and returns the pixels of finished rows as RGB bytes (see
    /// [`RowPainter::tints`]).
    pub fn paint(&mut self, samples: &Samples) -> Vec<u8> {
        self.tints(samples, 0..samples.len()).iter().copied().flat_map(rounded).collect()
    }

    /// Paints the next samples, those at `places`, and returns the pixels of finished rows. If
    /// pixels have several samples, a row is finished when all have come; under light from the
    /// side or where grain is smoothed, rows below it must have come, too.
    pub(crate) fn tints(&mut self, samples: &Samples, places: Range<usize>) -> &[Tint] {
        let mut fresh = std::mem::take(&mut self.fresh);
        self.colour(samples, places.clone(), &mut fresh);
        fresh = match self.corners.take() {
            Some(mut corners) => {
                let mixed = self.mixed(&mut corners, &fresh);
                self.corners = Some(corners);
                mixed
            }
            None => {
                self.light(samples, places, &mut fresh);
                self.gathered(fresh)
            }
        };
        if let Some(denoised) = &mut self.denoised {
            fresh = denoised.denoise(&fresh);
        }
        self.mark(&mut fresh);
        self.next_row += (fresh.len() / self.grid.size()[0] as usize) as u32;
        self.fresh = fresh;
        &self.fresh
    }

    /// Writes the colours of samples to `tints`.
    fn colour(&self, samples: &Samples, places: Range<usize>, tints: &mut Vec<Tint>) {
        let tint = |k| self.colours.tint(samples.get(k).status, samples.values(k));
        places.into_par_iter().with_min_len(SHARE).map(tint).collect_into_vec(tints);
    }

    /// Puts the colours of samples under light from the side, if there is any.
    fn light(&mut self, samples: &Samples, places: Range<usize>, tints: &mut Vec<Tint>) {
        if let Some(lit) = &mut self.lit {
            let heights = places.map(|k| height(&self.colours, samples, k));
            *tints = lit.light(tints.drain(..), heights);
        }
    }

    /// Takes the colours of the next samples, and returns those of the pixels of complete rows.
    fn gathered(&mut self, mut samples: Vec<Tint>) -> Vec<Tint> {
        let along = self.samples_along as usize;
        let row_samples = self.grid.size()[0] as usize * along * along;
        if !self.pending.is_empty() || !samples.len().is_multiple_of(row_samples) {
            self.pending.append(&mut samples);
            let whole = self.pending.len() / row_samples * row_samples;
            samples.extend(self.pending.drain(..whole));
        }
        if along > 1 { self.averaged(&samples) } else { samples }
    }

    /// Returns the colours of pixels, given those of their corners. Light from the side uses the
    /// heights of the middles, of which each pixel has one.
    fn mixed(&mut self, corners: &mut CornerRows, tints: &[Tint]) -> Vec<Tint> {
        let (first, mut pixels) = corners.mixed(tints);
        let places = first..first + pixels.len();
        self.light(corners.pixels().middles(), places, &mut pixels);
        pixels
    }

    /// Returns the mean colour of the samples of each pixel, for whole rows.
    fn averaged(&self, samples: &[Tint]) -> Vec<Tint> {
        let (width, along) = (self.grid.size()[0] as usize, self.samples_along as usize);
        let mut pixels = vec![Tint::default(); samples.len() / (along * along)];
        let rows = samples.par_chunks(width * along * along);
        pixels.par_chunks_mut(width).zip(rows).for_each(|(pixels, samples)| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                *pixel = mean(samples, width * along, column * along, along);
            }
        });
        pixels
    }

    /// Draws the energy curve and the insets over the colours of a whole picture, which were
    /// painted elsewhere; returns its pixels as RGB bytes.
    pub fn marked(&self, colours: &[Rgb]) -> Vec<u8> {
        let mut tints: Vec<Tint> = colours.iter().copied().map(tint_of).collect();
        self.mark(&mut tints);
        tints.into_iter().flat_map(rounded).collect()
    }

    /// Draws the energy curve and the insets over the next rows.
    fn mark(&self, pixels: &mut [Tint]) {
        if !self.curve && self.insets.is_empty() {
            return;
        }
        let width = self.grid.size()[0] as usize;
        let rows = self.next_row..self.next_row + (pixels.len() / width) as u32;
        let curves = if self.curve { CurveBand::all(&self.grid, rows.clone()) } else { Vec::new() };
        let rows = rows.into_par_iter().zip(pixels.par_chunks_mut(width));
        rows.for_each(|(row, pixels)| {
            let curve = CurveBand::of_row(&curves, self.next_row, row);
            for (column, pixel) in (0..).zip(pixels) {
                *pixel = self.with_marks(*pixel, [column, row], curve);
            }
        });
    }

    /// Returns the colour of a pixel under the energy curve and the insets.
    fn with_marks(&self, tint: Tint, [column, row]: [u32; 2], curve: Option<&CurveBand>) -> Tint {
        let tint = match curve.map_or(0.0, |band| band.cover(&self.grid, column, row)) {
            0.0 => tint,
            cover => mixed(tint, tint_of(self.colours.ground().curve), cover as f32),
        };
        self.insets.iter().fold(tint, |tint, inset| inset.over(tint, column, row))
    }
}

/// Number of samples that a thread colours at a time.
const SHARE: usize = 1 << 12;

/// Returns the height of a sample in the landscape of times; NaN without a time.
fn height(colours: &AnswerColours, samples: &Samples, index: usize) -> f32 {
    match colours.times() {
        Some((channel, tones)) if samples.get(index).status == Status::Answered => {
            tones.scale().height(samples.values(index)[channel]) as f32
        }
        _ => f32::NAN,
    }
}

/// Returns the colour of `below` under a share `cover` of `above`.
pub(crate) fn blended(below: Rgb, above: Rgb, cover: f64) -> Rgb {
    rounded(mixed(tint_of(below), tint_of(above), cover as f32))
}

/// Returns the tint of `below` under a share `cover` of `above`.
pub(super) fn mixed(below: Tint, above: Tint, cover: f32) -> Tint {
    [0, 1, 2].map(|i| below[i] + (above[i] - below[i]) * cover)
}

/// Returns the mean colour of `along` × `along` samples from index `first` on, in linear light.
fn mean(row: &[Tint], stride: usize, first: usize, along: usize) -> Tint {
    let mut sum = [0.0; 3];
    for j in 0..along {
        for tint in &row[j * stride + first..j * stride + first + along] {
            for (sum, &channel) in sum.iter_mut().zip(tint) {
                *sum += light_of(channel);
            }
        }
    }
    sum.map(|sum| channel_of(sum / (along * along) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::Outcome;
    use flipmap_scene::Sampling;
    use flipmap_scene::palette::{Ground, encoded, light};

    fn painter(size: [u32; 2], samples: u32, curve: bool) -> RowPainter {
        let samples = Sampling::Square(samples);
        let picture = PictureTable { samples, curve, ..PictureTable::default() };
        RowPainter::new(&Scene::default(), size, &picture).unwrap()
    }

    #[test]
    fn one_sample_a_pixel_is_its_colour() {
        let mut samples = Samples::unflipped(4);
        samples.set(1, Outcome::without_time(Status::Forbidden));
        let bytes = painter([2, 2], 1, false).paint(&samples);
        let Ground { unflipped, forbidden, .. } = Ground::DARK;
        assert_eq!(bytes, [unflipped, forbidden, unflipped, unflipped].concat());
    }

    #[test]
    fn samples_are_averaged_as_light_and_rows_wait_until_complete() {
        let mut painter = painter([1, 1], 2, false);
        let mut samples = Samples::unflipped(2);
        samples.set(0, Outcome::without_time(Status::Forbidden));
        assert!(painter.paint(&samples).is_empty());
        let mixed = painter.paint(&samples);
        let Ground { unflipped, forbidden, .. } = Ground::DARK;
        let mean = (light(unflipped[0]) + light(forbidden[0])) / 2.0;
        assert_eq!(mixed[0], encoded(mean));
    }

    #[test]
    fn light_from_the_side_changes_slopes_alone_and_every_row_comes_out() {
        let size = [32, 24];
        let picture = PictureTable { curve: false, ..PictureTable::default() };
        let twofold = PictureTable { samples: Sampling::Square(2), ..picture };
        let lit = PictureTable { relief: 1.0, light: 0.0, ..twofold.clone() };
        let mut samples = Samples::unflipped(64 * 48);
        for index in 0..64 * 48 {
            let (x, y) = (index % 64, index / 64);
            // A plane that rises to the right, beside one that is flat, with a cliff between.
            let secs = if x < 30 { 2.0 * 1.04f64.powi(x) } else { 20.0 };
            if y > 3 {
                samples.set(index as usize, Outcome::flipped(secs));
            }
        }
        let scene = Scene::default();
        let paint = |picture: &PictureTable, part: usize| {
            let mut painter = RowPainter::new(&scene, size, picture).unwrap();
            let parts = (0..samples.len()).step_by(part);
            let parts = parts.map(|at| samples.part(at..samples.len().min(at + part)));
            parts.flat_map(|part| painter.paint(&part)).collect::<Vec<u8>>()
        };
        let flat = paint(&twofold, 64);
        let bytes = paint(&lit, 64);
        assert_eq!(bytes, paint(&lit, 7), "however they come");
        assert_eq!((bytes.len(), flat.len()), (3 * 32 * 24, 3 * 32 * 24));
        let at = |bytes: &[u8], x: usize, y: usize| bytes[3 * (32 * y + x)..][..3].to_vec();
        for y in 0..24 {
            assert_eq!(at(&bytes, 24, y), at(&flat, 24, y), "a plain, row {y}");
        }
        let [dark, own] = [&bytes, &flat]
            .map(|bytes| at(bytes, 8, 12).iter().map(|c| u32::from(*c)).sum::<u32>());
        assert!(dark + 20 < own, "it rises towards the light: {dark} {own}");
        assert_eq!(at(&bytes, 8, 1), at(&flat, 8, 1), "no time, no height");
    }

    #[test]
    fn light_survives_encoding() {
        for channel in 0..=255 {
            assert_eq!(encoded(light(channel)), channel);
        }
    }

    #[test]
    fn the_energy_curve_is_a_thin_ring() {
        let size = [64, 64];
        let bytes = painter(size, 1, true).paint(&Samples::unflipped(64 * 64));
        let [ground, curve] = [Ground::DARK.unflipped[0], Ground::DARK.curve[0]];
        let ring = bytes.chunks(3).filter(|rgb| rgb[0] > curve / 2).count();
        assert!((60..400).contains(&ring), "{ring}");
        // The curve is 2 cos θ1 + cos θ2 = 1: at θ1 = 0 only θ2 = π, and at θ2 = 0 it is θ1 = ±π/2.
        let at = |x: usize, y: usize| bytes[3 * (y * 64 + x)];
        assert!(at(48, 32) > curve / 2 || at(47, 32) > curve / 2);
        assert_eq!(at(32, 32), ground);
    }
}
