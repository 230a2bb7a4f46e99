//! Colours of samples. The tables are data in `assets/palettes`; nothing here computes flips.

mod answers;
pub mod gradient;
mod ground;
mod legend;
mod tones;

pub use answers::AnswerColours;
pub use ground::{Ground, GroundTable, colour_text};
pub use legend::{BarLabels, LegendTitle};
pub use tones::{Lookup, Tones, equalised, rise};

use super::SceneError;

/// An opaque sRGB colour.
pub type Rgb = [u8; 3];

/// A named table of 256 colours from early to late.
#[derive(Clone, Debug, PartialEq)]
pub struct Palette {
    /// Name of the palette.
    pub name: &'static str,
    /// Colours that suit it.
    pub ground: Ground,
    table: Vec<Rgb>,
}

const FILES: [(&str, &str); 6] = [
    ("iris", include_str!("../../../assets/palettes/iris.txt")),
    ("batlow", include_str!("../../../assets/palettes/batlow.txt")),
    ("viridis", include_str!("../../../assets/palettes/viridis.txt")),
    ("magma", include_str!("../../../assets/palettes/magma.txt")),
    ("cividis", include_str!("../../../assets/palettes/cividis.txt")),
    ("romao", include_str!("../../../assets/palettes/romao.txt")),
];

/// Colour of starts whose integration failed.
pub const FAILED: Rgb = [0xff, 0x00, 0xff];

impl Palette {
    /// Each palette's own words about itself: its name, where it is from, and its licence.
    pub fn notes() -> impl Iterator<Item = String> {
        FILES.iter().map(|(_, text)| {
            let lines = text.lines().map_while(|line| line.strip_prefix("# "));
            lines.collect::<Vec<_>>().join(" ")
        })
    }

    /// Name of the palette that is used where none is chosen.
    pub const DEFAULT: &str = "iris";
    /// Name of the palette that pictures of the first versions record where none was chosen.
    const FIRST_DEFAULT: &str = "batlow";
    /// Name of a palette whose end is its beginning.
    pub const CYCLIC: &str = "romao";

    /// Name of a palette from dark to bright.
    pub const DARK_TO_BRIGHT: &str = "magma";

    /// The palette called `name`, or that of a list of colours (see [`gradient::parse_list`]).
    pub fn named(name: &str) -> Result<Self, SceneError> {
        if name.starts_with('#') {
            return Self::of_list(name);
        }
        let found = FILES.iter().find(|(known, _)| *known == name);
        let (name, text) = found.ok_or_else(|| SceneError {
            option: "--palette",
            value: format!("'{name}'"),
            range: "the palettes are iris, batlow, viridis, magma, cividis, romao, lists of colours \
                    (#000000,#ff8000,#ffffff) and files .map, .ugr and .gpl",
        })?;
        let table = text.lines().filter_map(parse_colour).collect();
        let ground = if *name == Self::DEFAULT { Ground::DARK } else { Ground::LIGHT };
        Ok(Palette { name, ground, table })
    }

    fn of_list(text: &str) -> Result<Self, SceneError> {
        let stops = gradient::parse_list(text).ok_or_else(|| SceneError {
            option: "--palette",
            value: format!("'{text}'"),
            range: "a list is 2 to 256 colours such as #ff8000, separated by commas",
        })?;
        Ok(Palette { name: "custom", ground: Ground::DARK, table: gradient::table(&stops) })
    }

    /// Returns true if a picture's palette need not have been chosen by anyone, so that answers with
    /// natural colours of their own have these.
    pub fn is_unchosen(name: &str) -> bool {
        [Self::DEFAULT, Self::FIRST_DEFAULT].contains(&name)
    }

    /// The names of all palettes.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FILES.iter().map(|(name, _)| *name)
    }

    /// The colour at `position` in [0, 1], from early to late.
    pub fn colour(&self, position: f64) -> Rgb {
        let last = self.table.len() - 1;
        self.table[((position.clamp(0.0, 1.0) * last as f64).round() as usize).min(last)]
    }
}

/// Converts a channel of sRGB to linear light in [0, 1] (IEC 61966-2-1).
pub fn light(channel: u8) -> f64 {
    let c = f64::from(channel) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Converts linear light to sRGB: the inverse of [`light`].
pub fn encoded(linear: f64) -> u8 {
    let c =
        if linear <= 0.0031308 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (c * 255.0).round() as u8
}

/// [`light`] of every channel value, scaled so that full light is 65535.
pub fn light_table() -> [u16; 256] {
    std::array::from_fn(|channel| (light(channel as u8) * 65535.0).round() as u16)
}

/// Reads a line `#rrggbb`; other lines are comments.
fn parse_colour(line: &str) -> Option<Rgb> {
    let digits = line.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    if !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let channel = |i: usize| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok();
    Some([channel(0)?, channel(1)?, channel(2)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_has_256_colours() {
        for name in Palette::names() {
            assert_eq!(Palette::named(name).unwrap().table.len(), 256, "{name}");
        }
        let refused = Palette::named("rainbow").unwrap_err().to_string();
        assert!(refused.contains(&Palette::names().collect::<Vec<_>>().join(", ")), "{refused}");
        assert!(Palette::named("#000000").unwrap_err().to_string().contains("2 to 256"));
        let own = Palette::named("#000000,#ffffff").unwrap();
        assert_eq!((own.name, own.colour(0.5)), ("custom", [128; 3]));
    }

    #[test]
    fn the_statuses_have_colours_of_their_own() {
        for name in Palette::names() {
            let Palette { table, ground, .. } = Palette::named(name).unwrap();
            for own in [ground.forbidden, ground.unflipped, FAILED] {
                assert!(!table.contains(&own), "{name} {own:?}");
            }
        }
    }
}
