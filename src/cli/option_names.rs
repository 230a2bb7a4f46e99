//! The names of options, made from those of settings: on the command line, the width is `--width`.

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

/// Returns the option of a setting, or the setting's own name if it has none.
pub(super) fn option_of(setting: &'static str) -> &'static str {
    OPTIONS.get(setting).map_or(setting, String::as_str)
}

/// Returns the given paths, each with its option.
pub(super) fn by_option(paths: &Paths) -> Vec<Named<'_>> {
    paths.named().into_iter().map(|(setting, path)| (option_of(setting), path)).collect()
}
