//! Colours kept under the digits of the keyboard.

use super::settings::Settings;
use super::state::AppState;
use flipmap_scene::PictureTable;

/// The digits under which colours can be kept.
pub(super) const DIGITS: std::ops::RangeInclusive<u8> = 1..=9;

impl Settings {
    /// Keeps the colours of a picture under a digit, without times that were taken from the view.
    /// Returns the other colours that were kept there, if there were any.
    pub(crate) fn keep_colours(
        &mut self,
        digit: u8,
        picture: &PictureTable,
    ) -> Option<toml::Table> {
        let mut kept = PictureTable::default().with_colours_of(picture);
        kept.forget_view_times();
        let table = toml::Table::try_from(&kept).ok()?;
        let before = self.favourites.insert(digit.to_string(), table.clone());
        before.filter(|before| *before != table)
    }

    /// Returns a picture in the colours kept under a digit, or a sentence that says why there are
    /// none.
    pub(crate) fn kept_colours(
        &self,
        digit: u8,
        picture: &PictureTable,
    ) -> Result<PictureTable, String> {
        let table = self.favourites.get(&digit.to_string()).ok_or_else(|| {
            format!("No colours are kept under {digit}; Ctrl+{digit} keeps the current colours.")
        })?;
        let kept: PictureTable = table.clone().try_into().map_err(|error: toml::de::Error| {
            format!("The colours kept under {digit} cannot be read: {}.", error.message())
        })?;
        let kept = picture.with_colours_of(&kept);
        kept.check().map_err(|error| format!("The colours kept under {digit}: {error}."))?;
        Ok(kept)
    }
}

/// Colours that others have replaced under a digit.
#[derive(Debug)]
pub(super) struct ReplacedFavourite {
    digit: u8,
    colours: toml::Table,
    /// Step of the history that was shown then.
    step: usize,
}

impl AppState {
    /// Keeps the colours of the map under a digit.
    pub(super) fn keep_favourite(&mut self, digit: u8, settings: &mut Settings) {
        let Some(colours) = settings.keep_colours(digit, &self.picture) else {
            self.notices.tell(format!("The key {digit} brings these colours back."));
            return;
        };
        self.replaced.push(ReplacedFavourite { digit, colours, step: self.history.step() });
        self.notices.tell(format!("Favourite {digit} replaced; Ctrl+Z brings back the old one."));
    }

    /// Returns true if going back brings back a favourite, or an earlier step of the history.
    pub(super) fn has_back(&self) -> bool {
        self.history.has_back() || !self.replaced.is_empty()
    }

    /// Brings back the favourite that was replaced last, unless something that was shown since then
    /// has to be taken back first. Returns true if it did.
    pub(super) fn bring_back_favourite(&mut self, settings: &mut Settings) -> bool {
        let step = self.history.step();
        let Some(ReplacedFavourite { digit, colours, .. }) =
            self.replaced.pop_if(|replaced| replaced.step >= step)
        else {
            return false;
        };
        settings.favourites.insert(digit.to_string(), colours);
        self.notices.tell(format!("Favourite {digit} is the old one again."));
        true
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
    use crate::action::Look;
    use crate::state::tests::state;
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
        assert_eq!(settings.keep_colours(3, &picture), None);
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
        assert_eq!(none, "No colours are kept under 4; Ctrl+4 keeps the current colours.");
    }

    #[test]
    fn a_replaced_favourite_comes_back_in_its_turn() {
        let (mut state, mut settings) = (state(), Settings::default());
        state.look.animate = false;
        let paint = |state: &mut AppState, palette: &str, now_secs: f64| {
            state.paint(PictureTable { palette: palette.into(), ..state.picture.clone() });
            state.tick(now_secs);
        };
        let kept = |settings: &Settings| {
            settings.kept_colours(1, &PictureTable::default()).unwrap().palette
        };
        paint(&mut state, "magma", 1.0);
        state.keep_favourite(1, &mut settings);
        state.keep_favourite(1, &mut settings);
        assert!(!state.bring_back_favourite(&mut settings), "nothing was replaced");
        paint(&mut state, "viridis", 10.0);
        state.keep_favourite(1, &mut settings);
        assert!(state.notices.iter().any(|notice| notice.text.starts_with("Favourite 1 replaced")));
        paint(&mut state, "cividis", 20.0);
        state.keep_favourite(1, &mut settings);
        assert_eq!(kept(&settings), "cividis");
        assert!(state.bring_back_favourite(&mut settings));
        assert_eq!(kept(&settings), "viridis");
        assert!(!state.bring_back_favourite(&mut settings), "the last colours first");
        state.look(Look::Back);
        state.tick(30.0);
        assert!(state.has_back() && state.bring_back_favourite(&mut settings));
        assert_eq!(
            (kept(&settings).as_str(), state.picture.palette.as_str()),
            ("magma", "viridis")
        );
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
