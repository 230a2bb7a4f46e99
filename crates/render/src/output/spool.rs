//! Files that are not written from front to back, whatever their destination.

use std::env::temp_dir;
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::PathBuf;

use tempfile::TempPath;

use super::SafeFile;

/// A file that is written in any order. If its destination is a stream, which cannot seek, an
/// unnamed temporary file holds it until it is complete.
pub(crate) struct Spool {
    file: BufWriter<File>,
    last: FinalStep,
}

/// The last step, which takes the file to its destination.
enum FinalStep {
    Rename(TempPath, PathBuf),
    Copy(SafeFile),
}

impl Spool {
    /// Creates a spool for a destination to which nothing has been written.
    pub(crate) fn new(destination: SafeFile) -> io::Result<Self> {
        Ok(match destination {
            SafeFile::Beside(file, beside, path) => {
                Spool { file, last: FinalStep::Rename(beside, path) }
            }
            stream => {
                let file = tempfile::tempfile().map_err(in_temporary_folder)?;
                Spool { file: BufWriter::new(file), last: FinalStep::Copy(stream) }
            }
        })
    }

    /// Returns the destination with everything in it.
    pub(crate) fn into_file(self) -> io::Result<SafeFile> {
        let Spool { mut file, last } = self;
        match last {
            FinalStep::Rename(beside, path) => Ok(SafeFile::Beside(file, beside, path)),
            FinalStep::Copy(mut stream) => {
                file.rewind().map_err(in_temporary_folder)?;
                io::copy(file.get_mut(), &mut stream)?;
                Ok(stream)
            }
        }
    }

    fn explained<T>(&self, result: io::Result<T>) -> io::Result<T> {
        match self.last {
            FinalStep::Rename(..) => result,
            FinalStep::Copy(_) => result.map_err(in_temporary_folder),
        }
    }
}

/// Names the temporary folder in an error: its disk may not be the destination's.
fn in_temporary_folder(error: io::Error) -> io::Error {
    let folder = temp_dir();
    let text = format!("in the temporary folder {}: {error}", folder.display());
    io::Error::new(error.kind(), text)
}

impl Write for Spool {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes);
        self.explained(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.file.flush();
        self.explained(flushed)
    }
}

impl Seek for Spool {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        let sought = self.file.seek(place);
        self.explained(sought)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Destination;
    use std::io::Read;
    use std::path::Path;

    /// Writes "done", its first letter last.
    fn write(path: &Path) -> io::Result<()> {
        let mut spool = Spool::new(SafeFile::create(&Destination::from(path))?)?;
        spool.write_all(b"gone")?;
        spool.rewind()?;
        spool.write_all(b"d")?;
        spool.seek(SeekFrom::End(0))?;
        spool.into_file()?.finish()
    }

    #[test]
    fn files_are_written_in_any_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("word");
        write(&path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "done");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn streams_get_everything_at_the_end_and_say_when_they_cannot() {
        let (mut reader, writer) = io::pipe().unwrap();
        let descriptor = std::os::fd::AsRawFd::as_raw_fd(&writer);
        write(Path::new(&format!("/proc/self/fd/{descriptor}"))).unwrap();
        drop(writer);
        let mut text = String::new();
        reader.read_to_string(&mut text).unwrap();
        assert_eq!(text, "done");
        let error = write(Path::new("/dev/full")).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    }
}
