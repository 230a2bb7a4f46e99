//! Weights of the pixels around a pixel, for every direction and strength of bands.

use std::f32::consts::PI;

/// Farthest pixel that contributes, in columns or rows.
pub(super) const RADIUS: usize = 5;
/// Number of directions, over half a turn.
const DIRECTIONS: usize = 32;
/// Number of steps from no band to a perfect one.
const STEPS: usize = 8;

/// Standard deviation of the weights along a perfect band, in pixels.
const ALONG_PX: f32 = 3.0;
/// Standard deviation across a perfect band, in pixels.
const ACROSS_PX: f32 = 0.2;
/// Standard deviation in all directions where there is no band, in pixels.
const NO_BAND_PX: f32 = 1.0;
/// Weights below this share of the middle's are left out.
const MIN_WEIGHT: f32 = 0.01;

/// A pixel that contributes: its offset in the block of pixels, and its weight beside a middle of 1.
pub(super) type Tap = (isize, f32);

/// The weights for all directions and strengths.
pub(super) struct BandWeights(Vec<Vec<Tap>>);

impl BandWeights {
    /// Computes the weights for a block whose rows lie `stride` pixels apart.
    pub(super) fn new(stride: usize) -> Self {
        let all = (0..DIRECTIONS).flat_map(|d| (0..=STEPS).map(move |s| (d, s)));
        let taps = |(direction, step)| {
            let across_rad = direction as f32 * PI / DIRECTIONS as f32;
            taps(across_rad, step as f32 / STEPS as f32, stride)
        };
        BandWeights(all.map(taps).collect())
    }

    /// Returns the weights where colours change fastest in the direction `across_rad` and the
    /// strength of the bands is `band`, from 0 to 1.
    pub(super) fn of(&self, across_rad: f32, band: f32) -> &[Tap] {
        let turns = (across_rad / PI).rem_euclid(1.0);
        let direction = (turns * DIRECTIONS as f32).round() as usize % DIRECTIONS;
        let step = (band * STEPS as f32).round() as usize;
        &self.0[direction * (STEPS + 1) + step.min(STEPS)]
    }
}

/// Returns the pixels of an elliptic Gaussian without its middle.
fn taps(across_rad: f32, band: f32, stride: usize) -> Vec<Tap> {
    let mix = |perfect_px: f32| NO_BAND_PX + (perfect_px - NO_BAND_PX) * band;
    let (along_px, across_px) = (mix(ALONG_PX), mix(ACROSS_PX));
    let (sin, cos) = across_rad.sin_cos();
    let reach = RADIUS as isize;
    let places = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y)));
    let weighed = places.filter(|place| *place != (0, 0)).map(|(x, y)| {
        let [dx, dy] = [x as f32, y as f32];
        let across = (dx * cos + dy * sin) / across_px;
        let along = (dy * cos - dx * sin) / along_px;
        (y * stride as isize + x, (-0.5 * (across * across + along * along)).exp())
    });
    weighed.filter(|(_, weight)| *weight >= MIN_WEIGHT).collect()
}
