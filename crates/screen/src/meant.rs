//! The number that the last bits of a computed one hide.

/// Returns the number of at most twelve digits that a computed one stands for, such as 0.02 for
/// 0.1 · 0.2; or else the number itself.
pub fn meant(value: f64) -> f64 {
    let short: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    if (short - value).abs() <= 8.0 * f64::EPSILON * value.abs() { short } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_bits_of_a_computed_number_are_not_shown() {
        for (computed, text) in [(0.1 * 0.2, "0.02"), (0.1 + 0.2, "0.3"), (-1.1 * 3.0, "-3.3")] {
            assert_ne!(computed.to_string(), text);
            assert_eq!(meant(computed).to_string(), text);
        }
        for exact in [0.0, 1.0 / 3.0, std::f64::consts::TAU / 1e6, 5e-324, f64::INFINITY] {
            assert_eq!(meant(exact), exact);
        }
        assert!(meant(f64::NAN).is_nan());
    }
}
