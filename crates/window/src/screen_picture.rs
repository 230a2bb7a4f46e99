//! The map as it is on the screen, saved or copied at once: nothing is computed again.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use egui::ColorImage;

use super::canvas::copied::CopiedPicture;
use super::compute_service::Wake;
use super::model::AppModel;
use flipmap_render::output::{PictureFile, RowPainter};
use flipmap_scene::Document;

/// Highest number in the name of a picture; beyond that, names are taken again from 1 upwards.
const LAST_NUMBER: u32 = 99_999;

/// Pictures that are being written.
#[derive(Default)]
pub(crate) struct SavedPictures {
    running: Vec<Receiver<Result<PathBuf, String>>>,
}

impl SavedPictures {
    /// Begins to write a picture of what a document shows.
    pub(crate) fn begin(
        &mut self,
        copied: CopiedPicture,
        document: Document,
        path: PathBuf,
        wake: Wake,
    ) {
        let (sender, news) = channel();
        std::thread::spawn(move || {
            let written = write(copied, &document, &path).map(|()| path);
            // The window may have been closed by now; the picture is written all the same.
            let _ = sender.send(written);
            wake();
        });
        self.running.push(news);
    }

    /// Returns what has become of the pictures that are finished.
    pub(crate) fn news(&mut self) -> Vec<Result<PathBuf, String>> {
        let mut news = Vec::new();
        self.running.retain(|picture| match picture.try_recv() {
            Ok(written) => {
                news.push(written);
                false
            }
            Err(std::sync::mpsc::TryRecvError::Empty) => true,
            Err(std::sync::mpsc::TryRecvError::Disconnected) => false,
        });
        news
    }
}

impl AppModel {
    /// Begins to write a picture of the map on the screen, if there is one.
    pub(crate) fn write_picture(
        &mut self,
        copied: Option<CopiedPicture>,
        of: Document,
        path: PathBuf,
    ) {
        match copied {
            Some(copied) => self.saved_pictures.begin(copied, of, path, Arc::clone(&self.wake)),
            None => self.state.notices.fail("There is no map to save yet."),
        }
    }

    /// Returns a copy of the map on the screen as an image, and tells the user of it.
    pub(crate) fn image(
        &mut self,
        copied: Option<CopiedPicture>,
        of: &Document,
    ) -> Option<ColorImage> {
        let copied = copied?;
        let size = copied.size_px.map(|side| side as usize);
        match marked(copied, of) {
            Ok(rgb) => {
                self.state.notices.tell("The picture was copied.");
                Some(ColorImage::from_rgb(size, &rgb))
            }
            Err(problem) => {
                self.state.notices.fail(format!("The picture was not copied: {problem}."));
                None
            }
        }
    }

    /// Tells what has become of pictures that were being written; returns true if there is news.
    pub(super) fn tell_of_pictures(&mut self) -> bool {
        let news = self.saved_pictures.news();
        for written in &news {
            match written {
                Ok(path) => self.state.notices.tell(format!("Saved as {}.", path.display())),
                Err(problem) => self.state.notices.fail(format!("Not saved: {problem}.")),
            }
        }
        !news.is_empty()
    }
}

/// Returns the pixels of a picture as RGB bytes, with the marks that its document asks for.
fn marked(copied: CopiedPicture, document: &Document) -> Result<Vec<u8>, String> {
    let size = copied.size_px;
    let colours = copied.colours().ok_or("the graphics device did not answer")?;
    let painter = RowPainter::new(&document.scene(), size, &document.picture);
    Ok(painter.map_err(|error| error.to_string())?.marked(&colours))
}

fn write(copied: CopiedPicture, document: &Document, path: &Path) -> Result<(), String> {
    let size = copied.size_px;
    let rgb = marked(copied, document)?;
    let written = || {
        let mut file = PictureFile::create(path, size, Some(document))?;
        file.write(&rgb)?;
        file.complete()?.finish()
    };
    written().map_err(|error| format!("cannot write {}: {error}", path.display()))
}

/// Returns a path in a folder that no file has: flipmap-1.png, flipmap-2.png, …
pub(crate) fn free_path(folder: &Path) -> PathBuf {
    let named = |number: u32| folder.join(format!("flipmap-{number}.png"));
    (1..=LAST_NUMBER).map(named).find(|path| !path.exists()).unwrap_or_else(|| named(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_never_replace_each_other() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(free_path(folder.path()).file_name().unwrap(), "flipmap-1.png");
        for name in ["flipmap-1.png", "flipmap-2.png", "flipmap-4.png"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        assert_eq!(free_path(folder.path()).file_name().unwrap(), "flipmap-3.png");
    }
}
