//! Colours of samples. The palettes are data in `assets/palettes`.

mod answers;
pub mod gradient;
pub mod gradient_file;
mod ground;
mod hsv;
mod legend;
mod oklab;
mod random;
mod relief;
mod spread;
mod steps;
mod ticks;
mod time_scale;
mod tones;

pub use answers::AnswerColours;
pub use ground::{Ground, GroundTable, colour_text};
pub use hsv::hue_deg;
pub use legend::LegendTitle;
pub use random::random_palette;
pub use relief::Relief;
pub use spread::ViewTimes;
pub use ticks::BarLabels;
pub use time_scale::TimeScale;
pub use tones::{Lookup, Tones, budget_range_secs, equalised, rise};

use flipmap_assets::PALETTES;

use super::SceneError;
use super::allowed::did_you_mean;

/// An opaque sRGB colour.
pub type Rgb = [u8; 3];

/// An unrounded sRGB colour: channels from 0 to 255, with fractions.
pub type Tint = [f32; 3];

/// Rounds a colour to eight bits per channel.
pub fn rounded(tint: Tint) -> Rgb {
    tint.map(rounded_channel)
}

/// Rounds a channel to eight bits.
pub fn rounded_channel(channel: f32) -> u8 {
    // Equals `round` except just below one half; `round` is a function call on most machines.
    (channel + 0.5) as u8
}

/// Converts a colour to a tint.
pub fn tint_of(colour: Rgb) -> Tint {
    colour.map(f32::from)
}

/// A named table of 256 colours from early to late.
#[derive(Clone, Debug, PartialEq)]
pub struct Palette {
    /// Name of the palette.
    pub name: &'static str,
    /// Colours outside the palette that suit it.
    pub ground: Ground,
    table: Vec<Tint>,
}

/// Largest difference of a channel between two colours without a visible seam.
const MAX_SEAM: f32 = 6.0;

/// Colour of starts whose integration failed.
pub const FAILED: Rgb = [0xff, 0x00, 0xff];

impl Palette {
    /// Returns a line about each palette: its name, its source and its licence.
    pub fn notes() -> impl Iterator<Item = String> {
        PALETTES.iter().map(|(_, text)| {
            let lines = text.lines().map_while(|line| line.strip_prefix("# "));
            lines.collect::<Vec<_>>().join(" ")
        })
    }

    /// Name of the palette that is used if none is chosen.
    pub(crate) const DEFAULT: &str = "iris";
    /// Name of the default palette in the first versions, which pictures from then record.
    const FIRST_DEFAULT: &str = "batlow";
    /// Name of the cyclic palette of long films, which begins as the default does.
    pub const CYCLIC: &str = "halo";
    /// Name of the cyclic palette of angles.
    pub(crate) const OF_ANGLES: &str = "romao";
    /// Names of the palettes that lie on a light ground: those that begin in black, and those of
    /// the first versions.
    const ON_LIGHT: [&str; 6] = ["batlow", "viridis", "magma", "inferno", "cividis", "romao"];

    /// Name of a palette from dark to bright.
    pub(crate) const DARK_TO_BRIGHT: &str = "magma";

    /// Returns the palette called `name`, or the palette of a list of colours (see
    /// [`gradient::parse_list`]).
    pub fn named(name: &str) -> Result<Self, SceneError> {
        if name.starts_with('#') {
            return Self::of_list(name);
        }
        if let Some(seed) = random::seed_of(name) {
            return Ok(Palette {
                name: "random",
                ground: Ground::DARK,
                table: random::table(seed),
            });
        }
        let found = PALETTES.iter().find(|(known, _)| *known == name);
        let (name, text) = found.ok_or_else(|| {
            let names: Vec<&str> = Self::names().collect();
            let allowed = format!(
                "the palettes are {}, random-1, random-2 and so on, lists of colours \
                 (#000000,#ff8000,#ffffff) and files .{}{}",
                names.join(", "),
                gradient_file::ENDINGS.join(", ."),
                did_you_mean(&names, name)
            );
            SceneError::new("palette", format!("'{name}'"), allowed)
        })?;
        let table = text.lines().filter_map(parse_colour).map(tint_of).collect();
        let is_light = Self::ON_LIGHT.contains(name);
        let ground = if is_light { Ground::LIGHT } else { Ground::DARK };
        Ok(Palette { name, ground, table })
    }

    fn of_list(text: &str) -> Result<Self, SceneError> {
        let stops = gradient::parse_list(text)
            .map_err(|why| SceneError::new("palette", format!("'{text}'"), why.to_string()))?;
        let table = gradient::table(&stops).into_iter().map(tint_of).collect();
        Ok(Palette { name: "custom", ground: Ground::DARK, table })
    }

    /// Returns true if `name` is a default palette. Answers that have natural colours of their own
    /// then use those.
    pub fn is_unchosen(name: &str) -> bool {
        [Self::DEFAULT, Self::FIRST_DEFAULT].contains(&name)
    }

    /// Returns true if a palette ends as it begins, so that it can repeat without a seam.
    pub fn is_cyclic(name: &str) -> bool {
        let ends = |palette: Palette| {
            palette.table[0].into_iter().zip(palette.table[palette.table.len() - 1])
        };
        let is_near = |(from, to): (f32, f32)| (from - to).abs() <= MAX_SEAM;
        Palette::named(name).is_ok_and(|palette| ends(palette).all(is_near))
    }

    /// Returns the names of all palettes.
    pub fn names() -> impl Iterator<Item = &'static str> {
        PALETTES.iter().map(|(name, _)| *name)
    }

    /// Returns the colour at `position` in [0, 1], from early to late, interpolated between the two
    /// nearest entries.
    pub(crate) fn tint(&self, position: f64) -> Tint {
        let last = self.table.len() - 1;
        // A NaN gets the first colour.
        let place = if position > 0.0 { position.min(1.0) * last as f64 } else { 0.0 };
        let first = (place as usize).min(last - 1);
        let share = (place - first as f64) as f32;
        let [from, to] = [self.table[first], self.table[first + 1]];
        [0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * share)
    }

    /// Returns the colour at `position` in [0, 1], rounded to eight bits per channel.
    pub fn colour(&self, position: f64) -> Rgb {
        rounded(self.tint(position))
    }
}

/// Converts a channel of sRGB to linear light in [0, 1] (IEC 61966-2-1).
pub fn light(channel: u8) -> f64 {
    light_of(f32::from(channel))
}

/// Converts a channel of a tint to linear light.
pub fn light_of(channel: f32) -> f64 {
    let c = f64::from(channel) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Converts linear light to sRGB: the inverse of [`light`].
pub fn encoded(linear: f64) -> u8 {
    channel_of(linear).round() as u8
}

/// Converts linear light to a channel of a tint, clipped to its range; the inverse of [`light_of`].
pub fn channel_of(linear: f64) -> f32 {
    let c =
        if linear <= 0.0031308 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (c * 255.0).clamp(0.0, 255.0) as f32
}

/// Returns [`light`] of every channel value, scaled so that full light is 65535.
pub fn light_table() -> [u16; 256] {
    std::array::from_fn(|channel| (light(channel as u8) * 65535.0).round() as u16)
}

/// Reads a colour written as `#rrggbb` or `#rgb`.
fn parse_colour(text: &str) -> Option<Rgb> {
    let digits = text.strip_prefix('#')?;
    let values: Option<Vec<u32>> = digits.chars().map(|digit| digit.to_digit(16)).collect();
    let channels = match *values? {
        [r, g, b] => [r, g, b].map(|digit| 17 * digit),
        [r, r2, g, g2, b, b2] => [16 * r + r2, 16 * g + g2, 16 * b + b2],
        _ => return None,
    };
    Some(channels.map(|channel| channel as u8))
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
    fn colours_lie_between_the_entries_of_a_table() {
        let palette = Palette::named("#000000,#ffffff").unwrap();
        let grey = |position| palette.tint(position)[0];
        assert!((grey(0.3) - 76.5).abs() < 1e-4 && (grey(0.301) - 76.755).abs() < 1e-4);
        assert_eq!((grey(-1.0), grey(2.0), grey(f64::NAN)), (0.0, 255.0, 0.0));
        let iris = Palette::named("iris").unwrap();
        let tints: Vec<Tint> = (0..4096).map(|k| iris.tint(f64::from(k) / 4095.0)).collect();
        for pair in tints.windows(2) {
            let step = (0..3).map(|i| (pair[1][i] - pair[0][i]).abs()).fold(0.0, f32::max);
            assert!(step > 0.0 && step < 0.5, "no flat bands: {pair:?}");
        }
    }

    #[test]
    fn some_palettes_end_as_they_begin() {
        let cyclic: Vec<_> = Palette::names().filter(|name| Palette::is_cyclic(name)).collect();
        assert_eq!(cyclic, [Palette::CYCLIC, Palette::OF_ANGLES, "twilight"]);
        assert!(Palette::is_cyclic("#102030,#ffffff,#112030") && !Palette::is_cyclic("rainbow"));
    }

    #[test]
    fn the_statuses_have_colours_of_their_own() {
        for name in Palette::names() {
            let Palette { table, ground, .. } = Palette::named(name).unwrap();
            for own in [ground.forbidden, ground.unflipped, FAILED] {
                assert!(!table.contains(&tint_of(own)), "{name} {own:?}");
            }
        }
    }
}
