//! A number field of a panel: named, with its unit, and always within its range.

use std::ops::RangeInclusive;

use egui::{DragValue, Ui};

/// Shows a named number, to be dragged or typed; returns the new one if it has changed. Dragging
/// changes a value in proportion to its size.
pub(super) fn number(
    ui: &mut Ui,
    name: &str,
    unit: &str,
    value: f64,
    range: RangeInclusive<f64>,
) -> Option<f64> {
    let mut new = value;
    let label = ui.label(name);
    let drag = DragValue::new(&mut new)
        .speed(0.005 * value.abs().max(1e-3))
        .suffix(unit)
        .custom_formatter(|value, _| plain(value))
        .update_while_editing(false)
        .range(range.clone());
    let response = ui.add(drag).labelled_by(label.id);
    let inside = new.clamp(*range.start(), *range.end());
    (response.changed() && inside != value && !inside.is_nan()).then_some(inside)
}

/// Formats a number with six significant digits; in powers of ten below 1e-4 and from 1e7 on.
pub(super) fn plain(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..7).contains(&exponent) {
        return short(&format!("{value:.5e}"));
    }
    short(&format!("{value:.*}", (5 - exponent).max(0) as usize))
}

/// Removes trailing zeros after the decimal point.
fn short(text: &str) -> String {
    let (digits, power) = text.split_once('e').map_or((text, None), |(d, p)| (d, Some(p)));
    let digits = match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    };
    power.map_or(digits.to_string(), |power| format!("{digits}e{power}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_plain() {
        let cases = [
            (0.0, "0"),
            (9.81, "9.81"),
            (30.0, "30"),
            (1.0 / 3.0, "0.333333"),
            (100.0, "100"),
            (123_456.7, "123457"),
            (1e6, "1000000"),
            (1e9, "1e9"),
            (2.5e-7, "2.5e-7"),
            (0.00025, "0.00025"),
            (f64::INFINITY, "inf"),
        ];
        for (value, text) in cases {
            assert_eq!(plain(value), text);
        }
    }
}
