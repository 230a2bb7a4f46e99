//! Frames: rectangles in the plane of starts, each with coordinates of its own from −1 to 1.

/// A rectangle, given in the coordinates of an outer frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Middle of the rectangle.
    pub middle: [f64; 2],
    /// Vectors from the middle to the middles of two sides, at right angles to each other.
    pub axes: [[f64; 2]; 2],
}

impl Frame {
    /// The whole outer frame, with the same coordinates.
    pub const WHOLE: Frame = Frame { middle: [0.0; 2], axes: [[1.0, 0.0], [0.0, 1.0]] };

    /// Halves the outer frame along the axes marked in `cut`. Returns the parts in order of their
    /// coordinates, the second varying faster.
    pub fn parts(cut: [bool; 2]) -> impl Iterator<Item = Frame> {
        let places = |cut: bool| if cut { &[-0.5, 0.5][..] } else { &[0.0] };
        let size = cut.map(|cut| if cut { 0.5 } else { 1.0 });
        let axes = [[size[0], 0.0], [0.0, size[1]]];
        let [across, along] = cut.map(places);
        across.iter().flat_map(move |&x| along.iter().map(move |&y| Frame { middle: [x, y], axes }))
    }

    /// The index among [`Frame::parts`] of the part that contains a point.
    pub fn part_of(cut: [bool; 2], [x, y]: [f64; 2]) -> usize {
        let step = if cut[1] { 2 } else { 1 };
        step * usize::from(cut[0] && x >= 0.0) + usize::from(cut[1] && y >= 0.0)
    }

    /// The smallest square that contains the outer frame and whose first axis points in the
    /// direction `angle` (rad).
    pub fn turned(angle: f64) -> Frame {
        let (sin, cos) = angle.sin_cos();
        let reach = sin.abs() + cos.abs();
        let axes = [[reach * cos, reach * sin], [-reach * sin, reach * cos]];
        Frame { middle: [0.0; 2], axes }
    }

    /// Converts coordinates in this frame to those of the outer frame.
    pub(crate) fn outward(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.axes;
        [0, 1].map(|i| self.middle[i] + x * a[i] + y * b[i])
    }

    /// Converts coordinates in the outer frame to those of this frame.
    pub fn inward(&self, point: [f64; 2]) -> [f64; 2] {
        let by = [0, 1].map(|i| point[i] - self.middle[i]);
        self.axes.map(|[u, v]| (by[0] * u + by[1] * v) / (u * u + v * v))
    }

    /// Converts a frame given in the coordinates of this one to those of the outer frame.
    pub fn outside(&self, inner: &Frame) -> Frame {
        let [a, b] = self.axes;
        let turned = |[x, y]: [f64; 2]| [0, 1].map(|i| x * a[i] + y * b[i]);
        Frame { middle: self.outward(inner.middle), axes: inner.axes.map(turned) }
    }

    /// Half the lengths of the sides along the two axes.
    pub fn half_sides(&self) -> [f64; 2] {
        self.axes.map(|[u, v]| u.hypot(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn coordinates_go_out_and_in(
            angle in -3.0..3.0f64, x in -1.0..1.0f64, y in -1.0..1.0f64, both: [bool; 2],
        ) {
            let turned = Frame::turned(angle);
            let [u, v] = turned.inward([x, y]);
            prop_assert!(u.abs() <= 1.0 && v.abs() <= 1.0, "the square is inside");
            let part = Frame::parts(both).nth(Frame::part_of(both, [u, v])).unwrap();
            let place = turned.outside(&part);
            let at = place.inward([x, y]);
            prop_assert!(at.iter().all(|at| at.abs() <= 1.0 + 1e-12), "{at:?} in {part:?}");
            let back = place.outward(at);
            prop_assert!((back[0] - x).abs() < 1e-14 && (back[1] - y).abs() < 1e-14);
        }
    }
}
