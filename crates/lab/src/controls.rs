//! Sliders that keep their values in range, and that show the range when a value reaches an end.

use std::ops::RangeInclusive;

use egui::{Color32, Grid, Slider, SliderClamping, Ui};

use flipmap_numbers::Decimal;
use flipmap_numbers::number_text::{brief, fixed};
use flipmap_pendulum::State;
use flipmap_scene::{Kind, PendulumSpec};

/// Shows a named number with a slider in a row of a grid, and returns true if it was changed. A
/// typed value outside the range is clamped to it, and the range is shown.
pub(super) fn number(
    ui: &mut Ui,
    name: &str,
    unit: &str,
    value: &mut f64,
    range: RangeInclusive<f64>,
) -> bool {
    let wide = *range.start() > 0.0 && range.end() / range.start() > 100.0;
    number_on(ui, name, unit, value, range, wide)
}

/// Does the same as [`number`], with an explicit choice of a logarithmic or linear scale.
pub(super) fn number_on(
    ui: &mut Ui,
    name: &str,
    unit: &str,
    value: &mut f64,
    range: RangeInclusive<f64>,
    logarithmic: bool,
) -> bool {
    let label = ui.label(name);
    let before = *value;
    let slider = Slider::new(value, range.clone())
        .suffix(unit)
        .logarithmic(logarithmic)
        .clamping(SliderClamping::Always)
        .custom_formatter(|value, _| typed(value));
    let hint = format!("{} to {}{unit}", brief(*range.start()), brief(*range.end()));
    let response = ui.add(slider).labelled_by(label.id).on_hover_text(&hint);
    if !value.is_finite() {
        *value = before;
    }
    let at_end = *value <= *range.start() || *value >= *range.end();
    if at_end && (response.has_focus() || response.dragged()) {
        ui.colored_label(ui.visuals().warn_fg_color, hint);
    }
    ui.end_row();
    response.changed() && *value != before
}

/// Formats a number for a field that is copied and typed over: as [`brief`] does, in ASCII.
fn typed(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if value == 0.0 || (-3.0..5.0).contains(&exponent) {
        return brief(value).replace('−', "-").replace('\u{2009}', "");
    }
    let text = format!("{value:.3e}");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{power}", mantissa.trim_end_matches('0').trim_end_matches('.'))
}

/// Shows a named value in a row of a grid.
pub(super) fn row(ui: &mut Ui, name: &str, value: impl Into<String>) {
    ui.label(name);
    ui.monospace(value.into());
    ui.end_row();
}

/// Shows a named value in a row of a grid, with the name in a colour.
pub(super) fn coloured_row(ui: &mut Ui, name: &str, colour: Color32, value: impl Into<String>) {
    ui.colored_label(colour, name);
    ui.monospace(value.into());
    ui.end_row();
}

/// Does the same as [`number`] for a decimal, which may have more digits than a slider shows.
fn decimal(ui: &mut Ui, name: &str, unit: &str, value: &mut Decimal, range: RangeInclusive<f64>) {
    let mut new = value.value();
    if number(ui, name, unit, &mut new, range) {
        *value = new.into();
    }
}

/// Range of masses in kg.
pub(super) const MASSES: RangeInclusive<f64> = 0.1..=8.0;
/// Range of a double pendulum's lengths in m.
pub(super) const LENGTHS: RangeInclusive<f64> = 0.1..=3.0;
/// Range of gravity in m/s².
pub(super) const GRAVITIES: RangeInclusive<f64> = 0.1..=30.0;
/// Range of friction in N m s.
pub(super) const FRICTIONS: RangeInclusive<f64> = 0.0..=2.0;
/// Range of a start's angles in rad, which a pinned pendulum may have turned often.
pub(super) const ANGLES: RangeInclusive<f64> = -1000.0..=1000.0;
/// Range of a start's speeds in rad/s.
pub(super) const SPEEDS: RangeInclusive<f64> = -100.0..=100.0;

/// Shows controls for the kind, masses, lengths and gravity of a double pendulum, and returns true
/// if any changed.
pub(super) fn build(ui: &mut Ui, build: &mut PendulumSpec) -> bool {
    let before = *build;
    ui.horizontal(|ui| {
        ui.radio_value(&mut build.kind, Kind::Points, "points");
        ui.radio_value(&mut build.kind, Kind::Rods, "rods");
    });
    Grid::new("build").num_columns(2).show(ui, |ui| {
        let PendulumSpec { masses: [m1, m2], lengths: [l1, l2], gravity, .. } = build;
        decimal(ui, "Mass m1", " kg", m1, MASSES);
        decimal(ui, "Mass m2", " kg", m2, MASSES);
        decimal(ui, "Length l1", " m", l1, LENGTHS);
        decimal(ui, "Length l2", " m", l2, LENGTHS);
        decimal(ui, "Gravity g", " m/s²", gravity, GRAVITIES);
    });
    *build != before
}

/// Shows a control for a friction that is the same at both pivots, and returns true if it was
/// changed.
pub(super) fn friction(ui: &mut Ui, build: &mut PendulumSpec) -> bool {
    let mut both = build.friction[0].value();
    let mut is_changed = false;
    Grid::new("friction").num_columns(2).show(ui, |ui| {
        is_changed = number(ui, "Friction b", " N m s", &mut both, FRICTIONS);
    });
    if is_changed {
        build.friction = [both.into(); 2];
    }
    is_changed
}

/// Shows a row with the speeds of a start, unless it is at rest.
pub(super) fn thrown(ui: &mut Ui, start: &State<f64>) {
    let [omega1, omega2] = start.speed;
    if start.speed != [0.0; 2] {
        row(ui, "thrown with", format!("{}, {} rad/s", fixed(omega1, 3), fixed(omega2, 3)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_fields_can_be_pasted_and_typed() {
        for (value, text) in [(0.0, "0"), (-9.81, "-9.81"), (1e-7, "1e-7"), (0.05, "0.05")] {
            assert_eq!(typed(value), text);
        }
        for value in [1.5e-12, -2.345e9, 12_345.0, 0.001, 3e300] {
            let read: f64 = typed(value).parse().unwrap();
            assert!((read / value - 1.0).abs() < 1e-3, "{read} for {value}");
        }
    }
}
