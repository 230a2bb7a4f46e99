//! The assurance of an answer: how sure it is and how far off it may be, in one byte.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::Trust;

/// Trust in an answer, and an upper bound of its estimated error in half decades.
///
/// The lower three bits hold the trust; the upper five hold 0 without an estimate, or else the
/// index k of a bound of 10^(k/2 − 14.5) s, of which the last stands for anything larger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Assurance(u8);

/// Number of bits of the trust.
const TRUST_BITS: u32 = 3;
/// Index of the bound that stands for all larger errors.
const LARGEST: u8 = 31;

/// The bounds in s, from index 1 on; computed once, because every checked pixel looks one up.
static BOUNDS_SECS: LazyLock<[f64; LARGEST as usize]> = LazyLock::new(|| {
    std::array::from_fn(|k| match k + 1 {
        index if index == LARGEST as usize => f64::INFINITY,
        index => 10f64.powf(0.5 * index as f64 - 14.5),
    })
});

impl Assurance {
    /// Creates an assurance with an estimated error in s, which is rounded up to half a decade, and to
    /// at least 1e-14 s.
    pub fn new(trust: Trust, error_secs: f64) -> Self {
        let holds = |bound_secs: &f64| error_secs <= *bound_secs;
        let index = BOUNDS_SECS.iter().zip(1..).find(|(bound_secs, _)| holds(bound_secs));
        let index = index.map_or(LARGEST, |(_, index)| index);
        Assurance(trust as u8 | index << TRUST_BITS)
    }

    /// Returns the trust.
    pub fn trust(self) -> Trust {
        let code = self.0 & ((1 << TRUST_BITS) - 1);
        // A byte that nothing here has written says that nothing is sure.
        Trust::ALL.get(usize::from(code)).map_or(Trust::Uncertain, |(_, trust)| *trust)
    }

    /// Returns the upper bound of the estimated error in s, rounded up to half a decade: infinite
    /// if no two runs agree, `None` if nothing was estimated.
    pub fn error_secs(self) -> Option<f64> {
        let index = self.0 >> TRUST_BITS;
        let place = usize::from(index).checked_sub(1)?;
        Some(BOUNDS_SECS[place])
    }

    /// Returns the assurance with another trust.
    #[must_use]
    pub fn with_trust(self, trust: Trust) -> Self {
        Assurance(self.0 >> TRUST_BITS << TRUST_BITS | trust as u8)
    }
}

impl From<Trust> for Assurance {
    /// Creates an assurance without an estimate.
    fn from(trust: Trust) -> Self {
        Assurance(trust as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_rounded_up_and_its_trust_stays() {
        for (_, trust) in Trust::ALL {
            assert_eq!(
                (Assurance::from(trust).trust(), Assurance::from(trust).error_secs()),
                (trust, None)
            );
            for secs in [0.0, 1e-14, 2e-14, 3.1e-9, 1e-3, 0.9, 3.0] {
                let assurance = Assurance::new(trust, secs);
                let error_secs = assurance.error_secs().unwrap();
                assert_eq!(assurance.trust(), trust);
                assert!(error_secs >= secs && error_secs <= (3.17 * secs).max(1.01e-14), "{secs}");
                let doubtful = assurance.with_trust(Trust::Uncertain);
                assert_eq!(doubtful.error_secs(), assurance.error_secs());
                assert_eq!(doubtful.trust(), Trust::Uncertain);
            }
        }
        for large in [4.0, 1e9, f64::INFINITY, f64::NAN] {
            assert_eq!(Assurance::new(Trust::Agreed, large).error_secs(), Some(f64::INFINITY));
        }
    }

    #[test]
    fn bytes_without_an_estimate_are_those_of_the_trust_and_unknown_ones_are_uncertain() {
        // Parts that were written before there were estimates are read as they were.
        assert_eq!(Assurance::from(Trust::Settled), Assurance(Trust::Settled as u8));
        assert_eq!(Assurance(7).trust(), Trust::Uncertain);
    }
}
