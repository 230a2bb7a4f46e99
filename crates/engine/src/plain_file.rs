//! Reads plain files up to a size limit. Anything else is refused, because a pipe would make
//! flipmap wait and a device has no end.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Largest size in bytes of a text file: a scene, a film's keys or a plan. A film of 100,000 keys
/// is far smaller.
pub const MAX_TEXT_BYTES: u64 = 64 << 20;

/// Opens a file for reading; refuses a pipe, a device or a folder without waiting.
pub fn open_plain(path: &Path) -> io::Result<File> {
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        // Without this flag, opening a pipe waits for its writer.
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    let file = options.open(path)?;
    if file.metadata()?.is_file() {
        Ok(file)
    } else {
        Err(io::Error::other("it is not a regular file"))
    }
}

/// Reads a plain file of `most` bytes at most.
pub fn read_plain(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = open_plain(path)?;
    let too_large = || {
        let most = match most >> 20 {
            0 => format!("{} KiB", most >> 10),
            mib => format!("{mib} MiB"),
        };
        io::Error::other(format!("it is larger than {most}, so it cannot be a flipmap file"))
    };
    let length = file.metadata()?.len();
    if length > most {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length as usize).map_err(|_| io::ErrorKind::OutOfMemory)?;
    // The file may grow while it is read.
    let read = file.take(most + 1).read_to_end(&mut bytes)?;
    if read as u64 > most { Err(too_large()) } else { Ok(bytes) }
}

/// Reads a text file, such as a scene, a film's keys or a plan, of at most 64 MiB.
pub fn read_text(path: &Path) -> io::Result<String> {
    let text = String::from_utf8(read_plain(path, MAX_TEXT_BYTES)?);
    text.map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not text in UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_files_are_read_up_to_a_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, "format = 1").unwrap();
        assert_eq!(read_text(&path).unwrap(), "format = 1");
        assert_eq!(read_plain(&path, 10).unwrap(), b"format = 1");
        std::fs::write(&path, vec![b' '; 4097]).unwrap();
        assert!(read_plain(&path, 4096).unwrap_err().to_string().contains("larger than 4 KiB"));
        std::fs::write(&path, [0xff]).unwrap();
        assert_eq!(read_text(&path).unwrap_err().kind(), io::ErrorKind::InvalidData);
        // The file is sparse: it takes no room on the disk.
        File::create(&path).unwrap().set_len(1 << 40).unwrap();
        assert!(read_text(&path).unwrap_err().to_string().contains("64 MiB"));
        assert!(read_text(folder.path()).is_err());
        let missing = read_text(&folder.path().join("nothing")).unwrap_err();
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        for path in [path.as_path(), Path::new("/dev/zero")] {
            assert!(read_text(path).unwrap_err().to_string().contains("not a regular file"));
        }
    }
}
