//! The separation from the ghost against time, on a logarithmic axis.

use std::ops::RangeInclusive;

use egui::{Color32, Ui, vec2};

use super::facts::round_secs;
use crate::pins::Pin;
use flipmap_lab::chart::{AxisScale, Chart, ChartAxis, Curve};
use flipmap_lab::drawing::Tint;
use flipmap_pendulum::separation::{Growth, Reading, reading_at};

/// Height of the chart in points.
const HEIGHT: f32 = 140.0;

/// Shows the chart with the current time marked, and the growth rate in words.
pub(super) fn separation(ui: &mut Ui, pin: &Pin) {
    let record = pin.flight.record();
    let growth = Growth::fit(&record.readings);
    ui.label(words(&record.readings, growth, pin.shown_secs()));
    let Some(decades) = decades(&record.readings) else { return };
    if record.end_secs() <= 0.0 {
        return;
    }
    let curve = points(&record.readings);
    let mut curves = vec![Curve::line("", pin.badge.colour(), curve)];
    let ink = Tint::of(ui).ink;
    if let Some(growth) = growth {
        let line = [0.0, growth.until_secs].map(|t| [t, growth.separation_rad(t)]);
        curves.push(Curve::guide("fitted growth", ink, line.to_vec()));
    }
    let now = reading_at(&record.readings, pin.shown_secs());
    curves.extend(now.map(|_| upright(pin.shown_secs(), &decades, ink)));
    let marks = now.map(|reading| [pin.shown_secs(), reading.separation_rad]);
    let chart = Chart {
        across: ChartAxis::new("time, s", 0.0..=record.end_secs(), AxisScale::Linear),
        up: ChartAxis::new("separation, rad", decades, AxisScale::Log),
        curves,
        marks: marks.into_iter().collect(),
    };
    let told = "Separation in rad from the pendulum one pixel away, against time in s";
    chart.show(ui, vec2(ui.available_width(), HEIGHT), told).on_hover_text(
        "How far apart the two pendulums are in phase space: angles in rad, speeds in rad per \
         natural unit of time. The dashed line is the fitted growth.",
    );
}

/// Returns the line that marks a moment.
fn upright(secs: f64, range: &RangeInclusive<f64>, colour: Color32) -> Curve {
    Curve::line("", colour, vec![[secs, *range.start()], [secs, *range.end()]])
}

/// Returns the range of whole decades that holds all separations; `None` while the pendulums are
/// together.
fn decades(readings: &[Reading]) -> Option<RangeInclusive<f64>> {
    let logs = readings.iter().map(|r| r.separation_rad.log10()).filter(|log| log.is_finite());
    let [low, high] = logs
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], log| [low.min(log), high.max(log)]);
    if low > high {
        return None;
    }
    let [low, high] = [low.floor(), high.ceil().max(low.floor() + 1.0)];
    Some(10f64.powf(low)..=10f64.powf(high))
}

/// Returns the separations above 0 against time in s.
fn points(readings: &[Reading]) -> Vec<[f64; 2]> {
    let apart = readings.iter().filter(|reading| reading.separation_rad > 0.0);
    apart.map(|reading| [reading.secs, reading.separation_rad]).collect()
}

/// Describes the separation at `secs` and its growth rate.
fn words(readings: &[Reading], growth: Option<Growth>, secs: f64) -> String {
    let now = reading_at(readings, secs).map_or(0.0, |reading| reading.separation_rad);
    let grows = match growth {
        Some(Growth { rate_per_sec, until_secs, .. }) => {
            // Adding 0 after rounding avoids "-0.00".
            let rate = (rate_per_sec * 100.0).round() / 100.0 + 0.0;
            let until = round_secs(until_secs);
            match rate {
                rate if rate > 0.0 => {
                    format!("grows × e every {:.1} s up to {until} s", 1.0 / rate)
                }
                rate => format!("grows at {rate:.2} a second up to {until} s"),
            }
        }
        None => "no growth rate can be told".into(),
    };
    format!("Separation {} rad; {grows}", short(now))
}

/// Formats a value with two digits, in plain notation where that is readable.
fn short(value: f64) -> String {
    if (0.01..1000.0).contains(&value) { format!("{value:.2}") } else { format!("{value:.1e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(secs: f64, separation_rad: f64) -> Reading {
        Reading { secs, energy_error: 0.0, separation_rad }
    }

    #[test]
    fn the_axis_spans_whole_decades() {
        let readings: Vec<Reading> =
            (0..5000).map(|i| reading(f64::from(i) / 100.0, 3e-7 * f64::from(i))).collect();
        let range = decades(&readings).expect("something to show");
        assert!((range.start().log10() + 7.0).abs() < 1e-9, "{range:?}");
        assert!((range.end().log10() + 2.0).abs() < 1e-9, "{range:?}");
        assert_eq!(points(&readings).len(), 4999, "the first has no logarithm");
        assert_eq!(decades(&[reading(0.0, 1.0)]), Some(1.0..=10.0));
        assert_eq!(decades(&[reading(0.0, 0.0)]), None, "two that never part");
    }
}
