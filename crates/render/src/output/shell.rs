//! Paths in commands that a message suggests.

use std::path::Path;

/// Returns a path as a shell reads it, quoted if it has spaces or special characters.
pub fn shell_word(path: &Path) -> String {
    let text = path.to_string_lossy();
    // Only a NUL cannot be quoted, and no path has one.
    shlex::try_quote(&text).map_or_else(|_| text.to_string(), |quoted| quoted.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_again_as_one() {
        assert_eq!(shell_word(Path::new("out/big.toml")), "out/big.toml");
        for name in ["two words.toml", "$(reboot).toml", "it's.toml", "a;b", "\n"] {
            assert_eq!(shlex::split(&shell_word(Path::new(name))).unwrap(), [name]);
        }
    }
}
