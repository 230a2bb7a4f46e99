//! The separation from the ghost against time, on a logarithmic axis.

use egui::emath::RectTransform;
use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2,
    vec2,
};

use super::facts::round_secs;
use super::{CANVAS, FAINT, INK};
use crate::app::pins::Pin;
use crate::lab::chart::round_step;
use crate::physics::separation::{Growth, Reading, reading_at};

const HEIGHT: f32 = 110.0;
/// Space for the numbers to the left of the plot and below it, in points.
const MARGIN: egui::Vec2 = vec2(38.0, 16.0);
/// Greatest number of points of the curve; more could not be told apart.
const MOST_POINTS: usize = 400;

/// Shows the plot with the current time marked, and the growth rate in words.
pub(super) fn separation(ui: &mut Ui, pin: &Pin) {
    let record = pin.flight.record();
    let growth = Growth::fit(&record.readings);
    ui.label(words(&record.readings, growth, pin.shown_secs()));
    let (response, painter) =
        ui.allocate_painter(vec2(ui.available_width(), HEIGHT), Sense::hover());
    response.widget_info(|| {
        let name = "Separation in rad from the pendulum one pixel away, against time in s";
        WidgetInfo::labeled(Role::Image, true, name)
    });
    response.clone().on_hover_text(
        "How far apart the two pendulums are in phase space: angles in rad, speeds in rad per \
         natural unit of time. The dashed line is the fitted growth.",
    );
    let Some(axes) = Axes::new(response.rect, &record.readings, record.end_secs()) else { return };
    axes.frame(&painter, ui.visuals().text_color());
    let curve = axes.curve(&record.readings);
    painter.add(Shape::line(curve, Stroke::new(1.5, pin.badge.colour())));
    if let Some(growth) = growth {
        let ends = [0.0, growth.until_secs].map(|t| axes.place(t, growth.separation_rad(t)));
        let stroke = Stroke::new(1.0, INK);
        painter.extend(Shape::dashed_line(&ends, stroke, 4.0, 3.0));
    }
    axes.now(&painter, &record.readings, pin.shown_secs());
}

/// Describes the separation at `secs` and its growth rate.
fn words(readings: &[Reading], growth: Option<Growth>, secs: f64) -> String {
    let now = reading_at(readings, secs).map_or(0.0, |reading| reading.separation_rad);
    let grows = match growth {
        Some(Growth { rate_per_sec, until_secs, .. }) => {
            // Adding 0 after rounding avoids "-0.00".
            let rate = (rate_per_sec * 100.0).round() / 100.0 + 0.0;
            format!("grows at {rate:.2} 1/s up to {} s", round_secs(until_secs))
        }
        None => "no growth rate can be told".into(),
    };
    format!("Separation {} rad; {grows}", short(now))
}

/// Formats a value with two digits, in plain notation where that is readable.
fn short(value: f64) -> String {
    if (0.01..1000.0).contains(&value) { format!("{value:.2}") } else { format!("{value:.1e}") }
}

/// The plot's axes: seconds to the right, decades up.
struct Axes {
    area: Rect,
    decades: [i32; 2],
    end_secs: f64,
    to_screen: RectTransform,
}

impl Axes {
    /// Creates the axes; none while there is nothing to plot.
    fn new(rect: Rect, readings: &[Reading], end_secs: f64) -> Option<Axes> {
        let logs = readings.iter().map(|r| r.separation_rad.log10()).filter(|log| log.is_finite());
        let [low, high] = logs.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], log| {
            [low.min(log), high.max(log)]
        });
        if end_secs <= 0.0 || low > high {
            return None;
        }
        let decades = [low.floor() as i32, (high.ceil() as i32).max(low.floor() as i32 + 1)];
        let area =
            Rect::from_min_max(rect.min + vec2(MARGIN.x, 4.0), rect.max - vec2(8.0, MARGIN.y));
        let unit = Rect::from_min_max(
            pos2(0.0, -decades[1] as f32),
            pos2(end_secs as f32, -decades[0] as f32),
        );
        Some(Axes { area, decades, end_secs, to_screen: RectTransform::from_to(unit, area) })
    }

    fn place(&self, secs: f64, separation_rad: f64) -> Pos2 {
        let log = separation_rad.log10().clamp(self.decades[0].into(), self.decades[1].into());
        self.to_screen.transform_pos(pos2(secs as f32, -log as f32))
    }

    fn curve(&self, readings: &[Reading]) -> Vec<Pos2> {
        let seen = readings.iter().filter(|reading| reading.separation_rad > 0.0);
        let stride = readings.len().div_ceil(MOST_POINTS).max(1);
        seen.step_by(stride).map(|r| self.place(r.secs, r.separation_rad)).collect()
    }

    /// Draws the area, its gridlines and their numbers.
    fn frame(&self, painter: &Painter, text: Color32) {
        let grid = Stroke::new(1.0, FAINT.gamma_multiply(0.4));
        let font = FontId::proportional(10.0);
        painter.rect_filled(self.area, 0.0, CANVAS);
        let [low, high] = self.decades;
        let step = ((high - low) as usize).div_ceil(4).max(1);
        for decade in (low..=high).step_by(step) {
            let y = self.place(0.0, 10f64.powi(decade)).y;
            painter.hline(self.area.x_range(), y, grid);
            let words = format!("1e{decade}");
            let at = pos2(self.area.left() - 4.0, y);
            painter.text(at, Align2::RIGHT_CENTER, words, font.clone(), text);
        }
        let step_secs = round_step(self.end_secs / 5.0);
        for tick in 0..=(self.end_secs / step_secs + 1e-9) as u32 {
            let secs = f64::from(tick) * step_secs;
            let at = pos2(self.place(secs, 1.0).x, self.area.bottom() + 2.0);
            painter.vline(at.x, self.area.y_range(), grid);
            let unit = if tick == 0 { " s" } else { "" };
            let words = format!("{}{unit}", round_secs(secs));
            painter.text(at, Align2::CENTER_TOP, words, font.clone(), text);
        }
    }

    /// Draws the current time: a vertical line, and a dot on the curve.
    fn now(&self, painter: &Painter, readings: &[Reading], secs: f64) {
        let Some(reading) = reading_at(readings, secs) else { return };
        let at = self.place(secs, reading.separation_rad);
        painter.vline(at.x, self.area.y_range(), Stroke::new(1.0, INK));
        painter.circle_filled(at, 3.0, INK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        let steps = [6.0, 0.9, 2.0, 130.0, 0.03].map(round_step);
        for (step, expected) in steps.into_iter().zip([10.0, 1.0, 2.0, 200.0, 0.05]) {
            assert!((step / expected - 1.0).abs() < 1e-12, "{step} for {expected}");
        }
    }

    #[test]
    fn the_axes_span_whole_decades_and_the_curve_stays_inside() {
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(300.0, HEIGHT));
        let reading =
            |secs: f64, separation_rad| Reading { secs, energy_error: 0.0, separation_rad };
        let readings: Vec<Reading> =
            (0..5000).map(|i| reading(f64::from(i) / 100.0, 3e-7 * f64::from(i + 1))).collect();
        let axes = Axes::new(rect, &readings, 50.0).expect("something to plot");
        assert_eq!(axes.decades, [-7, -2]);
        let curve = axes.curve(&readings);
        assert!(curve.len() <= MOST_POINTS && curve.len() > MOST_POINTS / 2);
        assert!(curve.iter().all(|&at| axes.area.expand(0.01).contains(at)));
        assert!(curve[0].y > curve[curve.len() - 1].y && curve[0].x < curve[curve.len() - 1].x);
        assert!(Axes::new(rect, &[reading(0.0, 0.0)], 50.0).is_none(), "two that never part");
    }
}
