//! Files of one colour in each line: Fractint's maps, GIMP's and Paint Shop Pro's palettes.

use super::super::gradient::{Stop, even};
use super::super::{Rgb, parse_colour};
use super::{GradientFileError, bad_line, lines};

/// Signs with which a comment begins; a sign # may also begin a colour.
const COMMENTS: [&str; 3] = [";", "//", "# "];
const ROW: &str = "red, green and blue from 0 to 255, or a colour such as #ff8000";

/// Reads Fractint's maps.
pub(super) fn map(text: &str) -> Result<Vec<Stop>, GradientFileError> {
    rows(lines(text, &COMMENTS))
}

/// Reads GIMP's palettes.
pub(super) fn gpl(text: &str) -> Result<Vec<Stop>, GradientFileError> {
    let mut rest = lines(text, &["#", "Name:", "Columns:", "Channels:"]);
    match rest.next() {
        Some((_, "GIMP Palette")) => rows(rest),
        _ => Err(GradientFileError::Format("does not begin with 'GIMP Palette'")),
    }
}

/// Reads Paint Shop Pro's palettes.
pub(super) fn pal(text: &str) -> Result<Vec<Stop>, GradientFileError> {
    let mut rest = lines(text, &[]);
    if rest.next().is_none_or(|(_, first)| first != "JASC-PAL") {
        return Err(GradientFileError::Format("does not begin with 'JASC-PAL'"));
    }
    let mut number = || rest.next().and_then(|(_, text)| text.parse::<usize>().ok());
    let (Some(_), Some(announced)) = (number(), number()) else {
        return Err(GradientFileError::Format("does not say how many colours it has"));
    };
    let stops = rows(rest)?;
    let found = stops.len();
    if found != announced {
        return Err(GradientFileError::Count { of_what: "colours", announced, found });
    }
    Ok(stops)
}

fn rows<'a>(lines: impl Iterator<Item = (usize, &'a str)>) -> Result<Vec<Stop>, GradientFileError> {
    let colours: Result<Vec<Rgb>, _> =
        lines.map(|line| row(line.1).ok_or_else(|| bad_line(line, ROW))).collect();
    Ok(even(&colours?))
}

/// Reads the colour that a line begins with; the rest of it is a comment.
fn row(line: &str) -> Option<Rgb> {
    let mut words = line.split(|sign: char| sign.is_whitespace() || sign == ',');
    let mut words = words.by_ref().filter(|word| !word.is_empty());
    let first = words.next()?;
    if first.starts_with('#') {
        return parse_colour(first);
    }
    Some([first.parse().ok()?, words.next()?.parse().ok()?, words.next()?.parse().ok()?])
}
