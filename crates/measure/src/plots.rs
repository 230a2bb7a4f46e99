//! Curves as plots in SVG.

use flipmap_estimate::Estimate;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use crate::curves::MeasuredCurve;
use crate::order::MeasureError;

/// Width and height of a plot.
const SIZE: (u32, u32) = (640, 400);
const INK: RGBColor = RGBColor(0x1f, 0x5f, 0xa8);

/// A point with the estimate and the ends of its interval.
type Shown = (f64, [f64; 3]);

/// Draws a curve with its intervals. Points that a logarithmic axis cannot show are left out.
pub(crate) fn svg(curve: &MeasuredCurve) -> Result<String, MeasureError> {
    let least = |y: &Estimate| if curve.log[1] { y.low.max(1e-2 * y.value) } else { y.low };
    let point = |(x, y): &(f64, Estimate)| (*x, [y.value, least(y), y.high]);
    let is_shown = |(x, ends): &Shown| {
        let is_in =
            |place: f64, axis: usize| place.is_finite() && (!curve.log[axis] || place > 0.0);
        is_in(*x, 0) && ends.iter().all(|end| is_in(*end, 1))
    };
    let points: Vec<Shown> = curve.points.iter().map(point).filter(is_shown).collect();
    let across = range(points.iter().map(|(x, _)| *x), curve.log[0]);
    let up = range(points.iter().flat_map(|(_, ends)| *ends), curve.log[1]);
    let drawn = match curve.log {
        [true, true] => draw(curve, &points, across.log_scale(), up.log_scale()),
        [true, false] => draw(curve, &points, across.log_scale(), up),
        [false, true] => draw(curve, &points, across, up.log_scale()),
        [false, false] => draw(curve, &points, across, up),
    };
    drawn.map_err(|error| MeasureError::Page(error.to_string()))
}

/// The range of an axis around some values.
fn range(values: impl Iterator<Item = f64>, is_log: bool) -> std::ops::Range<f64> {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for value in values {
        (low, high) = (low.min(value), high.max(value));
    }
    if !low.is_finite() {
        return if is_log { 0.1..1.0 } else { 0.0..1.0 };
    }
    if is_log {
        return low / 1.2..high * 1.2;
    }
    let margin = (0.04 * (high - low)).max(1e-3 * low.abs()).max(1e-9);
    low - margin..high + margin
}

/// The label of a value on an axis.
fn label(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_string(),
        size if (1e-3..1e5).contains(&size) => {
            let text = format!("{value:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_string()
        }
        _ => format!("{value:.0e}"),
    }
}

/// Draws points on two axes.
fn draw<X, Y>(
    curve: &MeasuredCurve,
    points: &[Shown],
    across: X,
    up: Y,
) -> Result<String, Box<dyn std::error::Error>>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let mut text = String::new();
    let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(curve.title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(across, up)?;
    chart
        .configure_mesh()
        .x_desc(curve.across)
        .y_desc(curve.up)
        .x_label_formatter(&|x| label(*x))
        .y_label_formatter(&|y| label(*y))
        .label_style(("sans-serif", 13))
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(0xdd, 0xdd, 0xdd))
        .draw()?;
    let there = points.iter().map(|(x, ends)| (*x, ends[1]));
    let back = points.iter().rev().map(|(x, ends)| (*x, ends[2]));
    let band: Vec<(f64, f64)> = there.chain(back).collect();
    chart.draw_series([Polygon::new(band, INK.mix(0.18).filled())])?;
    let middle = || points.iter().map(|(x, ends)| (*x, ends[0]));
    chart.draw_series(LineSeries::new(middle(), INK.stroke_width(2)))?;
    if points.len() <= 40 {
        chart.draw_series(middle().map(|at| Circle::new(at, 3, INK.filled())))?;
    }
    area.present()?;
    drop(chart);
    drop(area);
    Ok(text)
}
