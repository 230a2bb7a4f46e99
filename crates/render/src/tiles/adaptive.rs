//! Adaptive sampling: several samples per pixel where colours change, one elsewhere.
//!
//! A first run computes a sample in the middle of each pixel. A pixel is *plain* if no neighbour's
//! colour differs from its own by more than the eye notices; its one sample then stands for all.
//! Other pixels get the full number of samples, or samples in their corners:
//!
//! ```text
//!   ┌───┬───┬───┬───┐        ┌───┬───┬───┬───┐        ┌───┬───·───·───·
//!   │ a │ a │ a │ b │        │ a │ a │·:·│:·:│        │ a │ a │ a │ b │
//!   ├───┼───┼───┼───┤  ──▶   ├───┼───┼───┼───┤   or   ├───┼───·───·───·
//!   │ a │ a │ a │ b │        │ a │ a │·:·│:·:│        │ a │ a │ a │ b │
//!   └───┴───┴───┴───┘        └───┴───┴───┴───┘        └───┴───·───·───·
//! ```
//!
//! A pixel is plain or not because of the whole picture, regardless of tiles and jobs.

use rayon::prelude::*;

use super::preview::preview;
use super::{Counts, Renderer, Samples};
use flipmap_engine::{Assurance, Cells, EngineError};
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::palette::{AnswerColours, Tint};
use flipmap_scene::{Sampling, Scene};

/// Largest difference in a channel of neighbouring colours, on a scale of 255, that does not count
/// as an edge.
const EDGE: f32 = 6.0;

/// The plain pixels of a picture, and the sample of each.
#[derive(Clone, Debug)]
pub(crate) struct PlainPixels {
    /// A sample for each pixel, row by row from the top.
    samples: Samples,
    /// The colours of these samples.
    tints: Vec<Tint>,
    is_plain: Vec<bool>,
    /// True for corners that have a sample, row by row from the top; empty unless `others` is
    /// [`Sampling::Corners`].
    has_corner: Vec<bool>,
    size: [u32; 2],
    /// Sampling of the pixels that are not plain.
    others: Sampling,
    /// Counts of the run that found the plain pixels.
    counts: Counts,
}

impl PlainPixels {
    /// Finds the plain pixels of a checked scene in `size` pixels and `colours`; the others get the
    /// sampling `others`. Returns `None` once `keep_going`, which takes the counts so far, returns
    /// false.
    pub(crate) fn find(
        renderer: &mut Renderer,
        (scene, cells): (&Scene, Cells),
        size: [u32; 2],
        (colours, others): (&AnswerColours, Sampling),
        keep_going: &dyn Fn(&Counts) -> bool,
    ) -> Result<Option<Self>, EngineError> {
        let mut work = renderer.work(scene, size).with_cells(cells);
        let Some(samples) = preview(&mut work, size, renderer.engine(), keep_going)? else {
            return Ok(None);
        };
        let plain = PlainPixels::among(samples, size, colours, others);
        Ok(Some(PlainPixels { counts: work.counts(), ..plain }))
    }

    /// Finds the plain pixels of a picture of `size` pixels with these samples in their middles.
    pub(crate) fn among(
        samples: Samples,
        size: [u32; 2],
        colours: &AnswerColours,
        others: Sampling,
    ) -> Self {
        let tint = |k: usize| colours.tint(samples.get(k).status, samples.values(k));
        let tints: Vec<Tint> = (0..samples.len()).into_par_iter().map(tint).collect();
        let is_plain = plain(&tints, size[0] as usize);
        let has_corner = match others {
            Sampling::Corners => corners(&is_plain, size.map(|side| side as usize)),
            Sampling::Square(_) => Vec::new(),
        };
        let counts = Counts::default();
        PlainPixels { samples, tints, is_plain, has_corner, size, others, counts }
    }

    /// Returns the samples in the middles of all pixels, row by row from the top.
    pub(crate) fn middles(&self) -> &Samples {
        &self.samples
    }

    /// Returns the colour of a pixel's middle, by the pixel's index.
    pub(crate) fn tint(&self, pixel: usize) -> Tint {
        self.tints[pixel]
    }

    /// Returns the counts of the whole picture, given those of the samples of other pixels.
    pub(super) fn counts_with(&self, counts: Counts) -> Counts {
        // Samples in corners belong to no pixel.
        let pixels = if self.others == Sampling::Corners { self.counts } else { counts };
        let simulated = self.counts.simulated + counts.simulated;
        let mut effort = self.counts.effort;
        effort += counts.effort;
        Counts { simulated, effort, ..pixels }
    }

    /// Returns the known answer of a sample, by its column and row among all samples. A corner that
    /// only plain pixels share gets a placeholder, which is never read.
    pub(super) fn known(&self, place: [u32; 2]) -> Option<(Outcome, Assurance)> {
        let Sampling::Square(along) = self.others else {
            let none = Outcome::without_time(Status::Forbidden);
            return (!self.has_corner(place)).then_some((none, Assurance::default()));
        };
        let [x, y] = place.map(|at| at / along);
        let pixel = (y * self.size[0] + x) as usize;
        self.is_plain[pixel].then(|| (self.samples.get(pixel), self.samples.assurance(pixel)))
    }

    /// Returns true if a corner, by its column and row among all corners, has a sample, because it
    /// belongs to a pixel that is not plain.
    pub(crate) fn has_corner(&self, [x, y]: [u32; 2]) -> bool {
        self.has_corner[y as usize * (self.size[0] as usize + 1) + x as usize]
    }
}

/// Returns true for each corner of a pixel that is not plain. There is one more column and one more
/// row of corners than of pixels.
fn corners(is_plain: &[bool], [width, height]: [usize; 2]) -> Vec<bool> {
    let has_corner = |corner: usize| {
        let (x, y) = (corner % (width + 1), corner / (width + 1));
        let columns = x.saturating_sub(1)..=x.min(width - 1);
        let mut rows = y.saturating_sub(1)..=y.min(height - 1);
        rows.any(|row| columns.clone().any(|column| !is_plain[row * width + column]))
    };
    (0..(width + 1) * (height + 1)).into_par_iter().map(has_corner).collect()
}

/// Returns true for each pixel of a picture with rows of `width` whose colour differs from no
/// neighbour's by more than `EDGE`.
fn plain(tints: &[Tint], width: usize) -> Vec<bool> {
    let height = tints.len() / width.max(1);
    let apart = |a: Tint, b: Tint| (0..3).any(|i| (a[i] - b[i]).abs() > EDGE);
    let is_plain = |pixel: usize| {
        let (x, y) = (pixel % width, pixel / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        let columns = x.saturating_sub(1)..=(x + 1).min(width - 1);
        let mut around = rows.flat_map(|y| columns.clone().map(move |x| y * width + x));
        !around.any(|other| apart(tints[pixel], tints[other]))
    };
    (0..tints.len()).into_par_iter().map(is_plain).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_at_edges_are_not_plain_and_slow_gradients_are() {
        // A step between columns 3 and 4, on a gradient too slow to be seen.
        let tint = |k: usize| {
            let (x, y) = (k % 8, k / 8);
            let step = if x > 3 { 90.0 } else { 0.0 };
            [step + 0.5 * y as f32, 20.0, 30.0]
        };
        let tints: Vec<Tint> = (0..40).map(tint).collect();
        for (k, is_plain) in plain(&tints, 8).into_iter().enumerate() {
            assert_eq!(is_plain, !matches!(k % 8, 3 | 4), "pixel {k}");
        }
    }

    #[test]
    fn corners_of_pixels_that_are_not_plain_have_samples() {
        // Three columns and two rows; the last pixel of the first row is not plain.
        let found = corners(&[true, true, false, true, true, true], [3, 2]);
        let expected = [0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0].map(|corner| corner == 1);
        assert_eq!(found, expected);
    }

    #[test]
    fn a_single_pixel_is_plain() {
        assert_eq!(plain(&[[0.1; 3]], 1), [true]);
    }
}
