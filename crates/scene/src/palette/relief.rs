//! Shading by light from the side, on a landscape whose height is the time. Edges stay unshaded.

use crate::PictureTable;

/// A light from the side that shades slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    /// Share of the light that comes from the side, from 0 to 1.
    pub strength: f32,
    /// Unit vector towards the light: to the right, up the picture, and out of it.
    pub toward: [f32; 3],
}

/// Angle of the light above the picture, in degrees.
const ALTITUDE_DEG: f32 = 40.0;

impl Relief {
    /// Slope of a plane that rises from height 0 to height 1 across the picture. Sets how steep
    /// everything looks.
    pub const STEEPNESS: f32 = 0.6;
    /// Difference of heights between neighbouring samples beyond which a place is an edge and is
    /// not shaded, because times there do not form a slope. The shading fades out towards it.
    pub const EDGE: f32 = 0.05;

    /// Returns the light of a picture, or `None` if its relief is 0.
    pub fn of(picture: &PictureTable) -> Option<Self> {
        let (sin, cos) = ALTITUDE_DEG.to_radians().sin_cos();
        let (up, right) = (picture.light as f32).to_radians().sin_cos();
        let toward = [cos * right, cos * up, sin];
        (picture.relief > 0.0).then_some(Relief { strength: picture.relief as f32, toward })
    }

    /// Returns the factor on a colour's light at one sample. `rise` is the change of height from
    /// one sample to the next, to the right and up the picture; `most` is the largest difference
    /// from a neighbour's height; and `across` is the width of the picture in samples. Counterpart
    /// in shaders/picture.wgsl.
    pub(crate) fn factor(&self, rise: [f32; 2], most: f32, across: f32) -> f32 {
        let calm = 1.0 - most / Self::EDGE;
        if calm.is_nan() || calm <= 0.0 {
            return 1.0;
        }
        let [x, y] = rise.map(|rise| rise * across * Self::STEEPNESS);
        let [right, up, out] = self.toward;
        let facing = (out - right * x - up * y) / (1.0 + x * x + y * y).sqrt() / out;
        let calm = calm * calm * (3.0 - 2.0 * calm);
        1.0 + self.strength * calm * (facing.max(0.0) - 1.0)
    }

    /// Returns the factor at `column` in the middle of three rows of heights, ordered from the top.
    /// The row above the first and the row below the last row of a picture are `None`. Samples with
    /// NaN heights are not shaded, nor are their neighbours.
    pub fn factor_beside(&self, [above, here, below]: [Option<&[f32]>; 3], column: usize) -> f32 {
        let Some(here) = here else { return 1.0 };
        let [left, right] = [column.saturating_sub(1), (column + 1).min(here.len() - 1)];
        let rows_apart = [above, below].into_iter().flatten().count().max(1);
        let [above, below] = [above, below].map(|row| row.unwrap_or(here)[column]);
        let beside = [here[left], here[right], below, above];
        let rise = [
            (here[right] - here[left]) / (right - left).max(1) as f32,
            (above - below) / rows_apart as f32,
        ];
        self.factor(rise, max_gap(here[column], beside), here.len() as f32)
    }
}

/// Returns the largest difference from a neighbour's height, or NaN if any height is NaN.
fn max_gap(here: f32, beside: [f32; 4]) -> f32 {
    let apart = beside.map(|other| (other - here).abs());
    if apart.iter().any(|apart| apart.is_nan()) {
        return f32::NAN;
    }
    apart.into_iter().fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_that_face_the_light_are_bright_and_edges_stay_as_they_are() {
        let picture = PictureTable { relief: 0.8, light: 90.0, ..PictureTable::default() };
        let relief = Relief::of(&picture).unwrap();
        let factor = |rise: [f32; 2], most| relief.factor(rise, most, 1000.0);
        assert!((factor([0.0, 0.0], 0.0) - 1.0).abs() < 1e-6, "a plain has its own colour");
        let [to, from] = [[0.0, -1e-3], [0.0, 1e-3]].map(|rise| factor(rise, 1e-3));
        assert!(to > 1.1 && from < 0.8, "the light is above: {to} {from}");
        assert!((factor([1e-3, 0.0], 1e-3) - factor([-1e-3, 0.0], 1e-3)).abs() < 1e-6);
        for most in [Relief::EDGE, f32::NAN, f32::INFINITY] {
            assert_eq!(factor([0.0, 0.02], most), 1.0, "{most}");
        }
        let half = PictureTable { relief: 0.4, ..picture };
        let weaker = Relief::of(&half).unwrap().factor([0.0, 1e-3], 1e-3, 1000.0);
        assert!((2.0 * (1.0 - weaker) - (1.0 - from)).abs() < 1e-5);
        assert_eq!(Relief::of(&PictureTable::default()), None);
    }
}
