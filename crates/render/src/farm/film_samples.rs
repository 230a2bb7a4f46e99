//! The folder that keeps a film's samples, with the plan by which they are computed.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::{Plan, PlanError, PlannedOutput, Task};
use crate::output::{Destination, SafeFile, read_text};
use flipmap_engine::choice::Chosen;
use flipmap_scene::film::Film;

/// Reasons why a folder cannot keep a film's samples.
#[derive(Debug, thiserror::Error)]
pub enum FilmSamplesError {
    /// A name that is too long for the system.
    #[error("the name {0} is too long for a folder of samples: shorten it")]
    Name(PathBuf),
    /// A file in the folder's place.
    #[error("cannot keep samples in {0}: it is a file, not a folder")]
    File(PathBuf),
    /// A folder that cannot be written.
    #[error("cannot keep samples in {folder}: {source}")]
    Write {
        /// The folder.
        folder: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A plan, or another file, that a film did not write.
    #[error("{0} was not written by flipmap video, which would replace it: name another folder")]
    Foreign(PathBuf),
    /// A plan that cannot be followed.
    #[error("{0}")]
    Plan(#[from] PlanError),
}

/// A folder that keeps a film's samples: they are there again after a stop, and for other colours.
#[derive(Debug)]
pub struct FilmSamples {
    folder: PathBuf,
    plan: PathBuf,
}

impl FilmSamples {
    /// Returns the folder beside a film.
    pub fn beside(film: &Path) -> PathBuf {
        let mut name = film.file_name().unwrap_or(film.as_os_str()).to_os_string();
        name.push(".samples");
        film.with_file_name(name)
    }

    /// Refuses a folder whose place a file takes, and one with a plan that a film did not write.
    pub fn check(folder: &Path) -> Result<(), FilmSamplesError> {
        if folder.exists() && !folder.is_dir() {
            return Err(FilmSamplesError::File(folder.to_path_buf()));
        }
        let plan = folder.join("plan.toml");
        let is_film =
            || plan.is_file() && read_text(&plan).is_ok_and(|text| Plan::is_kept_by_film(&text));
        if plan.exists() && !is_film() {
            return Err(FilmSamplesError::Foreign(plan));
        }
        Ok(())
    }

    /// Makes the folder if necessary. Refuses one that cannot be written, and what
    /// [`FilmSamples::check`] refuses.
    pub fn open(folder: &Path) -> Result<Self, FilmSamplesError> {
        Self::check(folder)?;
        let plan = folder.join("plan.toml");
        let made = fs::create_dir_all(folder)
            .and_then(|()| SafeFile::check(&Destination::File(plan.clone())));
        made.map_err(|source| match source.kind() {
            ErrorKind::InvalidFilename => FilmSamplesError::Name(folder.to_path_buf()),
            _ => FilmSamplesError::Write { folder: folder.to_path_buf(), source },
        })?;
        Ok(FilmSamples { folder: folder.to_path_buf(), plan })
    }

    /// Returns the plan's file.
    pub fn plan(&self) -> &Path {
        &self.plan
    }

    /// Returns the plan of the samples that are there.
    pub fn earlier(&self) -> Option<Plan> {
        Plan::parse(&read_text(&self.plan).ok()?).ok()
    }

    /// Writes the film's plan, for the engine that was chosen, and returns its task.
    pub fn task(
        &self,
        film: Film,
        verify: bool,
        chosen: &Chosen,
    ) -> Result<Task, FilmSamplesError> {
        let engine = (chosen.engine.as_ref(), chosen.config, verify);
        let plan = Plan::new(PlannedOutput::Film(film), 1, engine, false);
        SafeFile::write_whole(&Destination::File(self.plan.clone()), plan.text().as_bytes())
            .map_err(|source| FilmSamplesError::Write { folder: self.folder.clone(), source })?;
        Ok(Task::new(plan, &self.plan)?)
    }
}
