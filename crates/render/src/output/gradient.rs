//! Reads gradient files of other programs as palettes.

use std::io;
use std::path::{Path, PathBuf};

use super::ending::ends_in;
use flipmap_engine::plain_file::{MAX_TEXT_BYTES, read_plain};
use flipmap_scene::palette::gradient::list_text;
use flipmap_scene::palette::gradient_file::{ENDINGS, GradientFileError, parse_file};

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
    /// A file that is not what its extension says.
    #[error("{path} {source}")]
    Content {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        source: GradientFileError,
    },
}

/// Returns the extension of a gradient file; `None` for other files.
fn ending_of(path: &Path) -> Option<&'static str> {
    ENDINGS.into_iter().find(|ending| ends_in(path, ending))
}

/// Returns the path of a gradient file and the name of the gradient in it, of a text such as
/// `fire.ugr:embers`; `None` for files of other kinds.
fn named_gradient(path: &Path) -> Option<(&Path, &'static str, Option<&str>)> {
    if let Some(ending) = ending_of(path) {
        return Some((path, ending, None));
    }
    let text = path.to_str()?;
    let parts = text.match_indices(':').map(|(colon, _)| (&text[..colon], &text[colon + 1..]));
    let mut found = parts.filter_map(|(file, name)| {
        Some((Path::new(file), ending_of(Path::new(file))?, Some(name)))
    });
    found.next()
}

/// Reads a gradient file as the text of a palette in a scene; `None` for files of other kinds. After
/// a colon may follow the name of one of the file's gradients.
pub fn read_gradient(path: &Path) -> Option<Result<String, GradientError>> {
    let (path, ending, name) = named_gradient(path)?;
    let read = || {
        let named = || path.to_path_buf();
        let bytes = read_plain(path, MAX_TEXT_BYTES)
            .map_err(|source| GradientError::File { path: named(), source })?;
        let stops = parse_file(ending, &bytes, name);
        let stops = stops.map_err(|source| GradientError::Content { path: named(), source })?;
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
        let error = read_gradient(&write("two.map", "0 0 0\nred\n")).unwrap().unwrap_err();
        assert!(error.to_string().contains("two.map line 2 is 'red'; it must be red, green"));
        let two = write(
            "two.ugr",
            "a {\ngradient:\n index=0 color=0\n}\nb {\ngradient:\n index=0 color=255\n}\n",
        );
        let b = read_gradient(Path::new(&format!("{}:b", two.display()))).unwrap().unwrap();
        assert_eq!(b, "#ff0000,#ff0000");
        assert!(read_gradient(Path::new("nowhere.ugr")).unwrap().is_err());
    }
}
