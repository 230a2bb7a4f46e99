//! What is worth a closer look in the view: its nearest filament and island, and its longest flip.
//! All are found among samples that are known already.

use glam::DVec2;

use flipmap_pendulum::{Outcome, Status};
use flipmap_render::tiles::explorer::Explorer;
use flipmap_screen::camera::{Camera, Screen};
use flipmap_screen::samples_in_view;

/// A place in the view, and the camera that shows it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Find {
    /// What it is.
    pub name: &'static str,
    /// Camera that shows it.
    pub camera: Camera,
    /// Its flip time in s, if the find is about one.
    pub secs: Option<f64>,
}

/// Number of columns of the grid on which finds are looked for.
const COLUMNS: u32 = 96;
/// Ratio of the width of the view to that of a find's own view.
const CLOSER: f64 = 8.0;
/// Distance from the middle, in columns, at which a place counts for half.
const NEAR: f64 = 24.0;
/// Largest difference of neighbours in an island, as a share of their times.
const CALM: f64 = 0.02;
/// Smallest and largest number of samples of an island, as a share of the view for the largest.
const ISLAND: (usize, f64) = (6, 0.03);
/// Width of an island's view in widths of the island.
const AROUND: f64 = 2.5;

/// Returns what is worth a closer look in a view whose samples are known.
pub(crate) fn finds(screen: &Screen, explorer: &mut Explorer) -> Vec<Find> {
    let rows = (f64::from(COLUMNS) * screen.size.y / screen.size.x).round().max(1.0) as u32;
    let outcomes = samples_in_view::grid(screen, explorer, [COLUMNS, rows]);
    let grid = OutcomeGrid { outcomes, columns: COLUMNS as usize };
    let at = |place: DVec2, width_share: f64| {
        let point = (place - 0.5 * DVec2::new(f64::from(COLUMNS), f64::from(rows)))
            * (screen.size.x / f64::from(COLUMNS));
        let moved = screen.camera.moved(screen.offset_at(point));
        Camera { width_rad: screen.camera.width_rad * width_share, ..moved }
    };
    let filament = grid.filament().map(|place| ("Nearest filament", at(place, 1.0 / CLOSER), None));
    let island = grid.island().map(|(place, width)| {
        ("Nearest island", at(place, AROUND * width / f64::from(COLUMNS)), None)
    });
    let longest = grid.longest();
    let longest =
        longest.map(|(place, secs)| ("Longest flip here", at(place, 1.0 / CLOSER), Some(secs)));
    let all = [filament, island, longest].into_iter().flatten();
    all.map(|(name, camera, secs)| Find { name, camera, secs }).collect()
}

/// Outcomes at the middles of a grid's places, row by row from the top; none where nothing is
/// known.
struct OutcomeGrid {
    outcomes: Vec<Option<Outcome>>,
    columns: usize,
}

impl OutcomeGrid {
    fn secs(&self, index: usize) -> Option<f64> {
        self.outcomes[index].filter(|o| o.status == Status::Answered).map(|o| o.time)
    }

    fn place(&self, index: usize) -> DVec2 {
        DVec2::new((index % self.columns) as f64 + 0.5, (index / self.columns) as f64 + 0.5)
    }

    fn middle(&self) -> DVec2 {
        0.5 * DVec2::new(self.columns as f64, (self.outcomes.len() / self.columns) as f64)
    }

    /// Returns the weight of a place by its distance from the middle.
    fn nearness(&self, place: DVec2) -> f64 {
        1.0 / (1.0 + (place.distance(self.middle()) / NEAR).powi(2))
    }

    /// Returns the places beside, above and below one, as far as the grid reaches.
    fn beside(&self, index: usize) -> impl Iterator<Item = usize> {
        let (column, columns, count) = (index % self.columns, self.columns, self.outcomes.len());
        let left = (column > 0).then(|| index - 1);
        let right = (column + 1 < columns).then_some(index + 1);
        let above = index.checked_sub(columns);
        let below = Some(index + columns).filter(|below| *below < count);
        [left, right, above, below].into_iter().flatten()
    }

    /// Returns the place near the middle whose flip times differ most from their neighbours' while
    /// all of them flip.
    fn filament(&self) -> Option<DVec2> {
        let liveliness = |index: usize| {
            let here = self.secs(index)?;
            let beside: Option<Vec<f64>> = self.beside(index).map(|k| self.secs(k)).collect();
            let differ = |there: f64| (there / here).ln().abs().min(1.0);
            let all: f64 = beside?.into_iter().map(differ).sum();
            (all > 0.1).then(|| all * self.nearness(self.place(index)))
        };
        let scored = (0..self.outcomes.len()).filter_map(|k| Some((k, liveliness(k)?)));
        let (best, _) = scored.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(self.place(best))
    }

    /// Returns the middle and the larger side of the calm piece nearest to the middle that has an
    /// end on all sides.
    fn island(&self) -> Option<(DVec2, f64)> {
        let mut seen = vec![false; self.outcomes.len()];
        let most = (ISLAND.1 * self.outcomes.len() as f64) as usize;
        let mut best: Option<(f64, DVec2, f64)> = None;
        for start in 0..self.outcomes.len() {
            let piece = self.piece(start, &mut seen);
            if !(ISLAND.0..=most).contains(&piece.len()) {
                continue;
            }
            let places = piece.iter().map(|&k| self.place(k));
            let (low, high) = places.fold((DVec2::MAX, DVec2::MIN), |(low, high), place| {
                (low.min(place), high.max(place))
            });
            let (middle, size) = (0.5 * (low + high), (high - low + 1.0).max_element());
            let score = self.nearness(middle) * piece.len() as f64 / (size * size);
            if best.is_none_or(|(other, ..)| score > other) {
                best = Some((score, middle, size));
            }
        }
        best.map(|(_, middle, size)| (middle, size))
    }

    /// Returns the connected places that flip at nearly the same time, or do not flip, as the one
    /// where it starts; empty if it was seen before, is not simulated, or reaches the border.
    fn piece(&self, start: usize, seen: &mut [bool]) -> Vec<usize> {
        let is_simulated = |o: &Outcome| matches!(o.status, Status::Answered | Status::Unflipped);
        if seen[start] || !self.outcomes[start].as_ref().is_some_and(is_simulated) {
            return Vec::new();
        }
        seen[start] = true;
        let (mut piece, mut next, mut is_whole) = (vec![start], 0, true);
        while let Some(&index) = piece.get(next) {
            next += 1;
            is_whole &= self.beside(index).count() == 4;
            for other in self.beside(index) {
                if !seen[other] && self.is_alike(index, other) {
                    seen[other] = true;
                    piece.push(other);
                }
            }
        }
        if is_whole { piece } else { Vec::new() }
    }

    fn is_alike(&self, a: usize, b: usize) -> bool {
        match (self.secs(a), self.secs(b)) {
            (Some(a), Some(b)) => (a / b).ln().abs() < CALM,
            (None, None) => {
                self.outcomes[a].map(|o| o.status) == self.outcomes[b].map(|o| o.status)
            }
            _ => false,
        }
    }

    /// Returns the place of the longest flip and its time in s.
    fn longest(&self) -> Option<(DVec2, f64)> {
        let flips = (0..self.outcomes.len()).filter_map(|k| Some((k, self.secs(k)?)));
        let (place, secs) = flips.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((self.place(place), secs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 24 × 16 places with these times; no time is an unflipped place.
    fn grid(secs: impl Fn(usize, usize) -> Option<f64>) -> OutcomeGrid {
        let places = (0..16).flat_map(|row| (0..24).map(move |column| (column, row)));
        let outcome = |secs: Option<f64>| {
            Some(match secs {
                Some(secs) => Outcome::flipped(secs),
                None => Outcome::without_time(Status::Unflipped),
            })
        };
        let outcomes = places.map(|(column, row)| outcome(secs(column, row))).collect();
        OutcomeGrid { outcomes, columns: 24 }
    }

    #[test]
    fn an_edge_is_a_filament_and_a_slope_is_none() {
        let place = grid(|x, _| Some(if x < 9 { 2.0 } else { 5.0 })).filament().unwrap();
        assert!((place.x - 9.0).abs() <= 0.5 && (place.y - 8.0).abs() < 1.0, "{place}");
        assert_eq!(grid(|x, _| Some(2.0 + 0.001 * x as f64)).filament(), None);
    }

    #[test]
    fn an_island_has_an_end_on_all_sides() {
        let lake = |x: usize, y: usize| {
            if (10..13).contains(&x) && (5..8).contains(&y) { None } else { Some((x * y) as f64) }
        };
        let (middle, size) = grid(lake).island().unwrap();
        assert!((middle - DVec2::new(11.5, 6.5)).length() < 1e-9 && size == 3.0, "{middle} {size}");
        let bay = |x: usize, y: usize| if x < 3 && y < 3 { None } else { Some((x * y) as f64) };
        assert_eq!(grid(bay).island(), None, "it reaches the border");
    }

    #[test]
    fn the_longest_flip_is_where_its_time_is() {
        let secs = |x: usize, y: usize| Some(if (x, y) == (20, 3) { 29.5 } else { 4.0 });
        assert_eq!(grid(secs).longest(), Some((DVec2::new(20.5, 3.5), 29.5)));
        assert_eq!(grid(|_, _| None).longest(), None);
    }
}
