//! Chooses places for labels, so that labels do not cover each other and cover few lines and bobs.

use std::cell::RefCell;

use egui::{Pos2, Rect, Vec2, vec2};

use super::drawing::corner_inside;

/// What a canvas already shows, so that labels can keep clear of it.
#[derive(Debug, Default)]
pub(super) struct Taken {
    /// Areas of words, which labels must not cover.
    words: RefCell<Vec<Rect>>,
    /// Areas of bobs and handles, which labels cover only if necessary.
    shapes: RefCell<Vec<Rect>>,
    /// Rods, arcs and arrows, which neither labels nor their leaders cross if they can avoid it.
    lines: RefCell<Vec<[Pos2; 2]>>,
}

/// A label's area, and the line that leads from it to its place if the two are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LabelPlace {
    pub area: Rect,
    pub leader: Option<[Pos2; 2]>,
}

/// Distances of a label from its place in points, in ascending order.
const GAPS: [f32; 7] = [12.0, 24.0, 36.0, 56.0, 76.0, 100.0, 130.0];
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
/// Distance in points from which a leader joins a label and its place.
const LED: f32 = 20.0;
/// Distance in points that a leader keeps from its place, and within which it may meet lines that
/// end there.
const NEAR: f32 = 6.0;
/// Cost of covering words, in points²; covering a shape costs the area that is covered.
const WORDS: f32 = 4000.0;
/// Cost of words on a line, likewise.
const THROUGH: f32 = 400.0;
/// Cost of a leader across a line or words, likewise.
const ACROSS: f32 = 600.0;

impl Taken {
    /// Marks an area as taken by words.
    pub(super) fn words(&self, area: Rect) {
        self.words.borrow_mut().push(area.expand(1.0));
    }

    /// Marks an area as taken by a shape.
    pub(super) fn shape(&self, area: Rect) {
        self.shapes.borrow_mut().push(area);
    }

    /// Returns the horizontal place right of `left` and of all words at a height.
    pub(super) fn right_of_words(&self, y: f32, left: f32) -> f32 {
        let words = self.words.borrow();
        let there = words.iter().filter(|area| area.y_range().contains(y));
        there.map(|area| area.right()).fold(left, f32::max)
    }

    /// Marks a line as taken.
    pub(super) fn line(&self, ends: [Pos2; 2]) {
        self.lines.borrow_mut().push(ends);
    }

    /// Finds the best place of a label of a `size` beside a point and inside an `area`, and takes it.
    pub(super) fn beside(&self, place: Pos2, size: Vec2, area: Rect) -> LabelPlace {
        let at = |corner: Pos2| {
            let area = Rect::from_min_size(corner_inside(area, size, corner), size);
            LabelPlace { area, leader: leader(area, place) }
        };
        let mut best = at(place);
        let mut least = f32::INFINITY;
        for gap in GAPS {
            for side in SIDES {
                let reach =
                    0.5 * size + Vec2::splat(gap) * if side.length() > 1.1 { 0.6 } else { 1.0 };
                let candidate = at(place + side * reach - 0.5 * size);
                let cost = self.cost(&candidate, place) + gap;
                if cost < least {
                    (best, least) = (candidate, cost);
                }
            }
        }
        self.words(best.area);
        if let Some(leader) = best.leader {
            self.line(leader);
        }
        best
    }

    /// Returns the cost of what a label and its leader cover and cross.
    fn cost(&self, label: &LabelPlace, place: Pos2) -> f32 {
        let shared = |other: &Rect| {
            let shared = label.area.intersect(*other);
            if shared.is_positive() { shared.area() } else { 0.0 }
        };
        let covered: f32 = self.shapes.borrow().iter().map(shared).sum();
        let words = self.words.borrow();
        let hidden = words.iter().filter(|words| shared(words) > 0.0).count();
        let lines = self.lines.borrow();
        let through = lines.iter().filter(|line| passes_through(line, label.area)).count();
        let crossed = label.leader.map_or(0, |leader| {
            let from_words = words.iter().filter(|words| passes_through(&leader, **words)).count();
            let met = |line: &&[Pos2; 2]| {
                meeting(&leader, line).is_some_and(|at| at.distance(place) > NEAR)
            };
            from_words + lines.iter().filter(met).count()
        });
        covered + WORDS * hidden as f32 + THROUGH * through as f32 + ACROSS * crossed as f32
    }
}

/// Returns the line from a label's edge towards its place, if they are far apart.
fn leader(area: Rect, place: Pos2) -> Option<[Pos2; 2]> {
    let edge = area.clamp(place);
    let away = place - edge;
    (away.length() >= LED).then(|| {
        let along = away.normalized();
        [edge + 2.0 * along, place - NEAR * along]
    })
}

/// Returns true if a line meets an area or lies in it.
fn passes_through(line: &[Pos2; 2], area: Rect) -> bool {
    let [a, b, c, d] = [area.left_top(), area.right_top(), area.right_bottom(), area.left_bottom()];
    let edges = [[a, b], [b, c], [c, d], [d, a]];
    area.contains(line[0]) || edges.iter().any(|edge| meeting(line, edge).is_some())
}

/// Returns the point at which two lines meet.
fn meeting([a, b]: &[Pos2; 2], [c, d]: &[Pos2; 2]) -> Option<Pos2> {
    let (along, other, apart) = (*b - *a, *d - *c, *c - *a);
    let cross = |u: Vec2, v: Vec2| u.x * v.y - u.y * v.x;
    let turn = cross(along, other);
    if turn == 0.0 {
        return None;
    }
    let (share, other_share) = (cross(apart, other) / turn, cross(apart, along) / turn);
    let between = |share: f32| (0.0..=1.0).contains(&share);
    (between(share) && between(other_share)).then(|| *a + share * along)
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
            let all: Vec<Rect> = (0..6).map(|_| taken.beside(place, size, area).area).collect();
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
        let free = Taken::default().beside(place, size, area);
        assert_eq!(free.area.left_center(), pos2(162.0, 100.0));
        assert_eq!(free.leader, None, "it is near enough");
        let crossed = Taken::default();
        crossed.line([place, pos2(260.0, 100.0)]);
        assert_eq!(crossed.beside(place, size, area).area.right_center(), pos2(138.0, 100.0));
    }

    #[test]
    fn a_leader_crosses_no_rod_where_it_need_not() {
        let area = Rect::from_min_max(Pos2::ZERO, pos2(400.0, 300.0));
        let (place, size) = (pos2(200.0, 150.0), vec2(60.0, 16.0));
        let taken = Taken::default();
        // A rod beside the place, and words all around it.
        let rod = [pos2(215.0, 60.0), pos2(215.0, 240.0)];
        taken.line(rod);
        taken.words(Rect::from_center_size(place, vec2(90.0, 60.0)));
        let label = taken.beside(place, size, area);
        let leader = label.leader.expect("the label is far from its place");
        assert_eq!(meeting(&leader, &rod), None, "{label:?}");
        assert!(meeting(&[pos2(200.0, 150.0), pos2(300.0, 150.0)], &rod).is_some());
        assert!(!passes_through(&rod, label.area));
    }
}
