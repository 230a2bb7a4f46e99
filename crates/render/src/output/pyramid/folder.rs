//! The folder of a pyramid, which appears only when it is complete.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::output::UnfinishedFolder;
use crate::output::safe::{existing_folder_of, refuse_what_fails_at_the_end};

/// File with the sizes of the picture and of its tiles, for viewers.
pub(super) const IMAGE: &str = "map.dzi";
/// Folder of the tiles.
pub(super) const TILES: &str = "map_files";
/// Page that shows the tiles.
pub(super) const PAGE: &str = "index.html";
/// File with the scene, for rendering the picture again.
pub(super) const SCENE: &str = "map.toml";

/// Names in the temporary folder: `NEW` is the pyramid being written, `OLD` the one it replaces.
const NEW: &str = "new";
const OLD: &str = "old";

/// A pyramid's folder, written beside its destination.
pub struct PyramidFolder {
    beside: UnfinishedFolder,
    path: PathBuf,
}

impl PyramidFolder {
    /// Begins a folder; refuses at once a destination that could not be replaced at the end.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        if path.is_symlink() && !path.exists() {
            return Err(io::Error::other("is a link to nothing: remove it, or name a folder"));
        }
        check_replaceable(path)?;
        if !path.exists() {
            refuse_what_fails_at_the_end(path)?;
        }
        // The target of a link is replaced, not the link.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        let folder = existing_folder_of(&path)?;
        check_same_disk(&path, folder)?;
        let beside = UnfinishedFolder::create_in(folder)?;
        fs::create_dir(beside.path().join(NEW))?;
        Ok(PyramidFolder { beside, path })
    }

    /// Path of the folder to write into.
    pub(crate) fn inside(&self) -> PathBuf {
        self.beside.path().join(NEW)
    }

    /// Renames the pyramid to its destination. If that fails, the pyramid, which may have taken
    /// hours, is kept, and the error says where.
    pub fn finish(self) -> io::Result<()> {
        let replaced = self.beside.release().and_then(|()| self.replace());
        let Err(error) = replaced else { return Ok(()) };
        let kept = self.beside.keep().join(NEW);
        let text = format!("{error}; the pyramid is complete in {}", kept.display());
        Err(io::Error::new(error.kind(), text))
    }

    fn replace(&self) -> io::Result<()> {
        check_replaceable(&self.path)?;
        let old = self.beside.path().join(OLD);
        let replaces = self.path.exists();
        if replaces {
            fs::rename(&self.path, &old)?;
        }
        fs::rename(self.inside(), &self.path).inspect_err(|_| {
            if replaces {
                // Nothing is lost if this fails too: the error says where everything is.
                let _ = fs::rename(&old, &self.path);
            }
        })
    }
}

/// Refuses to replace anything but an empty folder, or one that holds a pyramid of flipmap's and
/// nothing else.
fn check_replaceable(path: &Path) -> io::Result<()> {
    if !path.exists() {
        return Ok(());
    }
    if !path.is_dir() {
        return Err(io::Error::other("is a file: name a folder"));
    }
    let names = fs::read_dir(path)?.map(|entry| Ok(entry?.file_name()));
    let names: Vec<_> = names.collect::<io::Result<_>>()?;
    let holds = |name: &str| names.iter().any(|found| found == name);
    let ours = [IMAGE, PAGE, SCENE, TILES].map(OsStr::new);
    let mut foreign =
        names.iter().find(|name| !ours.contains(&name.as_os_str())).map(PathBuf::from);
    if foreign.is_none() && holds(TILES) {
        foreign = no_tile_in(&path.join(TILES))?.map(|name| Path::new(TILES).join(name));
    }
    if names.is_empty() || (holds(IMAGE) && holds(PAGE) && foreign.is_none()) {
        return Ok(());
    }
    let found = foreign.unwrap_or_else(|| PathBuf::from(&names[0]));
    let found = found.display();
    let text = format!("holds {found} and is not a pyramid of flipmap's: name a new folder");
    Err(io::Error::other(text))
}

/// Returns a name in a folder of tiles that a pyramid does not have: its levels are folders with
/// numbers for names, and hold tiles such as `3_14.png`.
fn no_tile_in(tiles: &Path) -> io::Result<Option<PathBuf>> {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let is_tile = |name: &str| {
        let place = name.strip_suffix(".png").and_then(|place| place.split_once('_'));
        place.is_some_and(|(column, row)| is_number(column) && is_number(row))
    };
    for level in fs::read_dir(tiles)? {
        let level = level?;
        let name = PathBuf::from(level.file_name());
        if !level.file_type()?.is_dir() || !name.to_str().is_some_and(is_number) {
            return Ok(Some(name));
        }
        for tile in fs::read_dir(level.path())? {
            let tile = tile?.file_name();
            if !tile.to_str().is_some_and(is_tile) {
                return Ok(Some(name.join(tile)));
            }
        }
    }
    Ok(None)
}

/// Refuses a folder where another disk is mounted: a folder beside it cannot be renamed onto it.
#[cfg(unix)]
fn check_same_disk(path: &Path, folder: &Path) -> io::Result<()> {
    if path.exists() {
        use std::os::unix::fs::MetadataExt;
        if path.metadata()?.dev() != folder.metadata()?.dev() {
            let text = "is where another disk is mounted: name a folder in it";
            return Err(io::Error::other(text));
        }
    }
    Ok(())
}

#[cfg(not(unix))]
fn check_same_disk(_: &Path, _: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::safe::HELD;

    fn write(folder: &Path, text: &str) -> io::Result<()> {
        let new = PyramidFolder::create(folder)?;
        for name in [IMAGE, PAGE, SCENE] {
            fs::write(new.inside().join(name), text)?;
        }
        new.finish()
    }

    fn refused(folder: &Path) -> String {
        PyramidFolder::create(folder).err().unwrap().to_string()
    }

    #[test]
    fn a_pyramid_replaces_a_pyramid_and_only_at_the_end() {
        let outside = tempfile::tempdir().unwrap();
        let path = outside.path().join("map");
        fs::create_dir(&path).unwrap();
        for text in ["first", "second"] {
            write(&path, text).unwrap();
            assert_eq!(fs::read_to_string(path.join(PAGE)).unwrap(), text);
        }
        let unfinished = PyramidFolder::create(&path).unwrap();
        assert_eq!(fs::read_to_string(path.join(PAGE)).unwrap(), "second");
        drop(unfinished);
        assert_eq!(fs::read_dir(outside.path()).unwrap().count(), 1);
    }

    #[test]
    fn whatever_else_is_there_is_left_alone() {
        let outside = tempfile::tempdir().unwrap();
        let at = |name: &str| outside.path().join(name);
        fs::write(at("file"), "mine").unwrap();
        assert!(refused(&at("file")).contains("is a file"));
        assert!(refused(&at("no/map")).contains("no does not exist"));
        fs::create_dir(at("full")).unwrap();
        fs::write(at("full").join(PAGE), "a site").unwrap();
        assert!(refused(&at("full")).contains("holds index.html and is not a pyramid"));
        write(&at("map"), "ours").unwrap();
        fs::write(at("map").join("notes.txt"), "mine").unwrap();
        assert!(refused(&at("map")).contains("holds notes.txt"));
        fs::remove_file(at("map").join("notes.txt")).unwrap();
        fs::create_dir_all(at("map").join("map_files/0")).unwrap();
        fs::write(at("map").join("map_files/0/0_0.png"), "ours").unwrap();
        assert!(PyramidFolder::create(&at("map")).is_ok());
        for foreign in ["map_files/0/my.txt", "map_files/note.txt"] {
            fs::write(at("map").join(foreign), "mine").unwrap();
            assert!(refused(&at("map")).contains(&format!("holds {foreign} and is not a pyramid")));
            fs::remove_file(at("map").join(foreign)).unwrap();
        }
        if Path::new("/proc/version").exists() {
            assert!(refused(Path::new("/proc")).contains("holds"));
        }
    }

    #[test]
    fn what_cannot_take_its_place_is_kept() {
        let outside = tempfile::tempdir().unwrap();
        let path = outside.path().join("map");
        let new = PyramidFolder::create(&path).unwrap();
        fs::write(new.inside().join(PAGE), "hours").unwrap();
        fs::write(&path, "taken meanwhile").unwrap();
        let error = new.finish().unwrap_err().to_string();
        let (why, kept) = error.split_once("; the pyramid is complete in ").unwrap();
        assert_eq!(why, "is a file: name a folder");
        let held = Path::new(kept).with_file_name(HELD);
        assert!(!held.exists(), "or the next run would remove it");
        assert_eq!(fs::read_to_string(Path::new(kept).join(PAGE)).unwrap(), "hours");
        assert_eq!(fs::read_to_string(&path).unwrap(), "taken meanwhile");
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_links() {
        let outside = tempfile::tempdir().unwrap();
        let [path, link, lost] = ["map", "link", "lost"].map(|name| outside.path().join(name));
        write(&path, "old").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write(&link, "new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(path.join(PAGE)).unwrap(), "new");
        std::os::unix::fs::symlink(outside.path().join("nothing"), &lost).unwrap();
        assert!(refused(&lost).contains("a link to nothing"));
    }
}
