//! Colours of a deep film, spread over the times at which its own places flip.

use super::task::TaskKind;
use super::{PartError, Parts, Task};
use flipmap_pendulum::Status;
use flipmap_scene::PictureTable;
use flipmap_scene::film::Film;
use flipmap_scene::palette::{Palette, equalised};

/// Decades of zoom for each run through the palette.
const DECADES_A_CYCLE: f64 = 2.0;
/// Width in rad of a film's narrowest view below which its colours are spread over its own times.
const DEEP_FILM_RAD: f64 = 1e-6;

/// Returns true if a film zooms so far, or so deep, that its colours are spread over its own times
/// unless the user chose others.
pub fn is_deep(film: &Film) -> bool {
    decades(film) > PictureTable::SPREAD_FILM_DECADES
        || widths_rad(film).any(|width| width < DEEP_FILM_RAD)
}

/// Returns the number of decades that a film zooms through.
fn decades(film: &Film) -> f64 {
    let (least, most) = widths_rad(film).fold((f64::MAX, 0f64), |(a, b), w| (a.min(w), b.max(w)));
    (most / least).log10()
}

fn widths_rad(film: &Film) -> impl Iterator<Item = f64> {
    film.keys.iter().map(|key| key.scene.view.width_rad().hi)
}

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

/// Spreads the colours of a film of flips over its own times.
/// Deeper views flip later, so a long zoom runs through the palette repeatedly; unless the user
/// chose a palette, it is then a cyclic one. If nothing flips, the colours stay as they are; returns
/// false then.
pub fn spread_film(
    task: &Task,
    parts: &mut Parts,
    open: OpenChoices,
    picture: &mut PictureTable,
) -> Result<bool, PartError> {
    let TaskKind::Film(film, _) = &task.work else { return Ok(false) };
    let times = times(task, parts)?;
    if times.is_empty() {
        return Ok(false);
    }
    picture.times = times;
    if open.cycles && picture.cycles == 1.0 {
        picture.cycles = (decades(film) / DECADES_A_CYCLE).clamp(1.0, 100.0).round();
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
