//! Ultra Fractal's gradients: pairs such as `index=0 color=16777215`, with blue in the high bits.

use super::super::Rgb;
use super::super::gradient::{STOPS, Stop, mixed};
use super::{GradientFileError, bad_line};

/// Length of a gradient, which is cyclic, in index steps.
const LENGTH: f64 = 400.0;

/// Reads the gradient called `name`, or the first one.
pub(super) fn read(text: &str, name: Option<&str>) -> Result<Vec<Stop>, GradientFileError> {
    let gradients = gradients(text);
    let found = match name {
        None => gradients.first(),
        Some(name) => gradients.iter().find(|found| found.name.eq_ignore_ascii_case(name)),
    };
    match (found, name) {
        (Some(found), _) => found.stops(),
        (None, Some(name)) if !gradients.is_empty() => {
            let known: Vec<_> = gradients.iter().map(|gradient| gradient.name).collect();
            Err(GradientFileError::Name { name: name.to_string(), known: known.join(", ") })
        }
        _ => Err(GradientFileError::Format("has no section 'gradient:'")),
    }
}

/// A gradient's name and the lines of its section, with their numbers.
struct Gradient<'a> {
    name: &'a str,
    lines: Vec<(usize, &'a str)>,
}

/// Returns the gradients of a file: `name { gradient: … opacity: … }`.
fn gradients(text: &str) -> Vec<Gradient<'_>> {
    let mut gradients: Vec<Gradient> = Vec::new();
    let (mut name, mut inside) = ("", false);
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.trim();
        if let Some((before, _)) = text.split_once('{') {
            name = before.trim();
        }
        if text.ends_with("gradient:") {
            gradients.push(Gradient { name, lines: Vec::new() });
            inside = true;
        } else if text.starts_with('}') || text.ends_with(':') {
            inside = false;
        } else if let Some(gradient) = gradients.last_mut().filter(|_| inside) {
            gradient.lines.push((line, text));
        }
    }
    gradients
}

impl Gradient<'_> {
    /// Returns the stops of one full cycle.
    fn stops(&self) -> Result<Vec<Stop>, GradientFileError> {
        let mut known = self.known()?;
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (Some(&first), Some(&last)) = (known.first(), known.last()) else {
            return Err(GradientFileError::TooFew);
        };
        // The gradient is cyclic: between the last stop and the first lies its seam.
        let gap = first.0 + LENGTH - last.0;
        let seam = mixed(last.1, first.1, (LENGTH - last.0) / gap);
        if first.0 > 0.0 {
            known.insert(0, (0.0, seam));
        }
        known.push((LENGTH, seam));
        let stop = |(index, colour): (f64, Rgb)| Stop { place: index / LENGTH, colour };
        let stops: Vec<Stop> = known.into_iter().map(stop).collect();
        if stops.len() < *STOPS.start() { Err(GradientFileError::TooFew) } else { Ok(stops) }
    }

    /// Returns the stops as they are written: index and colour.
    fn known(&self) -> Result<Vec<(f64, Rgb)>, GradientFileError> {
        let mut stops = Vec::new();
        let mut index = None;
        for (line, text) in &self.lines {
            // A title can have spaces; a semicolon begins a comment.
            if ["title=", ";"].into_iter().any(|word| text.starts_with(word)) {
                continue;
            }
            for word in text.split_whitespace() {
                let bad = || bad_line((*line, word), "a whole number");
                let number = |value: &str| value.parse::<i64>().map_err(|_| bad());
                match word.split_once('=') {
                    Some(("index", value)) => {
                        if index.is_some() {
                            return Err(bad_line(
                                (*line, text),
                                "color=… after the index=… before",
                            ));
                        }
                        index = Some(number(value)?.rem_euclid(LENGTH as i64) as f64);
                    }
                    Some(("color", value)) => {
                        let [r, g, b, ..] = (number(value)? as u32).to_le_bytes();
                        let index = index
                            .take()
                            .ok_or_else(|| bad_line((*line, text), "index=… before its color=…"))?;
                        stops.push((index, [r, g, b]));
                    }
                    Some(("linked" | "numnodes" | "rotation" | "smooth", _)) => {}
                    _ => return Err(bad_line((*line, word), "index=… or color=…")),
                }
            }
        }
        Ok(stops)
    }
}
