//! `flipmap report --hunt`: tests `exact` on random scenes.

use std::path::Path;

use anyhow::Context;
use flipmap_engine::choice::EngineRequest;
use flipmap_report::hunt::{Hunt, WrongPixel};

use super::exit::Exit;
use super::stop;

/// Hunts for wrong pixels, and writes the findings to `hunt.json` after every window.
pub(super) fn run(
    minutes: f64,
    seed: u64,
    folder: &Path,
    request: &EngineRequest,
) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("-o: cannot create {}", folder.display()))?;
    let path = folder.join("hunt.json");
    if path.exists() && !Hunt::is_in(&path) {
        return Err(Exit::Usage(format!(
            "-o: {} was not written by flipmap report --hunt: name another folder",
            path.display()
        ))
        .into());
    }
    write(&path, &Hunt { seed, ..Hunt::default() })?;
    stop::listen()?;
    let (mut known, mut failed) = (0, None);
    let hunt = Hunt::run(minutes, usize::MAX, seed, request, &stop::asked, &mut |hunt| {
        hunt.wrong[known..].iter().for_each(tell);
        known = hunt.wrong.len();
        failed = write(&path, hunt).err();
    })?;
    if let Some(error) = failed {
        return Err(error);
    }
    if stop::asked() {
        let (path, windows) = (path.display(), hunt.windows);
        return Err(Exit::Partly(format!("stopped; {path} holds {windows} windows")).into());
    }
    let Hunt { windows, simulated, marked, judged, untold, .. } = hunt;
    super::tell(&format!(
        "flipmap: seed {seed}: {windows} windows with {simulated} simulated pixels: {marked} \
         marked, {judged} judged ({untold} undecidable), {known} wrong and not marked; details \
         are in {}",
        path.display()
    ));
    if known > 0 {
        return Err(Exit::Differs(format!("{known} pixels are wrong and not marked")).into());
    }
    Ok(())
}

fn tell(wrong: &WrongPixel) {
    let [column, row] = wrong.pixel;
    let WrongPixel { given, truth, command, .. } = wrong;
    super::tell(&format!(
        "flipmap: pixel ({column}, {row}) has {given} instead of {truth}: {command}"
    ));
}

fn write(path: &Path, hunt: &Hunt) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(hunt)? + "\n";
    super::write_whole(path, "-o", text.as_bytes())
}
