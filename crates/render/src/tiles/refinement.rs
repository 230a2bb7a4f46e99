//! Finer samples at edges, computed once a view is known and nothing else is left to do.
//!
//! A sample is *plain* if it and its neighbours in the cell have the same status and their values,
//! if any, lie on straight lines: finer samples could only show the values in between. So a quarter
//! with only plain samples is left as it is. In the other quarters, only the samples at edges are
//! computed if the question asks for a time; otherwise all are:
//!
//! ```text
//!   ┌───┬───┬───┬───┐        ┌───┬───┬───┬───┐
//!   │ a │ a │ a │ b │        │ aaaaaa│a·:│:·b│   a, b: from the line through their neighbours
//!   ├───┼───┼───┼───┤  ──▶   │ aaaaaa├───┼───┤   · :   computed
//!   │ a │ a │ b │ b │        │ aaa│a·:│:·b│bb│
//!   └───┴───┴───┴───┘        └───┴───┴───┴───┘
//! ```
//!
//! Lines end at the borders of a cell, so a sample is plain or not regardless of which neighbouring
//! cells are known. Colours do not matter either, unlike for the plain pixels of a picture
//! (`adaptive.rs`): they may change at any time without computing anything.

use std::sync::Arc;

use super::open_tile::Known;
use super::samples::Samples;
use super::saved_pixels::SavedPixel;
use super::view_target::ViewTarget;
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::lattice::{Cell, DEEPEST, SIDE};

/// A flag for each quarter of a cell, row by row from the upper left.
pub(super) type Quarters = [bool; 4];

/// Largest bend of a line, as a share of its rise, at which values are interpolated.
const STRAIGHT: f64 = 0.125;
/// Largest bend, as a share of the value itself, that is taken for rounding.
const ROUNDING: f64 = 1e-9;
/// Steps to the neighbours on one side of the four lines through a sample; the first two lines give
/// its slope.
const LINES: [[i32; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];

/// The finer levels of a view: how many it may have, and how many have begun.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Refinement {
    pub begun: u32,
    last: u32,
    /// Number of cells that the level begun last had to compute.
    planned: usize,
}

impl Refinement {
    /// Creates the finer levels of a target, each with at most `most` cells in view; `begun` levels
    /// had begun for the same view.
    pub(super) fn of(target: &ViewTarget, most: usize, begun: u32) -> Self {
        let fits = |n: &u32| {
            let level = target.level + n;
            level <= DEEPEST && !target.region.cells(level, most).is_empty()
        };
        let last = (1..=target.refinements).take_while(fits).last().unwrap_or(0);
        Refinement { begun: begun.min(last), last, planned: 0 }
    }

    /// Begins the next finer level; returns false if there is none.
    pub(super) fn begin_next(&mut self) -> bool {
        let goes_on = self.begun < self.last;
        self.begun += u32::from(goes_on);
        goes_on
    }

    /// Returns true if there are finer levels.
    pub(super) fn is_wanted(&self) -> bool {
        self.last > 0
    }

    /// Takes note of the number of cells that the level begun last has to compute.
    pub(super) fn expect(&mut self, cells: usize) {
        self.planned = cells;
    }

    /// Returns the share of the finer levels that is computed, 0 to 1, while `left` cells of the
    /// level begun last are missing. Each level has about three times as many samples as the one
    /// before.
    pub(super) fn share(&self, left: usize) -> f64 {
        let weight = |levels: u32| 3f64.powf(levels.into()) - 1.0;
        let Some(done) = self.begun.checked_sub(1) else {
            return if self.last == 0 { 1.0 } else { 0.0 };
        };
        let part = 1.0 - left as f64 / self.planned.max(left).max(1) as f64;
        let reached = weight(done) + part * (weight(self.begun) - weight(done));
        reached / weight(self.last)
    }
}

/// Returns, for each quarter of a cell, true if any of its samples is not plain.
pub(super) fn edges(samples: &Samples) -> Quarters {
    let half = (SIDE / 2) as i32;
    [[0, 0], [half, 0], [0, half], [half, half]].map(|[left, top]| {
        let mut places = (top..top + half).flat_map(|y| (left..left + half).map(move |x| [x, y]));
        places.any(|place| slope(samples, place).is_none())
    })
}

/// Returns the rise of a plain sample's first value from column to column and from row to row;
/// `None` if the sample is not plain.
fn slope(samples: &Samples, place: [i32; 2]) -> Option<[f64; 2]> {
    let middle = index(place)?;
    let status = samples.get(middle).status;
    let mut slope = [0.0; 2];
    for (k, [dx, dy]) in LINES.into_iter().enumerate() {
        let sides = [[-dx, -dy], [dx, dy]].map(|[dx, dy]| index([place[0] + dx, place[1] + dy]));
        let differs = |side: &usize| samples.get(*side).status != status;
        if sides.iter().flatten().any(differs) {
            return None;
        }
        if status != Status::Answered {
            continue;
        }
        let rise = line(samples, middle, sides)?;
        if k < 2 {
            slope[k] = rise;
        }
    }
    Some(slope)
}

/// Returns the rise of the first value from sample to sample along a line through a sample and its
/// neighbours in the cell; `None` if the values of a channel do not lie on a line.
fn line(samples: &Samples, middle: usize, sides: [Option<usize>; 2]) -> Option<f64> {
    let of = |side: usize, channel: usize| samples.values(side)[channel];
    let (before, after) = match sides {
        [Some(before), Some(after)] => (before, after),
        [Some(before), None] => return Some(of(middle, 0) - of(before, 0)),
        [None, Some(after)] => return Some(of(after, 0) - of(middle, 0)),
        [None, None] => return Some(0.0),
    };
    let is_straight = |channel: usize| {
        let [a, b, c] = [before, middle, after].map(|side| of(side, channel));
        let rise = (b - a).abs() + (c - b).abs();
        (a - 2.0 * b + c).abs() <= STRAIGHT * rise + ROUNDING * b.abs()
    };
    let all = (0..samples.channels()).all(is_straight);
    all.then(|| 0.5 * (of(after, 0) - of(before, 0)))
}

/// Returns the index of the sample at a column and a row, if it is in the cell.
fn index([x, y]: [i32; 2]) -> Option<usize> {
    let side = 0..SIDE as i32;
    (side.contains(&x) && side.contains(&y)).then(|| (y * side.end + x) as usize)
}

/// The samples of a cell from which those of one of its quarters are interpolated.
#[derive(Debug)]
pub(super) struct Coarser {
    samples: Arc<Samples>,
    /// True if the samples are those of the cell's mirror image, in reverse order.
    mirrored: bool,
    /// The first column and row of the quarter among the cell's samples.
    first: [u32; 2],
}

/// Returns the index of a child's quarter among those of its parent's samples.
pub(super) fn quarter_of(child: &Cell, parent: &Cell, mirrored: bool) -> usize {
    let [column, from_below] = child.index_in(parent);
    let quarter = column as usize + 2 * (1 - from_below as usize);
    if mirrored { 3 - quarter } else { quarter }
}

impl Coarser {
    /// Takes the samples of a child's parent, or of the parent's mirror image.
    pub(super) fn of(child: &Cell, parent: &Cell, samples: Arc<Samples>, mirrored: bool) -> Self {
        let quarter = quarter_of(child, parent, false) as u32;
        let first = [quarter % 2, quarter / 2].map(|half| half * SIDE / 2);
        Coarser { samples, mirrored, first }
    }

    /// Returns the interpolated sample at a column and row of the quarter's own cell; `None` if it
    /// has to be computed.
    pub(super) fn known(&self, [x, y]: [u32; 2]) -> Option<Known> {
        let [mut column, mut row] = [self.first[0] + x / 2, self.first[1] + y / 2];
        // From the middle of the coarse sample to that of the fine one.
        let mut away = [x, y].map(|fine| if fine % 2 == 0 { -0.25 } else { 0.25 });
        if self.mirrored {
            [column, row] = [column, row].map(|coarse| SIDE - 1 - coarse);
            away = away.map(|away: f64| -away);
        }
        let slope = slope(&self.samples, [column as i32, row as i32])?;
        let index = (row * SIDE + column) as usize;
        let Outcome { status, time } = self.samples.get(index);
        let time = time + away[0] * slope[0] + away[1] * slope[1];
        Some((SavedPixel::Over(Outcome { status, time }), self.samples.assurance(index)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::lattice::SAMPLES;

    /// Returns a cell whose samples flip at these times; a sample with a negative time does not
    /// flip.
    fn cell(time: impl Fn(f64, f64) -> f64) -> Samples {
        let mut samples = Samples::unflipped(SAMPLES);
        for place in 0..SAMPLES {
            let [x, y] = [place as u32 % SIDE, place as u32 / SIDE].map(f64::from);
            let secs = time(x, y);
            if secs >= 0.0 {
                samples.set(place, Outcome::flipped(secs));
            }
        }
        samples
    }

    #[test]
    fn finer_levels_count_by_their_samples() {
        let none = Refinement::default();
        assert_eq!(none.share(0), 1.0, "there is nothing to refine");
        let mut two = Refinement { last: 2, ..none };
        assert_eq!(two.share(0), 0.0, "none has begun");
        assert!(two.begin_next());
        two.expect(10);
        assert_eq!((two.share(10), two.share(5), two.share(0)), (0.0, 0.125, 0.25));
        assert!(two.begin_next());
        two.expect(20);
        assert_eq!((two.share(20), two.share(0)), (0.25, 1.0));
        assert!(!two.begin_next());
    }

    #[test]
    fn only_quarters_with_edges_have_any() {
        assert_eq!(edges(&cell(|x, y| 3.0 + 0.01 * x - 0.02 * y)), [false; 4], "a slope");
        assert_eq!(edges(&cell(|_, _| -1.0)), [false; 4], "nothing flips");
        let jump = |x: f64, y: f64| if x > 50.0 && y > 35.0 { 9.0 } else { 3.0 };
        assert_eq!(edges(&cell(jump)), [false, false, false, true]);
        let unflipped = |x: f64, y: f64| if x < 15.0 && y > 49.0 { -1.0 } else { 3.0 };
        assert_eq!(edges(&cell(unflipped)), [false, false, true, false]);
        assert_eq!(edges(&cell(|x, y| 5.0 + (7.7 * x * x + 3.1 * y).sin())), [true; 4], "chaos");
    }

    #[test]
    fn what_is_plain_follows_from_its_neighbours_also_in_the_mirror() {
        let secs = |x: f64, y: f64| 3.0 + 0.01 * x - 0.02 * y;
        let samples = Arc::new(cell(|x, y| if x > 50.0 { 9.0 } else { secs(x, y) }));
        let [lower_left, _, lower_right, _] = Cell::WHOLE.children();
        let coarser = |child: &Cell, mirrored| {
            Coarser::of(child, &Cell::WHOLE, Arc::clone(&samples), mirrored)
        };
        let at = |coarser: &Coarser, x, y| match coarser.known([x, y]) {
            Some((SavedPixel::Over(outcome), _)) => Some(outcome.time),
            _ => None,
        };
        let right = coarser(&lower_right, false);
        assert_eq!(at(&right, 37, 5), None, "beside the jump");
        let expected = secs(32.0 + 5.25, 32.0 + 3.0 - 0.25);
        assert!((at(&right, 11, 6).unwrap() - expected).abs() < 1e-12);
        // The mirror image of the lower left quarter is the upper right one, turned by half a turn.
        let left = coarser(&lower_left, true);
        let expected = secs(63.0 - 25.25, 63.0 - 32.0 - 3.25);
        assert!((at(&left, 51, 7).unwrap() - expected).abs() < 1e-12);
        assert_eq!(at(&left, 26, 7), None, "beside the jump in the mirror");
    }
}
