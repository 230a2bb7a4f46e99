//! Numbers as people paste them: with the signs and spaces of web pages and papers.

use std::borrow::Cow;

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

/// Returns a hint if a text of numbers has commas where the decimal points should be: `count`
/// numbers are expected.
pub(crate) fn comma_for_point(text: &str, count: usize) -> Option<String> {
    let plain = plain_numbers(text);
    let parts: Vec<&str> = plain.split(',').collect();
    let is_whole = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let digits = |part: &str| is_whole(part.trim().trim_start_matches(['-', '+']));
    if parts.len() != 2 * count || !parts.iter().all(|part| digits(part)) {
        return None;
    }
    let with_point = |pair: &[&str]| format!("{}.{}", pair[0].trim(), pair[1].trim());
    let numbers: Vec<String> = parts.chunks(2).map(with_point).collect();
    Some(format!("; decimals are written with a point, as in {}", numbers.join(",")))
}

/// Returns a hint if a text is a number with a comma where the decimal point should be; empty if not.
pub fn decimal_hint(text: &str) -> String {
    comma_for_point(text, 1).unwrap_or_default()
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
    fn commas_for_points_are_recognised() {
        assert!(comma_for_point("1,5", 1).unwrap().ends_with("as in 1.5"));
        assert!(comma_for_point("\u{2212}1,66,0,1", 2).unwrap().ends_with("as in -1.66,0.1"));
        for (text, count) in [("1.5", 1), ("1,2", 2), ("1,x", 1), ("1,2,3", 2), ("1,2", 4)] {
            assert_eq!(comma_for_point(text, count), None, "{text}");
        }
    }
}
