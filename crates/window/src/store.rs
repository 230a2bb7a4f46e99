//! The file of the settings, which several windows may share: each writes only what it changed.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use toml::{Table, Value};

use super::folders::{Folders, free_beside};
use super::settings::Settings;
use super::settings_file::{BadValue, merge, remove_bad, warn_of_unknown};
use flipmap_render::output::{Destination, SafeFile, read_text};

/// The file that holds the settings, or none.
#[derive(Clone, Debug)]
pub struct Store {
    path: Option<PathBuf>,
    /// The settings that this window last read or wrote.
    base: Table,
    /// True once the user knows that nothing can be kept.
    has_complained: bool,
}

/// The settings at the start, and what the user should know about them.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// Saved settings, or the defaults.
    pub settings: Settings,
    /// Sentence for the user, if the file could not be used.
    pub notice: Option<String>,
}

/// Beginning of the names under which files with bad values are kept.
const BAD: &str = "settings-bad";
/// Number of times that a window tries to lock the file, and the time between two of them.
const TRIES: u32 = 10;
const BETWEEN_TRIES: Duration = Duration::from_millis(5);

impl Store {
    /// Returns the store in these folders. Without a folder nothing is ever read or written.
    pub fn new(folders: &Folders) -> Self {
        let path = folders.config.as_ref().map(|folder| folder.join("settings.toml"));
        Store { path, base: table_of(&Settings::default()), has_complained: false }
    }

    /// Returns true if settings are kept.
    pub(crate) fn keeps(&self) -> bool {
        self.path.is_some()
    }

    /// Loads the saved settings. A file that is not valid is moved aside and not lost; of one with
    /// wrong values, all others are used.
    pub fn load(&mut self) -> Loaded {
        let (settings, notice) = match self.path.clone() {
            Some(path) => self.load_from(&path),
            None => (Settings::default(), None),
        };
        self.base = table_of(&settings);
        Loaded { settings, notice: notice.or_else(|| self.cannot_keep()) }
    }

    fn load_from(&mut self, path: &Path) -> (Settings, Option<String>) {
        let fresh = |notice| (Settings::default(), notice);
        let text = match read_text(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return fresh(None),
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                return fresh(Some(self.set_aside(path, &error.to_string())));
            }
            Err(error) => {
                (self.path, self.has_complained) = (None, true);
                let path = path.display();
                return fresh(Some(format!(
                    "Your settings in {path} could not be read ({error}); nothing is saved this \
                     time."
                )));
            }
        };
        let mut table = match text.parse::<Table>() {
            Ok(table) => table,
            Err(error) => return fresh(Some(self.set_aside(path, error.message()))),
        };
        warn_of_unknown(&table);
        let bad = remove_bad(&mut table);
        let notice = (!bad.is_empty()).then(|| keep_copy(path, &bad));
        // Every value that is left can be read.
        (table.try_into::<Settings>().unwrap_or_default().sound(), notice)
    }

    /// Returns a sentence that says why nothing can be kept; none if it can.
    fn cannot_keep(&mut self) -> Option<String> {
        let path = self.path.clone()?;
        let made = path.parent().map_or(Ok(()), std::fs::create_dir_all);
        let error = made.and_then(|()| SafeFile::check(&Destination::File(path.clone()))).err()?;
        self.has_complained = true;
        let path = path.display();
        Some(format!(
            "Settings and the keys of films cannot be kept: cannot write {path}: {error}."
        ))
    }

    /// Returns true if the user does not know yet that nothing can be kept; from then on, false.
    pub(crate) fn complains_first(&mut self) -> bool {
        !std::mem::replace(&mut self.has_complained, true)
    }

    /// Moves a bad file to a free name; if that fails it stays, and nothing is saved over it.
    fn set_aside(&mut self, path: &Path, why: &str) -> String {
        let aside = free_beside(path, BAD, |_| false);
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

    /// Writes what has changed in the settings since this window last read or wrote them, and leaves
    /// the rest as another window wrote it; the old file stays until the new one is complete.
    pub fn save(&mut self, settings: &Settings) -> io::Result<()> {
        let Some(path) = self.path.clone() else { return Ok(()) };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        // Without a lock the file is still written as a whole.
        let lock = lock_beside(&path);
        let ours = table_of(settings);
        let mut merged = current(&path).unwrap_or_else(|| self.base.clone());
        merge(&mut merged, &self.base, &ours);
        let text = toml::to_string(&merged).map_err(io::Error::other)?;
        SafeFile::write_whole(&Destination::File(path), text.as_bytes())?;
        drop(lock);
        self.base = ours;
        Ok(())
    }
}

/// Returns the good values that the file holds now; none if there is no such file.
fn current(path: &Path) -> Option<Table> {
    let text = read_text(path).ok()?;
    let mut table = text.parse::<Table>().ok();
    let bad = table.as_mut().map(remove_bad);
    if bad.is_none_or(|bad| !bad.is_empty()) {
        // Someone has edited the file while the window was open.
        log::warn!("{} was edited and has bad values{}", path.display(), copied(path));
    }
    table
}

/// Locks the settings in this file against other windows; returns none if that takes too long.
fn lock_beside(path: &Path) -> Option<File> {
    let lock = File::options().create(true).append(true).open(path.with_extension("lock")).ok()?;
    for _ in 0..TRIES {
        match lock.try_lock() {
            Ok(()) => return Some(lock),
            Err(TryLockError::WouldBlock) => sleep(BETWEEN_TRIES),
            Err(TryLockError::Error(_)) => return None,
        }
    }
    None
}

/// Copies a file with bad values to a free name; returns a sentence that says so.
fn keep_copy(path: &Path, bad: &[BadValue]) -> String {
    let words: Vec<String> = bad.iter().map(ToString::to_string).collect();
    format!("In your settings, {}{}.", words.join("; "), copied(path))
}

/// Copies a file to a free name; returns words that say so, or none if it cannot be copied.
fn copied(path: &Path) -> String {
    let copy = free_beside(path, BAD, |_| false);
    match std::fs::copy(path, &copy) {
        Ok(_) => format!("; the old file is kept as {}", copy.display()),
        Err(_) => String::new(),
    }
}

fn table_of(settings: &Settings) -> Table {
    match Value::try_from(settings) {
        Ok(Value::Table(table)) => table,
        _ => Table::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{EdgeSamples, Layers, Theme};
    use flipmap_scene::{Document, PictureTable};

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
    fn two_windows_keep_what_each_of_them_changed() {
        let (folder, mut first, _) = store();
        let mut second = Store::new(&Folders::under(folder.path()));
        let [mut one, mut two] = [&mut first, &mut second].map(|store| store.load().settings);
        let magma = PictureTable { palette: "magma".into(), ..PictureTable::default() };
        one.keep_colours(1, &magma);
        one.remember(Path::new("/one.png"));
        one.ui_scale = 1.5;
        two.keep_colours(2, &PictureTable { cycles: 3.0, ..magma.clone() });
        two.remember(Path::new("/two.png"));
        two.layers.grid = true;
        first.save(&one).unwrap();
        second.save(&two).unwrap();
        // What did not change since the last save is left as the other window wrote it.
        first.save(&one).unwrap();
        let both = first.load().settings;
        assert_eq!(both.recent, ["/two.png", "/one.png"]);
        assert_eq!(both.favourites.keys().collect::<Vec<_>>(), ["1", "2"]);
        assert!(both.layers.grid && both.ui_scale == 1.5);
    }

    #[test]
    fn a_file_that_is_no_table_is_set_aside_and_said() {
        let (_folder, mut store, path) = store();
        for k in 1..=2 {
            std::fs::write(&path, format!("ui_scale = big {k}")).unwrap();
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

    #[test]
    fn one_wrong_value_costs_no_other_and_is_told_once() {
        let (_folder, mut store, path) = store();
        let text = "ui_scale = \"big\"\ncache_mib = 256\nrecent = [\"/a.png\", 3]\n\
                    [layers]\ngrid = true\ncurve = 7\n[favourites]\n1 = 5\n2 = {cycles = 2.0}\n";
        std::fs::write(&path, text).unwrap();
        let Loaded { settings, notice } = store.load();
        let notice = notice.unwrap();
        for words in ["`ui_scale` is \"big\"", "from 0.5 to 3", "`layers.curve` is 7", "`recent`"] {
            assert!(notice.contains(words), "{notice}");
        }
        assert!(settings.layers.grid && settings.layers.curve && settings.cache_mib == 256);
        assert_eq!((settings.recent.len(), settings.favourites.len()), (1, 1));
        let aside = path.with_file_name("settings-bad-1.toml");
        assert_eq!(std::fs::read_to_string(aside).unwrap(), text, "nothing is lost");
        store.save(&settings).unwrap();
        let copies = std::fs::read_dir(path.parent().unwrap()).unwrap().count();
        assert_eq!(store.load().settings, settings);
        assert_eq!(store.load().notice, None);
        assert_eq!(copies, std::fs::read_dir(path.parent().unwrap()).unwrap().count());
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
    fn a_folder_that_cannot_be_written_is_said_at_the_start() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("config"), "a file").unwrap();
        let mut store = Store::new(&Folders::under(folder.path()));
        let notice = store.load().notice.unwrap();
        assert!(notice.contains("settings.toml"), "{notice}");
        assert!(!store.complains_first(), "it was said");
        #[cfg(target_os = "linux")]
        {
            let mut store = Store::new(&Folders::under(Path::new("/proc/nobody")));
            let notice = store.load().notice.unwrap();
            assert!(notice.contains("cannot write /proc/nobody/config/settings.toml"), "{notice}");
            assert!(store.save(&Settings::default()).is_err() && !store.complains_first());
        }
    }

    #[test]
    fn unknown_keys_are_kept_for_the_program_that_wrote_them() {
        let (_folder, mut store, path) = store();
        std::fs::write(&path, "lights = true\nui_scale = 99.0\n[layers]\nsky = 1\n").unwrap();
        let Loaded { settings, notice } = store.load();
        assert_eq!((settings.ui_scale, notice), (3.0, None));
        store.save(&Settings { animate: false, ..settings }).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("lights = true") && text.contains("sky = 1"), "{text}");
        assert!(text.contains("animate = false"), "{text}");
    }

    #[test]
    fn without_folders_nothing_is_read_or_written() {
        let mut store = Store::new(&Folders::none());
        store.save(&Settings { animate: false, ..Settings::default() }).unwrap();
        assert_eq!(store.load(), Loaded { settings: Settings::default(), notice: None });
    }
}
