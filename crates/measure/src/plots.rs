//! MeasuredCurves as plots in SVG.

use flipmap_estimate::Estimate;
use plotters::prelude::*;

use crate::curves::MeasuredCurve;
use crate::order::MeasureError;

/// Width and height of a plot.
const SIZE: (u32, u32) = (640, 400);
const INK: RGBColor = RGBColor(0x1f, 0x5f, 0xa8);

/// Draws a curve with its intervals. Points that a logarithmic axis cannot show are left out.
pub(crate) fn svg(curve: &MeasuredCurve) -> Result<String, MeasureError> {
    let place = |x: f64, axis: usize| if curve.log[axis] { x.log10() } else { x };
    let least = |y: &Estimate| if curve.log[1] { y.low.max(1e-3 * y.value) } else { y.low };
    let point = |(x, y): &(f64, Estimate)| {
        let ends = [y.value, least(y), y.high].map(|end| place(end, 1));
        (place(*x, 0), ends)
    };
    let is_shown =
        |(x, ends): &(f64, [f64; 3])| x.is_finite() && ends.iter().all(|end| end.is_finite());
    let points: Vec<(f64, [f64; 3])> = curve.points.iter().map(point).filter(is_shown).collect();
    let mut text = String::new();
    draw(curve, &points, &mut text).map_err(|error| MeasureError::Page(error.to_string()))?;
    Ok(text)
}

/// The range of an axis around some values.
fn range(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for value in values {
        (low, high) = (low.min(value), high.max(value));
    }
    if !low.is_finite() {
        return 0.0..1.0;
    }
    let margin = (0.04 * (high - low)).max(1e-3 * low.abs()).max(1e-9);
    low - margin..high + margin
}

/// The label of a place on an axis.
fn label(place: f64, is_log: bool) -> String {
    let value = if is_log { 10f64.powf(place) } else { place };
    match value.abs() {
        0.0 => "0".to_string(),
        size if (1e-2..1e4).contains(&size) => {
            let text = format!("{value:.3}");
            text.trim_end_matches('0').trim_end_matches('.').to_string()
        }
        _ => format!("{value:.0e}"),
    }
}

fn draw(
    curve: &MeasuredCurve,
    points: &[(f64, [f64; 3])],
    text: &mut String,
) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let across = range(points.iter().map(|(x, _)| *x));
    let up = range(points.iter().flat_map(|(_, ends)| *ends));
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
        .x_label_formatter(&|x| label(*x, curve.log[0]))
        .y_label_formatter(&|y| label(*y, curve.log[1]))
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
    Ok(())
}
