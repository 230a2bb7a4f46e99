//! Plots on logarithmic axes as SVG: one for every format, with colours left to the style sheet.

use std::fmt::Write;

use super::html::escaped;
use flipmap_engine::{IntegratorConfig, Precision};

/// Points that belong together.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// Number of the colour in the style sheet, and what it stands for.
    pub colour: (usize, &'static str),
    /// Precision, which decides the marker.
    pub precision: Precision,
    /// Engine, which decides the dashes.
    pub engine: String,
    /// Points as horizontal and vertical values.
    pub points: Vec<[f64; 2]>,
    /// Name beside the first point; may be empty.
    pub name: &'static str,
}

/// The contents of a plot.
#[derive(Clone, Debug)]
pub(super) struct Plot {
    /// Label of the horizontal axis.
    pub across: &'static str,
    /// Label of the vertical axis.
    pub up: &'static str,
    /// Curves of the plot.
    pub series: Vec<Series>,
}

/// The engine, the config and the coordinates of a point.
pub(super) type Point = (String, IntegratorConfig, [f64; 2]);

impl Series {
    /// A point with a name.
    pub(super) fn named((engine, config, point): Point, name: &'static str) -> Self {
        let IntegratorConfig { method, precision } = config;
        let colour = (method.colour(), method.name());
        Series { colour, precision, engine, points: vec![point], name }
    }

    /// Curves of the points, one for each engine, method and precision.
    pub(super) fn by_method(points: impl Iterator<Item = Point>) -> Vec<Self> {
        let mut all: Vec<Series> = Vec::new();
        for point in points {
            let one = Series::named(point, "");
            let key = |series: &Series| (series.colour, series.precision, series.engine.clone());
            match all.iter_mut().find(|series| key(series) == key(&one)) {
                Some(series) => series.points.extend(one.points),
                None => all.push(one),
            }
        }
        all
    }
}

/// Left and right edge of the chart.
const LEFT: f64 = 58.0;
const RIGHT: f64 = 460.0;
/// Upper and lower edge of the chart.
const TOP: f64 = 10.0;
const BOTTOM: f64 = 300.0;
/// Width of chart and labels.
const WIDTH: f64 = 480.0;

/// The decades of an axis; values that are not positive lie on its lower edge.
struct Axis {
    from: i32,
    to: i32,
    has_zero: bool,
}

impl Axis {
    /// Whole decades around the positive `values`, and one below them for others.
    fn around(values: impl Iterator<Item = f64>) -> Self {
        let (positive, others): (Vec<f64>, Vec<f64>) = values.partition(|&value| value > 0.0);
        let least = positive.iter().copied().reduce(f64::min).unwrap_or(1e-3);
        let most = positive.iter().copied().reduce(f64::max).unwrap_or(1.0);
        let has_zero = !others.is_empty();
        let from = least.log10().floor() as i32 - i32::from(has_zero);
        Axis { from, to: (most.log10().ceil() as i32).max(from + 1), has_zero }
    }

    /// The place of a value on the axis, from 0 to 1.
    fn place(&self, value: f64) -> f64 {
        (value.log10() - f64::from(self.from)).max(0.0) / f64::from(self.to - self.from)
    }

    /// Places and labels of the grid's lines.
    fn ticks(&self) -> Vec<(f64, String)> {
        let decades = self.to - self.from;
        let between: &[f64] = if decades <= 2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let exponents = (self.from..=self.to).step_by(1 + decades as usize / 8);
        let values = exponents.flat_map(|exponent| between.iter().map(move |x| (exponent, x)));
        let values = values.map(|(exponent, x)| format!("{x}e{exponent}").parse().unwrap_or(*x));
        let ticks = values.map(|value: f64| match self.place(value) {
            0.0 if self.has_zero => (0.0, "0".to_string()),
            place if (0.001..10_000.0).contains(&value) => (place, value.to_string()),
            place => (place, format!("{value:e}")),
        });
        ticks.filter(|(place, _)| *place <= 1.0).collect()
    }
}

/// The marker of a precision: f32 a ring, f64 a disc, pairs of numbers a large ring.
fn marker(precision: Precision, [x, y]: [f64; 2]) -> String {
    let (radius, class) = match precision {
        Precision::F32 => (3.5, "ring"),
        Precision::F64 => (4.0, "disc"),
        Precision::Df32 | Precision::Dd => (6.5, "wide-ring"),
    };
    format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>")
}

fn words(x: f64, y: f64, attributes: &str, text: &str) -> String {
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\"{attributes}>{}</text>\n", escaped(text))
}

fn line([x, y]: [f64; 2], [x2, y2]: [f64; 2]) -> String {
    format!("<line class=\"grid\" x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\"/>\n")
}

/// The entries of a legend that differ, in the order of their first appearance.
fn different<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    all.fold(Vec::new(), |mut known, one| {
        if !known.contains(&one) {
            known.push(one);
        }
        known
    })
}

impl Plot {
    /// Draws the plot as an `<svg>` element; points that are not finite are left out.
    pub(super) fn svg(&self) -> String {
        let finite = |series: &Series| -> Vec<[f64; 2]> {
            let points = series.points.iter().copied();
            points.filter(|[x, y]| x.is_finite() && y.is_finite()).collect()
        };
        let all: Vec<Vec<[f64; 2]>> = self.series.iter().map(finite).collect();
        let [across, up] = [0, 1].map(|k| Axis::around(all.iter().flatten().map(|point| point[k])));
        let to_page = |[x, y]: [f64; 2]| {
            [LEFT + (RIGHT - LEFT) * across.place(x), BOTTOM - (BOTTOM - TOP) * up.place(y)]
        };
        let mut names = Vec::new();
        let mut curves = String::new();
        for (series, points) in self.series.iter().zip(all) {
            let points: Vec<[f64; 2]> = points.into_iter().map(to_page).collect();
            curves += &self.curve(series, &points);
            names.extend(
                points.first().filter(|_| !series.name.is_empty()).map(|&at| (series.name, at)),
            );
        }
        let (legend, height) = self.legend();
        let (grid, names) = (grid(&across, &up), placed(&names));
        let title = words(
            14.0,
            0.5 * (TOP + BOTTOM),
            " text-anchor=\"middle\" transform=\"rotate(-90 14 155)\"",
            self.up,
        );
        let across =
            words(0.5 * (LEFT + RIGHT), BOTTOM + 36.0, " text-anchor=\"middle\"", self.across);
        format!(
            "<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">\n{grid}{title}{across}{curves}\
             {names}{legend}</svg>\n"
        )
    }

    fn engines(&self) -> Vec<&String> {
        different(self.series.iter().map(|series| &series.engine))
    }

    fn dashes(&self, engine: &String) -> &'static str {
        let place = self.engines().iter().position(|known| *known == engine).unwrap_or(0);
        ["0", "7 4", "2 3"][place % 3]
    }

    fn curve(&self, series: &Series, points: &[[f64; 2]]) -> String {
        let path: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let marks: String = points.iter().map(|&at| marker(series.precision, at)).collect();
        format!(
            "<g class=\"c{}\"><polyline points=\"{}\" fill=\"none\" stroke=\"currentColor\" \
             stroke-width=\"1.5\" stroke-dasharray=\"{}\"/>{marks}</g>\n",
            series.colour.0,
            path.join(" "),
            self.dashes(&series.engine)
        )
    }

    /// The legend of colours, markers and dashes below the plot, and the height of all.
    fn legend(&self) -> (String, f64) {
        let stroke = |dashes: &str| {
            format!(
                "<path d=\"M0,-4h24\" stroke=\"currentColor\" stroke-width=\"2\" stroke-dasharray=\"{dashes}\"/>"
            )
        };
        let colours = different(self.series.iter().map(|series| series.colour));
        let mut items: Vec<(String, String)> = colours
            .iter()
            .map(|(colour, name)| {
                (format!("<g class=\"c{colour}\">{}</g>", stroke("0")), name.to_string())
            })
            .collect();
        let precisions = different(self.series.iter().map(|series| series.precision));
        items.extend(precisions.iter().map(|p| (marker(*p, [12.0, -4.0]), p.to_string())));
        let engines = self.engines();
        if engines.len() > 1 {
            items.extend(engines.iter().map(|name| (stroke(self.dashes(name)), name.to_string())));
        }
        let (mut x, mut y, mut text) = (LEFT, BOTTOM + 64.0, String::new());
        for (sign, name) in items {
            let width = 44.0 + 7.2 * name.chars().count() as f64;
            if x + width > WIDTH && x > LEFT {
                (x, y) = (LEFT, y + 20.0);
            }
            let name = words(30.0, 0.0, "", &name);
            let _ = write!(text, "<g transform=\"translate({x:.0} {y:.0})\">{sign}{name}</g>");
            x += width;
        }
        (text, y + 10.0)
    }
}

fn grid(across: &Axis, up: &Axis) -> String {
    let vertical = across.ticks().into_iter().map(|(place, label)| {
        let x = LEFT + (RIGHT - LEFT) * place;
        line([x, TOP], [x, BOTTOM]) + &words(x, BOTTOM + 16.0, " text-anchor=\"middle\"", &label)
    });
    let horizontal = up.ticks().into_iter().map(|(place, label)| {
        let y = BOTTOM - (BOTTOM - TOP) * place;
        line([LEFT, y], [RIGHT, y]) + &words(LEFT - 6.0, y + 4.0, " text-anchor=\"end\"", &label)
    });
    vertical.chain(horizontal).collect()
}

/// Writes names beside their points, each moved up until it overlaps no earlier one.
fn placed(names: &[(&str, [f64; 2])]) -> String {
    let mut taken: Vec<[f64; 3]> = Vec::new();
    let mut text = String::new();
    for (name, [x, y]) in names {
        let width = 8.0 * name.chars().count() as f64;
        let left = (x + 9.0).min(WIDTH - width);
        let mut base = y - 7.0;
        while taken
            .iter()
            .any(|[x, y, w]| left < x + w && *x < left + width && (base - y).abs() < 14.0)
        {
            base -= 4.0;
        }
        taken.push([left, base, width]);
        text += &words(left, base.max(TOP + 8.0), " class=\"name\"", name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan;

    fn svg(points: &[[f64; 2]]) -> String {
        let all = points.iter().map(|&point| ("cpu".to_string(), plan::FAST, point));
        Plot { across: "µs", up: "a<b", series: Series::by_method(all) }.svg()
    }

    #[test]
    fn a_value_of_zero_lies_on_the_lower_edge_which_is_called_so() {
        let ends = |values: &[f64]| {
            let axis = Axis::around(values.iter().copied());
            (axis.from, axis.to)
        };
        assert_eq!([ends(&[0.0, 0.02, 3.0]), ends(&[0.02, 3.0])], [(-3, 1), (-2, 1)]);
        assert_eq!([ends(&[0.0]), ends(&[1.0])], [(-4, 0), (0, 1)]);
        let ticks = Axis::around([0.0, 0.02, 3.0].into_iter()).ticks();
        let labels: Vec<&str> = ticks.iter().map(|(_, label)| label.as_str()).collect();
        assert_eq!(labels, ["0", "0.01", "0.1", "1", "10"]);
        let text = svg(&[[1.0, 0.0], [10.0, 1e-3]]);
        // Two marks in the chart and one in the legend.
        assert_eq!(text.matches("<circle").count(), 3);
        assert!(text.contains("cy=\"300.0\"") && !text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let text = svg(&[[f64::NAN, 1.0], [1.0, f64::INFINITY], [2.0, 1.0]]);
        assert_eq!(text.matches("<circle").count(), 2);
        assert!(svg(&[]).starts_with("<svg") && text.contains("a&lt;b"));
    }

    #[test]
    fn names_do_not_cover_each_other() {
        let place = |at: [f64; 2]| placed(&[("fast", [100.0, 100.0]), ("lesson", at)]);
        assert!(
            place([110.0, 102.0]).contains("y=\"93.0\"")
                && place([110.0, 102.0]).contains("y=\"79.0\"")
        );
        assert!(place([200.0, 100.0]).matches("y=\"93.0\"").count() == 2);
    }
}
