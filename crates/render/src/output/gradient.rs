//! Reads gradient files of other programs as palettes.

use std::io;
use std::path::{Path, PathBuf};

use flipmap_engine::plain_file::read_text;
use flipmap_scene::palette::gradient::{ENDINGS, list_text, parse_file};

/// Reasons why a gradient file gives no palette.
#[derive(Debug, thiserror::Error)]
pub enum GradientError {
    /// A file that could not be read.
    #[error("cannot read the gradient {path}: {source}")]
    File {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A file without colours.
    #[error("{path} is not a gradient: {why}")]
    Empty {
        /// Path of the file.
        path: PathBuf,
        /// The part that is missing.
        why: &'static str,
    },
}

/// Returns the extension of a gradient file; `None` for other files.
fn ending_of(path: &Path) -> Option<&'static str> {
    let found = path.extension()?;
    ENDINGS.into_iter().find(|ending| found.eq_ignore_ascii_case(ending))
}

/// Reads a gradient file as the text of a palette in a scene; `None` for files of other kinds.
pub fn read_gradient(path: &Path) -> Option<Result<String, GradientError>> {
    let ending = ending_of(path)?;
    let read = || {
        let named = || path.to_path_buf();
        let text =
            read_text(path).map_err(|source| GradientError::File { path: named(), source })?;
        let stops = parse_file(ending, &text);
        let stops = stops.map_err(|why| GradientError::Empty { path: named(), why })?;
        Ok(list_text(&stops))
    };
    Some(read())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_files_are_known_by_their_endings_and_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let fire = write("fire.MAP", "0 0 0\n255 128 0\n");
        assert_eq!(read_gradient(&fire).unwrap().unwrap(), "#000000,#ff8000");
        assert!(read_gradient(&write("scene.toml", "format = 1")).is_none());
        let error = read_gradient(&write("no.gpl", "")).unwrap().unwrap_err().to_string();
        assert!(error.ends_with("no.gpl is not a gradient: it does not begin with 'GIMP Palette'"));
        assert!(read_gradient(Path::new("nowhere.ugr")).unwrap().is_err());
    }
}
