//! Systems with known boundaries.

use flipmap_estimate::boxes::Raster;
use flipmap_estimate::pairs::{PairCounts, PairScale};
use flipmap_estimate::scatter::{random, scattered};

/// A system: the class of a point of the unit square.
pub(crate) type System = fn([f64; 2]) -> u8;

/// A map of an annulus with two attractors (Grebogi, McDonald, Ott and Yorke 1983, Phys. Lett. A 99,
/// 415): α ≈ 0.2.
pub(crate) fn grebogi([u, v]: [f64; 2]) -> u8 {
    let (mut angle, mut x) = (std::f64::consts::TAU * u, v - 0.5);
    for _ in 0..5000 {
        let (sin, cos) = angle.sin_cos();
        if sin.abs() < 1e-3 && (x + 0.3 * cos).abs() < 1e-3 {
            return u8::from(cos < 0.0);
        }
        let next = angle + 1.32 * (2.0 * angle).sin() - 0.9 * (4.0 * angle).sin() - x * sin;
        (angle, x) = (next.rem_euclid(std::f64::consts::TAU), -0.3 * cos);
    }
    2
}

/// Newton's method for z³ = 1 on [−1, 1]²: D = 1.4444 by the pressure of the map.
pub(crate) fn newton([u, v]: [f64; 2]) -> u8 {
    let (mut x, mut y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    for _ in 0..2000 {
        let (a, b) = (x * x - y * y, 2.0 * x * y);
        let (cube_x, cube_y) = (a * x - b * y, a * y + b * x);
        if (cube_x - 1.0).hypot(cube_y) < 1e-6 {
            return if x > 0.0 { 0 } else { 1 + u8::from(y > 0.0) };
        }
        let (p, q, scale) = (2.0 * cube_x + 1.0, 2.0 * cube_y, 3.0 * (a * a + b * b));
        (x, y) = ((p * a + q * b) / scale, (q * a - p * b) / scale);
    }
    3
}

/// Hénon's map, bounded or not: a smooth boundary, α = 1.
pub(crate) fn henon([u, v]: [f64; 2]) -> u8 {
    let (mut x, mut y) = (4.0 * u - 2.0, 4.0 * v - 2.0);
    for _ in 0..200 {
        (x, y) = (1.0 - 1.4 * x * x + y, 0.3 * x);
        if x.hypot(y) > 100.0 {
            return 1;
        }
    }
    0
}

/// A disc.
pub(crate) fn disc([u, v]: [f64; 2]) -> u8 {
    u8::from((u - 0.5).hypot(v - 0.5) < 0.4)
}

/// A map whose boundary is Weierstrass's curve (McDonald, Grebogi, Ott and Yorke 1985): exactly
/// α = ln 1.5 / ln 3. Turns are kept as integers, in which three times is exact.
pub(crate) fn weierstrass([u, v]: [f64; 2]) -> u8 {
    const GROWTH: f64 = 1.5;
    let (mut turn, mut y) = ((u * 2f64.powi(64)) as u64, 4.0 * v - 2.0);
    while y.abs() <= 4.0 / (GROWTH - 1.0) {
        let angle = std::f64::consts::TAU * (turn as f64 / 2f64.powi(64));
        y = GROWTH * y + angle.cos();
        turn = turn.wrapping_mul(3);
    }
    u8::from(y > 0.0)
}

/// The exponent of [`weierstrass`].
pub(crate) fn weierstrass_alpha() -> f64 {
    1.5f64.ln() / 3f64.ln()
}

/// The fat Cantor set of Smith, Volterra and Cantor along x: measure 1/2, β = 1/2.
pub(crate) fn fat_cantor([u, _]: [f64; 2]) -> u8 {
    let (mut from, mut length, mut gap) = (0.0, 1.0, 0.25);
    for _ in 0..24 {
        let side = 0.5 * (length - gap);
        match u - from {
            x if x < side => {}
            x if x > side + gap => from += side + gap,
            _ => return 1,
        }
        (length, gap) = (side, 0.25 * gap);
    }
    0
}

/// Cantor's set of middle thirds times an interval; its gaps are coloured by depth: D = 1 + ln 2 / ln 3.
pub(crate) fn cantor([u, _]: [f64; 2]) -> u8 {
    depth_of_gap(u, 3.0)
}

/// The set that keeps the first and the last of four quarters, times an interval: D = 3 / 2.
pub(crate) fn quarters([u, _]: [f64; 2]) -> u8 {
    depth_of_gap(u, 4.0)
}

/// Depth, modulo 2, of the gap in which a number lies, if of `parts` parts the inner ones are gaps.
fn depth_of_gap(mut x: f64, parts: f64) -> u8 {
    for depth in 0..40u8 {
        x *= parts;
        match x {
            x if x < 1.0 => {}
            x if x < parts - 1.0 => return depth % 2,
            _ => x -= parts - 1.0,
        }
    }
    0
}

/// Pairs along x at decades of distance, in 16 groups.
pub(crate) fn scales(system: System, decades: &[f64], per_group: u32, seed: u64) -> Vec<PairScale> {
    let scale = |(k, exponent): (usize, &f64)| {
        let epsilon = 10f64.powf(-exponent);
        let group = |replicate| {
            let mut rng = random(seed, u64::from(replicate) << 8 | k as u64);
            let mut pairs = PairCounts::default();
            for index in 0..per_group {
                let place = scattered(seed + 1000 * k as u64, replicate, index);
                let at = place.map(|x| (f64::from(x) + rng.f64()) / 2f64.powi(32));
                let other = [at[0] + epsilon, at[1]];
                pairs.differing += u64::from(system(at) != system(other));
                pairs.total += 1;
            }
            pairs
        };
        PairScale { epsilon, groups: (0..16).map(group).collect() }
    };
    decades.iter().enumerate().map(scale).collect()
}

/// A picture of the unit square.
pub(crate) fn raster(system: System, side: usize) -> Raster {
    let class = |k: usize| {
        let at = [k % side, k / side].map(|x| (x as f64 + 0.5) / side as f64);
        system(at)
    };
    Raster { classes: (0..side * side).map(class).collect(), side }
}
