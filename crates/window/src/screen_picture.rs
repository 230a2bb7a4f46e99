//! The map as it is on the screen, saved or copied at once: nothing is computed again. Figures of the
//! laboratory are saved in the same way.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use egui::ColorImage;

use super::compute_service::Wake;
use super::folders::free_beside;
use super::model::AppModel;
use flipmap_render::output::{PictureFile, RowPainter};
use flipmap_scene::Document;
use flipmap_screen::canvas::copied::CopiedPicture;

/// Pictures that are being written.
#[derive(Default)]
pub(crate) struct SavedPictures {
    running: Vec<Running>,
}

/// A picture that a thread writes, and how that ends.
struct Running {
    path: PathBuf,
    news: Receiver<Result<(), String>>,
}

impl SavedPictures {
    /// Begins to `write` a file on a thread.
    pub(crate) fn begin(
        &mut self,
        path: PathBuf,
        wake: Wake,
        write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
    ) {
        let ((sender, news), to) = (channel(), path.clone());
        std::thread::spawn(move || {
            // The window may have been closed by now; the file is written all the same.
            let _ = sender.send(write(&to));
            wake();
        });
        self.running.push(Running { path, news });
    }

    /// Returns the path of the next picture or other file beside a file: flipmap-1.png,
    /// flipmap-2.png, … that neither exists nor is being written.
    pub(crate) fn next_path(&self, beside: &Path, stem: &str, ending: &str) -> PathBuf {
        let near = beside.parent().unwrap_or(Path::new("")).join(format!("{stem}.{ending}"));
        let near = std::path::absolute(&near).unwrap_or(near);
        let is_taken = |path: &Path| self.running.iter().any(|running| running.path == path);
        free_beside(&near, stem, is_taken)
    }

    /// Returns what has become of the pictures that are finished.
    fn news(&mut self) -> Vec<Result<PathBuf, String>> {
        let mut news = Vec::new();
        self.running.retain(|Running { path, news: of }| match of.try_recv() {
            Ok(written) => {
                news.push(written.map(|()| path.clone()));
                false
            }
            Err(error) => error == TryRecvError::Empty,
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
            Some(copied) => {
                let write = move |path: &Path| write(copied, &of, path);
                self.saved_pictures.begin(path, Arc::clone(&self.wake), write);
            }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_never_replaces_one_that_is_still_being_written() {
        let folder = tempfile::tempdir().unwrap();
        let beside = folder.path().join("map.npy");
        let mut pictures = SavedPictures::default();
        let first = pictures.next_path(&beside, "flipmap", "png");
        assert_eq!(first, folder.path().join("flipmap-1.png"));
        let (sender, news) = channel();
        pictures.running.push(Running { path: first.clone(), news });
        assert_eq!(
            pictures.next_path(&beside, "flipmap", "png"),
            folder.path().join("flipmap-2.png")
        );
        assert!(pictures.news().is_empty());
        sender.send(Ok(())).unwrap();
        assert_eq!(pictures.news(), [Ok(first.clone())]);
        assert_eq!(pictures.next_path(&beside, "flipmap", "png"), first, "it was never written");
    }
}
