//! Palettes drawn by lot: `random-7` is always the same palette.

use std::f64::consts::TAU;

use super::Tint;
use super::oklab::{Oklab, from_oklab, light_of_oklab};

/// Beginning of the names of such palettes; the seed follows.
const PREFIX: &str = "random-";
/// Number of colours of a palette.
const COLOURS: usize = 256;
/// Number of points of the curve through Oklab along which colours are spaced evenly.
const POINTS: usize = 1024;

/// Returns the seed in the name of a random palette.
pub(super) fn seed_of(name: &str) -> Option<u32> {
    name.strip_prefix(PREFIX)?.parse().ok()
}

/// Returns the name of the random palette with a seed.
pub fn random_palette(seed: u32) -> String {
    format!("{PREFIX}{seed}")
}

/// Returns the colours of a seed: from dark to bright, through part of the hues or more than all
/// of them, in equal steps of Oklab.
pub(super) fn table(seed: u32) -> Vec<Tint> {
    let mut random = fastrand::Rng::with_seed(u64::from(seed));
    let first_hue = TAU * random.f64();
    let sweep = (0.3 + 0.9 * random.f64()) * if random.bool() { TAU } else { -TAU };
    let [darkest, brightest] = [0.14 + 0.1 * random.f64(), 0.88 + 0.09 * random.f64()];
    let chroma = 0.12 + 0.1 * random.f64();
    let curve: Vec<Oklab> = (0..POINTS)
        .map(|point| {
            let along = point as f64 / (POINTS - 1) as f64;
            let lightness = darkest + (brightest - darkest) * along;
            // Colours that are nearly black or white have little chroma.
            let chroma = chroma * (0.25 + 0.75 * (TAU / 2.0 * along).sin());
            within_gamut(lightness, chroma, first_hue + sweep * along)
        })
        .collect();
    even(&curve).into_iter().map(from_oklab).collect()
}

/// Returns a colour of sRGB with at most this chroma.
fn within_gamut(lightness: f64, chroma: f64, hue_rad: f64) -> Oklab {
    const STEPS: u32 = 40;
    let (sin, cos) = hue_rad.sin_cos();
    let colour = |step: u32| {
        let chroma = chroma * f64::from(step) / f64::from(STEPS);
        [lightness, chroma * cos, chroma * sin]
    };
    let fits = |colour: &Oklab| light_of_oklab(*colour).iter().all(|c| (0.0..=1.0).contains(c));
    (0..=STEPS).rev().map(colour).find(fits).unwrap_or(colour(0))
}

/// Returns points at equal distances along a curve.
fn even(curve: &[Oklab]) -> Vec<Oklab> {
    let mut lengths = vec![0.0];
    for pair in curve.windows(2) {
        let step = (0..3).map(|i| (pair[1][i] - pair[0][i]).powi(2)).sum::<f64>().sqrt();
        lengths.push(lengths[lengths.len() - 1] + step);
    }
    let whole = lengths[lengths.len() - 1];
    let at = |k: usize| {
        let length = whole * k as f64 / (COLOURS - 1) as f64;
        let next = lengths.partition_point(|&l| l < length).clamp(1, curve.len() - 1);
        let share = (length - lengths[next - 1]) / (lengths[next] - lengths[next - 1]);
        std::array::from_fn(|i| curve[next - 1][i] + (curve[next][i] - curve[next - 1][i]) * share)
    };
    (0..COLOURS).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{FAILED, Ground, Palette, light_of, tint_of};
    use super::*;

    #[test]
    fn a_seed_is_always_the_same_palette_and_another_is_another() {
        assert_eq!(seed_of(&random_palette(7)), Some(7));
        assert!(seed_of("random-").is_none() && seed_of("random-x").is_none());
        assert_eq!(table(7), table(7));
        assert!(table(7) != table(8));
        assert!(Palette::named("random-7").is_ok() && Palette::named("random--7").is_err());
    }

    #[test]
    fn they_rise_in_lightness_by_even_steps_and_leave_the_ground_alone() {
        for seed in 0..200 {
            let table = table(seed);
            assert_eq!(table.len(), COLOURS);
            let luminance = |tint: &Tint| {
                0.2126 * light_of(tint[0]) + 0.7152 * light_of(tint[1]) + 0.0722 * light_of(tint[2])
            };
            let luminances: Vec<f64> = table.iter().map(luminance).collect();
            let falls = luminances.windows(2).filter(|pair| pair[1] < pair[0] - 2e-3).count();
            assert!(falls < 20 && luminances[255] > 20.0 * luminances[0], "{seed}: {falls}");
            for own in [Ground::DARK.unflipped, Ground::DARK.forbidden, FAILED] {
                assert!(!table.contains(&tint_of(own)), "{seed}");
            }
        }
    }
}
