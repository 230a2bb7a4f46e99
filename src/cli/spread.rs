//! Spreads colours over a view's own times.

use flipmap_engine::{Engine, IntegratorConfig};
use flipmap_pendulum::Status;
use flipmap_render::tiles::Work;
use flipmap_render::tiles::preview::preview;
use flipmap_scene::Document;
use flipmap_scene::palette::{ViewTimes, budget_range_secs};

use super::exit::Exit;
use super::stop;

/// Sets the times of a document's colours to those of its own view, which have this weight beside
/// the budget's, and prints their range.
/// If nothing flips, they stay as they are.
pub(super) fn spread(
    document: &mut Document,
    size: [u32; 2],
    config: IntegratorConfig,
    engine: &mut dyn Engine,
    weight: f64,
) -> anyhow::Result<()> {
    let few = ViewTimes::grid(size);
    let scene = document.scene();
    let count = (few[0] * few[1]) as usize;
    let mut work = Work::new(&scene, few, config, count).before(&scene, size);
    let samples = preview(&mut work, few, engine, &|_| !stop::asked())?;
    let samples = samples.ok_or(Exit::Interrupted)?;
    let flipped = samples.iter().filter(|outcome| outcome.status == Status::Answered);
    let times = ViewTimes::new(flipped.map(|outcome| outcome.time));
    let (unit_secs, budget_secs) = (scene.build.unit_secs(), scene.question.budget.secs);
    let spread = times.spread(weight, budget_range_secs(unit_secs, budget_secs));
    if let [first, .., last] = spread[..] {
        super::tell(&format!(
            "flipmap: colours are spread over the view's own times, {first:.4} to {last:.4} s; \
             --times budget spreads them over the whole budget"
        ));
        (document.picture.times, document.picture.of_view) = (spread, true);
    }
    if let Some(flat_secs) = times.flat_secs() {
        let to = if flat_secs > 0.0 { format!(" to {flat_secs:.0e} s") } else { String::new() };
        super::tell(&format!(
            "flipmap: the view is flat{to}: there is nothing smaller here; \
             flipmap deeper follows the nearest filament"
        ));
    }
    Ok(())
}
