//! Scrambled low-discrepancy points.
//!
//! Sobol's sequence with the hashed scrambling of Owen (Burley 2020, *Practical hash-based Owen
//! scrambling*, JCGT 9:4), as 32 bits for each coordinate. Replicates are scrambled independently, so
//! that their spread is the error of their mean.

use sobol_burley::parts::{hash, owen_scramble_rev, sobol_rev};

/// Largest number of points of a replicate.
pub const MOST_POINTS: u32 = 1 << 16;

/// Returns point `index` of a replicate, its coordinates as shares of 2³².
pub fn scattered(seed: u64, replicate: u32, index: u32) -> [u32; 2] {
    debug_assert!(index < MOST_POINTS);
    let [order, across, up] = words(seed, replicate);
    let shuffled = owen_scramble_rev(index.reverse_bits(), order);
    let scrambled =
        |dimension, by| owen_scramble_rev(sobol_rev(shuffled, dimension), by).reverse_bits();
    [scrambled(0, across), scrambled(1, up)]
}

/// Returns a generator of random numbers that are independent of the points of every replicate.
pub fn random(seed: u64, stream: u64) -> fastrand::Rng {
    let mut rng = fastrand::Rng::with_seed(seed ^ 0xa5a5_5a5a_c3c3_3c3c);
    let first = rng.u64(..);
    fastrand::Rng::with_seed(first.wrapping_add(stream.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
}

/// Returns three random words that belong to a replicate alone.
fn words(seed: u64, replicate: u32) -> [u32; 3] {
    let (low, high) = (seed as u32, (seed >> 32) as u32);
    let base = hash(hash(hash(low ^ 0x79c6_8e4a) ^ high) ^ replicate.wrapping_mul(0x9c8f_2d3b));
    [0x912f_69ba, 0x174f_18ab, 0x691e_72ca].map(|salt| hash(base ^ salt))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every elementary rectangle of a net holds as many points as its area says.
    #[test]
    fn points_are_a_net_in_every_replicate() {
        for (seed, replicate) in [(1, 0), (1, 1), (77, 3), (u64::MAX, 40)] {
            let points: Vec<[u32; 2]> = (0..256).map(|k| scattered(seed, replicate, k)).collect();
            for bits in 0..=8 {
                let mut counts = [0; 256];
                for [x, y] in &points {
                    let column = u64::from(*x) >> (32 - bits);
                    let row = u64::from(*y) >> (32 - (8 - bits));
                    counts[((column << (8 - bits)) + row) as usize] += 1;
                }
                assert!(counts.iter().all(|count| *count == 1), "{seed} {replicate} {bits}");
            }
        }
    }

    #[test]
    fn replicates_and_seeds_differ() {
        let first = |seed, replicate| scattered(seed, replicate, 0);
        let mut all: Vec<[u32; 2]> =
            (0..40).flat_map(|k| [first(1, k), first(2, k), first(1 << 40, k)]).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 120);
        assert_ne!(random(1, 0).u64(..), random(1, 1).u64(..));
        assert_eq!(random(5, 9).u64(..), random(5, 9).u64(..));
    }
}
