//! The least energy with which a bob can pass the top. Friction only takes energy away, so a
//! pendulum with less energy than this provably never flips, and its integration ends early.

use flipmap_pendulum::{Pendulum, Rule};

/// Share of the energy's range by which a pendulum must lie below the bound: more than any error of
/// its energy, in f32 too.
const MARGIN: f64 = 1e-3;

/// The energy in reduced units below which a pendulum is done before the end of its budget, because
/// it cannot pass the top any more. `None` without friction, and where no bob is watched.
pub(super) fn least_energy(reduced: &Pendulum<f64>, rule: Rule) -> Option<f64> {
    reduced.friction.filter(|_| rule != Rule::Neither)?;
    Some(-reduced.least_depth(rule) - MARGIN * (reduced.p + reduced.q))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::State;

    #[test]
    fn only_what_can_never_pass_the_top_is_done_early() {
        let still = Pendulum::points([1.0, 1.0], [1.0, 1.0], 1.0);
        let slowed = Pendulum { friction: Some([0.1, 0.1]), ..still };
        assert_eq!(least_energy(&still, Rule::Second), None, "nothing is ever slowed");
        assert_eq!(least_energy(&slowed, Rule::Neither), None, "states are followed to the end");
        let least = least_energy(&slowed, Rule::Second).unwrap();
        // The second bob at the top with the first at the bottom has just the energy to pass.
        let top = slowed.energy(&State::rest([0.0, std::f64::consts::PI]));
        assert!(least < top && least > top - 0.01, "{least} and {top}");
    }
}
