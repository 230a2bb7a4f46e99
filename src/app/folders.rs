//! Where the program keeps what belongs to its user: the XDG folders, or nowhere.

use std::path::{Path, PathBuf};

use etcetera::BaseStrategy;

/// The program's own folders; none where nothing is to be kept (`--no-config`).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folders {
    /// For settings.
    pub config: Option<PathBuf>,
    /// For bookmarks.
    pub data: Option<PathBuf>,
}

impl Folders {
    /// Those of the user; none without a home.
    pub fn of_user() -> Self {
        let Ok(base) = etcetera::choose_base_strategy() else { return Folders::default() };
        let own = |folder: PathBuf| Some(folder.join("flipmap"));
        Folders { config: own(base.config_dir()), data: own(base.data_dir()) }
    }

    /// Nothing is read and nothing is kept.
    pub fn none() -> Self {
        Folders::default()
    }

    /// Both under one folder.
    pub fn under(folder: &Path) -> Self {
        Folders { config: Some(folder.join("config")), data: Some(folder.join("data")) }
    }
}
