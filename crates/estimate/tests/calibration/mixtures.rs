//! Entropies, fat fractals and shared boundaries.

use flipmap_estimate::entropy::{Boxes, entropy};
use flipmap_estimate::fat::fat_fractal;
use flipmap_estimate::scatter::{random, scattered};
use flipmap_estimate::shares::ClassCounts;
use flipmap_estimate::wada::wada;

use super::systems::*;

/// The boxes of a picture whose pixels are at both ends of every side, as Attractors.jl samples it; the
/// columns of boxes are the groups.
fn tiles(system: System, side: usize, size: usize) -> Boxes {
    let class = |x: usize, y: usize| system([x, y].map(|k| k as f64 / (side - 1) as f64));
    let tile = |column: usize, row: usize| {
        let mut counts = ClassCounts::new(4);
        for (x, y) in (0..size * size).map(|k| (k % size, k / size)) {
            counts.add(class(column * size + x, row * size + y).into(), true);
        }
        counts
    };
    let across = side / size;
    let group = |column| (0..across).map(|row| tile(column, row)).collect();
    Boxes { side: size as f64, groups: (0..across).map(group).collect() }
}

/// Boxes at scattered places with 25 samples each.
fn boxes(system: System, side: f64, per_group: u32, seed: u64) -> Boxes {
    let group = |replicate| {
        let mut rng = random(seed, u64::from(replicate));
        let one = |index| {
            let corner = scattered(seed, replicate, index).map(|x| f64::from(x) / 2f64.powi(32));
            let mut counts = ClassCounts::new(4);
            for _ in 0..25 {
                let at = corner.map(|x| x * (1.0 - side) + side * rng.f64());
                counts.add(system(at).into(), true);
            }
            counts
        };
        (0..per_group).map(one).collect()
    };
    Boxes { side, groups: (0..16).map(group).collect() }
}

#[test]
fn grebogis_map_has_the_published_entropies() {
    let found = entropy(&tiles(grebogi, 300, 6)).unwrap();
    let boundary = found.boundary.unwrap();
    assert!((0.40..0.42).contains(&found.basin.value), "{found:?}");
    assert!((0.60..0.61).contains(&boundary.value), "{found:?}");
    assert!(!found.is_above_ln2);
}

#[test]
fn a_smooth_boundary_has_the_entropy_of_a_straight_line() {
    // Lines of all directions through boxes of 5 x 5 pixels: 0.484 (continuous boxes: 0.400).
    let found = entropy(&tiles(disc, 1000, 5)).unwrap();
    assert!((found.boundary.unwrap().value - 0.484).abs() < 0.02, "{found:?}");
}

#[test]
fn three_basins_of_newton_are_above_ln_2() {
    let found = entropy(&boxes(newton, 2e-3, 2000, 6)).unwrap();
    let rough = found.boundary.unwrap().value;
    let smooth = entropy(&boxes(disc, 2e-3, 2000, 6)).unwrap().boundary.unwrap().value;
    assert!(rough > smooth + 0.1, "{rough} beside {smooth}");
}

/// Three tenths of the square are noise, the rest Cantor's set.
fn partly_noise([u, v]: [f64; 2]) -> u8 {
    if u < 0.3 { (random(u.to_bits(), v.to_bits()).u8(..)) % 2 } else { cantor([u, v]) }
}

#[test]
fn mixtures_have_their_exact_exponents_and_rests() {
    let sides = [1e-3, 3e-4, 1e-4, 3e-5, 1e-5];
    let found = |system: System| {
        let one = |(k, side): (u64, f64)| boxes(system, side, 400, 9 + 100 * k);
        fat_fractal(&(0..).zip(sides).map(one).collect::<Vec<_>>(), 9).unwrap()
    };
    let thin_beta = 1.0 - 2f64.ln() / 3f64.ln();
    let thin = found(cantor);
    assert!(!thin.is_fat && thin.rest.low == 0.0, "{thin:?}");
    assert!((thin.beta.value - thin_beta).abs() < 0.06, "{thin:?}");
    // In ever smaller boxes a share of the gaps that falls to nothing.
    let fat = found(fat_cantor);
    assert!(!fat.is_fat && (fat.beta.value - 0.5).abs() < 0.08, "{fat:?}");
    let mixed = found(partly_noise);
    assert!(mixed.is_fat && mixed.rest.contains(0.3), "{mixed:?}");
    assert!(mixed.beta.contains(thin_beta), "{mixed:?}");
}

#[test]
fn the_basins_of_newton_are_wada_and_stripes_with_a_circle_are_not() {
    let pictures = [250, 500].map(|side| raster(newton, side));
    let found = wada(&pictures).unwrap();
    assert!(found.is_wada, "{found:?}");
    fn halves([u, v]: [f64; 2]) -> u8 {
        if (u - 0.2).hypot(v - 0.2) < 0.1 { 2 } else { u8::from(u > 0.5) }
    }
    assert!(!wada(&[250, 500].map(|side| raster(halves, side))).unwrap().is_wada);
}
