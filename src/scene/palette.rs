//! Colours of samples. The tables are data in `assets/palettes`; nothing here computes flips.

use crate::physics::{Outcome, Status};

/// An opaque sRGB colour.
pub type Rgb = [u8; 3];

/// 256 colours from early to late, by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Palette {
    /// Its name.
    pub name: &'static str,
    table: Vec<Rgb>,
}

const FILES: [(&str, &str); 5] = [
    ("batlow", include_str!("../../assets/palettes/batlow.txt")),
    ("viridis", include_str!("../../assets/palettes/viridis.txt")),
    ("magma", include_str!("../../assets/palettes/magma.txt")),
    ("cividis", include_str!("../../assets/palettes/cividis.txt")),
    ("romao", include_str!("../../assets/palettes/romao.txt")),
];

/// Starts that can never flip: a grey that no palette has.
pub const FORBIDDEN: Rgb = [0xb8, 0xbc, 0xc0];
/// Starts that did not flip within the budget.
pub const UNFLIPPED: Rgb = [0xff, 0xff, 0xff];
/// Starts whose integration failed.
pub const FAILED: Rgb = [0xff, 0x00, 0xff];

impl Palette {
    /// The palette called `name`.
    pub fn named(name: &str) -> Result<Self, String> {
        let (name, text) = FILES.iter().find(|(known, _)| *known == name).ok_or_else(|| {
            let names: Vec<&str> = FILES.iter().map(|(name, _)| *name).collect();
            format!("unknown palette '{name}'; the palettes are {}", names.join(", "))
        })?;
        let table = text.lines().filter_map(parse_colour).collect();
        Ok(Palette { name, table })
    }

    /// The names of all palettes.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FILES.iter().map(|(name, _)| *name)
    }

    /// The colour at `position` in [0, 1], early to late.
    pub fn colour(&self, position: f64) -> Rgb {
        let last = self.table.len() - 1;
        self.table[((position.clamp(0.0, 1.0) * last as f64).round() as usize).min(last)]
    }
}

/// `#rrggbb`; other lines are comments.
fn parse_colour(line: &str) -> Option<Rgb> {
    let digits = line.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    let channel = |i: usize| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok();
    Some([channel(0)?, channel(1)?, channel(2)?])
}

/// Times to places in a palette: logarithmic, between two fixed times, so that a colour means
/// the same in every tile of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Seconds at the palette's beginning.
    pub first_secs: f64,
    /// Seconds at its end.
    pub last_secs: f64,
}

impl Range {
    /// From one natural unit of time of the pendulum, before which few flips come, to the budget.
    pub fn of(unit_secs: f64, budget_secs: f64) -> Self {
        let first_secs = if unit_secs < 0.5 * budget_secs { unit_secs } else { 0.1 * budget_secs };
        Range { first_secs, last_secs: budget_secs }
    }

    fn position(&self, secs: f64) -> f64 {
        (secs / self.first_secs).ln() / (self.last_secs / self.first_secs).ln()
    }
}

/// The colour of an outcome.
pub fn colour_of(outcome: &Outcome, palette: &Palette, range: &Range) -> Rgb {
    match outcome.status {
        Status::Flipped => palette.colour(range.position(outcome.time)),
        Status::Unflipped => UNFLIPPED,
        Status::Forbidden => FORBIDDEN,
        Status::Failed => FAILED,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_has_256_colours() {
        for name in Palette::names() {
            assert_eq!(Palette::named(name).unwrap().table.len(), 256, "{name}");
        }
        assert!(Palette::named("rainbow").unwrap_err().contains("batlow, viridis"));
    }

    #[test]
    fn times_run_from_the_first_colour_to_the_last() {
        let palette = Palette::named("batlow").unwrap();
        let range = Range::of(0.3, 30.0);
        let colour = |time| colour_of(&Outcome::flipped(time), &palette, &range);
        assert_eq!(colour(0.1), palette.table[0]);
        assert_eq!(colour(30.0), palette.table[255]);
        assert_eq!(colour(3.0), palette.table[128]);
    }

    #[test]
    fn the_statuses_have_colours_of_their_own() {
        for name in Palette::names() {
            let table = Palette::named(name).unwrap().table;
            for own in [FORBIDDEN, UNFLIPPED, FAILED] {
                assert!(!table.contains(&own), "{name} {own:?}");
            }
        }
    }
}
