//! The sample under the pointer.

use flipmap_engine::Assurance;
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::{Outcome, Status};
use flipmap_render::tiles::Stride;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::Turn;
use flipmap_scene::lattice::{Cell, SIDE};
use flipmap_scene::question::MAX_CHANNELS;

/// The answer that the map shows for a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Status: [`Status::Answered`] if there is an answer.
    pub status: Status,
    /// Values of the question's channels, followed by zeros.
    pub values: [f64; MAX_CHANNELS],
    /// Certainty of the answer.
    pub assurance: Assurance,
}

/// Returns the places of the sample that a level draws at a place and of the one to its right.
pub fn sample_at(angle: [Exact; 2], level: u32) -> [[Exact; 2]; 2] {
    let cell = Cell::around(angle, level);
    let [column, row] = cell.sample_at(angle);
    let pixel = Turn::side(level + SIDE.ilog2()).to_theta() + Exact::pi();
    let half = f64::from(SIDE) / 2.0;
    let [theta1, theta2] = cell.center();
    let along = |column: f64| theta1 + pixel * Exact::from_f64(column + 0.5 - half);
    let up = theta2 + pixel * Exact::from_f64(half - f64::from(row) - 0.5);
    let column = f64::from(column);
    [column, column + 1.0].map(|column| [along(column).wrapped(), up])
}

/// Returns the answer that the map shows for the sample at a place; none while only coarser samples
/// are known. Flips after `until_secs`, if it is given, are not shown.
pub fn answer_at(
    explorer: &mut Explorer,
    angle: [Exact; 2],
    level: u32,
    until_secs: Option<f64>,
) -> Option<Answer> {
    if explorer.is_behind() {
        return None;
    }
    let answer = known_at(explorer, Cell::around(angle, level), angle)?;
    // A sample computed for a larger budget may flip after the end of this one.
    let is_flipped = answer.status == Status::Answered;
    let late = is_flipped && until_secs.is_some_and(|until_secs| answer.values[0] > until_secs);
    Some(if late { Answer { status: Status::Unflipped, ..answer } } else { answer })
}

/// Returns the known answer of the sample at a place inside a cell.
pub(crate) fn known_at(explorer: &mut Explorer, cell: Cell, angle: [Exact; 2]) -> Option<Answer> {
    answer_of(explorer, cell, angle, |stride, place| stride.index(place, SIDE))
}

/// Returns the known answer of the sample at a place inside a cell, or of the nearest known one.
pub fn known_near(explorer: &mut Explorer, cell: Cell, angle: [Exact; 2]) -> Option<Answer> {
    answer_of(explorer, cell, angle, |stride, place| Some(stride.nearest(place, SIDE)))
}

fn answer_of(
    explorer: &mut Explorer,
    cell: Cell,
    angle: [Exact; 2],
    index: impl Fn(Stride, [u32; 2]) -> Option<u32>,
) -> Option<Answer> {
    let place = cell.sample_at(angle);
    let (known, mirrored) = explorer.known(cell)?;
    let place = if mirrored { place.map(|k| SIDE - 1 - k) } else { place };
    let index = index(known.stride, place)? as usize;
    let mut values = [0.0; MAX_CHANNELS];
    let known_values = known.samples.values(index);
    values[..known_values.len()].copy_from_slice(known_values);
    let Outcome { status, .. } = known.samples.get(index);
    Some(Answer { status, values, assurance: known.samples.assurance(index) })
}

impl Answer {
    /// Returns the answer to a question about a time as an outcome.
    pub fn outcome(&self) -> Outcome {
        match self.status {
            Status::Answered => Outcome::flipped(self.values[0]),
            other => Outcome::without_time(other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::Scene;

    use flipmap_scene::lattice::pitch_rad;

    #[test]
    fn a_sample_starts_where_its_tile_says() {
        let angle = [-1.66, 0.1].map(Exact::from_f64);
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
