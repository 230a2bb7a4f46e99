//! The settings, including the scene and layers last shown, kept between runs in `settings.toml`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::film_draft::FilmForm;
use flipmap_scene::Document;

/// The appearance of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appearance {
    /// True if moves are smooth.
    pub animate: bool,
    /// Theme: dark, light, or that of the system.
    pub theme: Theme,
    /// Scale of the interface.
    pub ui_scale: f32,
    /// Number of samples per pixel at edges while the view rests.
    pub edges: EdgeSamples,
}

impl Default for Appearance {
    fn default() -> Self {
        Appearance::of(&Settings::default())
    }
}

impl Appearance {
    /// Returns the appearance that settings ask for.
    pub(crate) fn of(settings: &Settings) -> Self {
        let Settings { animate, theme, ui_scale, edges, .. } = *settings;
        Appearance { animate, theme, ui_scale, edges }
    }
}

/// The least number of samples per pixel at edges of the map, once the view is complete and rests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum EdgeSamples {
    /// One sample everywhere.
    #[serde(rename = "1")]
    One,
    /// Four samples.
    #[serde(rename = "4")]
    Four,
    /// Four samples, then sixteen.
    #[default]
    #[serde(rename = "16")]
    Sixteen,
}

impl EdgeSamples {
    /// All choices with their names.
    pub(crate) const ALL: [(EdgeSamples, &str); 3] = [
        (EdgeSamples::One, "1 sample"),
        (EdgeSamples::Four, "4 samples"),
        (EdgeSamples::Sixteen, "16 samples"),
    ];

    /// Returns the number of finer levels that provide these samples.
    pub(crate) fn refinements(self) -> u32 {
        self as u32
    }
}

/// The choices of the user. Numbers out of range are clamped, so that the window opens in any case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Theme of the window.
    pub theme: Theme,
    /// Scale of everything around the map.
    pub ui_scale: f32,
    /// True if the view moves smoothly.
    pub animate: bool,
    /// True if the wheel zooms about structure next to the pointer.
    pub magnet: bool,
    /// Number of samples per pixel at edges while the view rests.
    pub edges: EdgeSamples,
    /// True if the window opens where it was left.
    pub restore: bool,
    /// Size in MiB of the cache of samples for places seen before.
    pub cache_mib: u32,
    /// True once the card of the first start was closed.
    pub greeted: bool,
    /// Files opened last, the newest first.
    pub recent: Vec<String>,
    /// Scene shown when the window was left.
    #[serde(with = "as_text", skip_serializing_if = "Option::is_none")]
    pub last_scene: Option<Document>,
    /// Layers drawn over the map.
    pub layers: Layers,
    /// Colours kept under the keys 1 to 9: picture tables, read when they are used.
    pub favourites: BTreeMap<String, toml::Table>,
    /// Names of the commands that were chosen from the list last, the newest first.
    pub recent_commands: Vec<String>,
    /// Palettes that the user has kept, by name, as a scene writes them.
    pub palettes: BTreeMap<String, String>,
    /// How the film that is being planned is shot.
    pub film: FilmForm,
}

/// The colours of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Theme {
    /// The same as the desktop.
    #[default]
    System,
    /// Light on dark.
    Dark,
    /// Dark on light.
    Light,
}

impl From<Theme> for egui::ThemePreference {
    fn from(theme: Theme) -> Self {
        match theme {
            Theme::System => egui::ThemePreference::System,
            Theme::Dark => egui::ThemePreference::Dark,
            Theme::Light => egui::ThemePreference::Light,
        }
    }
}

/// The layers drawn over the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layers {
    /// The energy curve.
    pub curve: bool,
    /// Hatching where checks disagree.
    pub trust: bool,
    /// Lines of equal angles, in multiples of π.
    pub grid: bool,
    /// Borders of the tiles.
    pub borders: bool,
    /// A pendulum that swings at the pointer.
    pub swing: bool,
    /// The legend: what the colours mean.
    pub legend: bool,
}

impl Default for Layers {
    fn default() -> Self {
        Layers { curve: true, trust: true, grid: false, borders: false, swing: true, legend: false }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            theme: Theme::default(),
            ui_scale: 1.0,
            animate: true,
            magnet: true,
            edges: EdgeSamples::default(),
            restore: true,
            cache_mib: 512,
            greeted: false,
            recent: Vec::new(),
            last_scene: None,
            layers: Layers::default(),
            favourites: BTreeMap::new(),
            recent_commands: Vec::new(),
            palettes: BTreeMap::new(),
            film: FilmForm::default(),
        }
    }
}

impl Settings {
    /// Largest number of recent files kept.
    pub(crate) const MAX_RECENT_FILES: usize = 10;
    /// Range of the scale of the interface.
    pub(crate) const UI_SCALES: std::ops::RangeInclusive<f32> = 0.5..=3.0;
    /// Range of the size of the cache in MiB.
    pub const CACHE_MIB: std::ops::RangeInclusive<u32> = 64..=65536;

    /// Puts a file first among the recent ones. Ignores a path that is not valid UTF-8.
    pub(crate) fn remember(&mut self, path: &Path) {
        let Some(path) = path.to_str() else { return };
        self.recent.retain(|other| other != path);
        self.recent.insert(0, path.to_string());
        self.recent.truncate(Self::MAX_RECENT_FILES);
    }

    /// Returns the nearest scale of the interface that is in range.
    pub(crate) fn within_ui_scales(scale: f32) -> f32 {
        scale.clamp(*Self::UI_SCALES.start(), *Self::UI_SCALES.end())
    }

    /// Returns the settings with every number clamped to its range.
    pub(super) fn sound(mut self) -> Self {
        let scale = if self.ui_scale.is_nan() { 1.0 } else { self.ui_scale };
        self.ui_scale = Self::within_ui_scales(scale);
        self.cache_mib = self.cache_mib.clamp(*Self::CACHE_MIB.start(), *Self::CACHE_MIB.end());
        self.recent.truncate(Self::MAX_RECENT_FILES);
        if !self.film.fps.is_finite() {
            self.film.fps = FilmForm::default().fps;
        }
        self
    }
}

/// Stores the last scene as the text of its file, so that a scene this program cannot read does not
/// invalidate the other settings.
mod as_text {
    use super::Document;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(
        scene: &Option<Document>,
        out: S,
    ) -> Result<S::Ok, S::Error> {
        match scene {
            Some(scene) => out.serialize_str(&scene.text()),
            None => out.serialize_none(),
        }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<Document>, D::Error> {
        let text = String::deserialize(from)?;
        let scene = Document::parse(&text);
        Ok(scene.inspect_err(|error| log::warn!("settings: last_scene: {error}")).ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_are_clamped() {
        let settings = Settings { ui_scale: 99.0, cache_mib: 1, ..Settings::default() }.sound();
        assert_eq!((settings.ui_scale, settings.cache_mib), (3.0, 64));
        for (wrong, sound) in [(f32::NAN, 1.0), (0.0, 0.5), (-1.0, 0.5), (f32::INFINITY, 3.0)] {
            let settings = Settings { ui_scale: wrong, ..Settings::default() };
            assert_eq!(settings.sound().ui_scale, sound);
        }
    }

    #[test]
    fn recent_files_are_few_and_each_is_there_once() {
        let mut settings = Settings::default();
        for k in 0..15 {
            settings.remember(Path::new(&format!("{k}.png")));
        }
        settings.remember(Path::new("9.png"));
        assert_eq!(settings.recent.len(), 10);
        assert_eq!(settings.recent[..3], ["9.png", "14.png", "13.png"]);
    }
}
