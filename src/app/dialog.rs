//! The desktop's own file dialogs. They wait on a thread, so that the window need not.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use rfd::{AsyncFileDialog, FileHandle};

/// An open file dialog.
#[derive(Debug)]
pub struct FileDialog {
    answer: Receiver<Option<PathBuf>>,
}

impl FileDialog {
    /// Asks where to write a file with the extension `ending`, beginning at `suggested`.
    pub fn save(ending: &str, suggested: &Path, wake: impl Fn() + Send + 'static) -> Self {
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
    pub fn open(wake: impl Fn() + Send + 'static) -> Self {
        let dialog = AsyncFileDialog::new().add_filter("pictures and scenes", &["png", "toml"]);
        Self::wait_for(dialog.pick_file(), wake)
    }

    fn wait_for(
        dialog: impl Future<Output = Option<FileHandle>> + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let (sender, answer) = channel();
        std::thread::spawn(move || {
            let chosen = pollster::block_on(dialog).map(|file| file.path().to_path_buf());
            // The receiver may be gone, if the dialog was dropped; then the answer is not needed.
            let _ = sender.send(chosen);
            wake();
        });
        FileDialog { answer }
    }

    /// Returns the answer once there is one: a file, or none if the dialog was closed.
    pub fn poll(&self) -> Option<Option<PathBuf>> {
        match self.answer.try_recv() {
            Ok(answer) => Some(answer),
            Err(TryRecvError::Empty) => None,
            // The desktop has no dialogs, so the thread ended without an answer.
            Err(TryRecvError::Disconnected) => Some(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::future::{pending, ready};

    #[test]
    fn an_answer_comes_once_and_a_closed_dialog_is_one() {
        let (sender, woken) = channel();
        let dialog = FileDialog::wait_for(ready(None), move || sender.send(()).unwrap());
        woken.recv().unwrap();
        assert_eq!(dialog.poll(), Some(None));
        let waiting = FileDialog::wait_for(pending(), || ());
        assert_eq!(waiting.poll(), None);
    }
}
