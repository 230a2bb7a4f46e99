//! Colours kept under the digits of the keyboard.

use super::settings::Settings;
use super::state::AppState;
use flipmap_scene::PictureTable;

/// The digits under which colours can be kept.
pub(super) const DIGITS: std::ops::RangeInclusive<u8> = 1..=9;

impl Settings {
    /// Keeps the colours of a picture under a digit, without times that were taken from the view.
    pub(crate) fn keep_colours(&mut self, digit: u8, picture: &PictureTable) {
        let mut kept = PictureTable::default().with_colours_of(picture);
        kept.forget_view_times();
        if let Ok(table) = toml::Table::try_from(&kept) {
            self.favourites.insert(digit.to_string(), table);
        }
    }

    /// Returns a picture in the colours kept under a digit, or a sentence that says why there are
    /// none.
    pub(crate) fn kept_colours(
        &self,
        digit: u8,
        picture: &PictureTable,
    ) -> Result<PictureTable, String> {
        let table = self.favourites.get(&digit.to_string()).ok_or_else(|| {
            format!("No colours are kept under {digit}; Shift+{digit} keeps the current colours.")
        })?;
        let kept: PictureTable = table.clone().try_into().map_err(|error: toml::de::Error| {
            format!("The colours kept under {digit} cannot be read: {}.", error.message())
        })?;
        let kept = picture.with_colours_of(&kept);
        kept.check().map_err(|error| format!("The colours kept under {digit}: {error}."))?;
        Ok(kept)
    }
}

impl AppState {
    /// Keeps the colours of the map under a digit.
    pub(super) fn keep_favourite(&mut self, digit: u8, settings: &mut Settings) {
        settings.keep_colours(digit, &self.picture);
        self.notices.tell(format!("The key {digit} brings these colours back."));
    }

    /// Paints the map in the colours kept under a digit.
    pub(super) fn show_favourite(&mut self, digit: u8, settings: &Settings) {
        match settings.kept_colours(digit, &self.picture) {
            Ok(picture) => self.paint(picture),
            Err(why) => self.notices.tell(why),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::Sampling;

    #[test]
    fn colours_are_kept_without_what_belongs_to_the_picture() {
        let mut settings = Settings::default();
        let picture = PictureTable {
            palette: "magma".into(),
            cycles: 3.0,
            times: vec![1.0, 2.0],
            of_view: true,
            samples: Sampling::Square(4),
            curve: false,
            ..PictureTable::default()
        };
        settings.keep_colours(3, &picture);
        let text = toml::to_string(&settings).unwrap();
        let settings: Settings = toml::from_str(&text).unwrap();
        let now = PictureTable { channel: Some("time".into()), ..PictureTable::default() };
        let shown = settings.kept_colours(3, &now).unwrap();
        assert_eq!(
            shown,
            PictureTable { palette: "magma".into(), cycles: 3.0, ..now.clone() },
            "its times were those of a view"
        );
        let none = settings.kept_colours(4, &now).unwrap_err();
        assert_eq!(none, "No colours are kept under 4; Shift+4 keeps the current colours.");
    }

    #[test]
    fn colours_that_cannot_be_used_are_said_and_cost_nothing_else() {
        let text =
            "ui_scale = 1.5\n[favourites.1]\npalette = \"rainbow\"\n[favourites.2]\nhue = 3\n";
        let settings: Settings = toml::from_str(text).unwrap();
        let why = |digit| settings.kept_colours(digit, &PictureTable::default()).unwrap_err();
        assert!(why(1).contains("rainbow") && why(2).contains("unknown field"), "{}", why(2));
        assert_eq!(settings.ui_scale, 1.5);
    }
}
