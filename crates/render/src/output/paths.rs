//! The files and folders that a picture can be written to.

use std::path::{Path, PathBuf};

use super::ending::check_ending;
use super::failure::OutputError;
use super::whole_picture::{PictureFormat, check_depth};
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

/// Extensions of arrays of answers: NumPy's, and tables.
pub(super) const RAW: &[&str] = &["npy", "npz", "csv"];

/// The kinds of outputs.
#[derive(Clone, Copy, Debug)]
pub(super) enum OutputKind {
    Picture,
    Pyramid,
    Raw,
    Exr,
    Trust,
}

impl OutputKind {
    const ALL: [OutputKind; 5] = [
        OutputKind::Picture,
        OutputKind::Pyramid,
        OutputKind::Raw,
        OutputKind::Exr,
        OutputKind::Trust,
    ];

    /// Returns the name of the setting.
    pub(super) fn setting(self) -> &'static str {
        match self {
            OutputKind::Picture => "output",
            OutputKind::Pyramid => "pyramid",
            OutputKind::Raw => "raw",
            OutputKind::Exr => "exr",
            OutputKind::Trust => "trust",
        }
    }
}

impl Paths {
    /// Returns each given path with its setting.
    pub fn named(&self) -> Vec<(&'static str, &Path)> {
        self.outputs().map(|(output, path)| (output.setting(), path)).collect()
    }

    /// Iterates over the given paths, each with its kind.
    pub(super) fn outputs(&self) -> impl Iterator<Item = (OutputKind, &Path)> {
        let path = |output| match output {
            OutputKind::Picture => self.picture.as_deref(),
            OutputKind::Pyramid => self.pyramid.as_deref(),
            OutputKind::Raw => self.raw.as_deref(),
            OutputKind::Exr => self.exr.as_deref(),
            OutputKind::Trust => self.trust.as_deref(),
        };
        OutputKind::ALL.into_iter().filter_map(move |output| Some((output, path(output)?)))
    }

    /// Refuses outputs that could not be written, before anything is computed.
    pub fn check(&self, picture: &PictureTable) -> Result<(), OutputError> {
        self.outputs().try_for_each(|(output, path)| {
            let name = Destination::from(path);
            let file = || SafeFile::check(&name);
            let checked = match output {
                OutputKind::Pyramid => PyramidFolder::create(path).map(drop),
                OutputKind::Picture if picture.bits == 16 => {
                    check_depth(path).and_then(|()| file())
                }
                OutputKind::Picture | OutputKind::Trust => {
                    PictureFormat::of(path).and_then(|_| file())
                }
                OutputKind::Raw => check_ending(path, RAW).and_then(|()| file()),
                OutputKind::Exr => check_ending(path, &["exr"]).and_then(|()| file()),
            };
            let setting = output.setting();
            checked.map_err(|source| OutputError::Create { setting, name, source })
        })
    }
}
