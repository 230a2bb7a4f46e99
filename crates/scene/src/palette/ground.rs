//! Colours outside the palette: those of pixels without an answer and of the energy curve.

use serde::{Deserialize, Serialize};

use super::{Palette, Rgb, parse_colour};
use crate::{PictureTable, SceneError};

/// Colours used in addition to those of a palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ground {
    /// Colour of starts that did not flip within the budget, or have no answer.
    pub unflipped: Rgb,
    /// Colour of starts that can never flip.
    pub forbidden: Rgb,
    /// Colour of the energy curve.
    pub curve: Rgb,
}

impl Ground {
    /// White and grey, for palettes that begin dark and do not end in white.
    pub const LIGHT: Ground =
        Ground { unflipped: [0xff; 3], forbidden: [0xb8, 0xbc, 0xc0], curve: [0; 3] };
    /// Nearly black, for the default palette and lists of colours.
    pub const DARK: Ground =
        Ground { unflipped: [9, 10, 14], forbidden: [38, 40, 46], curve: [0xc8, 0xcc, 0xd8] };

    /// Returns the picture's own colours, or those that suit its palette where it has none.
    pub fn of(picture: &PictureTable) -> Result<Self, SceneError> {
        let suited = Palette::named(&picture.palette)?.ground;
        let own = &picture.colours;
        let or = |own: &Option<String>, suited: Rgb| match own {
            Some(text) => colour(text),
            None => Ok(suited),
        };
        Ok(Ground {
            unflipped: or(&own.unflipped, suited.unflipped)?,
            forbidden: or(&own.forbidden, suited.forbidden)?,
            curve: or(&own.curve, suited.curve)?,
        })
    }
}

/// The table `[picture.colours]` of a scene file: colours as `#rrggbb`, or `None` for the colour
/// that suits the palette.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GroundTable {
    /// Colour of starts without an answer within the budget.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unflipped: Option<String>,
    /// Colour of starts that can never flip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forbidden: Option<String>,
    /// Colour of the energy curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curve: Option<String>,
}

/// Error text that shows the form of `colours`.
const FORM: &str =
    "it must be unflipped, forbidden or curve with a colour, as in unflipped=#101018,curve=#ffffff";

impl GroundTable {
    /// Sets some of the colours from a text such as `unflipped=#101018,curve=#ffffff`.
    pub fn set(&mut self, text: &str) -> Result<(), String> {
        for part in text.split(',') {
            let refuse = || match part == text {
                true => FORM.to_string(),
                false => format!("'{part}' in it is wrong: {FORM}"),
            };
            let (name, colour) = part.split_once('=').ok_or_else(refuse)?;
            let own = match name.trim() {
                "unflipped" => &mut self.unflipped,
                "forbidden" => &mut self.forbidden,
                "curve" => &mut self.curve,
                _ => return Err(refuse()),
            };
            parse_colour(colour.trim()).ok_or_else(refuse)?;
            *own = Some(colour.trim().to_lowercase());
        }
        Ok(())
    }
}

fn colour(text: &str) -> Result<Rgb, SceneError> {
    parse_colour(text).ok_or_else(|| {
        let value = format!("'{}'", text.chars().take(40).collect::<String>());
        let range = "each colour is # and six hexadecimal digits, as in #101018";
        SceneError::new("colours", value, range)
    })
}

/// Formats a colour as `#rrggbb`.
pub fn colour_text([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_its_own_colours_or_those_of_its_palette() {
        let of = |palette: &str, text: &str| {
            let mut picture =
                PictureTable { palette: palette.to_string(), ..PictureTable::default() };
            if !text.is_empty() {
                picture.colours.set(text).unwrap();
            }
            let written = toml::to_string(&picture).unwrap();
            assert_eq!(toml::from_str::<PictureTable>(&written).unwrap(), picture);
            Ground::of(&picture).unwrap()
        };
        assert_eq!((of("batlow", ""), of("iris", "")), (Ground::LIGHT, Ground::DARK));
        let own = of("batlow", "curve=#FF0000, unflipped = #000102");
        assert_eq!((own.curve, own.unflipped), ([255, 0, 0], [0, 1, 2]));
        assert_eq!(own.forbidden, Ground::LIGHT.forbidden);
        assert_eq!(colour_text(own.unflipped), "#000102");
    }

    #[test]
    fn what_is_no_colour_is_refused() {
        for text in
            ["", "unflipped", "unflipped=black", "sky=#000000", "curve=#12345", "curve=#-1+2+3"]
        {
            assert!(GroundTable::default().set(text).is_err(), "{text}");
        }
        let mut picture = PictureTable::default();
        picture.colours.forbidden = Some("grey".to_string());
        let error = picture.check().unwrap_err().to_string();
        assert_eq!(
            error,
            "`colours` is 'grey'; each colour is # and six hexadecimal digits, as in #101018"
        );
    }
}
