//! Numbers as people paste them: with the signs and spaces of web pages and papers.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use super::allowed::between;

/// Returns a text of numbers in plain characters: minus signs and dashes as `-`, without spaces that
/// do not break, around it without parentheses, and without a full stop that ends a sentence. Any
/// other text is only trimmed.
pub fn plain_numbers(text: &str) -> Cow<'_, str> {
    let text = text.trim();
    let is_odd =
        |sign: char| minus(sign) || is_space(sign) || matches!(sign, '(' | ')' | '[' | ']');
    if !text.contains(is_odd) && !text.ends_with('.') {
        return Cow::Borrowed(text);
    }
    let signs = text.chars().filter(|sign| !is_space(*sign));
    let plain: String = signs.map(|sign| if minus(sign) { '-' } else { sign }).collect();
    let mut rest = plain.trim();
    for (open, close) in [('(', ')'), ('[', ']')] {
        let inner = rest.strip_suffix('.').unwrap_or(rest).strip_prefix(open);
        rest = inner.and_then(|inner| inner.strip_suffix(close)).unwrap_or(rest);
    }
    Cow::Owned(rest.strip_suffix('.').unwrap_or(rest).trim().to_string())
}

/// Returns true for the signs that stand for a minus: hyphens, dashes and the minus sign itself.
fn minus(sign: char) -> bool {
    matches!(sign, '\u{2010}'..='\u{2015}' | '\u{2212}' | '\u{fe58}' | '\u{fe63}' | '\u{ff0d}')
}

/// Returns true for spaces that do not break, thin ones, and marks without width.
fn is_space(sign: char) -> bool {
    matches!(
        sign,
        '\u{a0}' | '\u{2002}'..='\u{200f}' | '\u{202f}' | '\u{205f}' | '\u{2060}' | '\u{feff}'
    )
}

/// Returns a hint if a text of `count` numbers has commas where the decimal points should be; empty
/// if not.
pub fn decimal_hint(text: &str, count: usize) -> String {
    let plain = plain_numbers(text);
    let parts: Vec<&str> = plain.split(',').collect();
    let is_whole = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let digits = |part: &str| is_whole(part.trim().trim_start_matches(['-', '+']));
    if parts.len() != 2 * count || !parts.iter().all(|part| digits(part)) {
        return String::new();
    }
    let with_point = |pair: &[&str]| format!("{}.{}", pair[0].trim(), pair[1].trim());
    let numbers: Vec<String> = parts.chunks(2).map(with_point).collect();
    format!("; decimals are written with a point, as in {}", numbers.join(","))
}

/// Reads a number as people paste it.
pub fn number(text: &str) -> Option<f64> {
    plain_numbers(text).parse().ok()
}

/// Reads a number of the given range, or says in a phrase which numbers are allowed; `unit` is one
/// or empty.
pub fn number_within(text: &str, range: RangeInclusive<f64>, unit: &str) -> Result<f64, String> {
    number(text).filter(|number| range.contains(number)).ok_or_else(|| {
        let allowed = format!("it must be a number {} {unit}", between(&range));
        format!("{}{}", allowed.trim_end(), decimal_hint(text, 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_papers_and_web_pages_are_plain_numbers() {
        for (text, wanted) in [
            ("\u{2212}1.66,0.1", "-1.66,0.1"),
            ("\u{2013}2", "-2"),
            ("1.5\u{a0}", "1.5"),
            ("(\u{2212}1.66, 0.1)", "-1.66, 0.1"),
            ("(1, 2).", "1, 2"),
            ("[1,2]", "1,2"),
            ("0.4.", "0.4"),
            ("3.", "3"),
            ("1\u{202f}000", "1000"),
            ("  7 ", "7"),
            ("(1", "(1"),
        ] {
            assert_eq!(plain_numbers(text), wanted, "{text}");
        }
        assert!(matches!(plain_numbers("-1.66,0.1"), Cow::Borrowed(_)));
    }

    #[test]
    fn a_number_is_read_or_its_range_is_said() {
        let share = |text: &str| number_within(text, 0.0..=1.0, "");
        assert_eq!(share("\u{a0}0.5."), Ok(0.5));
        assert_eq!(share("12"), Err("it must be a number between 0 and 1".to_string()));
        assert!(share("0,5").unwrap_err().ends_with("with a point, as in 0.5"));
        let width = number_within("x", 1e-100..=1.0, "rad").unwrap_err();
        assert_eq!(width, "it must be a number between 1e-100 and 1 rad");
    }

    #[test]
    fn commas_for_points_are_recognised() {
        assert!(decimal_hint("1,5", 1).ends_with("as in 1.5"));
        assert!(decimal_hint("\u{2212}1,66,0,1", 2).ends_with("as in -1.66,0.1"));
        for (text, count) in [("1.5", 1), ("1,2", 2), ("1,x", 1), ("1,2,3", 2), ("1,2", 4)] {
            assert_eq!(decimal_hint(text, count), "", "{text}");
        }
    }
}
