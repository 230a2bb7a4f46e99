//! Gradient files of other programs.

mod cpt;
mod ggr;
mod rows;
mod ugr;

use std::borrow::Cow;

use super::gradient::{STOPS, Stop, few};

/// File name extensions of gradients: Fractint's maps, Ultra Fractal's gradients, GIMP's palettes and
/// gradients, Paint Shop Pro's palettes, and the colour tables of the Generic Mapping Tools.
pub const ENDINGS: [&str; 6] = ["map", "ugr", "gpl", "ggr", "pal", "cpt"];

/// A reason why a file gives no gradient, as the end of a sentence that begins with its path.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GradientFileError {
    /// The file lacks what its format begins with.
    #[error("is not a gradient: it {0}")]
    Format(&'static str),
    /// A line that its format does not have.
    #[error("line {line} is '{text}'; it must be {wanted}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// The line as it is written.
        text: String,
        /// What the format has there.
        wanted: &'static str,
    },
    /// The file ends, or says that it does, with another number of lines than it announces.
    #[error("announces {announced} {of_what} and has {found}")]
    Count {
        /// What is counted.
        of_what: &'static str,
        /// The number announced.
        announced: usize,
        /// The number found.
        found: usize,
    },
    /// A name that none of the file's gradients has.
    #[error("has no gradient '{name}'; its gradients are {known}")]
    Name {
        /// The name asked for.
        name: String,
        /// Names of the gradients in the file.
        known: String,
    },
    /// Fewer than two colours.
    #[error("is not a gradient: it has fewer than {} colours", STOPS.start())]
    TooFew,
}

/// The lines of a file with their numbers from 1, trimmed; empty ones and those that begin with one
/// of the signs of a comment are left out.
fn lines<'a>(
    text: &'a str,
    comments: &'a [&str],
) -> impl Iterator<Item = (usize, &'a str)> + Clone {
    let numbered = (1..).zip(text.lines()).map(|(line, text)| (line, text.trim()));
    let is_comment = |text: &str| comments.iter().any(|sign| text.starts_with(sign));
    numbered.filter(move |(_, text)| !text.is_empty() && !is_comment(text))
}

fn bad_line((line, text): (usize, &str), wanted: &'static str) -> GradientFileError {
    let text = text.chars().take(60).collect();
    GradientFileError::Line { line, text, wanted }
}

/// Returns the text of a file in UTF-8 or UTF-16, or else in Windows' code page 1252, of which
/// Latin-1 is a part. A mark of the byte order is left out.
fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(_) => encoding_rs::WINDOWS_1252.decode(bytes).0,
    }
}

/// Reads a gradient file with this extension (see [`ENDINGS`]). Of several gradients in one file,
/// which only Ultra Fractal's format has, it takes the one called `name`, or else the first.
pub fn parse_file(
    ending: &str,
    bytes: &[u8],
    name: Option<&str>,
) -> Result<Vec<Stop>, GradientFileError> {
    let text = decoded(bytes);
    if ending == "ugr" {
        return ugr::read(&text, name).map(few);
    }
    if let Some(name) = name {
        let known = "of formats that hold one without a name".to_string();
        return Err(GradientFileError::Name { name: name.to_string(), known });
    }
    let stops = match ending {
        "map" => rows::map(&text),
        "gpl" => rows::gpl(&text),
        "pal" => rows::pal(&text),
        "ggr" => ggr::read(&text),
        _ => cpt::read(&text),
    }?;
    if stops.len() < *STOPS.start() { Err(GradientFileError::TooFew) } else { Ok(few(stops)) }
}

#[cfg(test)]
mod tests {
    use super::super::gradient::{colour_at, list_text};
    use super::*;

    fn told(ending: &str, bytes: impl AsRef<[u8]>) -> String {
        match parse_file(ending, bytes.as_ref(), None) {
            Ok(stops) => list_text(&stops),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn lists_of_colours_are_read_however_they_are_separated() {
        for text in [
            "0 0 0 by hand\n255 136 0\n255 255 255\n",
            "\u{feff}0,0,0\r\n255, 136, 0\r\n\r\n255,255,255",
            "; a comment\n0\t0\t0\n// another\n#f80\n# a third\n#ffffff\n",
        ] {
            assert_eq!(told("map", text), "#000000,#ff8800,#ffffff", "{text}");
        }
        let gpl = "GIMP Palette\nName: two\nColumns: 2\n# a comment\n 10  20 30\tink\n1 2 3 x\n";
        assert_eq!(told("gpl", gpl), "#0a141e,#010203");
        assert_eq!(
            told("pal", "JASC-PAL\r\n0100\r\n2\r\n1 2 3\r\n4 5 6 255\r\n"),
            "#010203,#040506"
        );
    }

    #[test]
    fn bytes_of_other_alphabets_are_read() {
        assert_eq!(told("map", b"0 0 0 gr\xfcn \x96\n1 2 3\n"), "#000000,#010203");
        let wide: Vec<u8> = [0xff, 0xfe]
            .into_iter()
            .chain("0 0 0\n1 2 3\n".encode_utf16().flat_map(u16::to_le_bytes))
            .collect();
        assert_eq!(told("map", wide), "#000000,#010203");
    }

    #[test]
    fn lines_that_cannot_be_read_are_named() {
        for (ending, text, why) in [
            ("map", "0 0 0\n300 0 0\n1 2 3\n", "line 2 is '300 0 0'; it must be red, green"),
            ("map", "0 0 0\nred\n1 2 3\n", "line 2 is 'red'"),
            ("map", "1 2 3\n", "fewer than 2 colours"),
            ("gpl", "1 2 3\n4 5 6\n", "begin with 'GIMP Palette'"),
            ("gpl", "GIMP Palette\nName: x\n1 2 3\n4 5\n", "line 4 is '4 5'"),
            ("pal", "JASC-PAL\n0100\n3\n1 2 3\n4 5 6\n", "announces 3 colours and has 2"),
            ("pal", "RIFF\u{0}\u{0}", "begin with 'JASC-PAL'"),
            (
                "ggr",
                "GIMP Gradient\nName: x\n2\n0 .5 1 0 0 0 1 1 1 1 1 0 0\n",
                "announces 2 segments",
            ),
            ("ggr", "GIMP Gradient\nName: x\n1\n0 .5 x 0 0 0 1 1 1 1 1 0 0\n", "line 4 is '0 .5 x"),
            ("cpt", "0 0 0 0 1 255 255\n", "line 1 is '0 0 0 0 1"),
            ("cpt", "0 mauve 1 white\n", "line 1 is '0 mauve 1 white'"),
            ("ugr", "nothing", "has no section 'gradient:'"),
            ("ugr", "a {\ngradient:\n index=0 color=red\n}", "line 3 is 'color=red'"),
            ("ugr", "a {\ngradient:\n index=0\n}", "fewer than 2 colours"),
        ] {
            let told = told(ending, text);
            assert!(told.contains(why), "{text}: {told}");
        }
    }

    #[test]
    fn gradients_of_gimp_keep_their_segments() {
        let linear = "GIMP Gradient\nName: x\n2\n0 0.25 0.5 0 0 0 1 1 0 0 1 0 0\n\
                      0.5 0.6 1 1 0 0 1 1 1 1 1 0 0\n";
        let stops = parse_file("ggr", linear.as_bytes(), None).unwrap();
        assert_eq!(list_text(&stops), "#000000 0%,#ff0000 50%,#ff8080 60%,#ffffff 100%");
        let sine = "GIMP Gradient\nName: x\n1\n0 0.5 1 0 0 0 1 1 1 1 1 2 0\n";
        let stops = parse_file("ggr", sine.as_bytes(), None).unwrap();
        assert!(colour_at(&stops, 0.25)[0].abs_diff(37) <= 1, "{:?}", colour_at(&stops, 0.25));
        let hue = "GIMP Gradient\nName: x\n1\n0 0.5 1 1 0 0 1 0 0 1 1 0 1\n";
        let stops = parse_file("ggr", hue.as_bytes(), None).unwrap();
        let [r, g, b] = colour_at(&stops, 0.5);
        assert!(
            r < 5 && g > 250 && b < 5,
            "anticlockwise from red to blue lies green: {r} {g} {b}"
        );
    }

    #[test]
    fn colour_tables_of_gmt_have_places_and_edges() {
        let table =
            "# COLOR_MODEL = RGB\n0 0/0/0 2 255/0/0\n2 blue 10 #fff\nB black\nF white\nN 128\n";
        assert_eq!(told("cpt", table), "#000000 0%,#ff0000 20%,#0000ff 20%,#ffffff 100%");
        assert_eq!(told("cpt", "0 0 0 0 1 255 255 255 ; label\n"), "#000000,#ffffff");
        assert_eq!(told("cpt", "# COLOR_MODEL=HSV\n0 0-1-1 1 120-1-1\n").matches('#').count(), 256);
    }

    #[test]
    fn one_of_several_gradients_is_chosen_by_name() {
        let two = "red {\ngradient:\n  title=\"red\" smooth=no\n  index=0 color=255\n  \
                   index=200 color=16711680\nopacity:\n  index=0 opacity=255\n}\n\
                   green {\ngradient:\n index=0 color=65280\n index=200 color=0\n}\n";
        let first = parse_file("ugr", two.as_bytes(), None).unwrap();
        assert_eq!(list_text(&first), "#ff0000,#0000ff,#ff0000", "the end is the beginning");
        let green = parse_file("ugr", two.as_bytes(), Some("Green")).unwrap();
        assert_eq!(list_text(&green), "#00ff00,#000000,#00ff00");
        let none = parse_file("ugr", two.as_bytes(), Some("blue")).unwrap_err();
        assert_eq!(none.to_string(), "has no gradient 'blue'; its gradients are red, green");
        assert!(parse_file("map", b"0 0 0\n1 1 1", Some("red")).is_err());
    }
}
