//! The share of a view that energy forbids to flip, as an integral.

use std::f64::consts::TAU;

use flipmap_estimate::Estimate;
use flipmap_numbers::Scalar;
use flipmap_scene::Scene;

/// Number of columns over which is summed: the error falls with the power 3/2, to about 1e-9.
const COLUMNS: u32 = 1 << 20;

/// Smallest width in rad at which angles in f64 leave the integral right to 1e-8.
const LEAST_WIDTH: f64 = 1e-6;

/// Returns the share of an upright view of released pendulums that is forbidden; `None` for other and
/// for narrow views and for other planes, in which it is counted.
pub(crate) fn forbidden_share(scene: &Scene) -> Option<Estimate> {
    let width = scene.view.width_rad().hi;
    if !scene.plane.is_at_rest() || scene.view.rotate != 0.0 || width < LEAST_WIDTH {
        return None;
    }
    let pendulum = scene.build.pendulum();
    if pendulum.q <= 0.0 {
        return Some(Estimate::exact(1.0));
    }
    let bound = pendulum.least_depth(scene.question.watched());
    let [x, y] = scene.view.center_rad().map(|theta| theta.to_f64());
    let height = width / scene.view.stretch;
    let (bottom, top) = (y - 0.5 * height, y + 0.5 * height);
    let column = |k: u32| {
        let theta = x + width * ((f64::from(k) + 0.5) / f64::from(COLUMNS) - 0.5);
        let cosine = (bound - pendulum.p * theta.cos()) / pendulum.q;
        (length_below(cosine, top) - length_below(cosine, bottom)) / height
    };
    let share = (0..COLUMNS).map(column).sum::<f64>() / f64::from(COLUMNS);
    let (low, high) = (share - 1e-8, share + 1e-8);
    Some(Estimate { value: share, low, high }.within(0.0, 1.0))
}

/// Returns the length of the angles from 0 to `angle` whose cosine is larger than `cosine`, negative
/// if `angle` is.
fn length_below(cosine: f64, angle: f64) -> f64 {
    let half = cosine.clamp(-1.0, 1.0).acos();
    let turns = (angle / TAU).round();
    2.0 * half * turns + (angle - TAU * turns).clamp(-half, half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::{BuiltIn, Document, View};

    fn share(text: &str) -> f64 {
        forbidden_share(&Document::parse(text).unwrap().scene().checked().unwrap()).unwrap().value
    }

    #[test]
    fn the_known_integrals_are_met() {
        // Home and equal rods: shares of the torus that energy forbids, by an independent program.
        assert!((share("") - 0.306_435_644_7).abs() < 1e-9);
        assert!((share("[pendulum]\nkind = \"rods\"") - 0.243_920_584_2).abs() < 1e-9);
        assert!(share("[view]\ncenter = [\"0\", \"0\"]\nwidth = \"1e-3\"") == 1.0);
        assert!(share("[view]\ncenter = [\"3\", \"0\"]\nwidth = \"1e-3\"") == 0.0);
    }

    #[test]
    fn turned_and_narrow_views_are_counted() {
        let mut scene = BuiltIn::home().document().scene();
        scene.view.rotate = 10.0;
        assert!(forbidden_share(&scene).is_none());
        scene.view = View { width: "1e-7".into(), ..View::default() };
        assert!(forbidden_share(&scene).is_none());
    }
}
