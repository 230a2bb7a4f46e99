//! All exports and films of a window, running or finished.

use std::path::Path;

use super::export::Export;
use super::panels::export::ExportStatus;

/// The exports and films, in the order in which they were started.
#[derive(Debug, Default)]
pub(crate) struct Exports(Vec<Export>);

impl Exports {
    /// Adds an export that was started.
    pub(crate) fn add(&mut self, export: Export) {
        self.0.push(export);
    }

    /// Returns a sentence that says so if an export is already writing the file.
    pub(crate) fn check_free(&self, path: &Path) -> Result<(), String> {
        if !self.0.iter().any(|export| export.will_write(path)) {
            return Ok(());
        }
        let why = "is being exported already; wait for it, or choose another name";
        Err(format!("{} {why}.", path.display()))
    }

    /// Returns a sentence for each export that closing the window would stop: what is lost and what
    /// is kept.
    pub(crate) fn at_stake(&self) -> Vec<String> {
        let unfinished = self.0.iter().filter(|export| export.is_unfinished());
        unfinished
            .map(|export| {
                let path = export.path().display();
                match export.is_film() {
                    true => format!(
                        "The film {path} is not finished. It stops, but its samples and its keys \
                         are kept: made again, it continues where it stopped."
                    ),
                    false => format!("{path} is not exported completely. No part of it is kept."),
                }
            })
            .collect()
    }

    /// Cancels an export.
    pub(crate) fn cancel(&self, index: usize) {
        if let Some(export) = self.0.get(index) {
            export.cancel();
        }
    }

    /// Removes an export from the list.
    pub(crate) fn dismiss(&mut self, index: usize) {
        if index < self.0.len() {
            self.0.remove(index);
        }
    }

    /// Returns what the panels show of the exports.
    pub(crate) fn statuses(&self) -> Vec<ExportStatus> {
        let name = |path: &Path| {
            path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
        };
        let status = |export: &Export| ExportStatus {
            name: name(export.path()),
            stage: export.stage(),
            is_film: export.is_film(),
        };
        self.0.iter().map(status).collect()
    }
}
