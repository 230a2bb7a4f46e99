//! The colours of samples: the palette, the mean of several samples per pixel, the energy curve, the
//! legend.

use super::curve::CurveBand;
use super::legend::Legend;
use crate::scene::palette::{AnswerColours, Rgb, encoded, light};
use crate::scene::{Grid, PictureTable, Scene, SceneError};
use crate::tiles::Samples;

/// Paints bands of a picture from the top.
pub struct RowPainter {
    colours: AnswerColours,
    /// The band of the next row, where the energy curve is drawn.
    curve: Option<CurveBand>,
    legend: Option<Legend>,
    samples_along: u32,
    grid: Grid,
    next_row: u32,
    /// Samples of a row of pixels that is not yet complete.
    pending: Vec<Rgb>,
}

impl RowPainter {
    /// A painter of a `size` picture of a checked scene; refuses a table that cannot be used.
    pub fn new(scene: &Scene, size: [u32; 2], picture: &PictureTable) -> Result<Self, SceneError> {
        let colours = AnswerColours::new(scene, picture)?;
        let legend = || Legend::new(&colours, scene.question.ask, size);
        let grid = Grid::new(scene, size);
        let curve = picture.curve && scene.build.pendulum().q > 0.0;
        Ok(RowPainter {
            legend: picture.legend.then(legend).transpose()?,
            colours,
            curve: curve.then(|| CurveBand::around(&grid, 0)),
            samples_along: picture.samples,
            grid,
            next_row: 0,
            pending: Vec::new(),
        })
    }

    /// Paints the next rows of samples as rows of RGB bytes. With several samples per pixel, a row
    /// comes out when it is complete.
    pub fn paint(&mut self, samples: &Samples) -> Vec<u8> {
        let colour = |k| self.colours.colour(samples.get(k).status, samples.values(k));
        self.pending.extend((0..samples.len()).map(colour));
        let along = self.samples_along as usize;
        let width = self.grid.size()[0] as usize;
        let row_samples = width * along * along;
        let rows = self.pending.len() / row_samples;
        let mut bytes = Vec::with_capacity(rows * width * 3);
        let painted: Vec<Rgb> = self.pending.drain(..rows * row_samples).collect();
        for row in painted.chunks(row_samples) {
            if let Some(curve) = &mut self.curve {
                curve.move_to(&self.grid, self.next_row);
            }
            for column in 0..width {
                let colour = mean(row, width * along, column * along, along);
                bytes.extend(self.with_marks(colour, column as u32));
            }
            self.next_row += 1;
        }
        bytes
    }

    /// The colour of a pixel of the next row under the energy curve and the legend.
    fn with_marks(&self, colour: Rgb, column: u32) -> Rgb {
        let colour = self.with_curve(colour, column);
        match &self.legend {
            Some(legend) => legend.over(colour, column, self.next_row),
            None => colour,
        }
    }

    fn with_curve(&self, colour: Rgb, column: u32) -> Rgb {
        let band = self.curve.as_ref();
        match band.map_or(0.0, |band| band.cover(&self.grid, column, self.next_row)) {
            0.0 => colour,
            cover => blended(colour, self.colours.ground().curve, cover),
        }
    }
}

/// The colour of which `above` covers a share.
pub fn blended(below: Rgb, above: Rgb, cover: f64) -> Rgb {
    let mix = |i: usize| f64::from(below[i]) * (1.0 - cover) + f64::from(above[i]) * cover;
    [0, 1, 2].map(|i| mix(i).round() as u8)
}

/// The mean colour of `along` × `along` samples from index `first` on, in linear light.
fn mean(row: &[Rgb], stride: usize, first: usize, along: usize) -> Rgb {
    if along == 1 {
        return row[first];
    }
    let mut sum = [0.0; 3];
    for j in 0..along {
        for colour in &row[j * stride + first..j * stride + first + along] {
            for (sum, &channel) in sum.iter_mut().zip(colour) {
                *sum += light(channel);
            }
        }
    }
    sum.map(|sum| encoded(sum / (along * along) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Outcome, Status};
    use crate::scene::palette::Ground;

    fn painter(size: [u32; 2], samples: u32, curve: bool) -> RowPainter {
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
