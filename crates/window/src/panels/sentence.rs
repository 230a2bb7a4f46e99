//! Sentences from lower crates, which put names of settings in backquotes.

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId, TextStyle, Ui};

/// Lays out a sentence in a colour. Text in backquotes becomes monospaced and loses the quotes.
pub(super) fn sentence(ui: &Ui, text: &str, colour: Color32) -> LayoutJob {
    let mut job = LayoutJob::default();
    let font = |style: TextStyle| -> FontId { style.resolve(ui.style()) };
    for (part, style) in parts(text) {
        job.append(part, 0.0, TextFormat::simple(font(style), colour));
    }
    job
}

/// Returns the parts of a sentence with their styles. A backquote without a partner is part of the
/// text.
fn parts(text: &str) -> Vec<(&str, TextStyle)> {
    let mut parts = Vec::new();
    let mut rest = text;
    while let Some((before, name, after)) = quoted(rest) {
        parts.extend([(before, TextStyle::Body), (name, TextStyle::Monospace)]);
        rest = after;
    }
    parts.push((rest, TextStyle::Body));
    parts.retain(|(part, _)| !part.is_empty());
    parts
}

/// Returns the text before the first name, the name, and the text after it.
fn quoted(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once('`')?;
    let (name, after) = rest.split_once('`')?;
    Some((before, name, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_monospaced_without_their_quotes() {
        let told = |text| parts(text).into_iter().map(|(part, _)| part).collect::<Vec<_>>();
        assert_eq!(told("`width` is '0': from 1"), ["width", " is '0': from 1"]);
        assert_eq!(parts("`width`")[0].1, TextStyle::Monospace);
        assert_eq!(told("use `at` or `count`."), ["use ", "at", " or ", "count", "."]);
        assert_eq!(told("a ` alone"), ["a ` alone"]);
        assert!(told("").is_empty());
    }
}
