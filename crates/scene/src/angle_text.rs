//! Angles as text: in rad, in degrees (`-95deg`, `-95°`) or in multiples of π (`0.5pi`).

use flipmap_numbers::{Exact, Scalar};

/// Number of decimals in converted angles: enough for [`Exact`] to read the same number back, so
/// that 180° is exactly the top.
const DIGITS: usize = 140;

/// Converts an angle in degrees or in multiples of π to text in rad; any other text is only
/// trimmed.
pub fn in_rad(text: &str) -> String {
    let text = text.trim();
    let in_degrees = || {
        let degrees = text.strip_suffix("deg").or_else(|| text.strip_suffix('°'))?;
        Some(Exact::parse(degrees.trim_end())? * Exact::pi() / Exact::from_f64(180.0))
    };
    let in_parts_of_pi = || {
        let parts = text.strip_suffix("pi").or_else(|| text.strip_suffix('π'))?;
        match parts.trim_end() {
            "" | "+" => Some(Exact::pi()),
            "-" => Some(-Exact::pi()),
            parts => Some(Exact::parse(parts)? * Exact::pi()),
        }
    };
    let rad = in_degrees().or_else(in_parts_of_pi);
    rad.map_or_else(|| text.to_string(), |rad| rad.decimal(DIGITS))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rad(text: &str) -> f64 {
        in_rad(text).parse().unwrap()
    }

    #[test]
    fn degrees_and_parts_of_pi_are_read() {
        use std::f64::consts::{FRAC_PI_2, PI};
        for (text, want) in [("90deg", FRAC_PI_2), ("-90°", -FRAC_PI_2), ("0.5pi", FRAC_PI_2)] {
            assert_eq!(rad(text), want, "{text}");
        }
        assert_eq!([rad("pi"), rad("-π"), rad(" 180 deg ")], [PI, -PI, PI]);
        assert!(
            in_rad("180deg").starts_with("3.14159265358979323846264338327950288419716939937510")
        );
        for text in ["pi", "180deg", "1pi", "-180deg", "-pi"] {
            assert_eq!(Exact::parse(&in_rad(text)).unwrap().abs(), Exact::pi(), "{text}");
        }
        // A text already in rad keeps every character, and a wrong one is reported as typed.
        for as_it_is in ["0.100", "1e-30", "deg", "fivedeg", "pipi", ""] {
            assert_eq!(in_rad(as_it_is), as_it_is);
        }
    }
}
