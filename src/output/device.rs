//! Pipes and devices as outputs, and as inputs that should be plain files.

use std::fs::File;
use std::io;
use std::path::Path;

/// Opens a pipe or a device for writing. A named pipe blocks whoever opens it until somebody reads
/// it; this waits for a reader, but not forever.
#[cfg(unix)]
pub(super) fn open_device(path: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    use std::time::{Duration, Instant};

    const MOST_WAIT: Duration = Duration::from_secs(5);
    let no_reader = rustix::io::Errno::NXIO.raw_os_error();
    let nonblocking = rustix::fs::OFlags::NONBLOCK.bits() as i32;
    let mut options = File::options();
    options.write(true);
    let begun = Instant::now();
    loop {
        match options.clone().custom_flags(nonblocking).open(path) {
            // With a reader there, opening it blocks no longer; writing to it may.
            Ok(_reader_is_kept) => return options.open(path),
            Err(error) if error.raw_os_error() != Some(no_reader) => return Err(error),
            Err(_) if begun.elapsed() > MOST_WAIT => {
                let message = "no program reads this pipe: start its reader first";
                return Err(io::Error::other(message));
            }
            Err(_) => std::thread::sleep(Duration::from_millis(20)),
        }
    }
}

/// Opens a device for writing.
#[cfg(not(unix))]
pub(super) fn open_device(path: &Path) -> io::Result<File> {
    File::options().write(true).open(path)
}

/// Opens a file for reading; refuses a pipe or a device, which could keep its reader waiting.
pub fn open_plain(path: &Path) -> io::Result<File> {
    if path.exists() && !path.is_file() {
        return Err(io::Error::other("it is no plain file"));
    }
    File::open(path)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::{Read, Write};

    fn pipe(folder: &Path) -> std::path::PathBuf {
        let path = folder.join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&path).status().unwrap();
        assert!(made.success());
        path
    }

    #[test]
    fn a_pipe_is_written_when_its_reader_comes() {
        let folder = tempfile::tempdir().unwrap();
        let path = pipe(folder.path());
        let reader = std::thread::spawn({
            let path = path.clone();
            move || {
                std::thread::sleep(std::time::Duration::from_millis(200));
                let mut text = String::new();
                File::open(path).unwrap().read_to_string(&mut text).unwrap();
                text
            }
        });
        open_device(&path).unwrap().write_all(b"read").unwrap();
        assert_eq!(reader.join().unwrap(), "read");
    }

    #[test]
    fn a_pipe_that_nobody_reads_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = pipe(folder.path());
        assert!(open_device(&path).unwrap_err().to_string().contains("no program reads"));
        assert!(open_plain(&path).unwrap_err().to_string().contains("no plain file"));
        assert!(open_plain(&folder.path().join("nothing")).is_err());
    }
}
