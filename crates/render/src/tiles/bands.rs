//! The bands of a small picture: their direction, and how much of the picture they make up.
//!
//! Two neighbouring pendulums part in one direction only, so the deeper a view, the more it is a
//! bundle of parallel bands. The structure tensor finds their direction: the sum of g gᵀ over the
//! gradients g of the flip times, whose larger eigenvector points across the bands (J. Bigün and
//! G. H. Granlund, *Optimal orientation detection of linear symmetry*, 1987). Gradients are taken
//! over 3 × 3 pixels with the weights of H. Scharr (*Optimale Operatoren in der Digitalen
//! Bildverarbeitung*, 2000). Their direction is right to a degree in a smooth picture and to some
//! five degrees among jumps.

/// Weights of three neighbouring pixels side by side in a gradient.
const WEIGHTS: [f64; 3] = [3.0 / 32.0, 10.0 / 32.0, 3.0 / 32.0];
/// Length, in natural units of time per pixel, above which all gradients count the same: a jump of
/// the flip time is an edge, however high.
const MAX_UNITS: f64 = 1.0;
/// Coherence above which the direction counts as certain. Most bands of a small picture are thinner
/// than its pixels, so few of them are coherent; noise of 32 × 32 pixels has about 0.1.
const SURE: f64 = 0.4;
/// Share of the turn and stretch towards its bands that a picture makes, even if they are certain:
/// the directions of single pictures vary by ten degrees, but those of many average out.
const SHARE: f64 = 0.5;
/// Largest factor by which bands are stretched apart.
const MAX_STRETCH: f64 = 2.0;

/// The bands of a square picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bands {
    /// Angle from the horizontal axis anticlockwise to the bands, in degrees within [0, 180].
    pub(super) along_deg: f64,
    /// Difference of the tensor's eigenvalues as a share of their sum: 1 for straight bands, 0
    /// where no direction is preferred.
    pub(super) coherence: f64,
}

impl Bands {
    /// Finds the bands of a square picture of times in natural units, row by row from the top;
    /// pixels without a time are ignored.
    pub(super) fn of(times: &[Option<f64>], side: usize) -> Self {
        let [mut xx, mut xy, mut yy] = [0.0; 3];
        for (y, x) in (1..side - 1).flat_map(|y| (1..side - 1).map(move |x| (y, x))) {
            let Some([gx, gy]) = gradient(times, side, [x, y]) else { continue };
            let shorter = (MAX_UNITS / gx.hypot(gy)).min(1.0);
            let (gx, gy) = (gx * shorter, gy * shorter);
            (xx, xy, yy) = (xx + gx * gx, xy + gx * gy, yy + gy * gy);
        }
        let across_deg = (2.0 * xy).atan2(xx - yy).to_degrees() / 2.0;
        let sum = xx + yy;
        let coherence = if sum > 0.0 { (xx - yy).hypot(2.0 * xy) / sum } else { 0.0 };
        Bands { along_deg: across_deg + 90.0, coherence }
    }

    /// Returns the angle in degrees and the stretch of the next picture, given those of this one.
    /// The picture turns by the smallest angle that brings one of its sides nearer to the direction
    /// of the bands, and stretches across them; the less certain the bands, the less it does so.
    pub(super) fn opened(&self, [from_deg, from_stretch]: [f64; 2]) -> [f64; 2] {
        let sure = (self.coherence / SURE).min(1.0);
        let quarter_turns = ((self.along_deg - from_deg) / 90.0).round();
        let by_deg = self.along_deg - 90.0 * quarter_turns - from_deg;
        let lying = quarter_turns.rem_euclid(2.0) < 0.5;
        // A stretched view needs more samples in proportion, which only straight bands justify.
        let straight = self.coherence * self.coherence;
        let stretch = MAX_STRETCH.powf(if lying { straight } else { -straight });
        let stretch = from_stretch * (stretch / from_stretch).powf(SHARE);
        [from_deg + SHARE * sure * by_deg, stretch]
    }
}

/// Returns the gradient at a pixel to the right and upwards, in units per pixel; `None` beside a
/// pixel without a time.
fn gradient(times: &[Option<f64>], side: usize, [x, y]: [usize; 2]) -> Option<[f64; 2]> {
    let at = |x: usize, y: usize| times[y * side + x];
    let mut gradient = [0.0; 2];
    for (k, weight) in WEIGHTS.into_iter().enumerate() {
        gradient[0] += weight * (at(x + 1, y + k - 1)? - at(x - 1, y + k - 1)?);
        gradient[1] += weight * (at(x + k - 1, y - 1)? - at(x + k - 1, y + 1)?);
    }
    Some(gradient)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 32;

    /// Returns a picture of a profile across a direction, in pixels.
    fn stripes(along_deg: f64, profile: impl Fn(f64) -> f64) -> Vec<Option<f64>> {
        let (sin, cos) = along_deg.to_radians().sin_cos();
        let place = |k: usize| [(k % SIDE) as f64, -((k / SIDE) as f64)];
        let across = |k: usize| cos * place(k)[1] - sin * place(k)[0];
        (0..SIDE * SIDE).map(|k| Some(profile(across(k)))).collect()
    }

    #[test]
    fn the_direction_of_stripes_is_found() {
        let smooth = |x: f64| (x / 2.0).sin();
        let jumps = |x: f64| (x / 5.0).rem_euclid(1.0) * 4.0;
        for along_deg in [0.0, 20.0, 45.0, 77.0, 90.0, 133.0, 179.0] {
            for (times, within) in
                [(stripes(along_deg, smooth), 1.0), (stripes(along_deg, jumps), 5.0)]
            {
                let bands = Bands::of(&times, SIDE);
                let apart = (bands.along_deg - along_deg + 90.0).rem_euclid(180.0) - 90.0;
                assert!(apart.abs() < within && bands.coherence > 0.8, "{along_deg}: {bands:?}");
            }
        }
    }

    #[test]
    fn noise_flat_pictures_and_pictures_without_times_have_no_bands() {
        let mut random = 1u64;
        let noise = (0..SIDE * SIDE).map(|_| {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            Some((random >> 40) as f64 / f64::from(1 << 23))
        });
        for times in [noise.collect(), vec![Some(3.0); SIDE * SIDE], vec![None; SIDE * SIDE]] {
            let bands = Bands::of(&times, SIDE);
            assert!(bands.coherence < 0.15, "{bands:?}");
        }
    }

    #[test]
    fn pictures_turn_by_the_smallest_angle_and_open_across_the_bands() {
        let opened = |along_deg, from_deg| {
            let [rotate_deg, stretch] = Bands { along_deg, coherence: 1.0 }.opened([from_deg, 1.0]);
            (rotate_deg, (stretch * stretch * 1e9).round() / 1e9)
        };
        assert_eq!(opened(20.0, 0.0), (10.0, 2.0), "bands lie: the vertical axis opens them");
        assert_eq!(opened(80.0, 0.0), (-5.0, 0.5), "bands stand");
        assert_eq!(opened(170.0, 6.0), (-2.0, 2.0));
        assert_eq!(opened(80.0, 100.0), (90.0, 2.0), "a turned picture goes on from its angle");
        assert_eq!(opened(4.0, 200.0), (192.0, 2.0));
        let unsure = Bands { along_deg: 20.0, coherence: 0.0 };
        assert_eq!(unsure.opened([-17.0, 1.0]), [-17.0, 1.0]);
        assert_eq!(unsure.opened([-17.0, 4.0]), [-17.0, 2.0], "without bands it closes again");
    }
}
