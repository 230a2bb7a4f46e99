//! The overlays on the map: grid, axes, labels, borders of tiles, and the frame of an export.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Shape, Stroke, pos2};
use glam::DVec2;

use flipmap_numbers::{Exact, Scalar};
use flipmap_render::tiles::explorer::MAX_CELLS;
use flipmap_scene::Axis;
use flipmap_scene::lattice::side_rad;
use flipmap_screen::camera::Screen;

/// Least distance in points between grid lines.
const POINTS_APART: f64 = 130.0;

/// Returns the position in the canvas' rectangle of a point relative to its middle.
pub(crate) fn position(rect: Rect, point: DVec2) -> Pos2 {
    rect.center() + egui::vec2(point.x as f32, point.y as f32)
}

/// A line of the grid, which marks a round value on an axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GridLine {
    /// Index of the axis: 0 across, 1 up.
    pub axis: usize,
    /// Text of the value, for example `π/2`.
    pub name: String,
    /// Offset from the centre in rad.
    pub offset_rad: f64,
}

/// The spacing of grid lines: binary fractions of π while they have short names, then π times 1, 2
/// or 5 times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spacing {
    /// π divided by 2 to this power.
    Binary(i32),
    /// π times the first number, divided by 10 to the power of the second.
    Decimal(i32, i32),
}

impl Spacing {
    /// Returns the finest spacing that keeps lines at least this far apart, in rad.
    fn at_least(min_rad: f64) -> Self {
        let share = min_rad / std::f64::consts::PI;
        if let Some(power) = (-1..=3).rev().find(|power| 0.5f64.powi(*power) >= share) {
            if power < 3 || 0.1 < share {
                return Spacing::Binary(power);
            }
        } else {
            return Spacing::Binary(-1);
        }
        let digits = (-share.log10()).floor() as i32;
        let times = [1, 2, 5]
            .into_iter()
            .find(|times| f64::from(*times) * 10f64.powi(-digits - 1) >= share);
        times.map_or(Spacing::Decimal(1, digits), |times| Spacing::Decimal(times, digits + 1))
    }

    /// Returns the distance between lines in units of π.
    fn step(self) -> Exact {
        match self {
            Spacing::Binary(power) => Exact::from_f64(0.5f64.powi(power)),
            Spacing::Decimal(times, digits) => {
                Exact::parse(&format!("{times}e-{digits}")).unwrap_or_default()
            }
        }
    }

    /// Returns the position of a line near a place, in units of π: 0, or the place rounded to one
    /// digit fewer than the lines have.
    fn base(self, near: Exact) -> Exact {
        match self {
            Spacing::Binary(_) => Exact::ZERO,
            Spacing::Decimal(_, digits) => {
                Exact::parse(&near.decimal(digits.max(1) as usize - 1)).unwrap_or_default()
            }
        }
    }

    /// Returns the name of the line at `share` times π, which is `steps` steps from the base.
    fn name(self, steps: i64, share: Exact) -> String {
        match self {
            _ if share == Exact::ZERO => "0".to_string(),
            Spacing::Binary(power) => binary_part_of_pi(steps, power),
            Spacing::Decimal(_, digits) => {
                format!("{}π", share.decimal(digits as usize).replace('-', "−"))
            }
        }
    }
}

/// Returns lines at round fractions of π, as many as are easy to tell apart.
pub(crate) fn grid_lines(screen: &Screen) -> Vec<GridLine> {
    let region = screen.region();
    let spacing = Spacing::at_least(2.0 * region.half_rad[0] / (screen.size.x / POINTS_APART));
    let step = spacing.step();
    let step_rad = step.to_f64() * std::f64::consts::PI;
    let mut lines = Vec::new();
    for axis in 0..2 {
        let (center, half) = (region.center[axis], region.half_rad[axis]);
        let base = spacing.base(center / Exact::pi());
        let from_center = (base * Exact::pi() - center).to_f64();
        let mut steps = ((-half - from_center) / step_rad).ceil();
        while from_center + steps * step_rad <= half {
            let share = base + step * Exact::from_f64(steps);
            let offset_rad = from_center + steps * step_rad;
            lines.push(GridLine { axis, name: spacing.name(steps as i64, share), offset_rad });
            steps += 1.0;
        }
    }
    lines
}

/// Returns lines at round numbers in the unit of an axis, as many as are easy to tell apart; their
/// offsets are in lattice radians.
pub(crate) fn round_lines(screen: &Screen, axis: usize) -> Vec<GridLine> {
    let (region, units) = (screen.region(), screen.camera.reach.units());
    let (center, half) = (region.center[axis].to_f64() * units, region.half_rad[axis] * units);
    let least = 2.0 * region.half_rad[0] * units / (screen.size.x / POINTS_APART);
    let power = 10f64.powi(least.log10().floor() as i32);
    let step = [1.0, 2.0, 5.0, 10.0].map(|times| times * power).into_iter().find(|s| *s >= least);
    let step = step.unwrap_or(10.0 * power);
    let decimals = (-step.log10() + 1e-9).ceil().max(0.0) as usize;
    let [first, last] = [((center - half) / step).ceil(), ((center + half) / step).floor()];
    let line = |k: f64| {
        let name = format!("{:.decimals$}", k * step + 0.0).replace('-', "−");
        GridLine { axis, name, offset_rad: (k * step - center) / units }
    };
    std::iter::successors(Some(first), |k| Some(k + 1.0))
        .take_while(|k| *k <= last)
        .map(line)
        .collect()
}

/// Writes the symbols and units of the axes in two corners of the map.
pub(crate) fn draw_axes(painter: &Painter, rect: Rect, axes: [Axis; 2]) {
    let [across, up] = axes.map(|axis| format!("{}, {}", axis.symbol(), axis.unit()));
    let inset = egui::vec2(6.0, 6.0);
    label(painter, rect.right_bottom() - inset, Align2::RIGHT_BOTTOM, &format!("{across} →"));
    label(painter, rect.left_top() + inset, Align2::LEFT_TOP, &format!("{up} ↑"));
}

/// Returns the text of `index`/2^`power` times π as a reduced fraction, such as `3π/4`.
fn binary_part_of_pi(index: i64, power: i32) -> String {
    let (mut above, mut below) = (index, 1i64 << power.max(0));
    if power < 0 {
        above *= 1 << -power;
    }
    while below > 1 && above % 2 == 0 {
        (above, below) = (above / 2, below / 2);
    }
    let sign = if above < 0 { "−" } else { "" };
    let above = match above.abs() {
        1 => String::new(),
        other => other.to_string(),
    };
    if below == 1 { format!("{sign}{above}π") } else { format!("{sign}{above}π/{below}") }
}

/// Draws the grid with its names along the left and lower edges.
pub(crate) fn draw_grid(painter: &Painter, rect: Rect, screen: &Screen, axes: [Axis; 2]) {
    let region = screen.region();
    let stroke = Stroke::new(1.0, Color32::from_black_alpha(110));
    let rim = Stroke::new(3.0, Color32::from_white_alpha(50));
    // On the torus, lattice radians are those of the angles. On other planes, even the lines of
    // angles are at round numbers.
    let lines = if screen.camera.reach.repeats {
        grid_lines(screen)
    } else {
        [0, 1].into_iter().flat_map(|axis| round_lines(screen, axis)).collect()
    };
    for line in lines {
        let other = 1 - line.axis;
        let end = |sign: f64| {
            let mut offset = [0.0; 2];
            offset[line.axis] = line.offset_rad;
            offset[other] = sign * region.half_rad[other];
            position(rect, screen.point_of(DVec2::from_array(offset)))
        };
        let ends = [end(-1.0), end(1.0)];
        painter.line_segment(ends, rim);
        painter.line_segment(ends, stroke);
        let symbol = axes[line.axis].symbol();
        let (at, align) = if line.axis == 0 {
            (pos2(ends[0].x + 3.0, rect.bottom() - 3.0), Align2::LEFT_BOTTOM)
        } else {
            (pos2(rect.left() + 3.0, ends[0].y - 2.0), Align2::LEFT_BOTTOM)
        };
        label(painter, at, align, &format!("{symbol} = {}", line.name));
    }
}

/// A text on the map, laid out and in its place.
pub(crate) struct PlacedLabel {
    /// Rectangle that it covers.
    pub rect: Rect,
    galley: Arc<Galley>,
}

impl PlacedLabel {
    /// Draws the text, readable on every colour.
    pub(crate) fn draw(self, painter: &Painter) {
        painter.rect_filled(self.rect, 3.0, Color32::from_black_alpha(150));
        painter.galley(self.rect.min + egui::vec2(2.0, 2.0), self.galley, Color32::WHITE);
    }
}

/// Places text on the map, moved as far as needed to show it whole.
pub(crate) fn placed(painter: &Painter, at: Pos2, align: Align2, text: &str) -> PlacedLabel {
    let galley = painter.layout_no_wrap(text.to_string(), FontId::monospace(11.0), Color32::WHITE);
    let rect = align.anchor_size(at, galley.size()).expand(2.0);
    PlacedLabel { rect: moved_inside(rect, painter.clip_rect()), galley }
}

/// Draws text on the map.
pub(crate) fn label(painter: &Painter, at: Pos2, align: Align2, text: &str) {
    placed(painter, at, align, text).draw(painter);
}

/// Returns a rectangle moved as little as brings it inside another, or at least its upper left
/// corner.
fn moved_inside(rect: Rect, within: Rect) -> Rect {
    let beyond = (rect.max - within.max).max(egui::Vec2::ZERO);
    let before = (within.min - (rect.min - beyond)).max(egui::Vec2::ZERO);
    rect.translate(before - beyond)
}

/// Returns the square of a disc beside the pointer, inside the map: above it if possible, and
/// where it covers neither the pointer nor its caption.
pub(crate) fn disc_beside(map: Rect, pointer: Pos2, caption: Rect, side: f32) -> Rect {
    const GAP: f32 = 16.0;
    let [left, right] = [pointer.x - GAP - side, pointer.x + GAP];
    let above_both = caption.top().min(pointer.y) - GAP - side;
    let below_both = caption.bottom().max(pointer.y) + GAP;
    let corners = [
        pos2(right, pointer.y - GAP - side),
        pos2(right, below_both),
        pos2(right, above_both),
        pos2(left, pointer.y - GAP - side),
        pos2(left, pointer.y + GAP),
        pos2(caption.right() + GAP, pointer.y - side / 2.0),
        pos2(caption.left() - GAP - side, pointer.y - side / 2.0),
    ];
    let square = |corner| Rect::from_min_size(corner, egui::Vec2::splat(side));
    let squares = corners.map(|corner| moved_inside(square(corner), map));
    let covers = |square: &Rect| square.intersects(caption) || square.contains(pointer);
    squares.into_iter().find(|square| !covers(square)).unwrap_or(squares[0])
}

/// Draws the borders of the tiles in view.
pub(crate) fn draw_tiles(painter: &Painter, rect: Rect, screen: &Screen) {
    let level = screen.level();
    let half = side_rad(level) / 2.0;
    for placed in screen.region().cells(level, MAX_CELLS) {
        let middle = DVec2::from_array(placed.offset);
        let corner =
            |x: f64, y: f64| position(rect, screen.point_of(middle + DVec2::new(x, y) * half));
        let ring = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        painter.add(Shape::closed_line(ring, Stroke::new(1.0, Color32::from_black_alpha(120))));
    }
}

/// Draws the frame of a picture of this size, which is as wide as the map, and darkens the map
/// beyond it.
pub(crate) fn draw_export_frame(painter: &Painter, rect: Rect, size: [u32; 2]) {
    let frame = export_frame(rect, size);
    let dark = Color32::from_black_alpha(120);
    let above = Rect::from_min_max(rect.min, pos2(rect.right(), frame.top()));
    let below = Rect::from_min_max(pos2(rect.left(), frame.bottom()), rect.max);
    for beyond in [above, below].into_iter().filter(|beyond| beyond.height() > 0.0) {
        painter.rect_filled(beyond, 0.0, dark);
    }
    for (width, colour) in [(3.0, Color32::BLACK), (1.0, Color32::WHITE)] {
        let stroke = Stroke::new(width, colour);
        painter.rect_stroke(frame, 0.0, stroke, egui::StrokeKind::Inside);
    }
    if frame.height() > rect.height() {
        let at = rect.center_bottom() - egui::vec2(0.0, 8.0);
        label(painter, at, Align2::CENTER_BOTTOM, "the picture goes on above and below");
    }
}

/// Returns the part of the screen that a picture of this size shows, which is as wide as the map.
fn export_frame(rect: Rect, [width, height]: [u32; 2]) -> Rect {
    let side = egui::vec2(rect.width(), rect.width() * height as f32 / width.max(1) as f32);
    Rect::from_center_size(rect.center(), side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_screen::camera::Camera;
    use flipmap_screen::reach::Reach;

    fn screen(center: [&str; 2], width_rad: f64) -> Screen {
        let center = center.map(|text| Exact::parse(text).unwrap());
        let camera = Camera { center, width_rad, ..Camera::whole(Reach::TORUS) };
        Screen { camera, size: DVec2::new(640.0, 480.0), pixels_per_point: 1.0 }
    }

    #[test]
    fn an_export_is_framed_as_it_is_cropped() {
        let map = Rect::from_min_size(pos2(10.0, 20.0), egui::vec2(960.0, 800.0));
        assert_eq!(export_frame(map, [960, 800]), map);
        let wide = export_frame(map, [1920, 1080]);
        assert_eq!((wide.width(), wide.height(), wide.center()), (960.0, 540.0, map.center()));
        assert!(export_frame(map, [100, 400]).height() > map.height());
    }

    #[test]
    fn a_disc_covers_neither_the_pointer_nor_its_caption_and_stays_on_the_map() {
        let map = Rect::from_min_size(pos2(7.0, 40.0), egui::vec2(640.0, 400.0));
        let places = |from: f32, to: f32| {
            (0..=40u16).map(move |k| egui::lerp(from..=to, f32::from(k) / 40.0))
        };
        for (width, height) in [(60.0, 15.0), (310.0, 15.0), (380.0, 29.0)] {
            for (x, y) in places(7.0, 647.0).flat_map(|x| places(40.0, 440.0).map(move |y| (x, y)))
            {
                let pointer = pos2(x, y);
                let below = y <= map.bottom() - 60.0;
                let at = pointer + egui::vec2(14.0, if below { 14.0 } else { -14.0 - height });
                let caption = Rect::from_min_size(at, egui::vec2(width, height));
                let caption = moved_inside(caption, map);
                let disc = disc_beside(map, pointer, caption, 88.0);
                assert!(map.contains_rect(disc) && map.contains_rect(caption), "{pointer}");
                assert!(!disc.intersects(caption) && !disc.contains(pointer), "{pointer} {disc}");
            }
        }
    }

    #[test]
    fn grid_lines_have_the_names_people_use() {
        let names = |axis: usize| -> Vec<String> {
            let lines = grid_lines(&screen(["0", "0"], std::f64::consts::TAU));
            lines.into_iter().filter(|line| line.axis == axis).map(|line| line.name).collect()
        };
        assert_eq!(names(0), ["−π", "−π/2", "0", "π/2", "π"]);
        assert!(names(1).contains(&"π/2".to_string()));
        for (index, power, name) in
            [(3, 2, "3π/4"), (-1, 0, "−π"), (2, 0, "2π"), (1, -1, "2π"), (6, 3, "3π/4")]
        {
            assert_eq!(binary_part_of_pi(index, power), name);
        }
        let decimal = grid_lines(&screen(["-1.66", "0.1"], 0.4));
        assert_eq!(decimal[0].name, "−0.55π");
        assert_eq!(decimal[1].name, "−0.5π");
    }

    #[test]
    fn lines_of_speeds_are_round_numbers() {
        let reach = Reach { doublings: 4, repeats: false };
        let camera = Camera {
            center: [0.5, 0.0].map(Exact::from_f64),
            width_rad: 1.0,
            ..Camera::whole(reach)
        };
        let screen = Screen { camera, ..screen(["0", "0"], 1.0) };
        let lines = round_lines(&screen, 0);
        // From 0 to 16 rad/s on 640 points.
        let names: Vec<&str> = lines.iter().map(|line| line.name.as_str()).collect();
        assert_eq!(names, ["0", "5", "10", "15"]);
        assert!((lines[2].offset_rad - (10.0 / 16.0 - 0.5)).abs() < 1e-12);
        assert!(round_lines(&screen, 1).iter().any(|line| line.name == "−5"));
    }

    #[test]
    fn grid_lines_are_neither_rare_nor_crowded_and_lie_where_they_say() {
        let mut width_rad = 12.0;
        while width_rad > 1e-98 {
            let screen = screen(["-1.66", "0.1"], width_rad);
            let lines = grid_lines(&screen);
            assert!((2..=20).contains(&lines.len()), "{} at {width_rad:e}", lines.len());
            for line in lines {
                let Some(share) =
                    line.name.replace('−', "-").strip_suffix('π').and_then(Exact::parse)
                else {
                    continue;
                };
                let at = share * Exact::pi() - screen.camera.center[line.axis];
                assert!((at.to_f64() - line.offset_rad).abs() < 1e-6 * width_rad, "{line:?}");
            }
            width_rad *= 0.37;
        }
    }
}
