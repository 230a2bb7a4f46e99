//! Colour tables of the Generic Mapping Tools: slices between two values, each with a colour at
//! either end (GMT's documentation, "Color palette tables").

use super::super::gradient::Stop;
use super::super::hsv::rgb_of;
use super::super::{Rgb, parse_colour};
use super::{GradientFileError, bad_line, lines};

const WANTED: &str = "a slice: value, colour, value, colour, the colours as 255/128/0, 255 128 0, \
                      #ff8000 or a name such as orange";
/// Number of steps of a slice between two hues.
const STEPS: u32 = 255;

/// A value with the colour there, as its three numbers in the file's own model.
type End = (f64, [f64; 3]);

/// Reads a colour table.
pub(super) fn read(text: &str) -> Result<Vec<Stop>, GradientFileError> {
    let is_hue = text.lines().any(|line| {
        let line = line.replace(' ', "").to_uppercase();
        line.starts_with("#COLOR_MODEL=") && line.ends_with("HSV")
    });
    let mut slices: Vec<[End; 2]> = Vec::new();
    for line in lines(text, &["#", "B", "F", "N"]) {
        let before = slices.last().map_or(f64::NEG_INFINITY, |slice| slice[1].0);
        let slice = slice(line.1, is_hue).filter(|[from, to]| from.0 >= before && to.0 > from.0);
        slices.push(slice.ok_or_else(|| bad_line(line, WANTED))?);
    }
    let (Some([first, _]), Some([_, last])) = (slices.first(), slices.last()) else {
        return Err(GradientFileError::TooFew);
    };
    let (first, length) = (first.0, last.0 - first.0);
    let steps = if is_hue { STEPS } else { 1 };
    let mut stops: Vec<Stop> = Vec::new();
    for [from, to] in slices {
        for step in 0..=steps {
            let share = f64::from(step) / f64::from(steps);
            let mixed = |from: f64, to: f64| from + (to - from) * share;
            let numbers = [0, 1, 2].map(|i| mixed(from.1[i], to.1[i]));
            let place = (mixed(from.0, to.0) - first) / length;
            let stop = Stop { place: place.clamp(0.0, 1.0), colour: colour(numbers, is_hue) };
            if stops.last() != Some(&stop) {
                stops.push(stop);
            }
        }
    }
    Ok(stops)
}

fn colour(numbers: [f64; 3], is_hue: bool) -> Rgb {
    let [h, s, v] = numbers;
    let rgb = if is_hue { rgb_of([h / 360.0, s, v]).map(|x| 255.0 * x) } else { numbers };
    rgb.map(|channel| channel.round().clamp(0.0, 255.0) as u8)
}

/// Reads the two ends of a slice; what follows them is a label.
fn slice(line: &str, is_hue: bool) -> Option<[End; 2]> {
    let line = line.split(';').next()?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let plain: Option<Vec<f64>> = words.iter().take(8).map(|word| word.parse().ok()).collect();
    let ends = match plain.as_deref() {
        Some([z0, a, b, c, z1, d, e, f]) => [(*z0, [*a, *b, *c]), (*z1, [*d, *e, *f])],
        _ => {
            let end = |place: usize| {
                let value = words.get(place)?.parse::<f64>().ok()?;
                Some((value, numbers(words.get(place + 1)?, is_hue)?))
            };
            [end(0)?, end(2)?]
        }
    };
    let most = if is_hue { [360.0, 1.0, 1.0] } else { [255.0; 3] };
    let fits = |end: &End| (0..3).all(|i| (0.0..=most[i]).contains(&end.1[i]));
    (ends.iter().all(|end| end.0.is_finite()) && ends.iter().all(fits)).then_some(ends)
}

/// Reads a colour written as one word.
fn numbers(word: &str, is_hue: bool) -> Option<[f64; 3]> {
    let parts: Vec<&str> = word.split(if is_hue { '-' } else { '/' }).collect();
    let parsed: Option<Vec<f64>> = parts.iter().map(|part| part.parse().ok()).collect();
    match parsed.as_deref() {
        Some([a, b, c]) => return Some([*a, *b, *c]),
        Some([grey]) if !is_hue => return Some([*grey; 3]),
        _ if is_hue => return None,
        _ => {}
    }
    let named =
        || NAMES.iter().find(|(name, _)| name.eq_ignore_ascii_case(word)).map(|named| named.1);
    parse_colour(word).or_else(named).map(|rgb| rgb.map(f64::from))
}

/// Names of colours that tables often use (X11's).
const NAMES: [(&str, Rgb); 16] = [
    ("black", [0; 3]),
    ("white", [255; 3]),
    ("gray", [190; 3]),
    ("grey", [190; 3]),
    ("red", [255, 0, 0]),
    ("green", [0, 255, 0]),
    ("blue", [0, 0, 255]),
    ("yellow", [255, 255, 0]),
    ("cyan", [0, 255, 255]),
    ("magenta", [255, 0, 255]),
    ("orange", [255, 165, 0]),
    ("brown", [165, 42, 42]),
    ("purple", [160, 32, 240]),
    ("pink", [255, 192, 203]),
    ("navy", [0, 0, 128]),
    ("darkgreen", [0, 100, 0]),
];
