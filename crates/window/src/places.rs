//! Bookmarks: places that the user wants to find again. Each is a small picture in a folder and
//! contains its scene, as every picture written by this program does.

use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::folders::Folders;
use flipmap_render::output::{
    Destination, Picture, PngError, PngWriter, SafeFile, open_plain, picture_in_png,
};

/// A place with a name and a small picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Bookmark {
    /// Name of the bookmark and of its file.
    pub name: String,
    /// Scene with its picture.
    pub picture: Arc<Picture>,
}

/// All bookmarks, sorted by name.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// Folder of the files; none if nothing is kept: bookmarks then last as long as the window.
    folder: Option<PathBuf>,
    bookmarks: Vec<Bookmark>,
}

/// The reason why a bookmark could not be changed.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// A name that no file can have.
    #[error(
        "'{0}' cannot be the name of a bookmark: use 1 to 80 letters, digits, spaces, or any of \
         - _ , . + ( ), the first not a dot"
    )]
    Name(String),
    /// A name that another bookmark has.
    #[error("there is a bookmark called '{0}' already; choose another name")]
    Taken(String),
    /// A bookmark that no longer exists.
    #[error("there is no bookmark called '{0}' any more")]
    Missing(String),
    /// A file that could not be changed.
    #[error("the bookmark '{name}' could not be {what}: {source}")]
    File {
        /// Name of the bookmark.
        name: String,
        /// Action that failed, such as "renamed".
        what: &'static str,
        /// Cause of the failure.
        source: PngError,
    },
}

/// Longest side of a bookmark's picture in pixels; larger pictures are not bookmarks.
const MAX_SIDE: u32 = 1024;

impl Places {
    /// Loads the bookmarks in these folders; logs and leaves alone pictures that are not bookmarks.
    pub fn load(folders: &Folders) -> Self {
        let folder = folders.data.as_ref().map(|folder| folder.join("bookmarks"));
        let mut places = Places { folder, bookmarks: Vec::new() };
        let entries = places.folder.as_ref().and_then(|folder| std::fs::read_dir(folder).ok());
        for path in entries.into_iter().flatten().flatten().map(|entry| entry.path()) {
            let Some(name) = name_of(&path) else { continue };
            match read(&path) {
                Ok(picture) => {
                    places.bookmarks.push(Bookmark { name, picture: Arc::new(picture) });
                }
                Err(error) => log::warn!("{} {error}; it is no bookmark", path.display()),
            }
        }
        places.sort();
        places
    }

    /// Returns all bookmarks, sorted by name.
    pub fn bookmarks(&self) -> &[Bookmark] {
        &self.bookmarks
    }

    /// Returns a name that no bookmark has yet.
    pub(crate) fn free_name(&self) -> String {
        let names = (1..).map(|k| format!("place {k}"));
        names.into_iter().find(|name| self.find(name).is_none()).expect("some number is free")
    }

    /// Adds a bookmark.
    pub fn add(&mut self, name: &str, picture: Picture) -> Result<(), PlaceError> {
        let name = self.usable(name, None)?;
        if let Some(path) = self.path(&name) {
            write(&path, &picture).map_err(failed(&name, "kept"))?;
        }
        self.bookmarks.push(Bookmark { name, picture: Arc::new(picture) });
        self.sort();
        Ok(())
    }

    /// Renames a bookmark.
    pub fn rename(&mut self, old: &str, new: &str) -> Result<(), PlaceError> {
        let place = self.find(old).ok_or_else(|| PlaceError::Missing(old.to_string()))?;
        let new = self.usable(new, Some(old))?;
        if let (Some(from), Some(to)) = (self.path(old), self.path(&new)) {
            std::fs::rename(from, to).map_err(failed(old, "renamed"))?;
        }
        self.bookmarks[place].name = new;
        self.sort();
        Ok(())
    }

    /// Deletes a bookmark.
    pub fn delete(&mut self, name: &str) -> Result<(), PlaceError> {
        let place = self.find(name).ok_or_else(|| PlaceError::Missing(name.to_string()))?;
        match self.path(name).map(std::fs::remove_file) {
            Some(Err(error)) if error.kind() != io::ErrorKind::NotFound => {
                return Err(failed(name, "deleted")(error));
            }
            _ => {}
        }
        self.bookmarks.remove(place);
        Ok(())
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.bookmarks.iter().position(|bookmark| bookmark.name == name)
    }

    fn path(&self, name: &str) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(format!("{name}.png")))
    }

    /// Returns the trimmed name, if a new bookmark or the one called `old` can have it.
    fn usable(&self, name: &str, old: Option<&str>) -> Result<String, PlaceError> {
        let name = name.trim();
        let fits = |c: char| c.is_alphanumeric() || " -_,.+()".contains(c);
        let short = (1..=80).contains(&name.chars().count()) && name.len() <= 240;
        if !short || !name.chars().all(fits) || name.starts_with('.') {
            return Err(PlaceError::Name(name.to_string()));
        }
        // Some file systems do not distinguish capitals from small letters.
        let same = |other: &str| other.to_lowercase() == name.to_lowercase();
        let mut others = self.bookmarks.iter().map(|other| other.name.as_str());
        let taken = others.any(|other| same(other) && old != Some(other));
        let is_there = self.path(name).is_some_and(|path| path.exists());
        if taken || (is_there && !old.is_some_and(same)) {
            return Err(PlaceError::Taken(name.to_string()));
        }
        Ok(name.to_string())
    }

    fn sort(&mut self) {
        self.bookmarks.sort_by_cached_key(|bookmark| bookmark.name.to_lowercase());
    }
}

fn failed<E: Into<PngError>>(name: &str, what: &'static str) -> impl Fn(E) -> PlaceError {
    move |error| PlaceError::File { name: name.to_string(), what, source: error.into() }
}

/// Returns the name of the bookmark in a PNG file; none for a hidden file, which is still being
/// written.
fn name_of(path: &Path) -> Option<String> {
    let name = path.file_stem()?.to_str()?;
    (path.extension()? == "png" && !name.starts_with('.')).then(|| name.to_string())
}

fn read(path: &Path) -> Result<Picture, PngError> {
    picture_in_png(BufReader::new(open_plain(path)?), MAX_SIDE)
}

fn write(path: &Path, picture: &Picture) -> Result<(), PngError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let file = SafeFile::create(&Destination::File(path.to_path_buf()))?;
    let mut png = PngWriter::new(file, picture.size, &picture.document)?;
    png.write(&picture.rgb)?;
    Ok(png.finish()?.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::Document;

    fn picture(width: &str) -> Picture {
        let mut document = Document::default();
        document.view.width = width.to_string();
        Picture { document, size: [4, 3], rgb: (0..36).collect() }
    }

    #[test]
    fn bookmarks_are_there_again_the_next_time() {
        let folder = tempfile::tempdir().unwrap();
        let folders = Folders::under(folder.path());
        let mut places = Places::load(&folders);
        places.add("Zoo", picture("1")).unwrap();
        places.add(" über all ", picture("2")).unwrap();
        places.add("gone", picture("3")).unwrap();
        places.rename("Zoo", "zoo").unwrap();
        places.rename("zoo", "zoo").unwrap();
        places.rename("zoo", "a zoo").unwrap();
        places.delete("gone").unwrap();
        let again = Places::load(&folders);
        let names: Vec<&str> = again.bookmarks().iter().map(|b| b.name.as_str()).collect();
        assert_eq!(names, ["a zoo", "über all"]);
        assert_eq!(again.bookmarks(), places.bookmarks());
        assert_eq!(*again.bookmarks()[0].picture, picture("1"));
        assert_eq!(again.free_name(), "place 1");
    }

    #[test]
    fn no_bookmark_is_lost_to_another() {
        let folder = tempfile::tempdir().unwrap();
        let mut places = Places::load(&Folders::under(folder.path()));
        places.add("one", picture("1")).unwrap();
        places.add("two", picture("2")).unwrap();
        assert!(matches!(places.add("ONE", picture("3")), Err(PlaceError::Taken(_))));
        assert!(matches!(places.rename("two", "one"), Err(PlaceError::Taken(_))));
        assert!(matches!(places.rename("three", "four"), Err(PlaceError::Missing(_))));
        for bad in ["", " ", "../up", ".hidden", "a/b", "a\\b", "a:b", "a\nb", &"x".repeat(81)] {
            assert!(matches!(places.add(bad, picture("4")), Err(PlaceError::Name(_))), "{bad}");
        }
        assert_eq!(*places.bookmarks()[0].picture, picture("1"));
    }

    #[test]
    fn what_is_no_bookmark_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let folders = Folders::under(folder.path());
        Places::load(&folders).add("good", picture("1")).unwrap();
        let inside = folder.path().join("data/bookmarks");
        for name in ["broken.png", "notes.txt", ".flipmap-1.png"] {
            std::fs::write(inside.join(name), "x").unwrap();
        }
        assert_eq!(Places::load(&folders).bookmarks().len(), 1);
        assert_eq!(std::fs::read_dir(inside).unwrap().count(), 4);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_said_and_nothing_changes() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("data"), "a file").unwrap();
        let mut places = Places::load(&Folders::under(folder.path()));
        let error = places.add("one", picture("1")).unwrap_err().to_string();
        assert!(error.starts_with("the bookmark 'one' could not be kept: "), "{error}");
        assert!(places.bookmarks().is_empty());
    }

    #[test]
    fn without_folders_bookmarks_last_as_long_as_the_window() {
        let mut places = Places::load(&Folders::none());
        places.add("one", picture("1")).unwrap();
        places.rename("one", "two").unwrap();
        assert_eq!(places.bookmarks()[0].name, "two");
        places.delete("two").unwrap();
        assert!(places.bookmarks().is_empty());
    }
}
