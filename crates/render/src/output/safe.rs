//! Files that appear only when they are complete.

use std::collections::BTreeSet;
use std::fmt;
use std::fs::File;
#[cfg(unix)]
use std::fs::Permissions;
#[cfg(unix)]
use std::fs::TryLockError;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use tempfile::TempPath;

use super::device::Device;

/// Destination of an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// A file.
    File(PathBuf),
    /// Standard output, given as `-`.
    Stdout,
}

impl From<&Path> for Destination {
    fn from(path: &Path) -> Self {
        if path.as_os_str() == "-" {
            Destination::Stdout
        } else {
            Destination::File(path.to_path_buf())
        }
    }
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Destination::File(path) => write!(f, "{}", path.display()),
            Destination::Stdout => f.write_str("standard output"),
        }
    }
}

/// A file being written beside its destination, or a device or standard output.
pub enum SafeFile {
    /// A temporary file, renamed onto the path at the end.
    Beside(BufWriter<File>, TempPath, PathBuf),
    /// A pipe, a device or standard output, written directly: it has no earlier content to protect,
    /// and a rename would replace it with a file.
    Device(BufWriter<Device>),
}

impl SafeFile {
    /// Opens a destination for writing; refuses at once one that could not be replaced at the end.
    pub fn create(destination: &Destination) -> io::Result<Self> {
        let path = match destination {
            Destination::Stdout => return SafeFile::stdout(),
            Destination::File(path) => path,
        };
        if path.is_symlink() && !path.exists() {
            return Err(io::Error::other("is a link to nothing: remove it, or name a file"));
        }
        if path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Err(io::Error::other("is a folder: name a file in it"));
        }
        if is_device(path) {
            return Ok(SafeFile::Device(BufWriter::new(Device::open(path)?)));
        }
        refuse_what_fails_at_the_end(path)?;
        // The target of a link is replaced, not the link.
        let path = path.canonicalize().unwrap_or_else(|_| path.clone());
        let folder = existing_folder_of(&path)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(UNFINISHED).rand_bytes(UNIQUE);
        #[cfg(unix)]
        builder.permissions(permissions(&path));
        remove_orphans(folder);
        let file = builder.tempfile_in(folder)?;
        hold(file.as_file());
        let (file, beside) = file.into_parts();
        Ok(SafeFile::Beside(BufWriter::new(file), beside, path))
    }

    /// Returns standard output.
    pub fn stdout() -> io::Result<Self> {
        Ok(SafeFile::Device(BufWriter::new(Device::stdout()?)))
    }

    /// Refuses the destinations that [`Self::create`] refuses, but opens no pipes and devices: a
    /// reader takes the closing of a pipe for its end.
    pub fn check(destination: &Destination) -> io::Result<()> {
        match destination {
            Destination::File(path) if is_device(path) => Ok(()),
            Destination::Stdout => Device::check_stdout(),
            destination => SafeFile::create(destination).map(drop),
        }
    }

    /// Writes these bytes as the whole content of a destination.
    pub fn write_whole(destination: &Destination, bytes: &[u8]) -> io::Result<()> {
        let mut file = SafeFile::create(destination)?;
        file.write_all(bytes)?;
        file.finish()
    }

    /// Returns the path of the temporary file, for another program to write to; `None` for a
    /// device.
    pub(crate) fn beside(&self) -> Option<&Path> {
        match self {
            SafeFile::Beside(_, beside, _) => Some(beside),
            SafeFile::Device(_) => None,
        }
    }

    /// Completes the file and renames it to its destination.
    pub fn finish(self) -> io::Result<()> {
        match self {
            SafeFile::Device(mut out) => out.flush(),
            SafeFile::Beside(mut out, beside, path) => {
                out.flush()?;
                // Synced before it is renamed, so a power cut leaves no partial file.
                out.get_ref().sync_all()?;
                beside.persist(path).map_err(|error| error.error)
            }
        }
    }
}

/// Returns true for a pipe or a device.
pub(super) fn is_device(path: &Path) -> bool {
    path.exists() && !path.is_file() && !path.is_dir()
}

/// Prefix of the names of unfinished files, too long for another program's file to have by chance.
pub(super) const UNFINISHED: &str = ".flipmap-unfinished-";

/// Number of random letters and digits after the prefix.
pub(super) const UNIQUE: usize = 16;

/// Name of the file in an unfinished folder that its process locks; a folder without it is kept.
pub(super) const HELD: &str = "held";

/// Time for which an unfinished file must be found without a lock: a running process locks its file
/// right after it has created it.
const UNLOCKED_FOR: Duration = Duration::from_millis(100);

/// Locks an unfinished file while it is open, if the file system has locks.
#[cfg(unix)]
pub(super) fn hold(file: &File) {
    // Another run, which looks for orphans, may hold it for a moment.
    for _ in 0..50 {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(2)),
            _ => return,
        }
    }
}

#[cfg(not(unix))]
pub(super) fn hold(_: &File) {}

/// Removes unfinished files and folders of killed runs, which no process locks. Looks into each
/// folder once a run, since films write thousands of files into one. Skips what cannot be removed.
pub(super) fn remove_orphans(folder: &Path) {
    static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let is_new = SEEN.lock().is_ok_and(|mut seen| seen.insert(folder.to_path_buf()));
    let Some(files) = is_new.then(|| folder.read_dir().ok()).flatten() else { return };
    let unlocked = |path: &PathBuf| is_unlocked(path) || is_unlocked(&path.join(HELD));
    let ours = files.flatten().filter(|file| is_unfinished(&file.file_name().to_string_lossy()));
    let mut orphans: Vec<PathBuf> = ours.map(|file| file.path()).filter(unlocked).collect();
    if orphans.is_empty() {
        return;
    }
    std::thread::sleep(UNLOCKED_FOR);
    orphans.retain(unlocked);
    for path in orphans {
        let _ =
            if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    }
}

/// Returns true for the name of an unfinished file: the prefix and `UNIQUE` letters and digits.
fn is_unfinished(name: &str) -> bool {
    let unique = name.strip_prefix(UNFINISHED).unwrap_or_default();
    unique.len() == UNIQUE && unique.bytes().all(|byte| byte.is_ascii_alphanumeric())
}

/// Returns true if no process locks an unfinished file.
#[cfg(unix)]
fn is_unlocked(path: &Path) -> bool {
    let is_file = path.symlink_metadata().is_ok_and(|found| found.is_file());
    // Opened for writing, because some network file systems lock no other files.
    is_file && File::options().write(true).open(path).is_ok_and(|file| file.try_lock().is_ok())
}

/// Returns false: files are not locked on other systems, where a lock would stop ffmpeg from
/// writing.
#[cfg(not(unix))]
fn is_unlocked(_: &Path) -> bool {
    false
}

/// Refuses a name that no file can have, and a write-protected file.
pub(super) fn refuse_what_fails_at_the_end(path: &Path) -> io::Result<()> {
    match path.metadata() {
        Ok(found) if found.permissions().readonly() => {
            Err(io::Error::other("is write-protected: remove it, or name another file"))
        }
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Returns the folder in which a path lies; an error if it does not exist.
pub(super) fn existing_folder_of(path: &Path) -> io::Result<&Path> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if folder.is_dir() {
        return Ok(folder);
    }
    Err(io::Error::other(format!("the folder {} does not exist", folder.display())))
}

/// Returns the mode of the file to be replaced, or that of any new file (less the umask).
#[cfg(unix)]
fn permissions(path: &Path) -> Permissions {
    use std::os::unix::fs::PermissionsExt;
    let old = path.metadata().map(|found| found.permissions());
    old.unwrap_or_else(|_| Permissions::from_mode(0o666))
}

impl Write for SafeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            SafeFile::Beside(out, ..) => out.write(bytes),
            SafeFile::Device(out) => out.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            SafeFile::Beside(out, ..) => out.flush(),
            SafeFile::Device(out) => out.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_fail_at_the_end_is_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |path: PathBuf| SafeFile::create(&Destination::File(path)).err();
        assert!(refused(folder.path().join("n".repeat(300))).is_some());
        let path = folder.path().join("kept.png");
        std::fs::write(&path, "mine").unwrap();
        let mut permissions = path.metadata().unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&path, permissions).unwrap();
        assert!(refused(path).unwrap().to_string().contains("write-protected"));
    }

    #[cfg(unix)]
    #[test]
    fn files_of_killed_runs_are_removed_and_those_of_running_ones_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let named = |word: &str| format!("{UNFINISHED}{word:0>UNIQUE$}");
        let unfinished = |name: &str| File::create(at(name)).unwrap();
        drop(unfinished(&named("killed")));
        let running = unfinished(&named("goeson"));
        hold(&running);
        // Another process locks its file a moment after it has created it.
        let young = unfinished(&named("young1"));
        let locked_later = std::thread::spawn(move || {
            std::thread::sleep(UNLOCKED_FOR / 4);
            hold(&young);
            young
        });
        let short = format!("{UNFINISHED}map");
        let dotted = named("keep.me");
        let others = ["mine", ".flipmap-abcdef", ".flipmap-", &short, &dotted];
        for name in others {
            drop(unfinished(name));
        }
        for folder in ["deadma", "goesma", "keptma"] {
            std::fs::create_dir_all(at(&named(folder)).join("new")).unwrap();
        }
        drop(unfinished(&(named("deadma") + "/held")));
        let running_map = unfinished(&(named("goesma") + "/held"));
        hold(&running_map);
        SafeFile::write_whole(&Destination::File(at("map.png")), b"new").unwrap();
        let _young = locked_later.join().unwrap();
        let left = |name: &str| at(name).exists();
        assert!(!left(&named("killed")) && !left(&named("deadma")));
        assert!(others.into_iter().chain(["map.png"]).all(left));
        assert!(["goeson", "young1", "goesma", "keptma"].iter().all(|word| left(&named(word))));
    }

    #[test]
    fn an_unfinished_file_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        std::fs::write(&path, "old").unwrap();
        let mut file = SafeFile::create(&Destination::File(path.clone())).unwrap();
        file.write_all(b"half").unwrap();
        drop(file);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);

        let mut file = SafeFile::create(&Destination::File(path.clone())).unwrap();
        file.write_all(b"new").unwrap();
        file.finish().unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_links_and_devices_stay_devices() {
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.path().join(name));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        let mut out = SafeFile::create(&Destination::File(link.clone())).unwrap();
        out.write_all(b"new").unwrap();
        out.finish().unwrap();
        assert!(link.is_symlink() && std::fs::read_to_string(&file).unwrap() == "new");

        let mut full = SafeFile::create(&Destination::File("/dev/full".into())).unwrap();
        full.write_all(b"lost").unwrap();
        assert_eq!(full.finish().unwrap_err().kind(), io::ErrorKind::StorageFull);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let missing = Destination::File(PathBuf::from("/nowhere/at/all/map.png"));
        let error = SafeFile::create(&missing).err().unwrap();
        assert!(error.to_string().contains("/nowhere/at/all does not exist"));
    }
}
