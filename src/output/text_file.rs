//! Text files, read as far as any of ours can be long.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Largest size of a scene, a film's keys or a plan: far above that of a film of 100,000 keys.
const MOST_BYTES: u64 = 64 << 20;

/// Reads a text file; refuses what is too long to be one of flipmap's, such as a device without an
/// end, before memory does.
pub fn read_text(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    let read = File::open(path)?.take(MOST_BYTES + 1).read_to_string(&mut text)?;
    if read as u64 > MOST_BYTES {
        return Err(io::Error::other("it is larger than 64 MiB, so it is no file of flipmap's"));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_without_an_end_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, "format = 1").unwrap();
        assert_eq!(read_text(&path).unwrap(), "format = 1");
        #[cfg(unix)]
        assert!(read_text(Path::new("/dev/zero")).unwrap_err().to_string().contains("64 MiB"));
    }
}
