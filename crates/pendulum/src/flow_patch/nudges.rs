//! The growth of nudges, small changes of a state, in a patch: the tangent map of its middle, from
//! which those of its other starts follow.
//!
//! The polynomials give the growth of only two nudges, those within the plane of the patch; a
//! tangent map consists of four. The map is therefore followed along the middle, where it costs
//! little compared with the polynomials. Late in a patch's motion, almost all nudges have grown
//! into the same one, and the polynomials give its differences from start to start.

use super::{Dynamics, FlowPatch, middle};
use crate::phase::Phase;
use crate::tangents::{TangentMap, nudges};

impl FlowPatch {
    /// The same patch, with its nudges followed from now on.
    #[must_use]
    pub fn with_nudges(self) -> Self {
        FlowPatch { nudges: Some(TangentMap::identity()), ..self }
    }

    /// Returns true if nudges are followed and the largest has grown by less than `factor`.
    pub fn has_grown_less_than(&self, factor: f64) -> bool {
        self.nudges.is_some_and(|map| map.log_growth() < factor.ln())
    }

    /// The same patch, with the nudges of its middle followed from `release`, its state at the
    /// release.
    #[must_use]
    pub fn with_nudges_from(self, dynamics: &Dynamics, release: &Phase<f64>) -> Self {
        let secs = self.time.0 + self.time.1;
        let map = TangentMap::identity().followed_by(&dynamics.pendulum, release, secs);
        FlowPatch { nudges: Some(map), ..self }
    }

    /// The tangent map of the start at a point of the patch, from its release; `None` if nudges are
    /// not followed.
    pub fn nudges_at(&self, dynamics: &Dynamics, at: [f64; 2]) -> Option<TangentMap> {
        let map = self.nudges?;
        let (sin, cos) = self.growing_angle(dynamics).sin_cos();
        let nudge = |at: [f64; 2]| {
            let state = self.phase.map(|jet| jet.along_at(at, [cos, sin]));
            let [nudge] = nudges(&dynamics.pendulum, &state);
            nudge
        };
        Some(map.of_neighbour(nudge([0.0; 2]), nudge(at)))
    }

    /// The tangent map of the middle after a step from its present state.
    pub(super) fn nudges_after(&self, dynamics: &Dynamics, length: f64) -> Option<TangentMap> {
        let before = middle(&self.phase);
        self.nudges.map(|map| map.followed_by(&dynamics.pendulum, &before, length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flip::Rule;
    use crate::flow_patch::PatchEnd;
    use crate::{Pendulum, State};

    #[test]
    fn every_start_has_the_tangent_map_of_its_own_motion() {
        let pendulum = Pendulum::points([1.0; 2], [1.0; 2], 1.0).reduced().0;
        let dynamics = Dynamics::new(pendulum, Rule::Neither);
        let (center, half) = ([2.2, -1.9], 1e-5);
        let mut patch = FlowPatch::release(&dynamics, center.map(f64::sin_cos), half).with_nudges();
        let end = patch.follow(&dynamics, 60.0, 1e-12, None);
        assert!(matches!(end, PatchEnd::Spread), "{end:?}");
        let time = patch.time.0 + patch.time.1;
        let (mut wrong, mut differs) = (0f64, 0f64);
        let whole = patch.nudges_at(&dynamics, [0.0; 2]).unwrap().log_growth();
        for at in [[0.0, 0.0], [1.0, 0.0], [-0.4, 0.9], [-1.0, -1.0]] {
            let angle = [0, 1].map(|i| center[i] + half * at[i]);
            let start = pendulum.phase(&State::rest(angle));
            let own = TangentMap::identity().followed_by(&pendulum, &start, time).log_growth();
            let mapped = patch.nudges_at(&dynamics, at).unwrap().log_growth();
            wrong = wrong.max((mapped - own).abs());
            differs = differs.max((own - whole).abs());
        }
        assert!(whole > 5.0 && differs > 1e-3, "{whole}, {differs}");
        assert!(wrong < 0.05 * differs, "wrong by {wrong}, which differ by {differs}");
    }
}
