//! Tests whether two paths lead to one file, so that no input is overwritten and no output is
//! written twice at once.

use std::path::{Path, PathBuf};

/// Returns true if two paths lead to one file, or would once it exists; `-` and devices may be
/// named twice.
pub fn is_one_file(a: &Path, b: &Path) -> bool {
    let is_stream = |path: &Path| path.as_os_str() == "-" || (path.exists() && is_device(path));
    if is_stream(a) || is_stream(b) {
        return false;
    }
    match same_file::is_same_file(a, b) {
        Ok(same) => same,
        Err(_) => place(a) == place(b),
    }
}

/// Returns true if a path leads to standard output: `-`, /dev/stdout, or the file or pipe that
/// standard output is.
pub fn is_stdout(path: &Path) -> bool {
    let names = ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];
    names.iter().any(|name| path == Path::new(name)) || is_file_of_stdout(path)
}

#[cfg(unix)]
fn is_file_of_stdout(path: &Path) -> bool {
    use std::os::fd::AsFd;
    use std::os::unix::fs::{FileTypeExt, MetadataExt};

    let stdout = std::io::stdout().as_fd().try_clone_to_owned().map(std::fs::File::from);
    let (Ok(found), Ok(out)) = (path.metadata(), stdout.and_then(|out| out.metadata())) else {
        return false;
    };
    // /dev/null may be named as often as one likes.
    !found.file_type().is_char_device() && (found.dev(), found.ino()) == (out.dev(), out.ino())
}

#[cfg(not(unix))]
fn is_file_of_stdout(_: &Path) -> bool {
    false
}

fn is_device(path: &Path) -> bool {
    !path.is_file() && !path.is_dir()
}

/// Returns the place of a file that need not exist: its folder without links, and its name.
fn place(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    match (whole.parent().and_then(|folder| folder.canonicalize().ok()), whole.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => whole,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_is_noticed_under_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("scene.toml"), "").unwrap();
        let is_scene = |path: &Path| is_one_file(&at("scene.toml"), path);
        assert!(is_scene(&at("scene.toml")) && is_scene(&at("./scene.toml")));
        assert!(!is_scene(&at("map.png")));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("scene.toml"), at("link.toml")).unwrap();
            std::fs::hard_link(at("scene.toml"), at("hard.toml")).unwrap();
            assert!(is_scene(&at("link.toml")) && is_scene(&at("hard.toml")));
            assert!(!is_one_file(Path::new("/dev/null"), Path::new("/dev/null")));
        }
        assert!(is_one_file(&at("b.png"), &at("./b.png")), "neither exists");
        assert!(!is_one_file(Path::new("-"), Path::new("-")));
    }
}
