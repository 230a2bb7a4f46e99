//! A sample in one word, as the atlas holds it (twin: shaders/picture.wgsl).

use crate::engine::Trust;
use crate::physics::Outcome;

/// The status' number in the lowest two bits, trust in the next three, and the time without its sign (it has none) and its
/// last four bits, which no colour shows.
pub fn word_of(outcome: &Outcome, trust: Trust) -> u32 {
    let time = (outcome.time as f32).max(0.0).to_bits() >> 4;
    (time << 5) | ((trust as u32) << 2) | outcome.status as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Status;

    #[test]
    fn a_word_holds_all_that_a_colour_needs() {
        for secs in [1e-6, 0.3, 29.999, 1e6] {
            let word = word_of(&Outcome::flipped(secs), Trust::Uncertain);
            assert_eq!((word & 3, (word >> 2) & 7), (1, 4));
            let back = f64::from(f32::from_bits((word >> 5) << 4));
            assert!((back / secs - 1.0).abs() < 3e-6, "{secs} {back}");
        }
        let forbidden = word_of(&Outcome::without_time(Status::Forbidden), Trust::Unchecked);
        assert_eq!(forbidden & 31, 2);
    }
}
