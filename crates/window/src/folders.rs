//! The folders for the user's files: those of the XDG standard, or none.

use std::path::{Path, PathBuf};

use etcetera::BaseStrategy;

/// The program's own folders; none if nothing is to be kept (`--no-config`).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folders {
    /// Folder for settings.
    pub config: Option<PathBuf>,
    /// Folder for bookmarks.
    pub data: Option<PathBuf>,
}

impl Folders {
    /// Returns the user's folders; none without a home directory.
    pub fn of_user() -> Self {
        let Ok(base) = etcetera::choose_base_strategy() else { return Folders::default() };
        let own = |folder: PathBuf| Some(folder.join("flipmap"));
        Folders { config: own(base.config_dir()), data: own(base.data_dir()) }
    }

    /// Returns no folders: nothing is read and nothing is kept.
    pub fn none() -> Self {
        Folders::default()
    }

    /// Returns both folders inside the given one.
    pub fn under(folder: &Path) -> Self {
        Folders { config: Some(folder.join("config")), data: Some(folder.join("data")) }
    }
}
