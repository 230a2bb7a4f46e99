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

/// Returns the first of the paths `stem`-1, `stem`-2, … beside a file, with the same ending, that
/// neither exists nor `is_taken`.
pub(crate) fn free_beside(path: &Path, stem: &str, is_taken: impl Fn(&Path) -> bool) -> PathBuf {
    let ending = path.extension().unwrap_or_default().display().to_string();
    let named = |number: u32| path.with_file_name(format!("{stem}-{number}.{ending}"));
    let mut paths = (1..).map(named);
    paths.find(|path| !path.exists() && !is_taken(path)).expect("some name is free")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_name_is_neither_there_nor_taken() {
        let folder = tempfile::tempdir().unwrap();
        let near = folder.path().join("map.png");
        let free = |taken: &str| free_beside(&near, "flipmap", |path| path.ends_with(taken));
        assert_eq!(free("none"), folder.path().join("flipmap-1.png"));
        for name in ["flipmap-1.png", "flipmap-2.png", "flipmap-4.png"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        assert_eq!(free("none"), folder.path().join("flipmap-3.png"));
        assert_eq!(free("flipmap-3.png"), folder.path().join("flipmap-5.png"));
    }
}
