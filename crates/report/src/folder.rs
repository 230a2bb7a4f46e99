//! The folder that holds a report: three files, each complete at every moment.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::{Report, ReportError, page};
use flipmap_render::output::{Destination, SafeFile, read_text};

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
        refuse_foreign(path).map_err(failed)?;
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
        let json = serde_json::to_string_pretty(report)
            .map_err(|error| ReportError::Layout(error.to_string()))?;
        let texts = [json + "\n", page::markdown(report), page::html(report)];
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

/// Refuses a folder with files of others under the names of a report's. The JSON file says whose they
/// are: it is written first.
fn refuse_foreign(folder: &Path) -> io::Result<()> {
    let found = NAMES.into_iter().find(|name| folder.join(name).exists());
    let Some(name) = found.filter(|_| !is_report(&folder.join(NAMES[0]))) else { return Ok(()) };
    let why = format!("it holds {name}, which is not of a report of flipmap's: name another");
    Err(io::Error::other(why))
}

/// Returns true if a file holds a report, of this version or another.
fn is_report(path: &Path) -> bool {
    let found = read_text(path).ok().and_then(|text| serde_json::from_str(&text).ok());
    let Some(serde_json::Value::Object(found)) = found else { return false };
    ["machine", "complete", "rows"].iter().all(|key| found.contains_key(*key))
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
    fn reports_of_others_are_not_replaced() {
        let outside = tempfile::tempdir().unwrap();
        let at = |name: &str| outside.path().join(name);
        for (name, text) in [("report.md", "# Mine"), ("report.json", "{\"rows\": 3}")] {
            fs::write(at(name), text).unwrap();
            let error = Folder::create(outside.path()).unwrap_err().to_string();
            assert!(error.contains(name) && error.contains("not of a report"), "{error}");
            assert_eq!(fs::read_to_string(at(name)).unwrap(), text);
            fs::remove_file(at(name)).unwrap();
        }
        Folder::create(outside.path()).unwrap().write(&fixtures::report()).unwrap();
        Folder::create(outside.path()).unwrap();
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
