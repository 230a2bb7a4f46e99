//! A folder for what lies on no path of the user's, removed at the end, or by a later run if this one
//! is killed.

use std::fs;
use std::io;
use std::path::Path;

use tempfile::{Builder, TempDir};

/// Beginning of the names of such folders; the number of the process follows.
const PREFIX: &str = "flipmap-film-";

/// A temporary folder of this process.
pub(super) struct TemporaryFolder(TempDir);

impl TemporaryFolder {
    /// Makes the folder, and removes those of processes that are gone.
    pub(super) fn new() -> io::Result<Self> {
        let place = std::env::temp_dir();
        remove_abandoned(&place);
        let prefix = format!("{PREFIX}{}-", std::process::id());
        Ok(TemporaryFolder(Builder::new().prefix(&prefix).tempdir_in(place)?))
    }

    /// Returns the path of the folder.
    pub(super) fn path(&self) -> &Path {
        self.0.path()
    }
}

/// Removes the folders of processes that are gone. What cannot be read or removed is left.
fn remove_abandoned(place: &Path) {
    // Only Linux tells here which processes run.
    if !Path::new("/proc/self").exists() {
        return;
    }
    let Ok(entries) = fs::read_dir(place) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let process = name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.split('-').next());
        let is_gone = |process: &str| {
            let is_number = !process.is_empty() && process.bytes().all(|b| b.is_ascii_digit());
            is_number && !Path::new("/proc").join(process).exists()
        };
        if process.is_some_and(is_gone) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn folders_of_processes_that_are_gone_are_removed_and_no_others() {
        let place = tempfile::tempdir().unwrap();
        let own = format!("{PREFIX}{}-abc", std::process::id());
        // No process has this number: it is above the largest that Linux gives.
        let gone = format!("{PREFIX}4194305-abc");
        let names = [own.as_str(), &gone, "flipmap-film-x-1", "other"];
        names.iter().for_each(|name| fs::create_dir(place.path().join(name)).unwrap());
        fs::write(place.path().join(&gone).join("film.mp4"), "half").unwrap();
        remove_abandoned(place.path());
        let left = names.map(|name| place.path().join(name).exists());
        assert_eq!(left, [true, false, true, true]);
    }
}
