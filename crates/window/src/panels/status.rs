//! The line below the map: the view, its progress, and the engine that computes it.

use egui::{ProgressBar, Ui};

use flipmap_engine::{DepthStats, Precision};
use flipmap_numbers::number_text::{fixed, significant};
use flipmap_render::tiles::explorer::ViewProgress;

/// The content of the line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StatusLine {
    /// The progress of the view.
    pub progress: ViewProgress,
    /// Seconds until the view is at rest, if they can be estimated.
    pub left_secs: Option<f64>,
    /// What is asked of each start.
    pub asks: &'static str,
    /// Width of the view in `unit`.
    pub width: f64,
    /// Unit of the horizontal axis.
    pub unit: &'static str,
    /// How sure the answers are: a short text, and the full one with the engine.
    pub sure: (String, String),
    /// Facts about a deep view's depth: a short text, and the full one.
    pub depth: Option<(String, String)>,
    /// A warning about the view, if it needs one: a short text, and the full one.
    pub warning: Option<(String, String)>,
    /// The longer task in progress.
    pub doing: Option<String>,
}

/// Shows the line.
pub fn status_line(ui: &mut Ui, status: &StatusLine) {
    ui.horizontal(|ui| {
        let way = status.progress.way;
        let percent = format!("{:.0} %", (100.0 * way).floor());
        let bar = ProgressBar::new(way as f32).desired_width(88.0).text(percent);
        ui.add(bar).on_hover_text("How much of the map is done, smooth edges included");
        if let Some(secs) = status.left_secs {
            ui.label(left_words(secs)).on_hover_text("Until the map is done, at this pace");
        }
        ui.separator();
        ui.label(status.asks);
        ui.separator();
        ui.label(width_text(status.width, status.unit));
        ui.separator();
        let mut told = |(short, whole): &(String, String), warns: bool| {
            let text = egui::RichText::new(short);
            let text = if warns { text.color(ui.visuals().warn_fg_color) } else { text };
            ui.label(text).on_hover_text(whole);
        };
        told(&status.sure, false);
        if let Some(warning) = &status.warning {
            told(warning, true);
        }
        if let Some((_, whole)) = &status.depth {
            told(&("deep".to_string(), whole.clone()), false);
        }
        if let Some(doing) = &status.doing {
            ui.separator();
            ui.add(egui::Label::new(doing).truncate());
        }
    });
}

/// Describes a view's depth in digits and seconds: a short text, and the full one.
pub(crate) fn depth_words(
    depth: &DepthStats,
    precision: Precision,
    budget_secs: f64,
) -> (String, String) {
    let [first, last] = depth.begins_secs;
    let short = format!("{} digits · budget {budget_secs:.0} s", depth.digits);
    let began = if depth.integrated == 0 {
        "All of it is known from polynomials.".to_string()
    } else {
        let horizon = depth.horizon_words(precision);
        let ends = significant(depth.structure_ends_at(budget_secs), 1);
        format!(
            "Cells are followed as polynomials to {first:.1} to {last:.1} s, and their pixels from \
             there in {precision}: to be trusted {horizon}. Neighbours move apart by \
             {:.2} decades a second, so within {budget_secs:.0} s there is structure down to widths \
             of {ends} rad.",
            depth.decades_a_second
        )
    };
    (short, format!("The cells' middles are followed in {} digits. {began}", depth.digits))
}

/// Describes the time that is left, in whole seconds, minutes or hours.
fn left_words(secs: f64) -> String {
    match secs {
        s if s < 1.0 => "a moment left".to_string(),
        s if s < 59.5 => format!("{s:.0} s left"),
        s if s < 3570.0 => format!("{:.0} min left", s / 60.0),
        s => format!("{:.0} h left", s / 3600.0),
    }
}

/// Formats a width, in powers of ten if it is small.
fn width_text(width: f64, unit: &str) -> String {
    let number = if width >= 1e-3 { fixed(width, 4) } else { significant(width, 4) };
    format!("{number} {unit} wide")
}

/// Formats a rate in thousands or millions.
pub(crate) fn short(rate: f64) -> String {
    match rate {
        r if r >= 1e6 => format!("{:.1} M", r / 1e6),
        r if r >= 1e3 => format!("{:.0} k", r / 1e3),
        r => format!("{r:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_told_in_the_unit_that_fits() {
        let words = [0.3, 12.4, 59.4, 59.6, 600.0, 3600.0, 40_000.0].map(left_words);
        let wanted = ["a moment", "12 s", "59 s", "1 min", "10 min", "1 h", "11 h"];
        assert_eq!(words, wanted.map(|left| format!("{left} left")));
    }

    #[test]
    fn widths_and_rates_are_easy_to_read() {
        assert_eq!(width_text(0.5, "rad"), "0.5000 rad wide");
        assert_eq!(width_text(1.5e-7, "rad"), "1.5\u{2009}×\u{2009}10⁻⁷ rad wide");
        assert_eq!(
            (short(12.3), short(45_678.0), short(2.35e6)),
            ("12".into(), "46 k".into(), "2.4 M".into())
        );
    }
}
