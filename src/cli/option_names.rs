//! Replaces the names of settings in messages by the options that set them.
//!
//! The library says that `` `width` `` is too small, because scenes, locations, the window and
//! Python have a width too; on the command line it is `--width`.

use std::collections::HashMap;
use std::sync::LazyLock;

use clap::CommandFactory;
use flipmap_render::output::Paths;

use super::Cli;
use super::same_file::Named;

/// Options of all subcommands by their long names: `-o` if there is a short form, else `--output`.
static OPTIONS: LazyLock<HashMap<String, String>> = LazyLock::new(|| {
    let program = Cli::command();
    let verbs = program.get_subcommands().flat_map(clap::Command::get_opts);
    verbs
        .filter_map(|option| {
            let name = option.get_long()?;
            let short = option.get_short().map(|short| format!("-{short}"));
            Some((name.to_string(), short.unwrap_or_else(|| format!("--{name}"))))
        })
        .collect()
});

/// Returns the given paths, each with its option.
pub(super) fn by_option(paths: &Paths) -> Vec<Named<'_>> {
    let option = |setting: &'static str| OPTIONS.get(setting).map_or(setting, String::as_str);
    paths.named().into_iter().map(|(setting, path)| (option(setting), path)).collect()
}

/// Returns the message with each setting in backquotes written as its option; other quoted words
/// stay as they are.
pub(super) fn with_options(message: &str) -> String {
    let mut text = String::new();
    let mut rest = message;
    while let Some((before, (quoted, after))) =
        rest.split_once('`').and_then(|(before, rest)| Some((before, rest.split_once('`')?)))
    {
        text.push_str(before);
        let Some(option) = OPTIONS.get(quoted) else {
            // The second backquote may open the next word.
            text.push('`');
            text.push_str(quoted);
            rest = &rest[before.len() + 1 + quoted.len()..];
            continue;
        };
        text.push_str(option);
        rest = after;
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_called_by_their_options() {
        let named = [
            ("`width` is '0'; with `cells` never", "--width is '0'; with --cells never"),
            ("`output`: cannot write", "-o: cannot write"),
            ("a ` alone, then `size`", "a ` alone, then --size"),
            ("the palette `romao` and `", "the palette `romao` and `"),
            ("nothing", "nothing"),
        ];
        for (message, expected) in named {
            assert_eq!(with_options(message), expected);
        }
    }
}
