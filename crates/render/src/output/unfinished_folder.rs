//! A temporary folder, which a later run removes if this one is killed.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::safe::{HELD, UNFINISHED, UNIQUE, hold, remove_orphans};

/// A temporary folder that is removed with everything in it. A file in it, which this process locks,
/// tells other runs that this one is alive.
pub struct UnfinishedFolder {
    _held: File,
    folder: TempDir,
}

impl UnfinishedFolder {
    /// Makes the folder in another one, and removes those of killed runs there.
    pub fn create_in(place: &Path) -> io::Result<Self> {
        remove_orphans(place);
        let folder =
            tempfile::Builder::new().prefix(UNFINISHED).rand_bytes(UNIQUE).tempdir_in(place)?;
        let held = File::create(folder.path().join(HELD))?;
        hold(&held);
        Ok(UnfinishedFolder { _held: held, folder })
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Makes other runs keep the folder, which may hold the only copy of something from here on: they
    /// remove one whose held file is unlocked, and keep one without such a file.
    pub(super) fn release(&self) -> io::Result<()> {
        fs::remove_file(self.path().join(HELD))
    }

    /// Keeps the folder and returns its path.
    pub(super) fn keep(self) -> PathBuf {
        self.folder.keep()
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn folders_of_processes_that_are_gone_are_removed_and_no_others() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        let gone = format!("{UNFINISHED}{:0>UNIQUE$}", "gone");
        for name in [gone.as_str(), "other"] {
            fs::create_dir(at(name)).unwrap();
            fs::write(at(name).join("film.mp4"), "half").unwrap();
        }
        drop(File::create(at(&gone).join(HELD)).unwrap());
        let own = UnfinishedFolder::create_in(place.path()).unwrap();
        remove_orphans(&own.path().join(".."));
        assert!(own.path().exists() && at("other").exists() && !at(&gone).exists());
        let path = own.path().to_path_buf();
        drop(own);
        assert!(!path.exists());
    }
}
