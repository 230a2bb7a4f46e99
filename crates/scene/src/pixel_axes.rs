//! Where the pixels of a picture lie: the coordinates of the plane along its columns and rows.

use super::grid::pixels_from_center;
use super::{Axis, Grid, Scene};
use flipmap_numbers::Scalar;

/// The coordinates of pixels: linear in column and row, and not wrapped, so that an angle can exceed
/// π.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelAxes {
    /// The two quantities, in the order of the centre's coordinates.
    pub axes: [Axis; 2],
    /// Coordinates of the centre as the scene writes them, in the units of the axes; a deep view
    /// needs more digits than an f64 has.
    pub center: [String; 2],
    /// Change of both coordinates from one column to the next, in the units of the axes.
    pub right: [f64; 2],
    /// Change of both coordinates from one row to the next one above it.
    pub up: [f64; 2],
    /// Width and height in pixels.
    pub size: [u32; 2],
    middle: [f64; 2],
}

impl PixelAxes {
    /// Returns the axes of a checked scene's picture of `size` pixels.
    pub fn new(scene: &Scene, size: [u32; 2]) -> Self {
        let [right, up] = Grid::steps(scene, size[0]);
        PixelAxes {
            axes: scene.plane.axes(),
            center: scene.view.center.clone(),
            right,
            up,
            size,
            middle: scene.view.center_rad().map(|coordinate| coordinate.to_f64()),
        }
    }

    /// Returns the names of the coordinates in a file that also has the question's channels: one that
    /// a channel has, too, gets `_at_start`.
    pub fn names_beside(&self, scene: &Scene) -> [String; 2] {
        let channels = scene.question.ask.kind().channels;
        self.axes.map(|axis| {
            let is_taken = channels.iter().any(|channel| channel.name == axis.name());
            format!("{}{}", axis.name(), if is_taken { "_at_start" } else { "" })
        })
    }

    /// Returns true if each coordinate changes along one direction only: columns have the first one
    /// and rows the second.
    pub fn is_upright(&self) -> bool {
        self.right[1] == 0.0 && self.up[0] == 0.0
    }

    /// Returns the change of both coordinates from one row to the next one below it.
    pub fn down(&self) -> [f64; 2] {
        self.up.map(|by| 0.0 - by)
    }

    /// Returns the axes as an object of JSON: for each, its unit, the coordinate of the top left
    /// pixel's middle, and its change by columns and by rows from the top.
    pub fn json(&self) -> String {
        let (first, down) = (self.coordinates(0, 0), self.down());
        let axis = |i: usize| {
            let (name, unit) = (self.axes[i].name(), self.axes[i].unit());
            format!(
                "\"{name}\": {{\"unit\": \"{unit}\", \"center\": \"{}\", \"first\": {:?}, \
                 \"per_column\": {:?}, \"per_row\": {:?}}}",
                self.center[i], first[i], self.right[i], down[i]
            )
        };
        format!("{{{}, {}}}", axis(0), axis(1))
    }

    /// Returns the distance of a pixel's middle from the centre; row 0 is at the top.
    pub fn offset(&self, column: u32, row: u32) -> [f64; 2] {
        let [x, y] = pixels_from_center(self.size, column, row);
        [0, 1].map(|i| x * self.right[i] + y * self.up[i])
    }

    /// Returns the coordinates of a pixel's middle, rounded to f64.
    pub fn coordinates(&self, column: u32, row: u32) -> [f64; 2] {
        let offset = self.offset(column, row);
        [0, 1].map(|i| self.middle[i] + offset[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::View;

    #[test]
    fn pixels_lie_where_the_grid_has_them() {
        for (rotate, stretch) in [(0.0, 1.0), (30.0, 2.0)] {
            let view = View { rotate, stretch, width: "0.5".into(), ..View::default() };
            let scene = Scene { view, ..Scene::default() };
            let (axes, grid) = (PixelAxes::new(&scene, [40, 30]), Grid::new(&scene, [40, 30]));
            assert_eq!(axes.is_upright(), rotate == 0.0);
            for [column, row] in [[0, 0], [39, 29], [7, 21]] {
                let wanted = grid.angle_from_pixel(column, row).map(|angle| angle.hi);
                let found = axes.coordinates(column, row);
                assert!((0..2).all(|i| (found[i] - wanted[i]).abs() < 1e-15), "{found:?}");
            }
        }
    }

    #[test]
    fn angles_go_on_beyond_the_edge_of_the_torus() {
        let view = View { center: ["3".into(), "0".into()], width: "2".into(), ..View::default() };
        let axes = PixelAxes::new(&Scene { view, ..Scene::default() }, [2, 2]);
        assert_eq!(axes.coordinates(1, 0), [3.5, 0.5]);
        assert_eq!(axes.offset(0, 1), [-0.5, -0.5]);
        let json = "{\"theta1\": {\"unit\": \"rad\", \"center\": \"3\", \"first\": 2.5, \"per_column\": 1.0, \
                    \"per_row\": 0.0}, \"theta2\": {\"unit\": \"rad\", \"center\": \"0\", \"first\": 0.5, \
                    \"per_column\": 0.0, \"per_row\": -1.0}}";
        assert_eq!(axes.json(), json);
    }
}
