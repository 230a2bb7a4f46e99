//! `flipmap --version`; with `--verbose` also licences and sources.

use flipmap_engine::cpu::instruction_set;
use flipmap_scene::palette::Palette;

/// Prints the version; if `is_verbose`, also the platform, the program's licence, and the sources
/// and licences of the colour tables.
pub(super) fn say(is_verbose: bool) -> anyhow::Result<()> {
    super::say(concat!("flipmap ", env!("CARGO_PKG_VERSION")))?;
    if !is_verbose {
        return Ok(());
    }
    let window = if cfg!(feature = "window") { "with" } else { "without" };
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    super::say(&format!(
        "built for {os} on {arch}, {window} a window; this processor has {}",
        instruction_set()
    ))?;
    super::say(concat!("licence: ", env!("CARGO_PKG_LICENSE")))?;
    super::say("colour tables:")?;
    Palette::notes().try_for_each(|note| super::say(&format!("  {note}")))
}
