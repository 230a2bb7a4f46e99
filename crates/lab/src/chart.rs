//! Curves on axes that are linear, logarithmic, or logarithmic on both sides of zero.

use std::f64::consts::{FRAC_PI_4, PI};
use std::ops::RangeInclusive;

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};

use super::drawing::{SMALL, Tint, corner_inside};
use super::polyline::simplified;
use flipmap_numbers::number_text::{of_pi, plain, power_of_ten, significant};

/// The mapping of values to places along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisScale {
    /// Linear: equal differences are equal lengths.
    Linear,
    /// Linear, marked at fractions of π.
    Angle,
    /// Logarithmic: equal ratios are equal lengths.
    Log,
    /// Logarithmic on both sides of zero, and linear up to this distance from it.
    SignedLog(f64),
}

/// One axis of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct ChartAxis {
    /// Name of the quantity, with its unit.
    pub name: String,
    /// Range of values shown.
    pub range: RangeInclusive<f64>,
    /// Scale of the axis.
    pub scale: AxisScale,
}

/// One curve of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend; a curve with an empty name is not listed.
    pub name: String,
    /// Colour of the line.
    pub colour: Color32,
    /// Points of the curve as (across, up), in order.
    pub points: Vec<[f64; 2]>,
    /// True if the curve is a guide, drawn dashed.
    pub dashed: bool,
}

/// A chart of curves on two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The horizontal axis.
    pub across: ChartAxis,
    /// The vertical axis.
    pub up: ChartAxis,
    /// The curves of the chart.
    pub curves: Vec<Curve>,
    /// Points marked with a dot, as (across, up).
    pub marks: Vec<[f64; 2]>,
}

/// Space for the numbers and names to the left of the chart and below it, in points.
const MARGIN: Vec2 = vec2(48.0, 36.0);
/// Least width and height of a chart with its margins, in points.
const LEAST: Vec2 = vec2(160.0, 136.0);
/// Height of a row of the legend above the chart, in points.
const HEAD: f32 = 16.0;

impl Curve {
    /// Creates a solid curve with a name in the legend.
    pub fn line(name: &str, colour: Color32, points: Vec<[f64; 2]>) -> Self {
        Curve { name: name.to_string(), colour, points, dashed: false }
    }

    /// Creates a dashed curve with a name in the legend.
    pub fn guide(name: &str, colour: Color32, points: Vec<[f64; 2]>) -> Self {
        Curve { dashed: true, ..Curve::line(name, colour, points) }
    }
}

impl ChartAxis {
    /// Creates an axis with its name, range and scale.
    pub fn new(name: &str, range: RangeInclusive<f64>, scale: AxisScale) -> Self {
        ChartAxis { name: name.to_string(), range, scale }
    }

    /// Creates a linear axis with a round range around values, or that of an angle.
    pub(crate) fn around(name: &str, values: impl Iterator<Item = f64>, is_angle: bool) -> Self {
        if is_angle {
            return ChartAxis::new(name, -3.2..=3.2, AxisScale::Angle);
        }
        let finite = values.filter(|value| value.is_finite());
        let [least, most] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| {
            [least.min(x), most.max(x)]
        });
        if least > most {
            return ChartAxis::new(name, 0.0..=1.0, AxisScale::Linear);
        }
        let step = round_step(((most - least) / 4.0).max(1e-3 * most.abs()).max(1e-9));
        let (from, to) = ((least / step).floor() * step, (most / step).ceil() * step);
        ChartAxis::new(name, from..=to.max(from + step), AxisScale::Linear)
    }

    /// Cuts a curve where an angle on this axis or on `up` jumps from π to −π.
    pub(crate) fn pieces(&self, up: &ChartAxis, points: Vec<[f64; 2]>) -> Vec<Vec<[f64; 2]>> {
        let jumps = |axis: &ChartAxis, from: f64, to: f64| {
            axis.scale == AxisScale::Angle && (to - from).abs() > PI
        };
        let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
        for point in points {
            match pieces.last_mut().and_then(|piece| Some((*piece.last()?, piece))) {
                Some((last, piece))
                    if !jumps(self, last[0], point[0]) && !jumps(up, last[1], point[1]) =>
                {
                    piece.push(point);
                }
                _ => pieces.push(vec![point]),
            }
        }
        pieces
    }

    fn stretched(&self, value: f64) -> f64 {
        match self.scale {
            AxisScale::Linear | AxisScale::Angle => value,
            AxisScale::Log => value.max(f64::MIN_POSITIVE).log10(),
            AxisScale::SignedLog(least) => (1.0 + value.abs() / least).log10().copysign(value),
        }
    }

    /// Returns the position of a value along the axis: 0 to 1 in its range, and at most one length
    /// of the axis outside it.
    fn share(&self, value: f64) -> f32 {
        let [from, to] = [*self.range.start(), *self.range.end()].map(|end| self.stretched(end));
        ((self.stretched(value) - from) / (to - from)).clamp(-1.0, 2.0) as f32
    }

    /// Returns the value at a position along the axis, 0 to 1.
    fn value(&self, share: f32) -> f64 {
        let [from, to] = [*self.range.start(), *self.range.end()].map(|end| self.stretched(end));
        let along = from + f64::from(share) * (to - from);
        match self.scale {
            AxisScale::Linear | AxisScale::Angle => along,
            AxisScale::Log => 10f64.powf(along),
            AxisScale::SignedLog(least) => {
                (least * (10f64.powf(along.abs()) - 1.0)).copysign(along)
            }
        }
    }

    /// Returns the values marked by gridlines, with their labels.
    fn ticks(&self) -> Vec<(f64, String)> {
        let (from, to) = (*self.range.start(), *self.range.end());
        let decade = |k: i32| 10f64.powi(k);
        match self.scale {
            AxisScale::Linear => {
                let step = round_step((to - from) / 5.0);
                let first = (from / step).ceil() as i64;
                let last = (to / step + 1e-9).floor() as i64;
                (first..=last).map(|k| k as f64 * step).map(|x| (x, plain(x, 3))).collect()
            }
            AxisScale::Angle => {
                let quarters = if to - from > 1.5 * PI { 2 } else { 1 };
                let step = f64::from(quarters) * FRAC_PI_4;
                let [first, last] = [(from / step).ceil(), (to / step).floor()];
                let multiple = |k: i64| (k as f64 * step, of_pi(k * i64::from(quarters), 4));
                (first as i64..=last as i64).map(multiple).collect()
            }
            AxisScale::Log => {
                let [low, high] = [from, to].map(|end| end.log10());
                let (low, high) = (low.ceil() as i32, high.floor() as i32);
                let step = ((high - low).max(1) as usize).div_ceil(6);
                (low..=high).step_by(step).map(|k| (decade(k), power_of_ten(k))).collect()
            }
            AxisScale::SignedLog(least) => {
                let (low, high) = (least.log10().round() as i32, to.log10().floor() as i32);
                let step = ((high - low).max(1) as usize).div_ceil(3);
                let up = (low + 1..=high).rev().step_by(step);
                let both = up.flat_map(|k| {
                    let power = power_of_ten(k);
                    [(-decade(k), format!("−{power}")), (decade(k), power)]
                });
                [(0.0, "0".to_string())].into_iter().chain(both).collect()
            }
        }
    }
}

/// Returns the smallest 1, 2 or 5 times a power of ten that is at least `least`.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= least);
    factor.unwrap_or(10.0) * power
}

impl Chart {
    /// Shows the chart in `size` points or its least size, and returns its response; `told` is its
    /// description for a screen reader. A curve that leaves the range is cut off at the edge.
    pub fn show(&self, ui: &mut Ui, size: Vec2, told: &str) -> Response {
        let (response, painter) = ui.allocate_painter(size.max(LEAST), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, told));
        let tint = Tint::of(ui);
        let head = self.head(&painter, response.rect, &tint);
        let area = Rect::from_min_max(
            response.rect.min + vec2(MARGIN.x, head),
            response.rect.max - vec2(8.0, MARGIN.y),
        );
        tint.fill(&painter, area);
        self.frame(&painter, area, &tint);
        let inside = painter.with_clip_rect(area.intersect(painter.clip_rect()));
        for curve in &self.curves {
            let points = self.places(area, &curve.points);
            if curve.dashed {
                let stroke = Stroke::new(1.0, curve.colour);
                inside.extend(Shape::dashed_line(&points, stroke, 5.0, 4.0));
            } else {
                inside.add(Shape::line(points, Stroke::new(1.5, curve.colour)));
            }
        }
        for mark in &self.marks {
            painter.circle_filled(area.clamp(self.place(area, mark)), 4.0, tint.ink);
        }
        if let Some(at) = response.hover_pos().filter(|at| area.contains(*at)) {
            self.crosshair(&inside, area, at, &tint);
        }
        response
    }

    /// Draws a cross at the pointer, with the values there.
    fn crosshair(&self, painter: &Painter, area: Rect, at: Pos2, tint: &Tint) {
        let stroke = Stroke::new(1.0, tint.faint);
        painter.vline(at.x, area.y_range(), stroke);
        painter.hline(area.x_range(), at.y, stroke);
        let across = self.across.value((at.x - area.left()) / area.width());
        let up = self.up.value((area.bottom() - at.y) / area.height());
        let words = [across, up].map(|value| significant(value, 3)).join(" · ");
        let galley = painter.layout_no_wrap(words, FontId::proportional(SMALL), tint.ink);
        let corner = corner_inside(area, galley.size(), at + vec2(8.0, -8.0 - galley.size().y));
        let plate = Rect::from_min_size(corner, galley.size()).expand(2.0);
        painter.rect_filled(plate, 2.0, tint.ground);
        painter.galley(corner, galley, tint.ink);
    }

    fn place(&self, area: Rect, [x, y]: &[f64; 2]) -> Pos2 {
        let across = area.left() + self.across.share(*x) * area.width();
        pos2(across, area.bottom() - self.up.share(*y) * area.height())
    }

    fn places(&self, area: Rect, points: &[[f64; 2]]) -> Vec<Pos2> {
        // Values that are not finite have no place on the chart.
        let finite = points.iter().filter(|point| point.iter().all(|x| x.is_finite()));
        simplified(&finite.map(|point| self.place(area, point)).collect::<Vec<_>>())
    }

    fn frame(&self, painter: &Painter, area: Rect, tint: &Tint) {
        let grid = Stroke::new(1.0, tint.faint.gamma_multiply(0.4));
        let mut written = Vec::new();
        for (value, words) in self.up.ticks() {
            let y = area.bottom() - self.up.share(value) * area.height();
            painter.hline(area.x_range(), y, grid);
            let at = pos2(area.left() - 4.0, y);
            write_if_free(painter, at, Align2::RIGHT_CENTER, words, tint, &mut written);
        }
        for (value, words) in self.across.ticks() {
            let x = area.left() + self.across.share(value) * area.width();
            painter.vline(x, area.y_range(), grid);
            let at = pos2(x, area.bottom() + 4.0);
            write_if_free(painter, at, Align2::CENTER_TOP, words, tint, &mut written);
        }
        let below = pos2(area.right(), area.bottom() + 19.0);
        let name = self.across.name.clone();
        write_if_free(painter, below, Align2::RIGHT_TOP, name, tint, &mut written);
    }

    /// Writes the name of the vertical axis and the legend above the chart, and returns their
    /// height.
    fn head(&self, painter: &Painter, rect: Rect, tint: &Tint) -> f32 {
        let from = rect.left() + MARGIN.x;
        let mut at = pos2(from, rect.top());
        let named = self.curves.iter().filter(|curve| !curve.name.is_empty());
        let entries = named.map(|curve| (curve.name.as_str(), Some(curve.colour)));
        for (words, colour) in [(self.up.name.as_str(), None)].into_iter().chain(entries) {
            let font = FontId::proportional(SMALL);
            let galley = painter.layout_no_wrap(words.to_string(), font, tint.ink);
            let line = if colour.is_some() { 24.0 } else { 0.0 };
            if at.x > from && at.x + line + galley.size().x > rect.right() {
                at = pos2(from, at.y + HEAD);
            }
            if let Some(colour) = colour {
                let ends = [at + vec2(0.0, 8.0), at + vec2(20.0, 8.0)];
                painter.line_segment(ends, Stroke::new(2.0, colour));
            }
            let end = at.x + line + galley.size().x;
            painter.galley(at + vec2(line, 0.0), galley, tint.ink);
            at.x = end + 16.0;
        }
        at.y + HEAD - rect.top()
    }
}

/// Writes words unless they would cover words written before.
fn write_if_free(
    painter: &Painter,
    at: Pos2,
    align: Align2,
    words: String,
    tint: &Tint,
    written: &mut Vec<Rect>,
) {
    let galley = painter.layout_no_wrap(words, FontId::proportional(SMALL), tint.ink);
    let place = align.anchor_size(at, galley.size());
    if written.iter().all(|other| !place.intersects(*other)) {
        painter.galley(place.min, galley, tint.ink);
        written.push(place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_where_their_scale_says() {
        let linear = ChartAxis::new("", 0.0..=10.0, AxisScale::Linear);
        assert_eq!([0.0, 5.0, 10.0, 15.0].map(|x| linear.share(x)), [0.0, 0.5, 1.0, 1.5]);
        let log = ChartAxis::new("", 1e-8..=1.0, AxisScale::Log);
        assert!((log.share(1e-4) - 0.5).abs() < 1e-6 && log.share(0.0) == -1.0);
        let signed = ChartAxis::new("", -1e2..=1e2, AxisScale::SignedLog(1e-6));
        assert_eq!(signed.share(0.0), 0.5);
        assert!((signed.share(1e-2) + signed.share(-1e-2) - 1.0).abs() < 1e-6);
        assert!(signed.share(1e-2) > signed.share(1e-4) && signed.share(1e300) == 2.0);
        for (axis, values) in [(linear, [0.5, 9.0]), (log, [1e-7, 0.3]), (signed, [-0.2, 20.0])] {
            for value in values {
                assert!((axis.value(axis.share(value)) / value - 1.0).abs() < 1e-4, "{axis:?}");
            }
        }
    }

    #[test]
    fn steps_are_round() {
        let steps = [6.0, 0.9, 2.0, 130.0, 0.03].map(round_step);
        for (step, expected) in steps.into_iter().zip([10.0, 1.0, 2.0, 200.0, 0.05]) {
            assert!((step / expected - 1.0).abs() < 1e-12, "{step} for {expected}");
        }
    }

    #[test]
    fn ticks_are_round_and_few() {
        let words =
            |axis: ChartAxis| axis.ticks().into_iter().map(|(_, words)| words).collect::<Vec<_>>();
        let linear = words(ChartAxis::new("", 0.0..=3.13, AxisScale::Linear));
        assert_eq!(linear, ["0", "1", "2", "3"]);
        assert_eq!(
            words(ChartAxis::new("", 1e-3..=1.0, AxisScale::Log)),
            ["10⁻³", "10⁻²", "10⁻¹", "1"]
        );
        let angle = words(ChartAxis::new("", -3.2..=3.2, AxisScale::Angle));
        assert_eq!(angle, ["−π", "−π/2", "0", "π/2", "π"]);
        let signed = ChartAxis::new("", -1e3..=1e3, AxisScale::SignedLog(1e-12)).ticks();
        assert!(signed.len() <= 9 && signed.iter().any(|(value, _)| *value < 0.0));
    }

    #[test]
    fn what_is_no_number_reaches_no_screen() {
        let chart = Chart {
            across: ChartAxis::new("", 0.0..=1.0, AxisScale::Linear),
            up: ChartAxis::new("", 0.0..=1.0, AxisScale::Linear),
            curves: Vec::new(),
            marks: Vec::new(),
        };
        let area = Rect::from_min_size(Pos2::ZERO, vec2(100.0, 100.0));
        let points = [[0.0, 0.5], [0.5, f64::NAN], [f64::INFINITY, 0.0], [1.0, 2.0]];
        let places = chart.places(area, &points);
        assert!(places.len() == 2, "{places:?}");
        let near = area.expand2(area.size());
        assert!(places.iter().all(|at| near.contains(*at)), "{places:?}");
    }
}
