//! The starts of a picture's pixels, and the outcomes that are known before any computation.

mod fate;

pub use self::fate::Fate;
use super::leaf_grid::{Grouped, LeafGrid};
use super::plane::{PlaneNumbers, wrapped};
use super::{Axis, ExactPlane, Sampling, Scene};
use flipmap_numbers::{Angle, Dd, Exact, Scalar};
use flipmap_pendulum::opening::Opening;
use flipmap_pendulum::{Launch, Pendulum, Rule, State};

/// The starts of all pixels in a picture of a scene.
#[derive(Clone, Debug)]
pub struct Grid {
    size: [u32; 2],
    center: [Dd; 2],
    exact_center: [Exact; 2],
    spots: LeafGrid,
    /// Change of (θ1, θ2) per pixel to the right, rad; `up` is the change per pixel upwards.
    right: [Dd; 2],
    up: [Dd; 2],
    plane: PlaneNumbers,
    exact_plane: ExactPlane,
    /// True if the plane's cells can be followed.
    has_cells: bool,
    passes: u32,
    pendulum: Pendulum<f64>,
    exact: Pendulum<Dd>,
    /// The pendulum in reduced units, and its unit of time in s.
    reduced: (Pendulum<Exact>, Exact),
    /// `Some(true)` if the energy shared by all starts of a section forbids every flip; `None` on
    /// other planes.
    forbids_section: Option<bool>,
    rule: Rule,
    opening: Opening,
    budget_secs: f64,
}

/// Returns the angle at an offset `by` from π. Opposite offsets have exactly opposite angles; at π
/// itself, the other coordinate's offset decides the sign.
fn beside_pi(by: Dd, other: Dd) -> Dd {
    let zero = Dd::new(0.0);
    if by > zero || by == zero && other < zero {
        let angle = by - Dd::PI;
        return if angle <= Dd::PI { angle } else { angle.wrapped() };
    }
    let angle = by + Dd::PI;
    if angle >= -Dd::PI { angle } else { angle.wrapped() }
}

/// Depth beyond which the sign of the energy in f64 is certain, as a share of P + Q.
pub(super) const SURE: f64 = 1e-12;
/// Depth below which the energy is computed in double-double, as a share of P + Q.
const NEAR: f64 = 1e-9;
/// Depth beyond which the sign of the energy in double-double is certain, as a share of P + Q.
const SURE_IN_DD: f64 = 1e-28;

impl Grid {
    /// Returns the grid of a checked scene for a picture of `size` pixels.
    pub fn new(scene: &Scene, size: [u32; 2]) -> Self {
        Grid::sampled(scene, size, Sampling::SINGLE)
    }

    /// Returns the grid of samples for a picture of `size` pixels.
    pub fn sampled(scene: &Scene, size: [u32; 2], sampling: Sampling) -> Self {
        let along = f64::from(sampling.along()) * f64::from(size[0]);
        let pixel = scene.view.width_rad() / Dd::new(along);
        let (right, up) = Self::axes(scene, pixel);
        let size = sampling.grid_size(size);
        Grid::spanned(scene, scene.view.center_rad(), right, up, size)
    }

    /// Returns an upright grid of `size` square pixels with sides of `pixel` rad, ignoring the
    /// scene's view.
    pub fn square(scene: &Scene, center: [Exact; 2], pixel: Dd, size: [u32; 2]) -> Self {
        let zero = Dd::new(0.0);
        Grid::spanned(scene, center, [pixel, zero], [zero, pixel], size)
    }

    /// Returns a grid of `size` pixels around the middle of a pixel, in the same directions; `sides` are
    /// the lengths of its pixels to the right and upwards, in the units of the plane's axes.
    pub fn around(&self, [column, row]: [u32; 2], sides: [f64; 2], size: [u32; 2]) -> Self {
        let exact_center = self.position(column, row);
        let scaled = |axis: [Dd; 2], side: f64| {
            let by = Dd::new(side) / (axis[0] * axis[0] + axis[1] * axis[1]).sqrt();
            axis.map(|part| part * by)
        };
        let (right, up) = (scaled(self.right, sides[0]), scaled(self.up, sides[1]));
        let leaf_plane = if self.has_cells { &self.exact_plane } else { &ExactPlane::AT_REST };
        Grid {
            size,
            center: exact_center.map(Exact::to_dd),
            exact_center,
            spots: LeafGrid::new(leaf_plane, exact_center, [right, up]),
            right,
            up,
            ..self.clone()
        }
    }

    /// Returns the change of both coordinates per pixel to the right and per pixel upwards, for a
    /// picture of `width` pixels.
    pub(super) fn steps(scene: &Scene, width: u32) -> [[f64; 2]; 2] {
        let (right, up) = Self::axes(scene, scene.view.width_rad() / Dd::new(f64::from(width)));
        [right, up].map(|step| step.map(|by| by.hi))
    }

    /// Returns the change of (θ1, θ2) per pixel to the right and per pixel upwards, given the
    /// scene's rotation and stretch.
    fn axes(scene: &Scene, pixel: Dd) -> ([Dd; 2], [Dd; 2]) {
        let tall = pixel / Dd::new(scene.view.stretch);
        let zero = Dd::new(0.0);
        if scene.view.rotate == 0.0 {
            return ([pixel, zero], [zero, tall]);
        }
        let angle = Dd::new(scene.view.rotate) * Dd::PI / Dd::new(180.0);
        let (sin, cos) = angle.sin_cos();
        ([pixel * cos, pixel * sin], [-(tall * sin), tall * cos])
    }

    fn spanned(
        scene: &Scene,
        center: [Exact; 2],
        right: [Dd; 2],
        up: [Dd; 2],
        size: [u32; 2],
    ) -> Self {
        let exact_plane = ExactPlane::new(&scene.plane, &scene.build);
        let has_cells =
            scene.has_cells() && Self::is_reached(&exact_plane, center, [right, up], size);
        let leaf_plane = if has_cells { &exact_plane } else { &ExactPlane::AT_REST };
        let reduced = scene.build.reduced_in::<Exact>();
        let rule = scene.question.watched();
        let budget = scene.question.end_secs() / reduced.1.to_f64();
        Grid {
            size,
            center: center.map(Exact::to_dd),
            exact_center: center,
            spots: LeafGrid::new(leaf_plane, center, [right, up]),
            right,
            up,
            plane: scene.plane.numbers(),
            forbids_section: exact_plane.forbids_section(rule),
            exact_plane,
            has_cells,
            passes: scene.question.passes(),
            pendulum: scene.build.pendulum(),
            exact: scene.build.pendulum_in(),
            opening: Opening::new(&reduced.0, scene.question.reported_bobs(), budget),
            reduced,
            rule,
            budget_secs: scene.question.end_secs(),
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Change of (θ1, θ2) per pixel to the right and per pixel upwards, rad.
    pub(super) fn axes_rad(&self) -> [[Dd; 2]; 2] {
        [self.right, self.up]
    }

    /// Returns true if all starts are at rest.
    pub(super) fn starts_at_rest(&self) -> bool {
        self.plane.is_at_rest
    }

    /// The pendulum.
    pub(super) fn pendulum(&self) -> &Pendulum<f64> {
        &self.pendulum
    }

    /// The bobs that are watched.
    pub(super) fn rule(&self) -> Rule {
        self.rule
    }

    /// Returns the distance from the top in rad within which the first moments of a start from rest
    /// may have to be computed separately.
    pub(super) fn opening_rad(&self) -> f64 {
        self.opening.rest_near_rad()
    }

    /// Returns the same pixels, to be grouped by the leaves of another, finer grid, so that both
    /// grids follow the same references.
    pub fn in_leaves_of(self, other: &Grid) -> Self {
        Grid { spots: self.spots.in_leaves_of(&other.spots), ..self }
    }

    /// Groups pixels by leaf, with about `leaf_pixels` pixels along a leaf's side. Each pixel is
    /// given with its index among all.
    pub fn grouped(
        &self,
        leaf_pixels: u32,
        pixels: impl Iterator<Item = (u32, [u32; 2])>,
    ) -> Grouped {
        self.spots.grouped(self.size, leaf_pixels, pixels)
    }

    /// Change of (θ1, θ2) per pixel to the right and per pixel upwards, rad.
    pub fn pixel_axes(&self) -> [[f64; 2]; 2] {
        [self.right, self.up].map(|by| by.map(|part| part.hi))
    }

    /// Returns a bound on the change of either angle over one pixel to the right and one upwards,
    /// in rad.
    pub fn pixel_rad(&self) -> f64 {
        let [right, up] = [self.right, self.up].map(|by| by[0].hi.hypot(by[1].hi));
        right + up
    }

    /// Returns the coordinates of pixel (`column`, `row`), row 0 at the top, in the units of the
    /// plane's axes. Angles lie in [−π, π].
    pub fn angle_from_pixel(&self, column: u32, row: u32) -> [Dd; 2] {
        let [x, y] = self.pixels_from_center(column, row).map(Dd::new);
        let wraps = self.plane.axes.map(Axis::wraps);
        let by = [0, 1].map(|i| x * self.right[i] + y * self.up[i]);
        [0, 1].map(|i| match wraps[i] {
            true if self.center[i].abs() == Dd::PI => beside_pi(by[i], by[1 - i]),
            true => wrapped(self.center[i] + by[i]),
            false => self.center[i] + by[i],
        })
    }

    /// Returns the exact start of a pixel, with angles in (−π, π] rad and speeds in rad/s, or
    /// `None` where a section has no real solution.
    pub fn exact_start(&self, column: u32, row: u32) -> Option<State<Exact>> {
        self.exact_plane.start_at(self.position(column, row))
    }

    /// Returns the exact coordinates of a pixel's middle, in the units of the plane's axes.
    fn position(&self, column: u32, row: u32) -> [Exact; 2] {
        let [x, y] = self.pixels_from_center(column, row).map(Exact::from_f64);
        let along = |by: [Dd; 2]| by.map(Exact::from_dd);
        let (right, up) = (along(self.right), along(self.up));
        [0, 1].map(|i| self.exact_center[i] + (x * right[i] + y * up[i]))
    }

    /// Returns the offset of a pixel's middle from the centre, to the right and upwards, in pixels.
    fn pixels_from_center(&self, column: u32, row: u32) -> [f64; 2] {
        pixels_from_center(self.size, column, row)
    }

    /// Returns the distance from the middle of a pixel to the energy curve in pixels, to first
    /// order: the energy's depth divided by its slope. It is large where the energy is flat.
    pub fn pixels_from_curve(&self, column: u32, row: u32) -> f64 {
        if !self.has_curve() {
            return f64::INFINITY;
        }
        let angle = self.angle_from_pixel(column, row);
        let Pendulum { p, q, .. } = self.pendulum;
        let near = angle.map(|theta| theta.hi);
        let slope = [-p * near[0].sin(), -q * near[1].sin()];
        let along = |by: [Dd; 2]| slope[0] * by[0].hi + slope[1] * by[1].hi;
        let a_pixel = along(self.right).hypot(along(self.up));
        let depth = self.energy_depth(near);
        let depth = if depth.abs() > NEAR * (p + q) { depth } else { self.exact_depth(angle).hi };
        if a_pixel > 0.0 { depth.abs() / a_pixel } else { f64::INFINITY }
    }

    /// Returns true if every pixel of a block is more than `pixels` away from the energy curve, as
    /// [`Grid::pixels_from_curve`] measures it. `origin` is the block's upper left pixel.
    pub fn is_clear_of_curve(&self, origin: [u32; 2], size: [u32; 2], pixels: f64) -> bool {
        if !self.has_curve() {
            return true;
        }
        let Pendulum { p, q, .. } = self.pendulum;
        // Largest change of the depth from one pixel to the next.
        let most = |by: [Dd; 2]| p.abs() * by[0].hi.abs() + q.abs() * by[1].hi.abs();
        let (right, up) = (most(self.right), most(self.up));
        let [x, y] = [0, 1].map(|i| origin[i] + size[i] / 2);
        let middle = self.angle_from_pixel(x, y).map(|theta| theta.hi);
        let half = size.map(|side| f64::from(side / 2));
        let reach = half[0] * right + half[1] * up + pixels * right.hypot(up);
        // The margin leaves every pixel of the block at a depth that f64 resolves.
        self.energy_depth(middle).abs() > reach + 2.0 * NEAR * (p.abs() + q.abs())
    }

    /// Returns true if the plane has an energy curve.
    fn has_curve(&self) -> bool {
        self.plane.is_at_rest && self.rule != Rule::Neither
    }

    /// Returns the depth of a start in the forbidden region in J: P cos θ1 + Q cos θ2 minus its
    /// bound, which is zero on the energy curve.
    fn energy_depth(&self, angle: [f64; 2]) -> f64 {
        self.pendulum.depth(angle.map(f64::cos)) - self.pendulum.least_depth(self.rule)
    }

    fn exact_depth(&self, angle: [Dd; 2]) -> Dd {
        let cos = angle.map(|theta| theta.sin_cos().1);
        self.exact.depth(cos) - self.exact.least_depth(self.rule)
    }

    /// Returns the start of a pixel in double-double, or `None` where a section has no real
    /// solution.
    fn launch(&self, column: u32, row: u32) -> Option<Launch> {
        let at = self.angle_from_pixel(column, row);
        match self.plane.is_at_rest {
            true => Some(Launch::at_rest(at)),
            false => self.plane.launch(&self.exact, at),
        }
    }

    /// Returns the exact start of a pixel, with speeds in reduced units.
    fn exact_reduced(&self, column: u32, row: u32) -> Option<State<Exact>> {
        let start = self.exact_start(column, row)?;
        Some(State { speed: start.speed.map(|speed| speed * self.reduced.1), ..start })
    }

    /// Returns true if the lattice covers all starts of a picture.
    fn is_reached(
        plane: &ExactPlane,
        center: [Exact; 2],
        [right, up]: [[Dd; 2]; 2],
        size: [u32; 2],
    ) -> bool {
        let [width, height] = size.map(f64::from);
        let half = [0, 1].map(|i| 0.5 * (width * right[i].hi.abs() + height * up[i].hi.abs()));
        plane.reaches(center.map(Exact::to_f64), half)
    }

    /// Returns the plane whose cells of starts can be followed, or `None` if starts move faster
    /// than the lattice reaches or polynomials cannot answer the question.
    pub fn cell_plane(&self) -> Option<ExactPlane> {
        self.has_cells.then_some(self.exact_plane)
    }

    /// Returns true if energy forbids a flip. The test uses f64, double-double or exact numbers,
    /// whichever first gives a certain answer.
    fn is_forbidden(&self, launch: &Launch, column: u32, row: u32) -> bool {
        if let Some(forbidden) = self.forbids_section {
            return forbidden;
        }
        let Pendulum { p, q, .. } = self.pendulum;
        if self.plane.is_at_rest {
            // Without gravity nothing moves from rest.
            if q <= 0.0 {
                return true;
            }
            let near = self.energy_depth(launch.angle.map(|theta| theta.hi));
            if near.abs() > SURE * (p + q) {
                return near > 0.0;
            }
        }
        let Launch { angle, speed } = *launch;
        let depth = -self.exact.energy(&State { angle, speed });
        let beyond = (depth - self.exact.least_depth(self.rule)).hi;
        if beyond.abs() > SURE_IN_DD * (p + q) {
            return q <= 0.0 || beyond > 0.0;
        }
        let (pendulum, start) = (&self.reduced.0, self.exact_reduced(column, row));
        start.is_some_and(|start| pendulum.forbids_depth(self.rule, -pendulum.energy(&start)))
    }
}

/// Returns the distance of a pixel's middle from that of a picture of `size`, in pixels to the right
/// and upwards.
pub(super) fn pixels_from_center(size: [u32; 2], column: u32, row: u32) -> [f64; 2] {
    let [width, height] = size.map(f64::from);
    [f64::from(column) + 0.5 - width / 2.0, height / 2.0 - f64::from(row) - 0.5]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{QuestionSettings, View};
    use flipmap_pendulum::{Outcome, Status};

    fn grid(view: View, size: [u32; 2]) -> Grid {
        let scene = Scene { view, ..Scene::default() };
        Grid::new(&scene.checked().unwrap(), size)
    }

    #[test]
    fn pixels_sit_at_cell_centres_with_row_0_at_the_top() {
        let view = View { center: ["1".into(), "-1".into()], width: "2".into(), ..View::default() };
        let grid = grid(view, [4, 2]);
        let near = |angle: [Dd; 2], x: f64, y: f64| {
            (angle[0].hi - x).abs() < 1e-15 && (angle[1].hi - y).abs() < 1e-15
        };
        assert!(near(grid.angle_from_pixel(0, 0), 0.25, -0.75));
        assert!(near(grid.angle_from_pixel(3, 1), 1.75, -1.25));
    }

    #[test]
    fn opposite_pixels_of_the_home_map_are_exact_mirrors() {
        let grid = grid(View { rotate: 30.0, ..View::default() }, [30, 20]);
        for (column, row) in [(0, 0), (7, 3), (29, 19), (15, 10)] {
            let angle = grid.angle_from_pixel(column, row);
            let mirror = grid.angle_from_pixel(29 - column, 19 - row);
            assert_eq!(angle, mirror.map(|theta| -theta));
        }
    }

    #[test]
    fn a_quarter_turn_swaps_the_axes() {
        let view = View { rotate: 90.0, ..View::default() };
        let [theta1, theta2] = grid(view, [3, 3]).angle_from_pixel(2, 1);
        assert!(theta1.hi.abs() < 1e-15 && (theta2.hi - std::f64::consts::TAU / 3.0).abs() < 1e-15);
    }

    #[test]
    fn a_stretched_view_shows_less_of_the_vertical() {
        let view = View { stretch: 4.0, width: "3".into(), ..View::default() };
        let [_, theta2] = grid(view, [3, 3]).angle_from_pixel(1, 0);
        assert!((theta2.hi - 0.25).abs() < 1e-15);
    }

    #[test]
    fn a_window_beyond_the_seam_wraps_round() {
        let view = View {
            center: ["6.283185307179586".into(), "0".into()],
            width: "1".into(),
            ..View::default()
        };
        let [theta1, _] = grid(view, [2, 2]).angle_from_pixel(1, 0);
        assert!((theta1.hi - 0.25).abs() < 1e-14);
    }

    #[test]
    fn blocks_that_are_clear_of_the_curve_have_no_pixel_near_it() {
        let turned = View { rotate: 25.0, stretch: 2.0, width: "4".into(), ..View::default() };
        let center = ["1.5707963267948966".into(), "0".into()];
        let close = View { center, width: "1e-7".into(), ..View::default() };
        for view in [View::default(), turned, close] {
            let grid = grid(view, [192, 160]);
            let (mut near, mut crossed) = (0, 0);
            for (x, y) in (0..12).flat_map(|x| (0..10).map(move |y| (16 * x, 16 * y))) {
                let pixels = (0..256).map(|k| (x + k % 16, y + k / 16));
                let least = pixels.map(|(x, y)| grid.pixels_from_curve(x, y)).fold(99.0, f64::min);
                let clear = grid.is_clear_of_curve([x, y], [16, 16], 1.25);
                assert!(!clear || least > 1.25, "({x}, {y}): {least}");
                near += u32::from(!clear);
                crossed += u32::from(least < 1.25);
            }
            let share = f64::from(near) / 120.0;
            assert!(crossed > 5 && share < 0.6, "{crossed} crossed, {share} tested");
        }
    }

    #[test]
    fn fates_follow_the_rule() {
        let pi = "3.14159265358979323846264338327950288";
        let fate = |center: [&str; 2], rule| {
            let view = View {
                center: center.map(str::to_string),
                width: "1e-30".into(),
                ..View::default()
            };
            let question = QuestionSettings { rule, ..QuestionSettings::default() };
            let scene = Scene { view, question, ..Scene::default() };
            Grid::new(&scene, [1, 1]).fate(0, 0)
        };
        let known = |status| Fate::Known(Outcome::without_time(status));
        assert_eq!(fate(["0", "0"], Rule::Second), known(Status::Forbidden));
        assert!(matches!(fate(["3", "3"], Rule::Second), Fate::Open(_)));
        // Just before the top, θ1 = 2 pushes the second bob over it, and θ1 = −2 away from it.
        let Fate::Known(Outcome { status: Status::Answered, time }) = fate(["2", pi], Rule::Second)
        else {
            panic!()
        };
        assert!(time > 0.0 && time < 1e-15);
        let Fate::BesideTop(moments) = fate(["-2", pi], Rule::Second) else { panic!() };
        assert!(moments.angle[1] == Dd::PI && moments.passes.is_empty() && moments.length > 0.0);
    }
}
