//! The settings, including the scene and layers last shown, kept between runs in `settings.toml`.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::folders::Folders;
use flipmap_render::output::{Destination, SafeFile, read_text};
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
        let Settings { animate, theme, ui_scale, edges, .. } = Settings::default();
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

/// The choices of the user. Numbers out of range are clamped and unknown keys ignored, so that the
/// window opens in any case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Theme of the window.
    pub theme: Theme,
    /// Scale of everything around the map.
    pub ui_scale: f32,
    /// True if the view moves smoothly.
    pub animate: bool,
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
            edges: EdgeSamples::default(),
            restore: true,
            cache_mib: 512,
            greeted: false,
            recent: Vec::new(),
            last_scene: None,
            layers: Layers::default(),
            favourites: BTreeMap::new(),
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
    fn sound(mut self) -> Self {
        let scale = if self.ui_scale.is_nan() { 1.0 } else { self.ui_scale };
        self.ui_scale = Self::within_ui_scales(scale);
        self.cache_mib = self.cache_mib.clamp(*Self::CACHE_MIB.start(), *Self::CACHE_MIB.end());
        self.recent.truncate(Self::MAX_RECENT_FILES);
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

/// The file that holds the settings, or none.
#[derive(Clone, Debug)]
pub struct Store {
    path: Option<PathBuf>,
}

/// The settings at the start, and what the user should know about them.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// Saved settings, or the defaults.
    pub settings: Settings,
    /// Sentence for the user, if the file could not be used.
    pub notice: Option<String>,
}

impl Store {
    /// Returns the store in these folders. Without a folder nothing is ever read or written.
    pub fn new(folders: &Folders) -> Self {
        Store { path: folders.config.as_ref().map(|folder| folder.join("settings.toml")) }
    }

    /// Returns true if settings are kept.
    pub(crate) fn keeps(&self) -> bool {
        self.path.is_some()
    }

    /// Loads the saved settings. A file that is not valid is moved aside and not lost.
    pub fn load(&mut self) -> Loaded {
        let fresh = |notice| Loaded { settings: Settings::default(), notice };
        let Some(path) = self.path.clone() else { return fresh(None) };
        let text = match read_text(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return fresh(None),
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                return fresh(Some(self.set_aside(&path, &error.to_string())));
            }
            Err(error) => {
                self.path = None;
                let path = path.display();
                return fresh(Some(format!(
                    "Your settings in {path} could not be read ({error}); nothing is saved this \
                     time."
                )));
            }
        };
        match toml::from_str::<Settings>(&text) {
            Ok(settings) => {
                warn_of_unknown(&text);
                Loaded { settings: settings.sound(), notice: None }
            }
            Err(error) => fresh(Some(self.set_aside(&path, error.message()))),
        }
    }

    /// Moves a bad file to a free name; if that fails it stays, and nothing is saved over it.
    fn set_aside(&mut self, path: &Path, why: &str) -> String {
        let aside = (1..).map(|k| path.with_file_name(format!("settings-bad-{k}.toml")));
        let aside = aside.into_iter().find(|aside| !aside.exists()).expect("some name is free");
        let kept = match std::fs::rename(path, &aside) {
            Ok(()) => aside.display().to_string(),
            Err(_) => {
                self.path = None;
                path.display().to_string()
            }
        };
        format!(
            "Your settings could not be read ({why}), so the defaults are used. The old file is \
             kept as {kept}."
        )
    }

    /// Saves the settings; the old file stays until the new one is complete.
    pub fn save(&self, settings: &Settings) -> io::Result<()> {
        let Some(path) = &self.path else { return Ok(()) };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let text = toml::to_string(settings).map_err(io::Error::other)?;
        SafeFile::write_whole(&Destination::File(path.clone()), text.as_bytes())
    }
}

/// Logs unknown keys, which come from a newer program or are misspelt.
fn warn_of_unknown(text: &str) {
    for key in unknown_keys(text) {
        log::warn!("settings.toml: unknown key '{key}' is ignored");
    }
}

fn unknown_keys(text: &str) -> Vec<String> {
    let full = Settings { last_scene: Some(Document::default()), ..Settings::default() };
    let known = toml::Table::try_from(full).expect("settings are a table");
    let Ok(found) = text.parse::<toml::Table>() else { return Vec::new() };
    let inner = |table: &toml::Table, key: &str| table.get(key)?.as_table().cloned();
    let mut unknown: Vec<String> =
        found.keys().filter(|key| !known.contains_key(*key)).cloned().collect();
    if let (Some(known), Some(found)) = (inner(&known, "layers"), inner(&found, "layers")) {
        let extra = found.keys().filter(|key| !known.contains_key(*key));
        unknown.extend(extra.map(|key| format!("layers.{key}")));
    }
    unknown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn store() -> (tempfile::TempDir, Store, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(&Folders::under(folder.path()));
        let path = store.path.clone().unwrap();
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        (folder, store, path)
    }

    #[test]
    fn settings_come_back_as_they_were() {
        let (_folder, mut store, _) = store();
        assert_eq!(store.load(), Loaded { settings: Settings::default(), notice: None });
        let mut settings = Settings {
            theme: Theme::Light,
            ui_scale: 1.5,
            edges: EdgeSamples::Four,
            layers: Layers { grid: true, ..Layers::default() },
            last_scene: Some(Document::default()),
            ..Settings::default()
        };
        settings.remember(Path::new("/tmp/a.png"));
        store.save(&settings).unwrap();
        assert_eq!(store.load(), Loaded { settings, notice: None });
    }

    #[test]
    fn a_bad_file_is_set_aside_and_said() {
        let (_folder, mut store, path) = store();
        for k in 1..=2 {
            std::fs::write(&path, format!("ui_scale = \"big {k}\"")).unwrap();
            let Loaded { settings, notice } = store.load();
            assert_eq!(settings, Settings::default());
            let aside = path.with_file_name(format!("settings-bad-{k}.toml"));
            assert!(notice.unwrap().contains(aside.to_str().unwrap()));
            assert!(std::fs::read_to_string(aside).unwrap().contains(&format!("big {k}")));
            assert!(!path.exists());
        }
        std::fs::write(&path, b"\xff\xfe").unwrap();
        assert!(store.load().notice.unwrap().contains("settings-bad-3.toml"));
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_prevent_no_start() {
        for device in [false, true] {
            let (_folder, mut store, path) = store();
            if device {
                std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
            } else {
                let made = std::process::Command::new("mkfifo").arg(&path).status().unwrap();
                assert!(made.success());
            }
            let Loaded { settings, notice } = store.load();
            assert_eq!(settings, Settings::default());
            assert!(notice.unwrap().contains("it is not a regular file"));
            store.save(&Settings::default()).unwrap();
            assert!(!path.is_file(), "it is left as it is");
        }
    }

    #[test]
    fn a_file_that_cannot_be_read_is_not_written_over() {
        let (_folder, mut store, path) = store();
        std::fs::create_dir(&path).unwrap();
        assert!(store.load().notice.unwrap().contains("nothing is saved"));
        store.save(&Settings::default()).unwrap();
        assert!(path.is_dir());
    }

    #[test]
    fn numbers_out_of_range_and_unknown_keys_do_no_harm() {
        let (_folder, mut store, path) = store();
        let text = "ui_scale = 99.0\ncache_mib = 1\nlast_scene = \"format = 99\"\nlights = true\n\
                    [layers]\ngrid = true\nsky = 1\n";
        std::fs::write(&path, text).unwrap();
        let Loaded { settings, notice } = store.load();
        assert_eq!((settings.ui_scale, settings.cache_mib, notice), (3.0, 64, None));
        assert!(settings.layers.grid && settings.layers.curve && settings.last_scene.is_none());
        assert_eq!(unknown_keys(text), ["lights", "layers.sky"]);
        assert_eq!(Settings { ui_scale: f32::NAN, ..settings }.sound().ui_scale, 1.0);
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

    #[test]
    fn without_folders_nothing_is_read_or_written() {
        let mut store = Store::new(&Folders::none());
        store.save(&Settings { animate: false, ..Settings::default() }).unwrap();
        assert_eq!(store.load(), Loaded { settings: Settings::default(), notice: None });
    }
}
