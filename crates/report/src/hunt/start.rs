//! The starts of a window's pixels, from the scene's decimals: no code is shared with how pictures
//! compute them, except for the equations of a section.

use flipmap_numbers::{Angle, Dd, Exact, Scalar};
use flipmap_pendulum::State;
use flipmap_scene::{Axis, Plane, PlaneKind, Scene};

/// The start of a pixel in a window of `side` × `side`, angles in (−π, π] rad and speeds in rad/s; none
/// where a section has no real solution.
pub(super) fn start(scene: &Scene, side: u32, [column, row]: [u32; 2]) -> Option<State<Exact>> {
    let pixel = Exact::parse(&scene.view.width).unwrap_or_default() / Exact::from_f64(side.into());
    let half = f64::from(side) / 2.0;
    let across = pixel * Exact::from_f64(f64::from(column) + 0.5 - half);
    let above = pixel * Exact::from_f64(half - f64::from(row) - 0.5);
    let above = above / Exact::from_f64(scene.view.stretch);
    let turn = Dd::new(scene.view.rotate) * Dd::PI / Dd::new(180.0);
    let (sin, cos) = turn.sin_cos();
    let [sin, cos] = [sin, cos].map(Exact::from_dd);
    let center = scene.view.center_rad();
    let at = [center[0] + across * cos - above * sin, center[1] + across * sin + above * cos];
    on_plane(&scene.plane, scene, at)
}

fn on_plane(plane: &Plane, scene: &Scene, at: [Exact; 2]) -> Option<State<Exact>> {
    if plane.kind == PlaneKind::Section {
        return on_section(scene, Exact::from_f64(plane.energy), at);
    }
    let mut all = [0, 1, 2, 3].map(|i| Exact::parse(&plane.origin[i]).unwrap_or_default());
    for (axis, value) in plane.axes().into_iter().zip(at) {
        let place = Axis::OF_STARTS.iter().position(|other| *other == axis)?;
        all[place] = value;
    }
    let [theta1, theta2, omega1, omega2] = all;
    Some(State { angle: [theta1, theta2].map(Exact::wrapped), speed: [omega1, omega2] })
}

/// The start where θ1 = 0 and ω1 > 0: of ω2 = (p2 − C c ω1) / B, the energy is α ω1² + γ.
fn on_section(scene: &Scene, energy: Exact, [theta2, p2]: [Exact; 2]) -> Option<State<Exact>> {
    let pendulum = scene.build.pendulum_in::<Exact>();
    let half = Exact::from_f64(0.5);
    let cos = theta2.sin_cos().1;
    let coupling = pendulum.c * cos;
    let alpha = half * (pendulum.a - coupling * coupling / pendulum.b);
    let gamma = half * p2 * p2 / pendulum.b - (energy + pendulum.p + pendulum.q * cos);
    let square = -gamma / alpha;
    if square < Exact::ZERO {
        return None;
    }
    let omega1 = square.sqrt();
    let omega2 = (p2 - coupling * omega1) / pendulum.b;
    Some(State { angle: [Exact::ZERO, theta2.wrapped()], speed: [omega1, omega2] })
}
