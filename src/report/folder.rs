//! The folder that holds a report: three files, each complete at every moment.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::{Report, ReportError, html, markdown, pages};
use crate::output::{Destination, SafeFile};

/// Names of the files.
pub(super) const NAMES: [&str; 3] = ["report.json", "report.md", "report.html"];

/// A folder that can be written to.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// Creates the folder and checks that the files can be written there. Existing files stay as
    /// they are.
    pub fn create(path: &Path) -> Result<Self, ReportError> {
        let failed = |why: io::Error| {
            let path = path.display().to_string();
            ReportError::Write { path, why }
        };
        if path.exists() && !path.is_dir() {
            return Err(failed(io::Error::other("it is a file, and a report needs a folder")));
        }
        fs::create_dir_all(path).map_err(failed)?;
        let folder = Folder(path.to_path_buf());
        for name in NAMES {
            drop(folder.open(name)?);
        }
        Ok(folder)
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Writes the report in place of the previous one.
    pub fn write(&self, report: &Report) -> Result<(), ReportError> {
        let sections = pages::sections(report)?;
        let title = pages::title(report);
        let json = serde_json::to_string_pretty(report)
            .map_err(|error| ReportError::Layout(error.to_string()))?;
        let texts =
            [json + "\n", markdown::write(&title, &sections), html::write(&title, &sections)];
        for (name, text) in NAMES.into_iter().zip(texts) {
            let mut file = self.open(name)?;
            let written = file.write_all(text.as_bytes());
            written.and_then(|()| file.finish()).map_err(|why| self.failed(name, why))?;
        }
        Ok(())
    }

    fn open(&self, name: &str) -> Result<SafeFile, ReportError> {
        SafeFile::create(&Destination::File(self.0.join(name)))
            .map_err(|why| self.failed(name, why))
    }

    fn failed(&self, name: &str, why: io::Error) -> ReportError {
        ReportError::Write { path: self.0.join(name).display().to_string(), why }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;

    #[test]
    fn three_files_appear_and_no_other() {
        let outside = tempfile::tempdir().unwrap();
        let folder = Folder::create(&outside.path().join("deep/report")).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        folder.write(&fixtures::report()).unwrap();
        let mut found: Vec<String> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        found.sort();
        assert_eq!(found, ["report.html", "report.json", "report.md"]);
    }

    #[test]
    fn a_file_is_no_folder() {
        let outside = tempfile::tempdir().unwrap();
        let file = outside.path().join("taken");
        fs::write(&file, "mine").unwrap();
        let error = Folder::create(&file).unwrap_err().to_string();
        assert!(error.contains("taken") && error.contains("it is a file"), "{error}");
        assert!(Folder::create(&file.join("below")).is_err());
    }
}
