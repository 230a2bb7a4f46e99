//! A number field of a panel with a name, a unit and a range.

use std::ops::RangeInclusive;

use egui::{DragValue, Ui};

use flipmap_scene::in_rad;

/// Shows a named number that can be dragged or typed; returns the new one if it has changed.
/// Dragging changes a value in proportion to its size. An angle, in rad, may be typed in degrees or
/// in parts of π, too.
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
        .custom_parser(|text| typed(text, unit))
        .update_while_editing(false)
        .range(range.clone());
    let response = ui.add(drag).labelled_by(label.id);
    let inside = new.clamp(*range.start(), *range.end());
    (response.changed() && inside != value && !inside.is_nan()).then_some(inside)
}

/// Reads a number that was typed in a field with a unit.
fn typed(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let text = text.strip_suffix(unit.trim()).filter(|_| !unit.is_empty()).unwrap_or(text).trim();
    let text = if unit.trim() == "rad" { in_rad(text) } else { text.to_string() };
    text.replace('−', "-").parse().ok()
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
    fn angles_are_typed_in_degrees_and_parts_of_pi_and_other_numbers_are_not() {
        use std::f64::consts::{FRAC_PI_2, PI};
        for (text, rad) in [("90deg", FRAC_PI_2), ("-0.5pi", -FRAC_PI_2), ("π", PI), ("2 rad", 2.0)]
        {
            assert_eq!(typed(text, " rad"), Some(rad), "{text}");
        }
        assert_eq!((typed("30 s", " s"), typed("−1.5", "")), (Some(30.0), Some(-1.5)));
        assert_eq!(
            (typed("90deg", " s"), typed("soon", " rad"), typed("", "")),
            (None, None, None)
        );
    }

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
