//! Halves pictures: each pixel becomes the mean of four, in linear light.

use super::RGB;
use flipmap_scene::palette::encoded;
use flipmap_scene::palette::light_table;

/// Tables for the mean of four channel values: the light of each value as an integer, and the value
/// for each sum of four. The steps are so fine that the two darkest values are twenty apart.
pub(super) struct Halving {
    light: [u32; 256],
    channel: Vec<u8>,
}

/// Light of a channel at its full value.
const WHITE: u32 = u16::MAX as u32;

impl Halving {
    /// Computes the tables.
    pub(super) fn new() -> Self {
        let light = light_table().map(u32::from);
        let mean = |sum| encoded(f64::from(sum) / f64::from(4 * WHITE));
        Halving { light, channel: (0..=4 * WHITE).map(mean).collect() }
    }

    /// Returns rows of `stride` bytes at half their size; odd edges repeat their last pixels.
    pub(super) fn halved(&self, rows: &[u8], stride: usize) -> Vec<u8> {
        let mut half = Vec::with_capacity(rows.len() / 4 + stride);
        for pair in rows.chunks(2 * stride) {
            let upper = &pair[..stride];
            let lower = if pair.len() > stride { &pair[stride..] } else { upper };
            for left in (0..stride).step_by(2 * RGB) {
                let right = if left + RGB < stride { left + RGB } else { left };
                for channel in 0..RGB {
                    let at = |row: &[u8], pixel| self.light[usize::from(row[pixel + channel])];
                    let sum =
                        at(upper, left) + at(upper, right) + at(lower, left) + at(lower, right);
                    half.push(self.channel[sum as usize]);
                }
            }
        }
        half
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::palette::light;

    #[test]
    fn what_is_one_colour_stays_it() {
        let halving = Halving::new();
        for channel in 0..=255 {
            assert_eq!(halving.halved(&[channel; 12], 6), [channel; 3]);
        }
    }

    #[test]
    fn means_are_those_of_light() {
        let halving = Halving::new();
        let [black, white] = [[0; 3], [255; 3]];
        let half = halving.halved(&[black, white, white, black].concat(), 6);
        assert_eq!(half, [188; 3]);
        for four in [[0, 1, 2, 3], [10, 200, 30, 90], [255, 255, 255, 0], [17, 17, 18, 18]] {
            let exact = encoded(four.iter().map(|channel| light(*channel)).sum::<f64>() / 4.0);
            let half = halving.halved(&four.map(|channel| [channel; 3]).concat(), 6);
            assert!(half[0].abs_diff(exact) <= 1, "{four:?}: {half:?} and {exact}");
        }
    }

    #[test]
    fn odd_edges_are_the_mean_of_what_is_there() {
        let rows: Vec<u8> =
            [10, 10, 90, 10, 10, 90, 200, 200, 0].iter().flat_map(|c| [*c; 3]).collect();
        let half = Halving::new().halved(&rows, 9);
        assert_eq!(half, [[10; 3], [90; 3], [200; 3], [0; 3]].concat());
    }
}
