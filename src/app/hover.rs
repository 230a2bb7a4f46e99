//! The sample under the pointer.

use crate::engine::Trust;
use crate::physics::{Outcome, Scalar, Status, Theta};
use crate::scene::Turn;
use crate::scene::lattice::{Cell, SIDE};
use crate::tiles::explorer::Explorer;

/// Returns the starts of the sample that a level draws at an angle and of the one to its right.
pub fn sample_at(angle: [Theta; 2], level: u32) -> [[Theta; 2]; 2] {
    let cell = Cell::around(angle, level);
    let [column, row] = cell.sample_at(angle);
    let pixel = Turn::side(level + SIDE.ilog2()).to_theta() + Theta::pi();
    let half = f64::from(SIDE) / 2.0;
    let [theta1, theta2] = cell.center();
    let along = |column: f64| theta1 + pixel * Theta::from_f64(column + 0.5 - half);
    let up = theta2 + pixel * Theta::from_f64(half - f64::from(row) - 0.5);
    let column = f64::from(column);
    [column, column + 1.0].map(|column| [along(column).wrapped(), up])
}

/// Returns the outcome and trust that the map shows for the sample at an angle within a budget;
/// none while only coarser samples are known.
pub fn outcome_at(
    explorer: &mut Explorer,
    angle: [Theta; 2],
    level: u32,
    budget_secs: f64,
) -> Option<(Outcome, Trust)> {
    let (outcome, trust) = known_at(explorer, Cell::around(angle, level), angle)?;
    // A sample computed for a larger budget may flip after the end of this one.
    let late = outcome.status == Status::Flipped && outcome.time > budget_secs;
    Some((if late { Outcome::without_time(Status::Unflipped) } else { outcome }, trust))
}

/// Returns the known outcome and trust of the sample at an angle inside a cell.
pub fn known_at(
    explorer: &mut Explorer,
    cell: Cell,
    angle: [Theta; 2],
) -> Option<(Outcome, Trust)> {
    let [column, row] = cell.sample_at(angle);
    let (known, mirrored) = explorer.known(cell)?;
    let place = (row * SIDE + column) as usize;
    let place = if mirrored { known.samples.len() - 1 - place } else { place };
    Some((known.samples.get(place), known.samples.trust(place)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    use crate::scene::lattice::pitch_rad;

    #[test]
    fn a_sample_starts_where_its_tile_says() {
        let angle = [-1.66, 0.1].map(Theta::from_f64);
        for level in [0, 3, 20, 60, 300] {
            let [start, next] = sample_at(angle, level);
            let cell = Cell::around(angle, level);
            let [column, row] = cell.sample_at(angle);
            let grid = cell.grid(&Scene::default(), SIDE);
            for (here, there) in start.into_iter().zip(grid.angle_from_pixel(column, row)) {
                assert!((here.to_dd() - there).hi.abs() < 1e-31, "{here} {there}");
            }
            let apart = (next[0] - start[0]).to_f64() / pitch_rad(level);
            assert!((apart - 1.0).abs() < 1e-9 && next[1] == start[1]);
        }
    }
}
