//! Extensions of files that are written: one that names another format is refused.

use std::io;
use std::path::Path;

use super::safe::is_device;

/// Returns true if a name has this extension, in any case.
pub(super) fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// Refuses a name whose extension is none of these, which are in lower case. Names without an
/// extension, `-`, pipes and devices can be anything.
pub fn check_ending(path: &Path, endings: &[&str]) -> io::Result<()> {
    let Some(ending) = path.extension().filter(|_| !is_device(path)) else { return Ok(()) };
    if endings.iter().any(|known| ends_in(path, known)) {
        return Ok(());
    }
    let known: Vec<String> = endings.iter().map(|known| format!(".{known}")).collect();
    let known = match &known[..] {
        [one] => one.clone(),
        [some @ .., last] => format!("{} or {last}", some.join(", ")),
        [] => String::new(),
    };
    let ending = ending.to_string_lossy();
    let why = format!("its name ends in .{ending}, and it is written as {known}");
    Err(io::Error::new(io::ErrorKind::InvalidInput, why))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_endings_are_refused_with_the_list() {
        let told = |name: &str, endings: &[&str]| match check_ending(Path::new(name), endings) {
            Ok(()) => String::new(),
            Err(error) => error.to_string(),
        };
        for name in ["map.png", "MAP.PNG", "map", "-", "/dev/full", ".png", "a.b/map"] {
            assert_eq!(told(name, &["png"]), "", "{name}");
        }
        let pdf = "its name ends in .pdf, and it is written as .png";
        assert_eq!(told("map.pdf", &["png"]), pdf);
        assert_eq!(
            told("map.mp4", &["png", "jpg", "tiff"]),
            "its name ends in .mp4, and it is written as .png, .jpg or .tiff"
        );
    }
}
