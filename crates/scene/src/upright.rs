//! Starts from rest in an upright picture: θ1 is constant along a column, and θ2 along a row.
//!
//! The energy of a start is then the sum of one number for its column and one for its row, and a
//! device needs only the angles of columns and rows. Where the energy in f64 does not decide
//! whether a start can flip, [`Grid::fate`] does.

use std::ops::Range;

use super::Grid;
use super::grid::SURE;
use flipmap_numbers::Dd;
use flipmap_pendulum::Rule;
use flipmap_pendulum::opening::from_top;

/// The angles of some columns and rows of an upright grid.
#[derive(Clone, Debug)]
pub struct SeparableGrid {
    /// Angles of the columns and of the rows, in rad within [−π, π].
    pub angles: [Vec<Dd>; 2],
    /// Contributions of each column and each row to a start's depth in the forbidden region; NaN
    /// near the top and at an angle of 0.
    depths: [Vec<f64>; 2],
    /// Depth in J beyond which the sign of a depth in f64 is certain.
    sure: f64,
    /// True if energy forbids every flip.
    is_never: bool,
}

impl Grid {
    /// Returns the angles of some columns and rows, or `None` if the grid is turned, has moving
    /// starts or watches no bob.
    pub fn upright(&self, columns: Range<u32>, rows: Range<u32>) -> Option<SeparableGrid> {
        let zero = Dd::new(0.0);
        let [right, up] = self.axes_rad();
        if !self.starts_at_rest()
            || self.rule() == Rule::Neither
            || right[1] != zero
            || up[0] != zero
        {
            return None;
        }
        let [x, y] = [columns.start, rows.start];
        let theta1: Vec<Dd> = columns.map(|x| self.angle_from_pixel(x, y)[0]).collect();
        let theta2: Vec<Dd> = rows.map(|y| self.angle_from_pixel(x, y)[1]).collect();
        let pendulum = self.pendulum();
        let near_rad = self.opening_rad();
        let part = |angle: &Dd, weight: f64, least: f64| {
            let is_plain = from_top(angle.hi).abs() > near_rad && angle.hi != 0.0;
            if is_plain { weight * angle.hi.cos() - least } else { f64::NAN }
        };
        let least = pendulum.least_depth(self.rule());
        let depths = [
            theta1.iter().map(|angle| part(angle, pendulum.p, least)).collect(),
            theta2.iter().map(|angle| part(angle, pendulum.q, 0.0)).collect(),
        ];
        Some(SeparableGrid {
            angles: [theta1, theta2],
            depths,
            sure: SURE * (pendulum.p + pendulum.q),
            is_never: pendulum.q <= 0.0,
        })
    }
}

impl SeparableGrid {
    /// Returns `Some(true)` if energy forbids a flip of the start at these indices into
    /// [`SeparableGrid::angles`], and `None` if its energy in f64 does not decide.
    pub fn is_forbidden(&self, column: usize, row: usize) -> Option<bool> {
        let depth = self.depths[0][column] + self.depths[1][row];
        (depth.abs() > self.sure).then_some(self.is_never || depth > 0.0)
    }

    /// Returns the angles of the start at these indices into [`SeparableGrid::angles`].
    pub fn angle(&self, column: usize, row: usize) -> [Dd; 2] {
        [self.angles[0][column], self.angles[1][row]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BuiltIn, Fate, Scene, View};
    use flipmap_pendulum::Status;

    fn upright(grid: &Grid) -> Option<SeparableGrid> {
        grid.upright(0..grid.size()[0], 0..grid.size()[1])
    }

    #[test]
    fn what_it_says_of_starts_is_their_fate() {
        let home = BuiltIn::home().document().scene();
        let center = ["1".to_string(), "1.6".to_string()];
        let across_the_curve = View { center, width: "1".to_string(), ..View::default() };
        let scenes = [home, Scene::default(), Scene { view: across_the_curve, ..Scene::default() }];
        for (scene, size) in
            scenes.iter().flat_map(|scene| [[96, 64], [61, 45]].map(|size| (scene, size)))
        {
            let grid = Grid::new(&scene.clone().checked().unwrap(), size);
            let upright = upright(&grid).expect("not turned");
            let mut sure = 0;
            for (x, y) in (0..size[0]).flat_map(|x| (0..size[1]).map(move |y| (x, y))) {
                let [column, row] = [x, y].map(|side| side as usize);
                let Some(is_forbidden) = upright.is_forbidden(column, row) else { continue };
                sure += 1;
                match grid.fate(x, y) {
                    Fate::Open(angle) => {
                        assert!(!is_forbidden && angle == upright.angle(column, row), "({x}, {y})");
                    }
                    Fate::Known(outcome) => {
                        assert!(is_forbidden && outcome.status == Status::Forbidden, "({x}, {y})");
                    }
                    Fate::Thrown(_) | Fate::BesideTop(_) => panic!("from rest, far from the top"),
                }
            }
            assert!(sure > size[0] * size[1] / 2, "{sure} of {size:?}");
        }
    }

    #[test]
    fn near_the_top_it_says_nothing() {
        let center = ["0".to_string(), "3.14159".to_string()];
        let view = View { center, width: "1e-4".to_string(), ..View::default() };
        let grid = Grid::new(&Scene { view, ..Scene::default() }.checked().unwrap(), [9, 9]);
        let upright = upright(&grid).expect("not turned");
        assert!((0..81).all(|place| upright.is_forbidden(place % 9, place / 9).is_none()));
    }

    #[test]
    fn turned_pictures_and_those_without_forbidden_starts_have_none() {
        let turned = View { rotate: 10.0, ..View::default() };
        let grid = |scene: Scene| Grid::new(&scene.checked().unwrap(), [20, 20]);
        assert!(upright(&grid(Scene { view: turned, ..Scene::default() })).is_none());
        assert!(upright(&grid(Scene::default())).is_some());
    }
}
