//! Reads scenes from files: pictures that flipmap wrote, and TOML.

use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use super::png::{PngError, document_in_png};
use flipmap_engine::plain_file::{open_plain, read_text};
use flipmap_scene::palette::gradient_file::ENDINGS;
use flipmap_scene::{BuiltIn, Document, DocumentError};

/// Reasons why a file has no scene.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// A file that could not be read.
    #[error("cannot read the scene {path}: {source}")]
    File {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A PNG without a scene.
    #[error("{path} {source}")]
    Picture {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        source: PngError,
    },
    /// A TOML file that is not a scene.
    #[error("{path}: {source}")]
    Scene {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        source: DocumentError,
    },
    /// A picture in a format that carries no scene.
    #[error("{path} carries no scene: of pictures, only a .png that flipmap wrote does")]
    OtherPicture {
        /// Path of the file.
        path: PathBuf,
    },
    /// A name that is neither that of a built-in scene nor that of a file with one.
    #[error(
        "no scene '{name}'{meant}: give a .toml file, a .png written by flipmap, or one of {}",
        BuiltIn::names()
    )]
    Unknown {
        /// The name.
        name: String,
        /// A suggestion of a similar name; empty if there is none.
        meant: String,
    },
    /// A file of no kind that the window opens.
    #[error(
        "{path} is neither a .png that flipmap wrote, nor a .toml scene, nor a gradient (.{})",
        ENDINGS.join(", .")
    )]
    Kind {
        /// Path of the file.
        path: PathBuf,
    },
}

/// Returns the document of a built-in scene, or reads it from a file.
pub fn named_document(name: &str) -> Result<Document, ReadError> {
    if let Some(built_in) = BuiltIn::named(name) {
        return Ok(built_in.document());
    }
    read_document(Path::new(name)).map_err(|error| match error {
        ReadError::Kind { .. } => {
            let meant = BuiltIn::like(name)
                .map_or(String::new(), |near| format!(" (did you mean {}?)", near.name));
            ReadError::Unknown { name: name.to_string(), meant }
        }
        error => error,
    })
}

/// Reads the document from a picture that flipmap wrote, or from a scene file.
pub fn read_document(path: &Path) -> Result<Document, ReadError> {
    let is =
        |ending: &str| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending));
    let named = || path.to_path_buf();
    let unreadable = |source| ReadError::File { path: named(), source };
    if is("png") {
        let file = open_plain(path).map_err(unreadable)?;
        return document_in_png(BufReader::new(file))
            .map_err(|source| ReadError::Picture { path: named(), source });
    }
    if is("toml") {
        let text = read_text(path).map_err(unreadable)?;
        return Document::parse(&text).map_err(|source| ReadError::Scene { path: named(), source });
    }
    if image::ImageFormat::from_path(path).is_ok() {
        return Err(ReadError::OtherPicture { path: named() });
    }
    Err(ReadError::Kind { path: named() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_gives_no_scene_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            read_document(&path).unwrap_err().to_string()
        };
        let other = file("a.txt", "");
        assert!(other.contains("a.txt is neither"), "{other}");
        for kind in [".png", ".toml", ".map", ".ugr", ".gpl", ".ggr"] {
            assert!(other.contains(kind), "{other}");
        }
        for name in ["a.jpg", "a.webp", "a.TIFF", "a.gif", "a.bmp", "a.avif"] {
            assert!(file(name, "").contains("carries no scene"), "{name}");
        }
        assert!(file("b.toml", "[view]\nwidth = 3").contains("b.toml: line 2"));
        assert!(file("c.png", "no").contains("c.png is not a complete PNG"));
        let missing = read_document(Path::new("/nowhere/d.toml")).unwrap_err().to_string();
        assert!(missing.contains("cannot read the scene /nowhere/d.toml"));
    }
}
