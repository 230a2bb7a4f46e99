//! The folder of a survey: samples that are done, and the results.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use flipmap_render::output::{Destination, SafeFile, read_text};

use crate::curves::CURVES;
use crate::order::MeasureError;
use crate::sampling::Sampled;

/// A folder that can be written to.
#[derive(Clone, Debug)]
pub struct SurveyFolder(PathBuf);

/// Folder of the samples inside a survey's folder.
const SAMPLES: &str = "samples";
/// The file that says whose folder it is.
pub(crate) const RESULTS: &str = "measure.json";

impl SurveyFolder {
    /// Creates the folder. Refuses one that holds files, but no survey.
    pub fn create(path: &Path) -> Result<Self, MeasureError> {
        let folder = SurveyFolder(path.to_path_buf());
        let failed = |why| folder.failed("", why);
        fs::create_dir_all(path).map_err(failed)?;
        let is_survey = path.join(RESULTS).exists();
        let mut found = fs::read_dir(path).map_err(failed)?.filter_map(Result::ok);
        if !is_survey && found.any(|entry| entry.file_name() != SAMPLES) {
            let why = "it holds files, but no measurements of flipmap's: name another folder";
            return Err(failed(io::Error::other(why)));
        }
        fs::create_dir_all(path.join(SAMPLES)).map_err(failed)?;
        Ok(folder)
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Returns the stages that are kept under a key, by name.
    pub(crate) fn read(&self, key: &str) -> BTreeMap<String, Sampled> {
        let ending = ending(key);
        let entries = fs::read_dir(self.0.join(SAMPLES)).into_iter().flatten();
        let stage = |entry: fs::DirEntry| {
            let name = entry.file_name().into_string().ok()?;
            let name = name.strip_suffix(&ending)?.to_string();
            // A file that was damaged is computed again.
            let text = read_text(&entry.path()).ok()?;
            Some((name, serde_json::from_str(&text).ok()?))
        };
        entries.filter_map(Result::ok).filter_map(stage).collect()
    }

    /// Keeps a stage.
    pub(crate) fn keep(
        &self,
        key: &str,
        name: &str,
        sampled: &Sampled,
    ) -> Result<(), MeasureError> {
        let file = format!("{SAMPLES}/{name}{}", ending(key));
        let text = serde_json::to_string(sampled)
            .map_err(|error| MeasureError::Page(error.to_string()))?;
        self.write_one(&file, &text)
    }

    /// Writes files by their names, and removes the curves of an earlier survey that are not among them.
    pub(crate) fn write(&self, files: &[(String, String)]) -> Result<(), MeasureError> {
        for name in CURVES.iter().flat_map(|name| [format!("{name}.csv"), format!("{name}.svg")]) {
            let path = self.0.join(&name);
            if files.iter().all(|(other, _)| *other != name) && path.exists() {
                fs::remove_file(path).map_err(|why| self.failed(&name, why))?;
            }
        }
        files.iter().try_for_each(|(name, text)| self.write_one(name, text))
    }

    fn write_one(&self, name: &str, text: &str) -> Result<(), MeasureError> {
        let destination = Destination::File(self.0.join(name));
        SafeFile::write_whole(&destination, text.as_bytes()).map_err(|why| self.failed(name, why))
    }

    fn failed(&self, name: &str, why: io::Error) -> MeasureError {
        MeasureError::Write { path: self.0.join(name).display().to_string(), why }
    }
}

/// The end of the names of the files that belong to a key.
fn ending(key: &str) -> String {
    format!("-{}.json", &key[..16])
}
