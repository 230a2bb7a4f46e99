//! The files and folders that a picture can be written to.

use std::path::{Path, PathBuf};

use super::failure::OutputError;
use super::whole_picture::{WholeFormat, check_depth};
use super::{Destination, PyramidFolder, SafeFile};
use flipmap_scene::PictureTable;

/// Paths of the outputs, by setting.
#[derive(Clone, Debug, Default)]
pub struct Paths {
    /// The picture.
    pub picture: Option<PathBuf>,
    /// The pyramid of tiles.
    pub pyramid: Option<PathBuf>,
    /// The array of answers.
    pub raw: Option<PathBuf>,
    /// The image with all channels.
    pub exr: Option<PathBuf>,
    /// The picture that shows each pixel's trust.
    pub trust: Option<PathBuf>,
}

/// The kinds of outputs.
#[derive(Clone, Copy, Debug)]
pub(super) enum Output {
    Picture,
    Pyramid,
    Raw,
    Exr,
    Trust,
}

impl Output {
    const ALL: [Output; 5] =
        [Output::Picture, Output::Pyramid, Output::Raw, Output::Exr, Output::Trust];

    /// Returns the name of the setting.
    pub(super) fn setting(self) -> &'static str {
        match self {
            Output::Picture => "output",
            Output::Pyramid => "pyramid",
            Output::Raw => "raw",
            Output::Exr => "exr",
            Output::Trust => "trust",
        }
    }
}

impl Paths {
    /// Returns each given path with its setting.
    pub fn named(&self) -> Vec<(&'static str, &Path)> {
        self.outputs().map(|(output, path)| (output.setting(), path)).collect()
    }

    /// Iterates over the given paths, each with its kind.
    pub(super) fn outputs(&self) -> impl Iterator<Item = (Output, &Path)> {
        let path = |output| match output {
            Output::Picture => self.picture.as_deref(),
            Output::Pyramid => self.pyramid.as_deref(),
            Output::Raw => self.raw.as_deref(),
            Output::Exr => self.exr.as_deref(),
            Output::Trust => self.trust.as_deref(),
        };
        Output::ALL.into_iter().filter_map(move |output| Some((output, path(output)?)))
    }

    /// Refuses outputs that could not be written, before anything is computed.
    pub fn check(&self, picture: &PictureTable) -> Result<(), OutputError> {
        self.outputs().try_for_each(|(output, path)| {
            let name = Destination::from(path);
            let file = || SafeFile::check(&name);
            let checked = match output {
                Output::Pyramid => PyramidFolder::create(path).map(drop),
                Output::Picture if picture.bits == 16 => check_depth(path).and_then(|()| file()),
                Output::Picture | Output::Trust => WholeFormat::of(path).and_then(|_| file()),
                Output::Raw | Output::Exr => file(),
            };
            let setting = output.setting();
            checked.map_err(|source| OutputError::Create { setting, name, source })
        })
    }
}
