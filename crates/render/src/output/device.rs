//! Pipes, devices and standard output as outputs, which may wait for their reader.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::OnceLock;

/// Test for a request to stop.
static STOP_ASKED: OnceLock<fn() -> bool> = OnceLock::new();

/// Makes writing to pipes and devices end with an error once `asked` returns true: their reader may
/// be slow, or never read on.
pub fn stop_writing_when(asked: fn() -> bool) {
    // A second call names the same function.
    let _ = STOP_ASKED.set(asked);
}

/// The error of a write that a request to stop ended.
#[derive(Debug, thiserror::Error)]
#[error("stopped while it was written")]
pub(super) struct StoppedWriting;

fn check_stop() -> io::Result<()> {
    match STOP_ASKED.get().is_some_and(|asked| asked()) {
        true => Err(io::Error::other(StoppedWriting)),
        false => Ok(()),
    }
}

/// Largest number of bytes in one write: a pipe that is ready for writing has room for as many.
const AT_ONCE: usize = 4096;

/// A pipe, a device or standard output, open for writing.
pub struct Device(File);

impl Device {
    /// Opens a pipe or a device. Opening a named pipe normally blocks until somebody reads it; this
    /// waits for a reader for a few seconds at most.
    #[cfg(unix)]
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        use std::os::unix::fs::OpenOptionsExt;
        use std::time::{Duration, Instant};

        const MAX_WAIT: Duration = Duration::from_secs(5);
        let no_reader = rustix::io::Errno::NXIO.raw_os_error();
        let mut options = File::options();
        options.write(true).custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
        let begun = Instant::now();
        loop {
            match options.open(path) {
                Ok(file) => return Ok(Device(file)),
                Err(error) if error.raw_os_error() != Some(no_reader) => return Err(error),
                Err(_) if begun.elapsed() > MAX_WAIT => {
                    let message = "no program reads this pipe: start its reader first";
                    return Err(io::Error::other(message));
                }
                Err(_) => std::thread::sleep(Duration::from_millis(20)),
            }
            check_stop()?;
        }
    }

    /// Opens a device.
    #[cfg(not(unix))]
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        File::options().write(true).open(path).map(Device)
    }

    /// Refuses a standard output that was closed before the program began. Rust's runtime then puts
    /// /dev/null in its place, open for reading and writing; a shell opens it for writing only.
    pub(super) fn check_stdout() -> io::Result<()> {
        #[cfg(target_os = "linux")]
        {
            use rustix::fs::{OFlags, fcntl_getfl, fstat, makedev, stat};
            let out = io::stdout();
            let is_null = fstat(&out)?.st_rdev
                == stat("/dev/null").map_or(makedev(1, 3), |null| null.st_rdev);
            if is_null && fcntl_getfl(&out)?.contains(OFlags::RDWR) {
                return Err(io::Error::other("it is closed: redirect it, or name a file"));
            }
        }
        Ok(())
    }

    /// Returns standard output.
    pub(super) fn stdout() -> io::Result<Self> {
        #[cfg(unix)]
        let owned = std::os::fd::AsFd::as_fd(&io::stdout()).try_clone_to_owned()?;
        #[cfg(windows)]
        let owned =
            std::os::windows::io::AsHandle::as_handle(&io::stdout()).try_clone_to_owned()?;
        #[cfg(any(unix, windows))]
        return Ok(Device(owned.into()));
        #[cfg(not(any(unix, windows)))]
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Waits until there is room for some bytes, or returns an error on a request to stop.
    #[cfg(unix)]
    fn wait(&self) -> io::Result<()> {
        use rustix::event::{PollFd, PollFlags, Timespec, poll};

        const PATIENCE: Timespec = Timespec { tv_sec: 0, tv_nsec: 50_000_000 };
        loop {
            check_stop()?;
            match poll(&mut [PollFd::new(&self.0, PollFlags::OUT)], Some(&PATIENCE)) {
                Ok(0) | Err(rustix::io::Errno::INTR) => {}
                Ok(_) => return Ok(()),
                Err(error) => return Err(error.into()),
            }
        }
    }

    #[cfg(not(unix))]
    fn wait(&self) -> io::Result<()> {
        check_stop()
    }
}

impl Write for Device {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        loop {
            self.wait()?;
            match self.0.write(&bytes[..bytes.len().min(AT_ONCE)]) {
                // Another writer of the same pipe was faster.
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    std::thread::sleep(std::time::Duration::from_millis(1));
                }
                written => return written,
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::Read;

    fn pipe(folder: &Path) -> std::path::PathBuf {
        let path = folder.join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&path).status().unwrap();
        assert!(made.success());
        path
    }

    #[test]
    fn a_pipe_is_written_when_its_reader_comes_however_slow_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = pipe(folder.path());
        // More than a pipe holds.
        let bytes: Vec<u8> = (0..300_000).map(|k| (k % 251) as u8).collect();
        let reader = std::thread::spawn({
            let path = path.clone();
            move || {
                std::thread::sleep(std::time::Duration::from_millis(200));
                let mut file = File::open(path).unwrap();
                std::thread::sleep(std::time::Duration::from_millis(200));
                let mut read = Vec::new();
                file.read_to_end(&mut read).unwrap();
                read
            }
        });
        Device::open(&path).unwrap().write_all(&bytes).unwrap();
        assert!(reader.join().unwrap() == bytes);
    }

    #[test]
    fn a_pipe_that_nobody_reads_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let refused = Device::open(&pipe(folder.path())).err().unwrap();
        assert!(refused.to_string().contains("no program reads"));
    }
}
