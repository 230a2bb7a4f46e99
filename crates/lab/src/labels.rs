//! Chooses places for labels, so that labels do not cover each other and cover few lines and bobs.

use std::cell::RefCell;

use egui::{Pos2, Rect, Vec2, vec2};

use super::drawing::corner_inside;

/// The areas of a canvas that are already in use.
#[derive(Debug, Default)]
pub(super) struct Taken(RefCell<Vec<(Rect, Layer)>>);

/// Kinds of things that use an area.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Layer {
    /// Words, which labels must not cover.
    Words,
    /// Lines and bobs, which labels cover only if necessary.
    Shapes,
}

/// Distances of a label from its place in points, in ascending order.
const GAPS: [f32; 6] = [12.0, 24.0, 36.0, 56.0, 76.0, 100.0];
/// Directions from a place to its label: right, left, below, above, then the corners.
const SIDES: [Vec2; 8] = [
    vec2(1.0, 0.0),
    vec2(-1.0, 0.0),
    vec2(0.0, 1.0),
    vec2(0.0, -1.0),
    vec2(1.0, 1.0),
    vec2(-1.0, 1.0),
    vec2(1.0, -1.0),
    vec2(-1.0, -1.0),
];
/// Side in points of the squares that stand for a line.
const BEAD: f32 = 8.0;

impl Taken {
    /// Marks an area as taken by words.
    pub(super) fn words(&self, area: Rect) {
        self.0.borrow_mut().push((area.expand(1.0), Layer::Words));
    }

    /// Marks an area as taken by a shape.
    pub(super) fn shape(&self, area: Rect) {
        self.0.borrow_mut().push((area, Layer::Shapes));
    }

    /// Marks the area of a line as taken.
    pub(super) fn line(&self, [from, to]: [Pos2; 2]) {
        let beads = ((to - from).length() / BEAD).ceil().clamp(1.0, 500.0);
        for k in 0..=beads as usize {
            let at = from.lerp(to, k as f32 / beads);
            self.shape(Rect::from_center_size(at, Vec2::splat(0.75 * BEAD)));
        }
    }

    /// Finds the best area of a `size` beside a place and inside an `area`, and takes it.
    pub(super) fn beside(&self, place: Pos2, size: Vec2, area: Rect) -> Rect {
        let mut best = Rect::from_min_size(corner_inside(area, size, place), size);
        let mut least = f32::INFINITY;
        for gap in GAPS {
            for side in SIDES {
                let reach =
                    0.5 * size + Vec2::splat(gap) * if side.length() > 1.1 { 0.6 } else { 1.0 };
                let middle = place + side * reach;
                let corner = corner_inside(area, size, middle - 0.5 * size);
                let candidate = Rect::from_min_size(corner, size);
                let cost = self.cost(candidate) + gap;
                if cost < least {
                    (best, least) = (candidate, cost);
                }
            }
        }
        self.words(best);
        best
    }

    /// Returns the cost of an area, which is what it covers; words count far more than shapes.
    fn cost(&self, area: Rect) -> f32 {
        let covered = |(other, layer): &(Rect, Layer)| {
            let shared = area.intersect(*other);
            match (shared.is_positive(), layer) {
                (false, _) => 0.0,
                (true, Layer::Words) => 1000.0 + 100.0 * shared.area(),
                (true, Layer::Shapes) => shared.area(),
            }
        };
        self.0.borrow().iter().map(covered).sum()
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn labels_of_one_place_go_around_it_and_stay_inside() {
        let area = Rect::from_min_max(Pos2::ZERO, pos2(300.0, 200.0));
        let (taken, size) = (Taken::default(), vec2(60.0, 16.0));
        for place in [pos2(150.0, 100.0), pos2(2.0, 198.0)] {
            let all: Vec<Rect> = (0..6).map(|_| taken.beside(place, size, area)).collect();
            for (k, one) in all.iter().enumerate() {
                assert!(area.contains_rect(*one), "{one}");
                assert!(
                    all[..k].iter().all(|other| !one.intersect(*other).is_positive()),
                    "{all:?}"
                );
            }
        }
    }

    #[test]
    fn the_first_choice_is_right_unless_a_line_runs_there() {
        let area = Rect::from_min_max(Pos2::ZERO, pos2(300.0, 200.0));
        let (place, size) = (pos2(150.0, 100.0), vec2(60.0, 16.0));
        assert_eq!(Taken::default().beside(place, size, area).left_center(), pos2(162.0, 100.0));
        let crossed = Taken::default();
        crossed.line([place, pos2(260.0, 100.0)]);
        assert_eq!(crossed.beside(place, size, area).right_center(), pos2(138.0, 100.0));
    }
}
