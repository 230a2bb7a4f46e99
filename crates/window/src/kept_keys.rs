//! The keys of the film that is being planned, kept between runs in a file that `flipmap video` and the
//! film panel read as well.

use std::io;
use std::path::{Path, PathBuf};

use super::film_draft::FilmDraft;
use super::folders::{Folders, free_beside};
use flipmap_render::output::{Destination, SafeFile, read_text};
use flipmap_scene::keys::Keys;

/// The file that keeps the keys, or none.
#[derive(Debug, Default)]
pub(super) struct KeptKeys {
    path: Option<PathBuf>,
    /// The text that this window last read or wrote; none if there was no file.
    text: Option<String>,
}

impl KeptKeys {
    /// Returns the file in these folders. Without a folder nothing is ever read or written.
    pub(super) fn new(folders: &Folders) -> Self {
        let path = folders.config.as_ref().map(|folder| folder.join("film-keys.toml"));
        KeptKeys { path, text: None }
    }

    /// Takes the kept keys into a draft; returns a sentence for the user if there are any. The error
    /// is a sentence too.
    pub(super) fn load(&mut self, draft: &mut FilmDraft) -> Result<Option<String>, String> {
        let Some(path) = &self.path else { return Ok(None) };
        let text = match read_text(path) {
            // Where the folder is no folder, the settings say so.
            Err(error)
                if [io::ErrorKind::NotFound, io::ErrorKind::NotADirectory]
                    .contains(&error.kind()) =>
            {
                return Ok(None);
            }
            other => other,
        };
        let refuse = |why: String| format!("The keys of your film in {} {why}.", path.display());
        let text = text.map_err(|error| refuse(format!("cannot be read: {error}")))?;
        let keys = Keys::parse(&text).map_err(|error| refuse(format!("are none: {error}")))?;
        draft.keys = keys.keys;
        self.text = text_of(draft);
        let many = draft.keys.len();
        Ok(Some(format!("The film that you planned is under Film; its keys: {many}.")))
    }

    /// Returns true if the keys of a draft are kept.
    pub(super) fn holds(&self, draft: &FilmDraft) -> bool {
        text_of(draft) == self.text
    }

    /// Keeps the keys of a draft if they have changed, and removes the file if there are none. Where
    /// another window has kept other keys, this one takes a file of its own and returns a sentence
    /// that says so.
    pub(super) fn save(&mut self, draft: &FilmDraft) -> io::Result<Option<String>> {
        let text = text_of(draft);
        if text == self.text {
            return Ok(None);
        }
        let Some(path) = self.path.clone() else { return Ok(None) };
        let is_same = self.text.is_some() && text_in(&path) == self.text;
        let is_ours = is_same || !path.exists();
        let own = if is_ours { path.clone() } else { free_beside(&path, "film-keys", |_| false) };
        match &text {
            Some(text) => {
                if let Some(folder) = own.parent() {
                    std::fs::create_dir_all(folder)?;
                }
                SafeFile::write_whole(&Destination::File(own.clone()), text.as_bytes())?;
            }
            None if is_ours && path.exists() => std::fs::remove_file(&path)?,
            None => {}
        }
        let notice = (!is_ours && text.is_some()).then(|| {
            let (path, own) = (path.display(), own.display());
            format!("{path} has the keys of another film; those of this one are kept in {own}.")
        });
        (self.path, self.text) = (Some(own), text);
        Ok(notice)
    }
}

/// Returns the text of the file for these keys; none if there are none.
fn text_of(draft: &FilmDraft) -> Option<String> {
    (!draft.keys.is_empty()).then(|| draft.text())
}

/// Returns the text of the keys in a file; none if it has none.
fn text_in(path: &Path) -> Option<String> {
    Some(Keys::parse(&read_text(path).ok()?).ok()?.text())
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::Document;

    fn draft(keys: usize) -> FilmDraft {
        let mut draft = FilmDraft::default();
        (0..keys).for_each(|_| draft.add(Document::default()));
        draft
    }

    fn loaded(folders: &Folders) -> (KeptKeys, FilmDraft) {
        let (mut kept, mut draft) = (KeptKeys::new(folders), FilmDraft::default());
        kept.load(&mut draft).unwrap();
        (kept, draft)
    }

    #[test]
    fn keys_are_there_again_until_they_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let folders = Folders::under(folder.path());
        assert_eq!(KeptKeys::new(&folders).save(&draft(2)).unwrap(), None);
        let (mut kept, mut opened) = loaded(&folders);
        assert_eq!(opened.keys, draft(2).keys);
        opened.add(Document::default());
        kept.save(&opened).unwrap();
        assert_eq!(loaded(&folders).1.keys.len(), 3);
        kept.save(&draft(0)).unwrap();
        assert_eq!(loaded(&folders).1.keys, []);
        assert!(!folder.path().join("config/film-keys.toml").exists());
    }

    #[test]
    fn the_keys_of_two_windows_are_both_kept() {
        let folder = tempfile::tempdir().unwrap();
        let folders = Folders::under(folder.path());
        let [mut one, mut two] = [(); 2].map(|()| loaded(&folders).0);
        assert_eq!(one.save(&draft(1)).unwrap(), None);
        let told = two.save(&draft(2)).unwrap().unwrap();
        assert!(told.contains("film-keys-1.toml"), "{told}");
        assert_eq!(one.save(&draft(3)).unwrap(), None);
        assert_eq!(two.save(&draft(4)).unwrap(), None);
        assert_eq!(loaded(&folders).1.keys.len(), 3);
        let keys_path = folder.path().join("config/film-keys-1.toml").display().to_string();
        let mut other = FilmDraft { keys_path, ..FilmDraft::default() };
        other.open_keys().unwrap();
        assert_eq!(other.keys.len(), 4);
    }

    #[test]
    fn what_has_no_keys_is_said_and_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let folders = Folders::under(folder.path());
        std::fs::create_dir_all(folder.path().join("config")).unwrap();
        let path = folder.path().join("config/film-keys.toml");
        std::fs::write(&path, "dear = \"diary\"").unwrap();
        let (mut kept, mut opened) = (KeptKeys::new(&folders), FilmDraft::default());
        assert!(kept.load(&mut opened).unwrap_err().contains("film-keys.toml"));
        kept.save(&draft(1)).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "dear = \"diary\"");
        assert_eq!(KeptKeys::new(&Folders::none()).save(&draft(1)).unwrap(), None);
    }
}
