//! The known samples of the view, for colours that fit it and for looking for something in it.

use glam::DVec2;

use super::camera::Screen;
use super::hover::{Answer, known_near};
use flipmap_pendulum::{Outcome, Status};
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::lattice::Cell;
use flipmap_scene::palette::ViewTimes;

/// Returns the outcome of the finest known sample at a point.
pub fn outcome(screen: &Screen, explorer: &mut Explorer, point: DVec2) -> Option<Outcome> {
    Some(best_answer(screen, explorer, point)?.outcome())
}

/// Returns the outcomes of the finest known samples at the middles of a grid over the whole screen,
/// row by row from the top; none where nothing is known.
pub fn grid(
    screen: &Screen,
    explorer: &mut Explorer,
    [columns, rows]: [u32; 2],
) -> Vec<Option<Outcome>> {
    let step = screen.size / DVec2::new(f64::from(columns), f64::from(rows));
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    let point =
        |place: [u32; 2]| DVec2::from(place.map(|k| f64::from(k) + 0.5)) * step - 0.5 * screen.size;
    places.map(|place| outcome(screen, explorer, point(place))).collect()
}

/// Returns the known flip times in s at the places of the view's small picture.
pub fn spread_times(screen: &Screen, explorer: &mut Explorer) -> Vec<f64> {
    let size = ViewTimes::grid(screen.size.to_array().map(|side| side as u32));
    let known = grid(screen, explorer, size).into_iter().flatten();
    let flipped = known.filter(|outcome| outcome.status == Status::Answered);
    flipped.map(|outcome| outcome.time).collect()
}

/// Returns the answer of the finest known sample at a point.
pub fn best_answer(screen: &Screen, explorer: &mut Explorer, point: DVec2) -> Option<Answer> {
    let angle = screen.angle_at(point);
    let around = Cell::around(angle, screen.level());
    let mut cells = std::iter::successors(Some(around), Cell::parent);
    cells.find_map(|cell| known_near(explorer, cell, angle))
}
