//! Files that a command names twice: what it reads, it must not replace.

use std::path::Path;

use super::exit::Exit;

/// A file with the words for it: an option, or what it holds.
pub(super) type Named<'a> = (&'a str, &'a Path);

/// Rejects outputs that are one file with an input or with another output, under any name.
pub(super) fn keep_apart(inputs: &[Named], outputs: &[Named]) -> Result<(), Exit> {
    for (k, (name, path)) in outputs.iter().enumerate() {
        let others = inputs.iter().chain(&outputs[..k]);
        if let Some((other, _)) = others.into_iter().find(|(_, earlier)| are_same(earlier, path)) {
            return Err(Exit::Usage(format!(
                "{other} and {name} name the same file; give each its own"
            )));
        }
    }
    Ok(())
}

/// Returns true if two paths lead to one file, or would once it exists; `-` and devices can be
/// named twice.
fn are_same(a: &Path, b: &Path) -> bool {
    let is_stream = |path: &Path| path.as_os_str() == "-" || (path.exists() && is_device(path));
    if is_stream(a) || is_stream(b) {
        return false;
    }
    match same_file::is_same_file(a, b) {
        Ok(same) => same,
        Err(_) => place(a) == place(b),
    }
}

fn is_device(path: &Path) -> bool {
    !path.is_file() && !path.is_dir()
}

/// The place of a file that need not exist: its folder without links, and its name.
fn place(path: &Path) -> std::path::PathBuf {
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
        let scene = at("scene.toml");
        let refused = |path: &Path| keep_apart(&[("the scene", &scene)], &[("-o", path)]).is_err();
        assert!(refused(&scene) && refused(&at("./scene.toml")) && !refused(&at("map.png")));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&scene, at("link.toml")).unwrap();
            std::fs::hard_link(&scene, at("hard.toml")).unwrap();
            assert!(refused(&at("link.toml")) && refused(&at("hard.toml")));
            let null = Path::new("/dev/null");
            assert!(keep_apart(&[("the scene", null)], &[("-o", null), ("--raw", null)]).is_ok());
        }
        let outputs = [at("b.png"), at("./b.png")];
        let said = keep_apart(&[], &[("-o", &outputs[0]), ("--raw", &outputs[1])]);
        assert!(said.unwrap_err().to_string().contains("-o and --raw name the same file"));
        let streams = [("-o", Path::new("-")), ("--raw", Path::new("-"))];
        assert!(keep_apart(&[], &streams).is_ok(), "another check says what is wrong with it");
    }
}
