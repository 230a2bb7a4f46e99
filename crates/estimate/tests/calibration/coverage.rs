//! Intervals of 95 % hold the truth in 92 to 98 of 100 seeds.

use flipmap_estimate::entropy::{Boxes, entropy};
use flipmap_estimate::pairs::exponent;
use flipmap_estimate::scatter::{random, scattered};
use flipmap_estimate::shares::{ClassCounts, share};

use super::systems::*;

fn check(what: &str, holds: impl Fn(u64) -> bool) {
    let held = (0..200).filter(|seed| holds(*seed)).count();
    assert!((184..=196).contains(&held), "{what}: {held} of 200");
}

#[test]
fn areas_hold() {
    let area = std::f64::consts::PI * 0.16;
    check("a disc's area", |seed| {
        let count = |replicate| {
            let mut counts = ClassCounts::new(2);
            for index in 0..256 {
                let at = scattered(seed, replicate, index).map(|x| f64::from(x) / 2f64.powi(32));
                counts.add(disc(at).into(), true);
            }
            counts
        };
        let replicates: Vec<ClassCounts> = (0..16).map(count).collect();
        share(&replicates, 1).unwrap().contains(area)
    });
}

#[test]
fn exponents_hold() {
    check("Weierstrass's exponent", |seed| {
        let found =
            exponent(&scales(weierstrass, &[2.0, 2.5, 3.0, 3.5, 4.0], 250, seed), 0.05, seed);
        found.unwrap().alpha.contains(weierstrass_alpha())
    });
}

#[test]
fn entropies_hold() {
    // Boxes with 25 samples of two equal classes: the mean of the entropy of a binomial share.
    let mut chance = 0.5f64.powi(25);
    let mut truth = 0.0;
    for k in 0..=25 {
        let share = f64::from(k) / 25.0;
        let term = |p: f64| if p > 0.0 { -p * p.ln() } else { 0.0 };
        truth += chance * (term(share) + term(1.0 - share));
        chance *= f64::from(25 - k) / f64::from(k + 1);
    }
    check("an entropy", |seed| {
        let group = |k| {
            let mut rng = random(seed, k);
            let mut one = || {
                let heads = (0..25).filter(|_| rng.bool()).count() as u64;
                ClassCounts { sure: vec![heads, 25 - heads], unsure: vec![0, 0] }
            };
            (0..40).map(|_| one()).collect()
        };
        let boxes = Boxes { side: 1.0, groups: (0..16).map(group).collect() };
        entropy(&boxes).unwrap().basin.contains(truth)
    });
}
