//! Numbers as people read them: a true minus sign, powers of ten with raised exponents, and thin
//! spaces between thousands. What is copied and pasted, such as locations and fields, stays ASCII.

/// The space between thousands and around the sign of multiplication.
const THIN: char = '\u{2009}';

/// Formats a number with a fixed number of decimals.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    // A number that is rounded to zero has no sign.
    let is_negative = value < 0.0 && text.contains(|c: char| ('1'..='9').contains(&c));
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let sign = if is_negative { "−" } else { "" };
    format!("{sign}{}{rest}", grouped(whole))
}

/// Formats a number for a column of figures of equal width: right-aligned in `width` characters.
pub fn column(value: f64, decimals: usize, width: usize) -> String {
    format!("{:>width$}", fixed(value, decimals))
}

/// Formats a number with at most `decimals` decimals, without trailing zeros.
pub fn plain(value: f64, decimals: usize) -> String {
    without_zeros(fixed(value, decimals))
}

/// Formats a count, such as 1 234 567.
pub fn count(count: u64) -> String {
    grouped(&count.to_string())
}

/// Formats a number with at most `digits` significant digits, as a power of ten if it is small or
/// large.
pub fn significant(value: f64, digits: usize) -> String {
    let text = format!("{:.*e}", digits.max(1) - 1, value.abs());
    let Some((mantissa, Ok(exponent))) = text.split_once('e').map(|(m, e)| (m, e.parse::<i32>()))
    else {
        return fixed(value, 0);
    };
    if value == 0.0 {
        return "0".to_string();
    }
    if (-3..5).contains(&exponent) {
        return plain(value, (digits as i32 - 1 - exponent).max(0) as usize);
    }
    let sign = if value < 0.0 { "−" } else { "" };
    match without_zeros(mantissa.to_string()).as_str() {
        "1" => format!("{sign}{}", power_of_ten(exponent)),
        mantissa => format!("{sign}{mantissa}{THIN}×{THIN}{}", power_of_ten(exponent)),
    }
}

/// Formats a number with four significant digits.
pub fn brief(value: f64) -> String {
    significant(value, 4)
}

/// Does the same as [`significant`], with a plus before a positive number.
pub fn signed(value: f64, digits: usize) -> String {
    let plus = if value > 0.0 { "+" } else { "" };
    format!("{plus}{}", significant(value, digits))
}

/// Formats a power of ten: 10⁻⁹, but 1 and 10.
pub fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".to_string(),
        1 => "10".to_string(),
        _ => format!("10{}", exponent.to_string().chars().map(raised).collect::<String>()),
    }
}

/// Formats `numerator` / `denominator` times π as a reduced fraction: −3π/4.
pub fn of_pi(numerator: i64, denominator: i64) -> String {
    let common = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()).max(1) as i64;
    let (above, below) = (numerator / common, denominator / common);
    let sign = if above < 0 { "−" } else { "" };
    let turns = match above.abs() {
        0 => return "0".to_string(),
        1 => "π".to_string(),
        times => format!("{times}π"),
    };
    if below == 1 { format!("{sign}{turns}") } else { format!("{sign}{turns}/{below}") }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn raised(letter: char) -> char {
    match letter {
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '-' => '⁻',
        _ => letter.to_digit(10).and_then(|digit| char::from_u32(0x2070 + digit)).unwrap_or(letter),
    }
}

fn without_zeros(text: String) -> String {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

/// Puts thin spaces between the thousands of a whole number.
fn grouped(digits: &str) -> String {
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(THIN);
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_have_a_true_minus_and_thin_spaces() {
        assert_eq!(fixed(-1.25, 1), "−1.2");
        assert_eq!(fixed(-0.004, 2), "0.00", "what is rounded to zero has no sign");
        assert_eq!(fixed(-12_345.678, 2), "−12\u{2009}345.68");
        assert_eq!([fixed(f64::NAN, 2), fixed(f64::NEG_INFINITY, 2)].concat(), "NaNinf");
        assert_eq!(column(-1.5, 2, 7), "  −1.50");
        assert_eq!([plain(2.5, 3), plain(-2.0, 3), plain(100.0, 0)].concat(), "2.5−2100");
        assert_eq!([count(999), count(1_234_567)], ["999", "1\u{2009}234\u{2009}567"]);
    }

    #[test]
    fn small_and_large_numbers_are_powers_of_ten() {
        for (value, text) in [
            (0.0, "0"),
            (9.81, "9.81"),
            (30.0, "30"),
            (0.05, "0.05"),
            (-0.001_234_5, "−0.001234"),
            (1e-7, "10⁻⁷"),
            (-1e-7, "−10⁻⁷"),
            (99_999.9, "10⁵"),
            (1.5e-9, "1.5\u{2009}×\u{2009}10⁻⁹"),
            (-6.02e23, "−6.02\u{2009}×\u{2009}10²³"),
        ] {
            assert_eq!(brief(value), text);
        }
        assert_eq!([signed(0.41, 2), signed(-3e-8, 2)].join(" "), "+0.41 −3\u{2009}×\u{2009}10⁻⁸");
        assert_eq!([power_of_ten(0), power_of_ten(1), power_of_ten(-14)].join(" "), "1 10 10⁻¹⁴");
    }

    #[test]
    fn fractions_of_pi_are_reduced() {
        let texts = [(0, 4), (4, 4), (-1, 2), (6, 8), (-8, 4)].map(|(k, of)| of_pi(k, of));
        assert_eq!(texts, ["0", "π", "−π/2", "3π/4", "−2π"]);
    }
}
