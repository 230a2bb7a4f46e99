//! The pendulum at the pointer: once the pointer rests on a start, a small pendulum swings from it.

use flipmap_numbers::Exact;
use flipmap_pendulum::phase::{Phase, rk4};
use flipmap_pendulum::{Pendulum, State};
use flipmap_scene::Scene;
use flipmap_screen::pin_start::PinStart;
use flipmap_screen::reach::Reach;

/// Time that the pointer rests before the pendulum is let go, s.
const REST_SECS: f64 = 0.6;
/// Time that it swings, in s; after that, nothing is redrawn.
const SWING_SECS: f64 = 6.0;
/// Longest integration step in s: fine enough for the eye, but not for the map.
const STEP_SECS: f64 = 1.0 / 240.0;

/// The pendulum at the pointer, if there is one.
#[derive(Debug, Default)]
pub(crate) struct HoverSwing {
    current: Option<Swinging>,
}

#[derive(Debug)]
struct Swinging {
    place: [Exact; 2],
    scene: Scene,
    pendulum: Pendulum<f64>,
    phase: Phase<f64>,
    /// Moment on the window's clock at which the pointer came to the place, s.
    since_secs: f64,
    /// Time that the pendulum has swung, s.
    swung_secs: f64,
}

impl HoverSwing {
    /// Follows the pointer, which is at a place of a scene's lattice or off the map, at a moment of
    /// the window's clock. Returns the angles of the pendulum to draw, in rad.
    pub(crate) fn follow(
        &mut self,
        scene: &Scene,
        place: Option<[Exact; 2]>,
        now_secs: f64,
    ) -> Option<[f64; 2]> {
        let is_here = |s: &Swinging| Some(s.place) == place && s.scene == *scene;
        if !self.current.as_ref().is_some_and(is_here) {
            self.current = place.and_then(|place| Swinging::at(scene, place, now_secs));
        }
        self.current.as_mut()?.advance(now_secs)
    }

    /// Returns the time in s after which the window must be redrawn; none if nothing will change.
    pub(crate) fn next_secs(&self, now_secs: f64) -> Option<f64> {
        let current = self.current.as_ref()?;
        let rest_secs = current.since_secs + REST_SECS - now_secs;
        (current.swung_secs < SWING_SECS).then(|| rest_secs.max(1.0 / 30.0))
    }
}

impl Swinging {
    fn at(scene: &Scene, place: [Exact; 2], since_secs: f64) -> Option<Self> {
        let start = PinStart::on_plane(scene, Reach::of(scene), [place; 2])?;
        let launch = start.launches[0];
        let pendulum = scene.build.pendulum();
        let state = State { angle: launch.angle.map(|x| x.hi), speed: launch.speed.map(|w| w.hi) };
        let phase = pendulum.phase(&state);
        let scene = scene.clone();
        Some(Swinging { place, scene, pendulum, phase, since_secs, swung_secs: 0.0 })
    }

    fn advance(&mut self, now_secs: f64) -> Option<[f64; 2]> {
        let until_secs = (now_secs - self.since_secs - REST_SECS).min(SWING_SECS);
        if until_secs < 0.0 {
            return None;
        }
        let ahead_secs = until_secs - self.swung_secs;
        let steps = (ahead_secs / STEP_SECS).ceil().max(0.0);
        for _ in 0..steps as u32 {
            self.phase = rk4(&self.pendulum, &self.phase, ahead_secs / steps);
        }
        self.swung_secs = until_secs;
        let [x1, y1, x2, y2, _, _] = self.phase;
        Some([y1.atan2(x1), y2.atan2(x2)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::Scalar;
    use flipmap_pendulum::taylor::Orbit;

    fn place(angle: [f64; 2]) -> Option<[Exact; 2]> {
        Some(angle.map(Exact::from_f64))
    }

    #[test]
    fn it_is_let_go_where_the_pointer_rests_and_comes_to_an_end() {
        let (scene, mut swing) = (Scene::default(), HoverSwing::default());
        assert_eq!(swing.next_secs(0.0), None, "no pointer, nothing to draw");
        assert_eq!(swing.follow(&scene, place([1.0, 0.5]), 5.0), None);
        assert!((swing.next_secs(5.0).unwrap() - REST_SECS).abs() < 1e-12);
        let at = swing.follow(&scene, place([1.0, 0.5]), 5.0 + REST_SECS + 1e-6).unwrap();
        assert!((at[0] - 1.0).abs() < 1e-9 && (at[1] - 0.5).abs() < 1e-9);
        assert_eq!(swing.follow(&scene, place([1.0, 0.6]), 6.0), None, "another start");
        let end_secs = 6.0 + REST_SECS + SWING_SECS;
        let mut now_secs = 6.0;
        while now_secs < end_secs {
            now_secs += 1.0 / 30.0;
            swing.follow(&scene, place([1.0, 0.6]), now_secs);
        }
        assert_eq!(swing.next_secs(now_secs), None);
        assert_eq!(swing.follow(&scene, None, now_secs), None);
    }

    #[test]
    fn it_moves_as_the_reference_does() {
        let (scene, mut swing) = (Scene::default(), HoverSwing::default());
        let start = [0.4, -0.3];
        let mut shown = None;
        // The first frame finds the pointer there; the clock begins then.
        for frame in 0..=90 {
            let now_secs = f64::from(frame) / 30.0;
            shown = swing.follow(&scene, place(start), now_secs);
        }
        let pendulum = scene.build.pendulum();
        let ends = Orbit::new(pendulum, State::rest(start)).state_at(3.0 - REST_SECS);
        for (shown, end) in shown.unwrap().into_iter().zip(ends.angle) {
            assert!((shown - end).abs() < 1e-5, "{shown} {end}");
        }
    }
}
