//! Rows of a picture that are denoised as they come, from the top.

use super::{Denoiser, REACH};
use flipmap_scene::palette::{Ground, Tint};

/// Number of pixels that are denoised at a time, if the picture has as many.
const BLOCK: usize = 1 << 20;

/// Denoises the rows of a picture from the top: each waits for those below it that it depends on.
pub(crate) struct DenoisedRows {
    denoiser: Denoiser,
    width: usize,
    /// Rows of the picture that have not been returned.
    rows_left: usize,
    /// Rows at the beginning of `tints` that have been returned; those below depend on them.
    returned: usize,
    tints: Vec<Tint>,
}

impl DenoisedRows {
    /// Creates the rows of a picture of `size` pixels.
    pub(crate) fn new(size: [u32; 2], ground: &Ground) -> Self {
        let [width, rows_left] = size.map(|side| side as usize);
        let denoiser = Denoiser::new(width, ground);
        DenoisedRows { denoiser, width, rows_left, returned: 0, tints: Vec::new() }
    }

    /// Takes the pixels of the next whole rows, and returns those that can be denoised now.
    pub(crate) fn denoise(&mut self, tints: &[Tint]) -> Vec<Tint> {
        self.tints.extend(tints);
        let there = self.tints.len() / self.width - self.returned;
        let is_last = there == self.rows_left;
        let ready = if is_last { there } else { there.saturating_sub(REACH) };
        if ready == 0 || !is_last && ready < (BLOCK / self.width).max(REACH) {
            return Vec::new();
        }
        let inner = self.returned..self.returned + ready;
        let denoised = self.denoiser.denoised(&self.tints, inner.clone());
        let dropped = inner.end.saturating_sub(REACH);
        self.tints.drain(..dropped * self.width);
        self.returned = inner.end - dropped;
        self.rows_left -= ready;
        denoised
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::palette::{FAILED, tint_of};

    const SIZE: [u32; 2] = [120, 90];
    const GOLD: Tint = [240.0, 200.0, 130.0];

    /// Denoises a picture that comes in parts of `rows` rows.
    fn denoised(tints: &[Tint], rows: usize) -> Vec<Tint> {
        let mut denoiser = DenoisedRows::new(SIZE, &Ground::DARK);
        tints.chunks(rows * SIZE[0] as usize).flat_map(|part| denoiser.denoise(part)).collect()
    }

    fn picture(colour: impl Fn(u32, u32) -> Tint) -> Vec<Tint> {
        (0..SIZE[1])
            .flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)))
            .map(|(x, y)| colour(x, y))
            .collect()
    }

    /// Colours of which a pixel has one by chance, the bright one as often as `share` says.
    fn sand(share: impl Fn(u32, u32) -> f64) -> Vec<Tint> {
        let random = std::cell::RefCell::new(fastrand::Rng::with_seed(7));
        let dark = tint_of(Ground::DARK.unflipped);
        picture(|x, y| if random.borrow_mut().f64() < share(x, y) { GOLD } else { dark })
    }

    #[test]
    fn the_parts_in_which_rows_come_change_nothing() {
        let sand = sand(|x, _| f64::from(x) / 120.0);
        let whole = Denoiser::new(SIZE[0] as usize, &Ground::DARK).denoised(&sand, 0..90);
        assert_ne!(whole, sand);
        for rows in [1, 7, 32, 90] {
            assert!(denoised(&sand, rows) == whole, "{rows}");
        }
    }

    #[test]
    fn wide_pictures_are_denoised_in_strips_without_seams() {
        let (width, rows) = (3000, 20);
        let grain = sand(|x, _| f64::from(x) / 120.0);
        let wide: Vec<Tint> = (0..width * rows).map(|k| grain[k * 7 % grain.len()]).collect();
        let whole = Denoiser::new(width, &Ground::DARK).denoised(&wide, 0..rows);
        // The same columns in a picture that fits into one strip, far from its edges.
        let columns = 1500..2500;
        let cut = |tints: &[Tint], columns: std::ops::Range<usize>| -> Vec<Tint> {
            tints.chunks(width).flat_map(|row| row[columns.clone()].to_vec()).collect()
        };
        let cut = cut(&wide, columns.clone());
        let part = Denoiser::new(columns.len(), &Ground::DARK).denoised(&cut, 0..rows);
        for (row, part) in part.chunks(1000).enumerate() {
            let same = &whole[row * width + 1500 + 2 * REACH..][..1000 - 4 * REACH];
            assert!(part[2 * REACH..1000 - 2 * REACH] == *same, "row {row}");
        }
    }

    #[test]
    fn resolved_pixels_and_those_without_a_sample_stay() {
        let smooth = picture(|x, y| [x as f32, y as f32, 40.0]);
        assert!(denoised(&smooth, 90) == smooth);
        let kept = [Ground::DARK.forbidden, FAILED].map(tint_of);
        let grain = sand(|_, _| 0.5);
        let beside = picture(|x, y| {
            if x < 60 { grain[(y * SIZE[0] + x) as usize] } else { kept[(y % 2) as usize] }
        });
        let after = denoised(&beside, 90);
        let at = |x: u32, y: u32| after[(y * SIZE[0] + x) as usize];
        assert!((0..90).all(|y| (60..120).all(|x| at(x, y) == kept[(y % 2) as usize])));
        // What is not a sample leaves no trace in the sand beside it.
        assert!(after.iter().all(|tint| *tint == kept[1] || tint[2] <= GOLD[2]), "no magenta");
    }

    #[test]
    fn a_straight_edge_stays_sharp() {
        let edge =
            picture(|x, y| if x + y / 4 < 70 { GOLD } else { tint_of(Ground::DARK.unflipped) });
        let after = denoised(&edge, 90);
        let far = edge.iter().zip(&after).filter(|(a, b)| (a[0] - b[0]).abs() > 40.0).count();
        assert!(far < 90, "{far} pixels in 90 rows");
    }

    #[test]
    fn sand_becomes_its_mean_along_bands_and_bands_stay() {
        let share = |x: u32, _| if (x / 6).is_multiple_of(2) { 0.8 } else { 0.3 };
        let sand = sand(share);
        let after = denoised(&sand, 90);
        let light = |tint: &Tint| flipmap_scene::palette::light_of(tint[0]);
        let [dark, bright] = [tint_of(Ground::DARK.unflipped), GOLD].map(|tint| light(&tint));
        let error = |tints: &[Tint]| {
            let off = |(place, tint)| {
                let share = share(place as u32 % SIZE[0], 0);
                light(tint) - (dark + (bright - dark) * share)
            };
            tints.iter().enumerate().map(|at| off(at).powi(2)).sum::<f64>().sqrt()
        };
        let ratio = error(&after) / error(&sand);
        assert!(ratio < 0.5, "{ratio}");
    }
}
