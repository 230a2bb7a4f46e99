//! Custom gradients: lists of colours in scenes and options.

use super::Rgb;

/// Allowed number of colours in a list.
pub const STOPS: std::ops::RangeInclusive<usize> = 2..=256;
/// Number of colours in a table that is made from a gradient.
const TABLE: usize = 256;

/// A colour of a gradient at its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Place from 0, the first colour of the palette, to 1, the last.
    pub place: f64,
    /// The colour there.
    pub colour: Rgb,
}

/// Returns colours as stops, evenly spaced.
pub fn even(colours: &[Rgb]) -> Vec<Stop> {
    let last = colours.len().saturating_sub(1).max(1) as f64;
    let stop = |(k, colour): (usize, &Rgb)| Stop { place: k as f64 / last, colour: *colour };
    colours.iter().enumerate().map(stop).collect()
}

/// Reasons why a text is not a list of colours.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ListError {
    /// An entry that is not a colour with an optional place.
    #[error("'{0}' in it is not a colour such as #ff8000, or #ff8000 30% for its place")]
    Entry(String),
    /// Too few or too many colours.
    #[error("a list is {least} to {most} colours from early to late, separated by commas, not {0}",
        least = STOPS.start(), most = STOPS.end())]
    Count(usize),
    /// Places outside of 0 to 100 %, or that fall.
    #[error("the places in it must lie between 0 and 100 % and must not fall")]
    Places,
}

/// Reads a list of colours from early to late, such as `#000000,#ff8000 30%,#ffffff`. As in the
/// gradients of CSS, the first is at 0 % and the last at 100 % unless they say otherwise, and others
/// without a place are evenly spaced between their neighbours. Places must not fall.
pub fn parse_list(text: &str) -> Result<Vec<Stop>, ListError> {
    let entry = |part: &str| parse_stop(part).ok_or_else(|| ListError::Entry(part.to_string()));
    let mut parts = text.split(',').map(entry).collect::<Result<Vec<_>, _>>()?;
    if !STOPS.contains(&parts.len()) {
        return Err(ListError::Count(parts.len()));
    }
    let last = parts.len() - 1;
    parts[0].1.get_or_insert(0.0);
    parts[last].1.get_or_insert(1.0);
    let mut stops: Vec<Stop> = Vec::with_capacity(parts.len());
    for (k, (colour, place)) in parts.iter().enumerate() {
        let place = place.or_else(|| {
            let before = stops.last()?.place;
            let next = (k..=last).find(|next| parts[*next].1.is_some())?;
            Some(before + (parts[next].1? - before) / (next - k + 1) as f64)
        });
        stops.push(Stop { place: place.ok_or(ListError::Places)?, colour: *colour });
    }
    let known = |stop: &Stop| (0.0..=1.0).contains(&stop.place);
    let is_fine = stops.iter().all(known) && stops.is_sorted_by(|a, b| a.place <= b.place);
    if is_fine { Ok(stops) } else { Err(ListError::Places) }
}

/// Reads a colour with an optional place such as `30%`.
fn parse_stop(text: &str) -> Option<(Rgb, Option<f64>)> {
    let mut words = text.split_whitespace();
    let colour = super::parse_colour(words.next()?)?;
    let place = words.next().map(|word| word.strip_suffix('%')?.parse::<f64>().ok());
    match (place, words.next()) {
        (None, None) => Some((colour, None)),
        (Some(Some(percent)), None) => Some((colour, Some(percent / 100.0))),
        _ => None,
    }
}

/// Formats stops as a list that [`parse_list`] reads, with places to the ten thousandth of a percent
/// unless they are evenly spaced.
pub fn list_text(stops: &[Stop]) -> String {
    let last = stops.len().saturating_sub(1).max(1) as f64;
    let is_even = |(k, stop): (usize, &Stop)| (stop.place - k as f64 / last).abs() < 1e-9;
    let all_even = stops.iter().enumerate().all(is_even);
    let text = |stop: &Stop| {
        let [r, g, b] = stop.colour;
        let place = (1e6 * stop.place).round() / 1e4;
        let place = if all_even { String::new() } else { format!(" {place}%") };
        format!("#{r:02x}{g:02x}{b:02x}{place}")
    };
    stops.iter().map(text).collect::<Vec<_>>().join(",")
}

/// Returns the colour of stops at a place. It interpolates sRGB values, as do the programs that such
/// gradients come from.
pub fn colour_at(stops: &[Stop], place: f64) -> Rgb {
    let next = stops.partition_point(|stop| stop.place <= place).clamp(1, stops.len() - 1);
    let [from, to] = [stops[next - 1], stops[next]];
    let share =
        ((place - from.place) / (to.place - from.place).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    mixed(from.colour, to.colour, share)
}

/// Interpolates stops to a table of colours.
pub(super) fn table(stops: &[Stop]) -> Vec<Rgb> {
    (0..TABLE).map(|k| colour_at(stops, k as f64 / (TABLE - 1) as f64)).collect()
}

pub(super) fn mixed(a: Rgb, b: Rgb, share: f64) -> Rgb {
    [0, 1, 2].map(|i| (f64::from(a[i]) * (1.0 - share) + f64::from(b[i]) * share).round() as u8)
}

/// Returns stops, at most as many as a list may have: evenly spaced colours of theirs if they are
/// more.
pub(super) fn few(stops: Vec<Stop>) -> Vec<Stop> {
    if stops.len() <= *STOPS.end() { stops } else { even(&table(&stops)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_comes_back_and_is_mixed_evenly() {
        let stops = parse_list("#000000, #f80,#FFFFFF").unwrap();
        assert_eq!(list_text(&stops), "#000000,#ff8800,#ffffff");
        let table = table(&stops);
        assert_eq!((table[0], table[255]), ([0; 3], [255; 3]));
        assert!(table[127][0].abs_diff(254) <= 1 && table[127][2] <= 1, "{:?}", table[127]);
        for wrong in ["", "#000000", "#000000,red", "#000000,#12345", &"#000000,".repeat(300)] {
            assert!(parse_list(wrong).is_err(), "{wrong}");
        }
        let said = |wrong: &str| parse_list(wrong).unwrap_err().to_string();
        assert!(said("#000000,#12345,#fff").starts_with("'#12345' in it is not a colour"));
        assert!(said("#000000").ends_with("separated by commas, not 1"));
    }

    #[test]
    fn places_follow_the_rules_of_css() {
        let places = |text: &str| -> Option<Vec<f64>> {
            Some(parse_list(text).ok()?.iter().map(|stop| stop.place).collect())
        };
        assert_eq!(places("#000,#f00 25%,#0f0,#fff"), Some(vec![0.0, 0.25, 0.625, 1.0]));
        assert_eq!(places("#000 10%,#fff 10%,#00f 50%"), Some(vec![0.1, 0.1, 0.5]));
        for wrong in [
            "#000 50%,#fff 20%",
            "#000,#fff 120%",
            "#000 -1%,#fff",
            "#000 5,#fff",
            "#000 NaN%,#fff",
        ] {
            assert_eq!(places(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn stops_with_places_come_back() {
        let text = "#000000 0%,#ff0000 20.5%,#ffffff 100%";
        let stops = parse_list(text).unwrap();
        assert_eq!(list_text(&stops), text);
        assert_eq!(colour_at(&stops, 0.1025), [128, 0, 0]);
        let edge = parse_list("#000000 50%,#ffffff 50%").unwrap();
        assert_eq!([0.49, 0.51].map(|place| colour_at(&edge, place)[0]), [0, 255], "a sharp edge");
    }

    #[test]
    fn gradients_with_more_stops_than_a_list_keep_their_ends() {
        let many: Vec<Rgb> = (0..1000).map(|k| [(k / 4) as u8; 3]).collect();
        let few = few(even(&many));
        assert_eq!((few.len(), few[0].colour, few[255].colour), (256, [0; 3], [249; 3]));
    }
}
