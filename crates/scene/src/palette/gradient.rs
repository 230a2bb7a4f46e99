//! Custom gradients: lists of colours in scenes and options, and gradient files of other programs.

use super::Rgb;

/// Allowed number of colours in a list.
pub const STOPS: std::ops::RangeInclusive<usize> = 2..=256;
/// File name extensions of gradients: Fractint's maps, Ultra Fractal's gradients and GIMP's
/// palettes.
pub const ENDINGS: [&str; 3] = ["map", "ugr", "gpl"];
/// Number of colours in a table that is made from a gradient.
const TABLE: usize = 256;
/// Length of Ultra Fractal's gradients, which are cyclic, in index steps.
const UGR_LENGTH: f64 = 400.0;

/// Reads a list of colours such as `#000000,#ff8000,#ffffff`, evenly spaced from early to late.
pub fn parse_list(text: &str) -> Option<Vec<Rgb>> {
    let stops: Option<Vec<Rgb>> =
        text.split(',').map(|stop| super::parse_colour(stop.trim())).collect();
    stops.filter(|stops| STOPS.contains(&stops.len()))
}

/// Formats colours as a list that [`parse_list`] reads.
pub fn list_text(stops: &[Rgb]) -> String {
    stops.iter().map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}")).collect::<Vec<_>>().join(",")
}

/// Interpolates evenly spaced stops to a table of colours.
pub(super) fn table(stops: &[Rgb]) -> Vec<Rgb> {
    let last = (stops.len() - 1) as f64;
    let at = |k: usize| k as f64 / (TABLE - 1) as f64 * last;
    (0..TABLE).map(|k| between(stops, at(k))).collect()
}

/// Returns the colour at `place` among stops spaced 1 apart. It interpolates sRGB values, as do the
/// programs that such gradients come from.
fn between(stops: &[Rgb], place: f64) -> Rgb {
    let first = (place.floor() as usize).min(stops.len() - 1);
    let next = (first + 1).min(stops.len() - 1);
    mixed(stops[first], stops[next], place - first as f64)
}

fn mixed(a: Rgb, b: Rgb, share: f64) -> Rgb {
    [0, 1, 2].map(|i| (f64::from(a[i]) * (1.0 - share) + f64::from(b[i]) * share).round() as u8)
}

/// Reads the colours of a gradient file with this extension (see [`ENDINGS`]), and only the first
/// gradient if it has several. The error says what is missing.
pub fn parse_file(ending: &str, text: &str) -> Result<Vec<Rgb>, &'static str> {
    match ending {
        "map" => few(rows(text.lines())),
        "gpl" => {
            let mut lines = text.lines();
            if lines.next().map(str::trim) != Some("GIMP Palette") {
                return Err("it does not begin with 'GIMP Palette'");
            }
            few(rows(lines))
        }
        _ => ugr(text),
    }
}

/// Reads the colours of those lines that begin with three numbers from 0 to 255.
fn rows<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<Rgb> {
    let row = |line: &str| {
        let mut words = line.split_whitespace();
        let mut channel = || words.next()?.parse::<u8>().ok();
        Some([channel()?, channel()?, channel()?])
    };
    lines.filter_map(row).collect()
}

fn few(stops: Vec<Rgb>) -> Result<Vec<Rgb>, &'static str> {
    match stops.len() {
        0 | 1 => Err("it holds fewer than two colours"),
        length if length > *STOPS.end() => Ok((0..TABLE)
            .map(|k| between(&stops, k as f64 / (TABLE - 1) as f64 * (length - 1) as f64))
            .collect()),
        _ => Ok(stops),
    }
}

/// Reads Ultra Fractal's pairs such as `index=0 color=16777215`, with blue in the high bits, and
/// samples one full cycle.
fn ugr(text: &str) -> Result<Vec<Rgb>, &'static str> {
    let section = text.split("gradient:").nth(1).ok_or("it has no section 'gradient:'")?;
    let section = section.split(['}', '\u{0}']).next().unwrap_or_default();
    let section = section.split("opacity:").next().unwrap_or_default();
    let mut stops: Vec<(f64, Rgb)> = Vec::new();
    let mut index = None;
    for (key, value) in section.split_whitespace().filter_map(|word| word.split_once('=')) {
        match (key, value.parse::<i64>()) {
            ("index", Ok(value)) => index = Some(value.rem_euclid(UGR_LENGTH as i64) as f64),
            ("color", Ok(value)) => {
                let [r, g, b, ..] = (value as u32).to_le_bytes();
                stops.extend(index.take().map(|index| (index, [r, g, b])));
            }
            _ => {}
        }
    }
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(&first), Some(&last)) = (stops.first(), stops.last()) else {
        return Err("its gradient has no colours");
    };
    // The gradient is cyclic: the last stop also precedes the first, and the first follows the
    // last.
    stops.insert(0, (last.0 - UGR_LENGTH, last.1));
    stops.push((first.0 + UGR_LENGTH, first.1));
    let at = |place: f64| {
        let next = stops.iter().position(|stop| stop.0 > place).unwrap_or(stops.len() - 1);
        let (a, b) = (stops[next.max(1) - 1], stops[next]);
        mixed(a.1, b.1, (place - a.0) / (b.0 - a.0).max(f64::MIN_POSITIVE))
    };
    Ok((0..TABLE).map(|k| at(k as f64 / (TABLE - 1) as f64 * UGR_LENGTH)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_comes_back_and_is_mixed_evenly() {
        let stops = parse_list("#000000, #ff8000,#FFFFFF").unwrap();
        assert_eq!(list_text(&stops), "#000000,#ff8000,#ffffff");
        let table = table(&stops);
        assert_eq!((table[0], table[255]), ([0; 3], [255; 3]));
        assert!(table[127][0].abs_diff(254) <= 1 && table[127][2] <= 1, "{:?}", table[127]);
        for wrong in ["", "#000000", "#000000,red", "#000000,#12345", &"#000000,".repeat(300)] {
            assert_eq!(parse_list(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn files_of_other_programs_are_read() {
        let map = "  0   0   0   made by hand\n255 128 0\n\nnot a colour\n255 255 255\n";
        assert_eq!(parse_file("map", map), Ok(vec![[0; 3], [255, 128, 0], [255; 3]]));
        let gpl = "GIMP Palette\nName: two\nColumns: 2\n# a comment\n 10  20 30\tink\n1 2 3 x\n";
        assert_eq!(parse_file("gpl", gpl), Ok(vec![[10, 20, 30], [1, 2, 3]]));
        let ugr = "red {\ngradient:\n  title=\"red\" smooth=no\n  index=0 color=255\n  \
                   index=200 color=16711680\nopacity:\n  index=0 opacity=255\n}\nother {}\n";
        let stops = parse_file("ugr", ugr).unwrap();
        assert_eq!((stops[0], stops[255]), ([255, 0, 0], [255, 0, 0]), "the end is the beginning");
        assert!(stops[128][2] > 250 && stops[64][0].abs_diff(128) < 3, "{:?}", stops[64]);
        let long = "1 2 3\n".repeat(1000);
        assert_eq!(parse_file("map", &long).unwrap().len(), 256);
    }

    #[test]
    fn files_without_colours_say_what_is_missing() {
        for (ending, text, why) in [
            ("map", "300 0 0\n1 2 3\n", "fewer than two"),
            ("gpl", "1 2 3\n4 5 6\n", "GIMP Palette"),
            ("ugr", "nothing", "gradient:"),
            ("ugr", "gradient:\n color=7", "no colours"),
        ] {
            assert!(parse_file(ending, text).unwrap_err().contains(why), "{text}");
        }
        let odd = "gradient: index=-9223372036854775808 color=-1 index=9 color=9";
        assert_eq!(parse_file("ugr", odd).unwrap().len(), 256);
    }
}
