//! Work–precision plots: error over time on logarithmic axes, as SVG.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::ReportError;
use super::depth::DepthWay;
use flipmap_engine::{IntegratorConfig, Method, Precision};

/// Points of one method in one precision, in the order of its settings.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// The config that decides the colour and the marker.
    pub config: IntegratorConfig,
    /// The way in which deep pixels were computed, if that decides the colour instead.
    pub way: Option<DepthWay>,
    /// Points as horizontal and vertical values.
    pub points: Vec<(f64, f64)>,
}

/// The contents of a plot.
#[derive(Clone, Debug)]
pub(super) struct Plot<'a> {
    /// Label of the horizontal axis.
    pub across: &'a str,
    /// Label of the vertical axis.
    pub up: &'a str,
    /// Curves of the plot.
    pub series: Vec<Series>,
}

const SIZE: (u32, u32) = (760, 420);
const LEGEND_LEFT: u32 = 620;
/// A grey that is readable on white and on black.
const GREY: RGBColor = RGBColor(128, 128, 128);
const FONT: (&str, i32) = ("sans-serif", 13);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Plot<'_> {
    /// Draws the plot as an `<svg>` element to embed in a page. Values that are not positive have
    /// no logarithm and lie on the lower edge; points that are not finite are left out.
    pub(super) fn svg(&self) -> Result<String, ReportError> {
        let mut text = String::new();
        let complain = |why: String| ReportError::Layout(why);
        {
            let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
            let (left, legend) = root.split_horizontally(LEGEND_LEFT);
            self.draw_chart(&left).map_err(|error| complain(error.to_string()))?;
            self.draw_legend(&legend).map_err(|error| complain(error.to_string()))?;
            root.present().map_err(|error| complain(error.to_string()))?;
        }
        // Inside a page the namespace is known; without it the page contains no address at all.
        Ok(text.replace(" xmlns=\"http://www.w3.org/2000/svg\"", ""))
    }

    fn draw_chart(&self, area: &Area) -> Result<(), Box<dyn std::error::Error>> {
        let across = axis(self.finite().map(|point| point.0));
        let up = axis(self.finite().map(|point| point.1));
        let mut chart = ChartBuilder::on(area)
            .margin(10)
            .x_label_area_size(44)
            .y_label_area_size(66)
            .build_cartesian_2d(across.clone().log_scale(), up.clone().log_scale())?;
        chart
            .configure_mesh()
            .x_desc(self.across)
            .y_desc(self.up)
            .label_style(FONT.into_font().color(&GREY))
            .axis_desc_style(FONT.into_font().color(&GREY))
            .axis_style(GREY)
            .bold_line_style(GREY.mix(0.3))
            .light_line_style(GREY.mix(0.1))
            .x_label_formatter(&|value| tick(*value))
            .y_label_formatter(&|value| tick(*value))
            .draw()?;
        for series in &self.series {
            let inside = |&(x, y): &(f64, f64)| (x.max(across.start), y.max(up.start));
            let points: Vec<_> = series.points.iter().filter(is_finite).map(inside).collect();
            let colour = series.colour();
            chart.draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))?;
            let marks = points.iter().map(|&point| marker(point, colour, series.config.precision));
            chart.draw_series(marks)?;
        }
        Ok(())
    }

    fn draw_legend(&self, area: &Area) -> Result<(), Box<dyn std::error::Error>> {
        let style = FONT.into_font().color(&GREY).pos(Pos::new(HPos::Left, VPos::Center));
        for (row, series) in self.series.iter().enumerate() {
            let y = 24 + 22 * row as i32;
            let colour = series.colour();
            area.draw(&PathElement::new([(0, y), (24, y)], colour.stroke_width(2)))?;
            area.draw(&marker((12, y), colour, series.config.precision))?;
            area.draw(&Text::new(series.label(), (32, y), style.clone()))?;
        }
        Ok(())
    }

    fn finite(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.series.iter().flat_map(|series| &series.points).filter(is_finite)
    }
}

fn is_finite((x, y): &&(f64, f64)) -> bool {
    x.is_finite() && y.is_finite()
}

/// Whole decades around the positive `values`, and one decade below if some are not positive.
fn axis(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (positive, others): (Vec<f64>, Vec<f64>) = values.partition(|&value| value > 0.0);
    let least = positive.iter().copied().reduce(f64::min).unwrap_or(1e-3);
    let most = positive.iter().copied().reduce(f64::max).unwrap_or(1.0);
    let below = if others.is_empty() { 0 } else { 1 };
    let from = least.log10().floor() as i32 - below;
    let to = (most.log10().ceil() as i32).max(from + 1);
    10f64.powi(from)..10f64.powi(to)
}

fn tick(value: f64) -> String {
    if (0.01..10_000.0).contains(&value) { format!("{value}") } else { format!("{value:.0e}") }
}

/// The method's colour in Okabe and Ito's palette, which colour-blind readers can tell apart.
fn colour(method: Method) -> RGBColor {
    match method {
        Method::Rk4 { .. } => RGBColor(213, 94, 0),
        Method::Dopri5 { .. } => RGBColor(230, 159, 0),
        Method::Dop853 { .. } => RGBColor(0, 114, 178),
        Method::Taylor { .. } => RGBColor(0, 158, 115),
        Method::Extrapolation { .. } => RGBColor(204, 121, 167),
    }
}

impl Series {
    /// Groups points into series, one per method and precision.
    pub(super) fn by_method(
        points: impl Iterator<Item = (IntegratorConfig, (f64, f64))>,
    ) -> Vec<Series> {
        let mut all: Vec<Series> = Vec::new();
        for (config, point) in points {
            let same = |series: &&mut Series| {
                series.config.method.name() == config.method.name()
                    && series.config.precision == config.precision
            };
            match all.iter_mut().find(same) {
                Some(series) => series.points.push(point),
                None => all.push(Series { config, way: None, points: vec![point] }),
            }
        }
        all
    }

    fn colour(&self) -> RGBColor {
        match self.way {
            None => colour(self.config.method),
            Some(DepthWay::Direct) => RGBColor(213, 94, 0),
            Some(DepthWay::Cells) => RGBColor(0, 158, 115),
            Some(DepthWay::Lines) => RGBColor(0, 114, 178),
        }
    }

    fn label(&self) -> String {
        let IntegratorConfig { method, precision } = self.config;
        self.way.map_or_else(|| format!("{} {precision}", method.name()), |way| way.to_string())
    }
}

/// The marker of a precision: f32 a ring, f64 a disc, pairs of numbers a large ring.
fn marker<C>(at: C, colour: RGBColor, precision: Precision) -> Circle<C, i32> {
    match precision {
        Precision::F32 => Circle::new(at, 4, colour.stroke_width(2)),
        Precision::F64 => Circle::new(at, 5, colour.filled()),
        Precision::Df32 | Precision::Dd => Circle::new(at, 8, colour.stroke_width(2)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan;

    fn svg(points: &[(f64, f64)]) -> String {
        let series = vec![Series { config: plan::FAST, way: None, points: points.to_vec() }];
        Plot { across: "µs", up: "error", series }.svg().unwrap()
    }

    #[test]
    fn a_value_of_zero_lies_on_the_lower_edge() {
        assert_eq!(axis([0.0, 0.02, 3.0].into_iter()), 1e-3..10.0);
        assert_eq!(axis([0.02, 3.0].into_iter()), 1e-2..10.0);
        assert_eq!(axis([0.0, 0.0].into_iter()), 1e-4..1.0);
        assert_eq!(axis([1.0].into_iter()), 1.0..10.0);
        let text = svg(&[(1.0, 0.0), (10.0, 1e-3)]);
        // Two marks in the chart and one in the legend.
        assert_eq!(text.matches("<circle").count(), 3);
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let text = svg(&[(f64::NAN, 1.0), (1.0, f64::INFINITY), (2.0, 1.0)]);
        assert_eq!(text.matches("<circle").count(), 2);
        assert!(svg(&[]).starts_with("<svg"));
    }

    #[test]
    fn a_plot_names_no_address() {
        assert!(!svg(&[(1.0, 1.0)]).contains("http"));
    }
}
