//! Colours of a deep film, spread over the times at which its own places flip.

use super::task::TaskKind;
use super::{PartError, Parts, Task};
use flipmap_pendulum::Status;
use flipmap_scene::PictureTable;
use flipmap_scene::film::Film;
use flipmap_scene::palette::{Palette, equalised};

/// Returns the number of decades that a film zooms through, and the width of its narrowest key in
/// rad.
pub fn zoom(film: &Film) -> (f64, f64) {
    let widths = film.keys.iter().map(|key| key.scene.view.width_rad().hi);
    let (least, most) = widths.fold((f64::MAX, 0f64), |(a, b), w| (a.min(w), b.max(w)));
    ((most / least).log10(), least)
}

/// Decades of zoom for each run through the palette.
const DECADES_A_CYCLE: f64 = 2.0;

/// The choices of colours that the user left open.
#[derive(Clone, Copy, Debug)]
pub struct OpenChoices {
    /// How often the colours run through the palette.
    pub cycles: bool,
    /// The palette.
    pub palette: bool,
    /// How the palette repeats.
    pub repeat: bool,
}

/// Spreads the colours of a film of flips, which zooms through `decades`, over its own times.
/// Deeper views flip later, so a long zoom runs through the palette repeatedly; unless the user
/// chose a palette, it is then a cyclic one. If nothing flips, the colours stay as they are; returns
/// false then.
pub fn spread_film(
    (task, parts): (&Task, &mut Parts),
    decades: f64,
    open: OpenChoices,
    picture: &mut PictureTable,
) -> Result<bool, PartError> {
    let times = times(task, parts)?;
    if times.is_empty() {
        return Ok(false);
    }
    picture.times = times;
    if open.cycles && picture.cycles == 1.0 {
        picture.cycles = (decades / DECADES_A_CYCLE).clamp(1.0, 100.0).round();
        if picture.cycles > 1.0 && open.palette && Palette::is_unchosen(&picture.palette) {
            picture.palette = Palette::CYCLIC.to_string();
        }
        if open.repeat {
            picture.mirror = picture.cycles > 1.0 && !Palette::is_cyclic(&picture.palette);
        }
    }
    Ok(true)
}

/// Stride between the samples of a patch that the spread of colours uses: every fourth row, one
/// column further each time.
const SAMPLED_ROWS: usize = 65;

/// Returns the times over which a deep film's colours are spread: all its depths count alike, and
/// the times are the same in every frame. Empty if nothing flips.
fn times(task: &Task, parts: &mut Parts) -> Result<Vec<f64>, PartError> {
    let TaskKind::Film(_, groups) = &task.work else { return Ok(Vec::new()) };
    let mut times = Vec::new();
    for group in groups {
        for cell in group.cells.iter() {
            let samples = parts.patch(group.of(cell), cell)?;
            let some = samples.iter().step_by(SAMPLED_ROWS);
            times.extend(some.filter(|o| o.status == Status::Answered).map(|o| o.time));
        }
    }
    Ok(equalised(times.into_iter(), PictureTable::MAX_TIMES - 1))
}
