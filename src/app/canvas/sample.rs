//! A sample packed into one word, as the atlas holds it (counterpart: shaders/picture.wgsl).

use crate::engine::Trust;
use crate::physics::Outcome;

/// Offset of the stored logarithms: they count from 2^-32 s (counterpart in the shader).
pub const LOG_BIAS: f64 = 32.0;
/// Number of steps of the stored logarithms per octave.
pub const LOG_STEPS: f64 = (1 << 21) as f64;

/// Packs the status into the lowest two bits, trust into the next three, and the logarithm of the
/// time into the rest: finer than any colour, and nothing for the card to work out.
pub fn word_of(outcome: &Outcome, trust: Trust) -> u32 {
    let steps = (outcome.time.log2() + LOG_BIAS) * LOG_STEPS;
    // Outcomes without a time have a logarithm of −∞, which becomes 0.
    ((steps.round() as u32) << 5) | ((trust as u32) << 2) | outcome.status as u32
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
            let back = (f64::from(word >> 5) / LOG_STEPS - LOG_BIAS).exp2();
            assert!((back / secs - 1.0).abs() < 3e-7, "{secs} {back}");
        }
        let forbidden = word_of(&Outcome::without_time(Status::Forbidden), Trust::Unchecked);
        assert_eq!(forbidden & 31, 2);
    }
}
