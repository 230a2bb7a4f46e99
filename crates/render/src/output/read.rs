//! Reads scenes: built-in ones, locations, pictures that flipmap wrote, and TOML, from files or from
//! standard input.

use std::io::{self, BufRead, Cursor, Read, Seek};
use std::path::{Path, PathBuf};

use super::ending::ends_in;
use super::png::{PngError, document_in_png};
use flipmap_engine::plain_file::{MAX_TEXT_BYTES, open_plain, read_text};
use flipmap_scene::palette::gradient_file::ENDINGS;
use flipmap_scene::{BuiltIn, Document, DocumentError, location};

/// Reasons why a file has no scene. A cause that the sentence quotes is not its source, so that it
/// is said once.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// A file that could not be read.
    #[error("cannot read the scene {path}: {why}")]
    File {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        why: io::Error,
    },
    /// A PNG without a scene.
    #[error("{path} {why}")]
    Picture {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        why: PngError,
    },
    /// A text that is not a scene.
    #[error("{path}: {why}")]
    Scene {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        why: DocumentError,
    },
    /// A location that is not a scene.
    #[error("{why}")]
    Location {
        /// The cause.
        why: location::LocationError,
    },
    /// A picture in a format that carries no scene.
    #[error("{path} carries no scene: of pictures, only a .png that flipmap wrote does")]
    OtherPicture {
        /// Path of the file.
        path: PathBuf,
    },
    /// A gradient in the place of a scene.
    #[error("{path} is a gradient, which is a palette and not a scene")]
    Gradient {
        /// Path of the file.
        path: PathBuf,
    },
    /// A name that is neither that of a built-in scene nor that of a file with one.
    #[error(
        "no scene '{name}'{meant}: give a .toml file, a .png written by flipmap, a location \
         (flipmap:center=…), - for standard input, or one of {}",
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
        "{path} is neither a .png that flipmap wrote, nor a .toml scene, nor a location \
         (flipmap:center=…), nor a gradient (.{})",
        ENDINGS.join(", .")
    )]
    Kind {
        /// Path of the file.
        path: PathBuf,
    },
}

/// Largest size in bytes of what is read from standard input: that of a large picture.
const MAX_STDIN_BYTES: u64 = 4 << 30;

/// Returns the document of a built-in scene or of a location, or reads it from a file or, for `-`,
/// from standard input.
pub fn named_document(name: &str) -> Result<Document, ReadError> {
    if let Some(built_in) = BuiltIn::named(name) {
        return Ok(built_in.document());
    }
    let path = Path::new(name);
    if name == "-" {
        return of_stdin();
    }
    if !path.exists() {
        match location::parse(name) {
            Ok(scene) => return Ok(Document::default().with_scene(scene)),
            Err(location::LocationError::Foreign) => {}
            Err(why) => return Err(ReadError::Location { why }),
        }
        if path.extension().is_none() {
            let meant = BuiltIn::like(name)
                .map_or(String::new(), |near| format!(" (did you mean {}?)", near.name));
            return Err(ReadError::Unknown { name: name.to_string(), meant });
        }
    }
    read_document(path)
}

fn of_stdin() -> Result<Document, ReadError> {
    let path = PathBuf::from("standard input");
    let mut bytes = Vec::new();
    match io::stdin().take(MAX_STDIN_BYTES).read_to_end(&mut bytes) {
        Ok(_) => document_in(Cursor::new(bytes), &path),
        Err(why) => Err(ReadError::File { path, why }),
    }
}

/// Reads the document from a picture that flipmap wrote, from a scene file or from a file with a
/// location, by its content and whatever its name is.
pub fn read_document(path: &Path) -> Result<Document, ReadError> {
    let unreadable = |why| ReadError::File { path: path.to_path_buf(), why };
    let file = open_plain(path).map_err(unreadable)?;
    document_in(io::BufReader::new(file), path)
}

/// The first bytes of every PNG.
const PNG: &[u8] = b"\x89PNG";

fn document_in(mut file: impl BufRead + Seek, path: &Path) -> Result<Document, ReadError> {
    let named = || path.to_path_buf();
    let unreadable = |why| ReadError::File { path: named(), why };
    let begins = file.fill_buf().map_err(unreadable)?;
    if begins.starts_with(PNG) || ends_in(path, "png") {
        return document_in_png(file).map_err(|why| ReadError::Picture { path: named(), why });
    }
    if image::guess_format(begins).is_ok() {
        return Err(ReadError::OtherPicture { path: named() });
    }
    let mut bytes = Vec::new();
    file.take(MAX_TEXT_BYTES).read_to_end(&mut bytes).map_err(unreadable)?;
    let is_scene = ends_in(path, "toml");
    let text = match String::from_utf8(bytes) {
        Ok(text) if is_scene || !text.trim().is_empty() => text,
        Err(_) if is_scene => {
            let why = io::Error::new(io::ErrorKind::InvalidData, "it is not text in UTF-8");
            return Err(unreadable(why));
        }
        _ => return Err(ReadError::Kind { path: named() }),
    };
    // Windows' editors begin a text with a mark of the byte order.
    let text = text.trim_start_matches('\u{feff}');
    match location::parse(text) {
        Ok(scene) => return Ok(Document::default().with_scene(scene)),
        Err(location::LocationError::Foreign) => {}
        Err(why) => return Err(ReadError::Location { why }),
    }
    Document::parse(text).map_err(|why| {
        if ENDINGS.into_iter().any(|ending| ends_in(path, ending)) {
            ReadError::Gradient { path: named() }
        } else if is_scene || text.contains('=') {
            ReadError::Scene { path: named(), why }
        } else {
            ReadError::Kind { path: named() }
        }
    })
}

/// Returns true for a file that holds the keys of a film and not a scene.
pub fn holds_keys(path: &Path) -> bool {
    ends_in(path, "toml") && read_text(path).is_ok_and(|text| text.contains("[[key]]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_known_by_their_content_whatever_they_are_called() {
        let folder = tempfile::tempdir().unwrap();
        let read = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            named_document(path.to_str().unwrap()).unwrap()
        };
        let mut document = Document::default();
        document.view.width = "0.4".into();
        for name in ["a.txt", "a.scene", "a"] {
            assert_eq!(read(name, document.text().as_bytes()), document, "{name}");
            assert_eq!(read(name, b"\xef\xbb\xbf[view]\r\nwidth = \"0.4\"\r\n"), document);
            assert_eq!(read(name, b"flipmap:center=0,0;width=0.4\n"), document, "{name}");
        }
        let mut writer = super::super::PngWriter::new(Vec::new(), [1, 1], &document).unwrap();
        writer.write(&[7; 3]).unwrap();
        assert_eq!(read("picture.bin", &writer.finish().unwrap()), document);
        assert_eq!(named_document("flipmap:width=0.4").unwrap(), document);
        assert_eq!(named_document("0,0,0.4").unwrap(), document);
        let why = named_document("flipmap:wide=1").unwrap_err().to_string();
        assert!(
            why.contains("unknown word 'wide'") && why.contains("did you mean 'width'?"),
            "{why}"
        );
    }

    #[test]
    fn what_gives_no_scene_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            read_document(&path).unwrap_err().to_string()
        };
        let other = file("a.txt", "dear diary");
        assert!(other.contains("a.txt is neither"), "{other}");
        for kind in [".png", ".toml", ".map", ".ugr", ".gpl", ".ggr"] {
            assert!(other.contains(kind), "{other}");
        }
        for (name, begins) in [("a.jpg", "GIF89a"), ("a", "GIF87a"), ("a.txt", "BM9999999999")] {
            assert!(file(name, begins).contains("carries no scene"), "{name}");
        }
        for name in ["a.gpl", "a.ugr", "a.map"] {
            let said = file(name, "title=\"fire\"");
            assert!(said.ends_with(" is a gradient, which is a palette and not a scene"), "{said}");
        }
        assert!(file("b.toml", "[view]\nwidth = true").contains("b.toml: line 2"));
        assert!(file("b.txt", "[view]\nwidth = 0").contains("b.txt: line 2: `width` is '0'"));
        assert!(file("c.png", "no").contains("c.png is not a complete PNG"));
        let missing = read_document(Path::new("/nowhere/d.toml")).unwrap_err().to_string();
        assert!(missing.contains("cannot read the scene /nowhere/d.toml"));
    }
}
