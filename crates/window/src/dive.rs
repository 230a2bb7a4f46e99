//! The pace of a dive: how fast the camera zooms from one view of a descent to the next.

use flipmap_screen::camera::{Camera, MovePace};

/// Pace of a dive before the user changes it, in octaves of zoom per second.
const OCTAVES_A_SEC: f64 = 0.9;
/// Paces that the user can choose.
const PACES: std::ops::RangeInclusive<f64> = 0.1..=4.0;
/// Share of a view that is drawn before the next one is approached at full pace.
const DRAWN: f64 = 0.5;
/// Pace below which a dive does not slow down for views that are not drawn yet: one octave in two
/// seconds.
const LEAST_OCTAVES_A_SEC: f64 = 0.5;

/// The pace of a dive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DivePace {
    octaves_a_sec: f64,
    /// True while the dive stands still.
    pub is_paused: bool,
}

impl Default for DivePace {
    fn default() -> Self {
        DivePace { octaves_a_sec: OCTAVES_A_SEC, is_paused: false }
    }
}

impl DivePace {
    /// Returns the chosen pace in octaves of zoom per second.
    pub(super) fn octaves_a_sec(&self) -> f64 {
        self.octaves_a_sec
    }

    /// Multiplies the pace by a factor, within what can be chosen.
    pub(super) fn quicken(&mut self, factor: f64) {
        let (least, most) = (*PACES.start(), *PACES.end());
        self.octaves_a_sec = (self.octaves_a_sec * factor).clamp(least, most);
    }

    /// Returns the pace of the move between two views, while `share` of the first is drawn.
    pub(super) fn between(&self, from: &Camera, to: &Camera, share: f64) -> MovePace {
        let slowed = self.octaves_a_sec * (share / DRAWN).min(1.0);
        let octaves_a_sec = slowed.max(LEAST_OCTAVES_A_SEC.min(self.octaves_a_sec));
        let octaves = (from.width_rad / to.width_rad).log2().abs();
        MovePace::Even { secs: octaves / octaves_a_sec }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_screen::reach::Reach;

    #[test]
    fn a_dive_waits_for_its_views_but_never_halts() {
        let (mut pace, from) = (DivePace::default(), Camera::whole(Reach::TORUS));
        let to = Camera { width_rad: from.width_rad / 8.0, ..from };
        let secs = |pace: &DivePace, share: f64| match pace.between(&from, &to, share) {
            MovePace::Even { secs } => secs,
            MovePace::Quick => panic!("a dive is even"),
        };
        assert!((secs(&pace, 1.0) - 3.0 / OCTAVES_A_SEC).abs() < 1e-12);
        assert!((secs(&pace, 0.0) - 6.0).abs() < 1e-12, "an octave in two seconds at least");
        assert!(secs(&pace, 0.4) > secs(&pace, 0.5));
        pace.quicken(1e-9);
        assert!((secs(&pace, 0.0) - 30.0).abs() < 1e-9, "unless the user wants it slower");
        pace.quicken(1e9);
        assert!((secs(&pace, 1.0) - 0.75).abs() < 1e-12);
    }
}
