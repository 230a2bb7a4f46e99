//! Spreads colours over a view's own times: at depth these lie so close together that a palette
//! over the whole budget would show a single colour.

use flipmap_engine::{Engine, IntegratorConfig};
use flipmap_pendulum::Status;
use flipmap_render::tiles::Work;
use flipmap_render::tiles::preview::preview;
use flipmap_scene::palette::equalised;
use flipmap_scene::{Document, PictureTable};

use super::exit::Exit;
use super::stop;

/// Length in pixels of the longer side of the small picture whose times are used.
const MAX_SIDE_PX: u32 = 64;

/// Sets the times of a document's colours to those of its own view, and prints their range.
/// If nothing flips, they stay as they are.
pub(super) fn spread(
    document: &mut Document,
    size: [u32; 2],
    config: IntegratorConfig,
    engine: &mut dyn Engine,
) -> anyhow::Result<()> {
    let longest = size[0].max(size[1]);
    let small = |side: u32| (u64::from(side) * u64::from(MAX_SIDE_PX) / u64::from(longest)) as u32;
    let few = if longest > MAX_SIDE_PX { size.map(|side| small(side).max(1)) } else { size };
    let scene = document.scene();
    let count = (few[0] * few[1]) as usize;
    let mut work = Work::new(&scene, few, config, count).before(&scene, size);
    let samples = preview(&mut work, few, engine, &|_| !stop::asked())?;
    let samples = samples.ok_or(Exit::Interrupted)?;
    let flipped = samples.iter().filter(|outcome| outcome.status == Status::Answered);
    let times = equalised(flipped.map(|outcome| outcome.time), PictureTable::SPREAD_STEPS);
    if let [first, .., last] = times[..] {
        let ask = scene.question.ask;
        let (what, unit) = match ask.is_time() {
            true => ("times", "s"),
            false => ("values", ask.kind().channels[0].unit),
        };
        super::tell(&format!(
            "flipmap: colours are spread over the view's own {what}, {first:.4} to {last:.4} \
             {unit}; --times budget spreads them over the whole budget"
        ));
        document.picture.times = times;
    }
    Ok(())
}
