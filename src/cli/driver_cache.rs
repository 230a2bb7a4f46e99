//! Turns off the shader cache of Mesa's drivers if its disk is full. They map a cache file into
//! memory, and without disk space the first write to that memory ends the program (SIGBUS).

use std::env;
use std::path::{Path, PathBuf};

use super::restart::again;

/// Mesa's variable that turns the cache off.
const OFF: &str = "MESA_SHADER_CACHE_DISABLE";
/// Free space, in bytes, for the index that Mesa maps (1.3 MB) and the shaders of one run.
const NEEDED: u64 = 8 << 20;

/// Starts this program again without the cache if there is no room for it.
pub(crate) fn do_without_on_a_full_disk() {
    if env::var_os(OFF).is_some() || folder().is_none_or(|folder| has_room(&folder, NEEDED)) {
        return;
    }
    // If this fails, the run goes on, and may end by SIGBUS.
    let Err(error) = again(|command| _ = command.env(OFF, "true"));
    log::warn!("the disk of Mesa's shader cache is full, and it cannot be turned off: {error}");
}

/// The folder that holds Mesa's cache.
fn folder() -> Option<PathBuf> {
    let of = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    of("MESA_SHADER_CACHE_DIR")
        .or_else(|| of("XDG_CACHE_HOME"))
        .or_else(|| of("HOME").map(|home| home.join(".cache")))
}

/// Returns true unless the disk of a folder is known to have less room. The folder may not exist
/// yet.
fn has_room(folder: &Path, bytes: u64) -> bool {
    folder
        .ancestors()
        .find_map(|folder| rustix::fs::statvfs(folder).ok())
        .is_none_or(|disk| disk.f_bavail.saturating_mul(disk.f_frsize) >= bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_is_that_of_the_nearest_folder_that_exists() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("not/yet/there");
        assert!(has_room(&deep, 1));
        assert!(!has_room(&deep, u64::MAX));
    }
}
