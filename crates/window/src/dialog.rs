//! The desktop's file dialogs, each awaited on a thread of its own.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use rfd::{AsyncFileDialog, FileHandle};

/// An open file dialog.
#[derive(Debug)]
pub(crate) struct FileDialog {
    answer: Receiver<DialogAnswer>,
}

/// The answer of a file dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum DialogAnswer {
    /// The file that the user chose.
    File(PathBuf),
    /// No file: the user closed the dialog.
    Closed,
    /// No file: the desktop has no dialog to show.
    Missing,
}

/// Shortest time in which a user can close a dialog. An answer without a file that comes sooner
/// means that the desktop has no dialogs.
const TOO_SOON: Duration = Duration::from_millis(300);

impl FileDialog {
    /// Asks where to write a file with the extension `ending`, beginning at `suggested`.
    pub(crate) fn save(ending: &str, suggested: &Path, wake: impl Fn() + Send + 'static) -> Self {
        let mut dialog = AsyncFileDialog::new().add_filter(ending, &[ending]);
        if let Some(name) = suggested.file_name().and_then(|name| name.to_str()) {
            dialog = dialog.set_file_name(name);
        }
        if let Some(folder) = suggested.parent().filter(|folder| folder.is_dir()) {
            dialog = dialog.set_directory(folder);
        }
        Self::wait_for(dialog.save_file(), wake)
    }

    /// Asks for a picture written by this program or for a scene.
    pub(crate) fn open(wake: impl Fn() + Send + 'static) -> Self {
        let dialog = AsyncFileDialog::new().add_filter("pictures and scenes", &["png", "toml"]);
        Self::wait_for(dialog.pick_file(), wake)
    }

    fn wait_for(
        dialog: impl Future<Output = Option<FileHandle>> + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let (sender, answer) = channel();
        std::thread::spawn(move || {
            let asked = Instant::now();
            let file = pollster::block_on(dialog).map(|file| file.path().to_path_buf());
            // The receiver may be gone, if the dialog was dropped; then the answer is not needed.
            let _ = sender.send(DialogAnswer::of(file, asked.elapsed()));
            wake();
        });
        FileDialog { answer }
    }

    /// Returns the answer once there is one.
    pub(crate) fn poll(&self) -> Option<DialogAnswer> {
        match self.answer.try_recv() {
            Ok(answer) => Some(answer),
            Err(TryRecvError::Empty) => None,
            // The thread ended without an answer.
            Err(TryRecvError::Disconnected) => Some(DialogAnswer::Missing),
        }
    }
}

impl DialogAnswer {
    /// Returns the answer of a dialog that took this long.
    fn of(file: Option<PathBuf>, took: Duration) -> Self {
        match file {
            Some(path) => DialogAnswer::File(path),
            None if took < TOO_SOON => DialogAnswer::Missing,
            None => DialogAnswer::Closed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::future::{pending, ready};

    #[test]
    fn an_answer_comes_once_and_one_that_comes_too_soon_is_that_of_no_dialog() {
        let (sender, woken) = channel();
        let dialog = FileDialog::wait_for(ready(None), move || sender.send(()).unwrap());
        woken.recv().unwrap();
        assert_eq!(dialog.poll(), Some(DialogAnswer::Missing));
        assert_eq!(DialogAnswer::of(None, Duration::from_secs(2)), DialogAnswer::Closed);
        let file = DialogAnswer::of(Some("a.png".into()), Duration::ZERO);
        assert_eq!(file, DialogAnswer::File("a.png".into()));
        let waiting = FileDialog::wait_for(pending(), || ());
        assert_eq!(waiting.poll(), None);
    }
}
