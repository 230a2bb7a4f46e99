//! `flipmap man` and `flipmap completions`: the manual's pages and the completions of shells, made
//! from the options themselves.

use clap::builder::PossibleValuesParser;
use clap::{Arg, Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;
use flipmap_scene::not_among;

use super::exit::Exit;

#[derive(Args, Debug)]
pub(super) struct ManOptions {
    /// Subcommand whose page is printed (default: the page of flipmap itself)
    subcommand: Option<String>,
}

#[derive(Args, Debug)]
pub(super) struct CompletionOptions {
    /// Shell to print completions for: bash, zsh, fish, elvish or powershell
    shell: Shell,
}

/// Prints a page of the manual, for `man -l -` or a file in `share/man/man1`.
pub(super) fn man(mut program: Command, options: &ManOptions) -> anyhow::Result<()> {
    program.build();
    let page = match &options.subcommand {
        None => program,
        Some(name) => {
            let found = program.get_subcommands().find(|verb| verb.get_name() == name).cloned();
            let known = || program.get_subcommands().map(Command::get_name).collect::<Vec<_>>();
            found.ok_or_else(|| {
                let known = not_among("subcommands", &known(), name);
                Exit::Usage(format!("no subcommand '{name}'; {known}"))
            })?
        }
    };
    // The manual has the whole text of every option.
    let page = page.mut_args(|option| option.hide_short_help(false));
    let name = page.get_display_name().unwrap_or("flipmap").to_string();
    let mut text = Vec::new();
    Man::new(page).title(name).render(&mut text)?;
    let text = String::from_utf8_lossy(&text).replace(".SH EXTRA", ".SH EXAMPLES");
    super::say(text.trim_end())
}

/// Prints the completions of a shell.
pub(super) fn completions(program: Command, options: &CompletionOptions) -> anyhow::Result<()> {
    let verbs: Vec<String> =
        program.get_subcommands().map(|verb| verb.get_name().to_string()).collect();
    let known = |subcommand: Arg| subcommand.value_parser(PossibleValuesParser::new(verbs));
    let mut program = program.mut_subcommand("man", |man| man.mut_arg("subcommand", known));
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut program, "flipmap", &mut text);
    super::say(String::from_utf8_lossy(&text).trim_end())
}
