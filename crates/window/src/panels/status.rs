//! The line below the map: the view, its progress, and the engine that computes it.

use egui::{ProgressBar, Ui};

use flipmap_engine::{DepthStats, Precision};
use flipmap_render::tiles::explorer::ViewProgress;

/// The content of the line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StatusLine {
    /// The progress of the view.
    pub progress: ViewProgress,
    /// Seconds until the view is complete, if they can be estimated.
    pub left_secs: Option<f64>,
    /// Width of the view in `unit`.
    pub width: f64,
    /// Unit of the horizontal axis.
    pub unit: &'static str,
    /// Recent number of starts integrated per second; 0 while nothing is computed.
    pub rate: f64,
    /// Number of starts integrated since the window was opened.
    pub simulated: u64,
    /// Facts about a deep view's depth: a short text, and the full one.
    pub depth: Option<(String, String)>,
    /// A warning about the view, if it needs one: a short text, and the full one.
    pub warning: Option<(String, String)>,
    /// The longer task in progress.
    pub doing: Option<String>,
    /// The engine with its integrator config, or its state while there is none.
    pub engine: String,
}

/// Shows the line.
pub fn status_line(ui: &mut Ui, status: &StatusLine) {
    ui.horizontal(|ui| {
        let ViewProgress { level, share, .. } = status.progress;
        let percent = format!("{:.0} %", (100.0 * share).floor());
        let bar = ProgressBar::new(share as f32).desired_width(90.0).text(percent);
        ui.add(bar).on_hover_text("Share of the view's samples that are computed");
        if let Some(secs) = status.left_secs {
            ui.label(left_words(secs)).on_hover_text("Until the view is complete, at this pace");
        }
        ui.label(format!("level {level}"));
        ui.separator();
        ui.label(width_text(status.width, status.unit));
        if let Some((short, whole)) = &status.depth {
            ui.separator();
            ui.label(short).on_hover_text(whole);
        }
        if let Some((short, whole)) = &status.warning {
            ui.separator();
            ui.colored_label(ui.visuals().warn_fg_color, short).on_hover_text(whole);
        }
        if let Some(doing) = &status.doing {
            ui.separator();
            ui.label(doing);
        }
        ui.separator();
        ui.label(format!("{} pendulums", grouped(status.simulated)));
        if status.rate > 0.0 {
            ui.label(format!("{}/s", short(status.rate)));
        }
        ui.separator();
        ui.add(egui::Label::new(&status.engine).truncate());
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
        let ends = depth.structure_ends_at(budget_secs);
        format!(
            "Cells are followed as polynomials to {first:.1} to {last:.1} s, and their pixels from \
             there in {precision}: to be trusted {horizon}. Neighbours move apart by \
             {:.2} decades a second, so within {budget_secs:.0} s there is structure down to widths \
             of {ends:.0e} rad.",
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
    if width >= 1e-3 {
        format!("{width:.4} {unit} wide")
    } else {
        format!("{width:.3e} {unit} wide")
    }
}

/// Formats a count with thin spaces between its thousands.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// Formats a rate in thousands or millions.
fn short(rate: f64) -> String {
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
    fn counts_are_easy_to_read() {
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1_234_567), "1\u{2009}234\u{2009}567");
        assert_eq!(
            (short(12.3), short(45_678.0), short(2.35e6)),
            ("12".into(), "46 k".into(), "2.4 M".into())
        );
    }
}
