//! The camera: the view on the screen, the mapping between points of the screen and of the plane,
//! and smooth moves.

use glam::{DMat2, DVec2};

use super::meant;
use super::reach::Reach;
use flipmap_numbers::{Exact, Scalar};
use flipmap_scene::lattice::{DEEPEST, Region, pitch_rad};
use flipmap_scene::{BuiltIn, MIN_WIDTH, View};

/// A view as numbers in lattice radians, which on the torus are the radians of the angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Place of the centre in lattice radians, within [−π, π].
    pub center: [Exact; 2],
    /// Length of the horizontal axis in lattice radians.
    pub width_rad: f64,
    /// Angle in degrees by which the picture's horizontal axis is turned anticlockwise.
    pub rotate_deg: f64,
    /// Factor by which the vertical axis shows fewer radians than square pixels would.
    pub stretch: f64,
    /// Scale and extent of the lattice on the plane of starts.
    pub reach: Reach,
}

/// Smallest and largest width that a camera zooms to, in rad.
const MIN_WIDTH_RAD: f64 = MIN_WIDTH;
const MAX_WIDTH_RAD: f64 = 4.0 * std::f64::consts::TAU;
/// Largest factor by which a camera stretches a map, either way. Samples are square, so a
/// stronger stretch would need too many of them for a screen.
const MAX_STRETCH: f64 = 16.0;
/// Share of the width by which cameras that show nearly the same differ at most.
const NEAR: f64 = 0.05;
/// Share of a bounded plane's square that its home view shows.
const HOME_SHARE: f64 = 0.25;
/// Largest width of a sample in physical pixels before the next level is drawn. Its samples are
/// half as wide, so no view has more than 1.3 of them along a pixel; edges get finer samples later.
const MAX_SAMPLE_PX: f64 = 2.0 / 1.3;

impl Camera {
    /// Returns the camera for a checked view of a plane.
    pub fn from_view(view: &View, reach: Reach) -> Self {
        Camera {
            center: reach.place(view.center_rad()),
            width_rad: view.width_rad().hi / reach.units(),
            rotate_deg: view.rotate,
            stretch: view.stretch,
            reach,
        }
        .within_reach()
    }

    /// Returns the camera that first shows a plane on a canvas of this size: the whole torus, as in
    /// the home scene, or the middle of a plane that does not repeat.
    pub fn home(reach: Reach, canvas: DVec2) -> Self {
        if reach != Reach::TORUS {
            return Camera::whole(reach);
        }
        let view = BuiltIn::home().document().view;
        Camera::from_view(&view.fitted(canvas.to_array()), reach)
    }

    /// Returns the camera around a plane's origin that shows the whole torus, or a quarter of the
    /// width of a plane that does not repeat.
    pub fn whole(reach: Reach) -> Self {
        let home = Camera::from_view(&View::default(), reach);
        let share = if reach.repeats { 1.0 } else { HOME_SHARE };
        Camera { width_rad: share * std::f64::consts::TAU, ..home }
    }

    /// Returns the view in decimal notation, with as many digits as its width calls for.
    pub fn view(&self) -> View {
        // Six digits below the width are far finer than a pixel of any screen. π gets 16, so that
        // it is read back as π and the view stays symmetric around it.
        let decimals = |coordinate: Exact| {
            let is_pi = self.reach.repeats && coordinate.abs() == Exact::pi();
            let below = if is_pi { 16.0 } else { 6.0 };
            (below - self.width().log10()).ceil().max(below) as usize
        };
        View {
            center: self.reach.coordinates(self.center).map(|x| x.decimal(decimals(x))),
            width: format!("{:?}", meant(self.width())),
            rotate: meant(self.rotate_deg),
            stretch: meant(self.stretch),
            fit: false,
        }
    }

    /// Returns the length of the horizontal axis in the units of the plane's axes.
    pub fn width(&self) -> f64 {
        self.width_rad * self.reach.units()
    }

    /// Returns the camera with its centre moved by an offset in rad, as far as the plane reaches.
    pub fn moved(&self, by_rad: DVec2) -> Self {
        let by = by_rad.to_array().map(Exact::from_f64);
        let center = [0, 1].map(|i| self.center[i] + by[i]);
        Camera { center: self.reach.inside(center), ..*self }
    }

    /// Returns the camera zoomed by a factor about a point at an offset from the centre in rad.
    pub fn zoomed(&self, factor: f64, about_rad: DVec2) -> Self {
        let zoomed = Camera { width_rad: self.width_rad / factor, ..*self }.within_reach();
        zoomed.moved(about_rad * (1.0 - zoomed.width_rad / self.width_rad))
    }

    /// Returns the camera stretched by a factor, within its limits.
    pub fn stretched(&self, factor: f64) -> Self {
        // A view from a file may be stretched beyond them.
        let (least, most) = (self.stretch.min(1.0 / MAX_STRETCH), self.stretch.max(MAX_STRETCH));
        Camera { stretch: (self.stretch * factor).clamp(least, most), ..*self }
    }

    /// Returns true if another camera shows nearly the same: its centre and its width differ by a
    /// twentieth of the width at most.
    pub fn is_near(&self, other: &Camera) -> bool {
        let away = self.offset_of(other.center).length() / self.width_rad;
        let zoom = (self.width_rad / other.width_rad).ln().abs();
        self.reach == other.reach && away < NEAR && zoom < NEAR
    }

    fn within_reach(self) -> Self {
        let width_rad = self.width_rad.clamp(MIN_WIDTH_RAD, MAX_WIDTH_RAD);
        Camera { width_rad, ..self }
    }

    /// Returns the offset of another centre from this one, the short way round the torus, in rad.
    pub fn offset_of(&self, angle: [Exact; 2]) -> DVec2 {
        DVec2::from_array(self.reach.difference(angle, self.center))
    }
}

/// A camera looking through a canvas. Points of the canvas are measured from its middle, x to the
/// right and y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Camera that looks through the canvas.
    pub camera: Camera,
    /// Width and height of the canvas in points.
    pub size: DVec2,
    /// Physical pixels per point.
    pub pixels_per_point: f64,
}

impl Screen {
    /// Returns the offset from the centre, in rad, of a point on the screen.
    pub fn offset_at(&self, point: DVec2) -> DVec2 {
        self.plane_from_screen() * point
    }

    /// Returns the start under a point.
    pub fn angle_at(&self, point: DVec2) -> [Exact; 2] {
        self.camera.moved(self.offset_at(point)).center
    }

    /// Returns the point on the screen at an offset from the centre in rad.
    pub fn point_of(&self, offset_rad: DVec2) -> DVec2 {
        self.plane_from_screen().inverse() * offset_rad
    }

    /// Returns the camera with the map turned about the middle of the canvas, as if it had been
    /// dragged there from one point to another.
    pub fn turned(&self, from: DVec2, to: DVec2) -> Camera {
        let shown = DVec2::new(1.0, -1.0 / self.camera.stretch);
        let by = (shown * to).angle_to(shown * from).to_degrees();
        if by.is_nan() {
            // One of the points is the middle itself.
            return self.camera;
        }
        let turned = self.camera.rotate_deg + by;
        Camera { rotate_deg: turned - 360.0 * (turned / 360.0).round(), ..self.camera }
    }

    /// Returns the matrix that converts points into radians.
    fn plane_from_screen(&self) -> DMat2 {
        let point_rad = self.camera.width_rad / self.size.x;
        let turn = DMat2::from_angle(self.camera.rotate_deg.to_radians());
        turn * DMat2::from_diagonal(DVec2::new(point_rad, -point_rad / self.camera.stretch))
    }

    /// Returns the upright rectangle of the plane that contains everything in view.
    pub fn region(&self) -> Region {
        let map = self.plane_from_screen();
        let half = map.x_axis.abs() * self.size.x / 2.0 + map.y_axis.abs() * self.size.y / 2.0;
        let Camera { center, reach, .. } = self.camera;
        Region { center, half_rad: half.to_array(), repeats: reach.repeats }
    }

    /// Returns the level whose samples are about as large as physical pixels.
    pub fn level(&self) -> u32 {
        let map = self.plane_from_screen();
        let pixel_rad = map.x_axis.length().min(map.y_axis.length()) / self.pixels_per_point;
        let fine = |level: &u32| pitch_rad(*level) <= MAX_SAMPLE_PX * pixel_rad * (1.0 + 1e-9);
        (0..DEEPEST).find(fine).unwrap_or(DEEPEST)
    }
}

/// A smooth move between two cameras.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Camera at the beginning of the move.
    pub from: Camera,
    /// Camera at the end of the move.
    pub to: Camera,
    /// Beginning of the move on the window's clock, in s.
    pub began_secs: f64,
    /// Pace of the move.
    pub pace: MovePace,
}

/// The pace of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MovePace {
    /// Fast at first and slower towards the end, for moves that the user makes.
    Quick,
    /// Even, for the successive steps of a dive.
    Even {
        /// Duration of the move in s.
        secs: f64,
    },
}

impl MovePace {
    /// Returns the duration of a move in s.
    pub fn secs(self) -> f64 {
        match self {
            MovePace::Quick => 0.25,
            MovePace::Even { secs } => secs,
        }
    }

    /// Returns the share of a move that is done after the share `t` of its duration.
    fn eased(self, t: f64) -> f64 {
        match self {
            MovePace::Quick => 1.0 - (1.0 - t).powi(3),
            MovePace::Even { .. } => t,
        }
    }
}

impl Move {
    /// Returns the camera at a moment, and true if the move is over. The width changes
    /// geometrically in eased time; a point that ends where it began stays there throughout.
    pub fn at(&self, now_secs: f64) -> (Camera, bool) {
        let t = ((now_secs - self.began_secs) / self.pace.secs()).clamp(0.0, 1.0);
        if t >= 1.0 {
            return (self.to, true);
        }
        let eased = self.pace.eased(t);
        let (w0, w1) = (self.from.width_rad, self.to.width_rad);
        let width_rad = w0 * (w1 / w0).powf(eased);
        let same_width = (w1 / w0).ln().abs() < 1e-6;
        let share = if same_width { eased } else { (width_rad - w0) / (w1 - w0) };
        let blend = |a: f64, b: f64| a + (b - a) * eased;
        let camera = Camera {
            center: self.from.moved(self.from.offset_of(self.to.center) * share).center,
            width_rad,
            rotate_deg: blend(self.from.rotate_deg, self.to.rotate_deg),
            stretch: blend(self.from.stretch, self.to.stretch),
            reach: self.to.reach,
        };
        (camera, false)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use proptest::prelude::*;

    fn screen(camera: Camera) -> Screen {
        Screen { camera, size: DVec2::new(1280.0, 800.0), pixels_per_point: 1.0 }
    }

    fn home() -> Camera {
        Camera::whole(Reach::TORUS)
    }

    proptest! {
        #[test]
        fn zooming_keeps_the_point_under_the_pointer(
            x in -600.0..600.0f64, y in -390.0..390.0f64, notches in 1usize..40,
        ) {
            let point = DVec2::new(x, y);
            let mut view = screen(home());
            let angle = view.angle_at(point);
            for _ in 0..notches {
                view.camera = view.camera.zoomed(1.3, view.offset_at(point));
            }
            let back = view.point_of(view.camera.offset_of(angle));
            prop_assert!((back - point).length() < 1e-3, "{back} from {point}");
        }

        #[test]
        fn screen_and_plane_are_inverse(rotate in -180.0..180.0f64, stretch in 0.1..10.0f64) {
            let view = screen(Camera { rotate_deg: rotate, stretch, ..home() });
            let point = DVec2::new(123.0, -45.0);
            prop_assert!((view.point_of(view.offset_at(point)) - point).length() < 1e-9);
        }

        #[test]
        fn a_turned_map_follows_the_pointer(
            x in 50.0..600.0f64, y in -390.0..390.0f64, angle in -3.0..3.0f64, rotate in -180.0..180.0f64,
        ) {
            let view = screen(Camera { rotate_deg: rotate, ..home() });
            let from = DVec2::new(x, y);
            let to = DMat2::from_angle(angle) * from;
            let after = screen(view.turned(from, to));
            prop_assert!((after.offset_at(to) - view.offset_at(from)).length() < 1e-9);
            prop_assert!(after.camera.rotate_deg.abs() <= 180.0 + 1e-9);
        }

        #[test]
        fn a_move_keeps_its_fixed_point(x in -600.0..600.0f64, t in 0.0..0.25f64) {
            let view = screen(home());
            let point = DVec2::new(x, 100.0);
            let to = home().zoomed(8.0, view.offset_at(point));
            let (camera, _) = Move { from: home(), to, began_secs: 0.0, pace: MovePace::Quick }.at(t);
            let angle = view.angle_at(point);
            let during = screen(camera);
            prop_assert!((during.point_of(camera.offset_of(angle)) - point).length() < 1e-6);
        }
    }

    #[test]
    fn cameras_that_show_nearly_the_same_are_near() {
        let near = Camera { width_rad: 1.01 * home().width_rad, ..home() };
        assert!(home().is_near(&near) && home().is_near(&near.moved(DVec2::new(0.1, 0.0))));
        assert!(!home().is_near(&Camera { width_rad: 0.9 * home().width_rad, ..home() }));
        assert!(!home().is_near(&home().moved(DVec2::new(0.0, 1.0))));
    }

    #[test]
    fn a_view_written_and_read_is_the_same_picture() {
        let mut camera = home();
        for _ in 0..320 {
            camera = camera.zoomed(2.0, DVec2::new(0.3, 0.2) * camera.width_rad);
        }
        let back = Camera::from_view(&camera.view(), Reach::TORUS);
        assert!(back.offset_of(camera.center).length() < 1e-5 * camera.width_rad);
        assert_eq!(back.width_rad, camera.width_rad);
        assert_eq!(Camera::from_view(&View::default(), Reach::TORUS), home());
        assert_eq!(home().view(), View::default());
    }

    #[test]
    fn a_view_around_pi_stays_there() {
        for width_rad in [TAU, 1.0, 1e-9] {
            let camera = Camera { center: [Exact::pi(), Exact::ZERO], width_rad, ..home() };
            assert_eq!(Camera::from_view(&camera.view(), Reach::TORUS), camera);
        }
    }

    #[test]
    fn home_fits_into_every_canvas() {
        for (canvas, width_rad) in [([1280.0, 800.0], 1.6 * TAU), ([600.0, 900.0], TAU)] {
            let camera = Camera::home(Reach::TORUS, DVec2::from_array(canvas));
            assert_eq!(camera.center, [Exact::pi(), Exact::ZERO]);
            assert!((camera.width_rad - width_rad).abs() < 1e-12);
        }
    }

    #[test]
    fn a_plane_of_speeds_has_its_own_units_and_an_end() {
        let reach = Reach { doublings: 4, repeats: false };
        let view =
            View { center: ["8".into(), "-4.5".into()], width: "2".into(), ..View::default() };
        let camera = Camera::from_view(&view, reach);
        assert_eq!((camera.width_rad, camera.width()), (0.125, 2.0));
        let back = camera.view();
        assert_eq!((back.center[0].parse(), back.center[1].parse()), (Ok(8.0), Ok(-4.5)));
        assert_eq!(back.width, "2.0");
        let far = camera.moved(DVec2::new(99.0, 0.0));
        assert_eq!(far.center[0], Exact::pi(), "nothing lies beyond");
        assert!((camera.offset_of(far.center).x - (std::f64::consts::PI - 0.5)).abs() < 1e-12);
    }

    #[test]
    fn samples_are_about_as_large_as_pixels() {
        let mut camera = home();
        for _ in 0..400 {
            let view = screen(camera);
            let pixel = camera.width_rad / 1280.0;
            let sample = pitch_rad(view.level());
            assert!((0.769..1.539).contains(&(sample / pixel)), "{}", sample / pixel);
            camera = camera.zoomed(1.7, DVec2::ZERO);
        }
        assert_eq!(screen(home()).level(), 4);
    }

    #[test]
    fn the_short_way_round() {
        let east = Camera { center: [3.1, 0.0].map(Exact::from_f64), ..home() };
        let west = Camera { center: [-3.1, 0.0].map(Exact::from_f64), ..home() };
        assert!((east.offset_of(west.center).x - 0.083).abs() < 1e-3);
        let (half, _) =
            Move { from: east, to: west, began_secs: 0.0, pace: MovePace::Quick }.at(0.05);
        assert!(half.center[0].to_f64().abs() > 3.1);
    }

    #[test]
    fn a_glide_takes_its_time_and_zooms_evenly() {
        let to = home().zoomed(10.0, DVec2::new(1.0, 0.5));
        let glide = Move { from: home(), to, began_secs: 2.0, pace: MovePace::Even { secs: 1.5 } };
        let log_width = |at_secs: f64| glide.at(at_secs).0.width_rad.ln();
        let steps = [2.0, 2.5, 3.0, 3.5].map(log_width);
        for pair in steps.windows(2) {
            assert!((pair[0] - pair[1] - 10f64.ln() / 3.0).abs() < 1e-12, "{steps:?}");
        }
        assert!(!glide.at(3.4).1 && glide.at(3.5) == (to, true));
    }
}
