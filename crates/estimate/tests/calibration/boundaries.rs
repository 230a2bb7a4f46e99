//! Exponents and dimensions of boundaries.

use flipmap_estimate::EstimateError;
use flipmap_estimate::boxes::dimension;
use flipmap_estimate::pairs::{self, Exponent, PairScale};

use super::systems::*;

fn exponent(scales: &[PairScale], seed: u64) -> Result<Exponent, EstimateError> {
    pairs::exponent(scales, 0.05, seed)
}

#[test]
fn weierstrass_has_its_exact_exponent() {
    let found = exponent(&scales(weierstrass, &[2.0, 3.0, 4.0, 5.0, 6.0], 1500, 7), 7).unwrap();
    let truth = weierstrass_alpha();
    assert!((found.alpha.value - truth).abs() < 0.01, "{found:?}");
    assert!(found.alpha.half_width() < 0.02 && found.smooth_below.is_none(), "{found:?}");
}

#[test]
fn grebogis_map_has_the_published_exponent() {
    let found = exponent(&scales(grebogi, &[2.0, 3.0, 4.0, 5.0, 6.0, 7.0], 1500, 1), 1).unwrap();
    // Published as about 0.2; 0.194 with 150,000 pairs a decade.
    assert!((0.18..0.22).contains(&found.alpha.value), "{found:?}");
}

#[test]
fn newtons_method_has_the_dimension_of_its_julia_set() {
    let found = exponent(&scales(newton, &[1.5, 2.0, 2.5, 3.0, 3.5], 6000, 2), 2).unwrap();
    assert!((found.dimension.value - 1.4444).abs() < 0.03, "{found:?}");
    assert!(found.dimension.contains(1.4444) && found.dimension.half_width() < 0.05, "{found:?}");
}

#[test]
fn henons_boundary_is_smooth() {
    let found = exponent(&scales(henon, &[2.5, 3.0, 3.5, 4.0], 20000, 3), 3).unwrap();
    assert!(found.alpha.contains(1.0) && found.alpha.half_width() < 0.15, "{found:?}");
}

#[test]
fn a_boundary_that_ends_in_a_smooth_one_is_told() {
    // Weierstrass's map, cut off after six steps: below 3^-6 its boundary is smooth.
    fn cut([u, v]: [f64; 2]) -> u8 {
        let (mut turn, mut y) = (u, 4.0 * v - 2.0);
        for _ in 0..6 {
            y = 1.5 * y + (std::f64::consts::TAU * turn).cos();
            turn = (3.0 * turn).fract();
        }
        u8::from(y > 0.0)
    }
    let decades = [1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5];
    let scales = scales(cut, &decades, 6000, 5);
    let coarse = exponent(&scales[..3], 5);
    assert!(coarse.is_ok_and(|found| found.alpha.high < 0.8));
    let found = exponent(&scales, 5).unwrap();
    assert!(found.local.last().unwrap().contains(1.0), "{found:?}");
}

#[test]
fn one_class_has_no_boundary() {
    assert_eq!(exponent(&scales(|_| 1, &[2.0, 3.0], 20, 1), 1), Err(EstimateError::OneClass));
    assert_eq!(dimension(&raster(|_| 1, 512)), Err(EstimateError::OneClass));
    assert!(matches!(dimension(&raster(disc, 128)), Err(EstimateError::TooFew { .. })));
}

#[test]
fn boxes_count_a_circle_a_cantor_set_and_a_julia_set() {
    let circle = dimension(&raster(disc, 1024)).unwrap();
    assert!((circle.dimension.value - 1.0).abs() < 0.03, "{circle:?}");
    let quarters = dimension(&raster(quarters, 4096)).unwrap();
    assert!((quarters.dimension.value - 1.5).abs() < 0.05, "{quarters:?}");
    let julia = dimension(&raster(newton, 1024)).unwrap();
    assert!((1.42..1.47).contains(&julia.dimension.value), "{julia:?}");
}
