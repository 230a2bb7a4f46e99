//! The scripts that measure machines and builds, and those that make packages.

#[macro_use]
#[path = "../common/adapter.rs"]
mod adapter;
mod first_light;
mod packages;
mod speed;

/// Writes a shell script that can be run, and returns its path.
#[cfg(unix)]
fn script(folder: &tempfile::TempDir, name: &str, text: &str) -> std::path::PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}
