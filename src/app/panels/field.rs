//! A number in a panel: named, with its unit, and never out of its range.

use std::ops::RangeInclusive;

use egui::{DragValue, Ui};

/// Shows a named number, to be dragged or typed; answers with the new one when it is changed.
/// Values over many magnitudes move by a share of themselves.
pub fn number(
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

/// A number for people: six digits that count, and powers of ten only where zeros would hide it.
pub fn plain(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..7).contains(&exponent) {
        return short(&format!("{value:.5e}"));
    }
    short(&format!("{value:.*}", (5 - exponent).max(0) as usize))
}

/// Without zeros that say nothing.
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
