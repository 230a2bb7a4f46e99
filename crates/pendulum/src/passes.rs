//! Every pass of the top along an orbit, and the first return to the section θ1 = 0.

use crate::oracle::passages;
use crate::pendulum::{Pendulum, State};
use crate::taylor::{Orbit, TaylorStep};
use flipmap_numbers::Dd;
use flipmap_numbers::real::Angle;

/// A pass of the top by a bob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Number of the bob, 1 or 2.
    pub bob: usize,
    /// Simulated seconds since the release.
    pub time: Dd,
    /// True if it goes over the top towards the left.
    pub anticlockwise: bool,
}

/// The passes of the top in a step of an orbit, in order of time.
pub fn passes_in(step: &TaylorStep<Dd>) -> Vec<Pass> {
    let mut passes: Vec<Pass> = (0..2)
        .flat_map(|bob| {
            passages(&step.angle[bob], step.length).into_iter().map(move |tau| (bob, tau))
        })
        .map(|(bob, tau)| Pass {
            bob: bob + 1,
            time: step.start + tau,
            anticlockwise: step.state(tau).speed[bob].hi > 0.0,
        })
        .collect();
    passes.sort_by(|a, b| a.time.hi.total_cmp(&b.time.hi));
    passes
}

/// The passes of the top up to and including `secs`, in order of time.
pub fn passes_until(mut orbit: Orbit<Dd>, secs: f64) -> Vec<Pass> {
    let mut passes = Vec::new();
    while orbit.time().hi <= secs {
        passes.extend(passes_in(&orbit.step()));
    }
    passes.retain(|pass| pass.time.hi <= secs);
    passes
}

/// A return to the section θ1 = 0 with dθ1/dt > 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionReturn {
    /// Seconds since the start.
    pub time: Dd,
    /// Unwrapped angle of the second rod, rad.
    pub theta2: Dd,
    /// Momentum of the second rod, in units of the pendulum.
    pub p2: Dd,
}

/// Finds where a start on the section θ1 = 0 first returns to it: one step of the Poincaré map.
/// `None` if it does not return within `max_secs`.
pub fn section_return(
    pendulum: &Pendulum<Dd>,
    start: State<Dd>,
    max_secs: f64,
) -> Option<SectionReturn> {
    // Beyond this angle (rad) the orbit has left the section.
    const LEFT: f64 = 1e-3;
    let mut orbit = Orbit::new(*pendulum, start);
    let mut has_left = false;
    while orbit.time().hi <= max_secs {
        let step = orbit.step();
        let length = step.end() - step.start;
        let [from, to] = [Dd::new(0.0), length].map(|tau| step.state(tau).angle[0]);
        has_left |= to.hi.abs() > LEFT;
        if !(has_left && from.hi < 0.0 && to.hi >= 0.0) {
            continue;
        }
        // Newton's method converges from the end: the angle rises through 0 in a short step.
        let tau = (0..60).fold(length, |tau, _| {
            let state = step.state(tau);
            tau - state.angle[0] / state.speed[0]
        });
        let State { angle, speed } = step.state(tau);
        let cos = (angle[0] - angle[1]).sin_cos().1;
        let p2 = pendulum.b * speed[1] + pendulum.c * cos * speed[0];
        return Some(SectionReturn { time: step.start + tau, theta2: angle[1], p2 });
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_oscillation_returns_after_its_period() {
        // The slow normal mode of the equal pendulum: ω² = 2 − √2, θ2 = √2 θ1, in units of 1.
        let unit = Pendulum::points([1.0; 2], [1.0; 2], 1.0).map(Dd::new);
        let omega = (2.0 - 2f64.sqrt()).sqrt();
        let speed = [1.0, 2f64.sqrt()].map(|mode| Dd::new(1e-6 * mode * omega));
        // So slow a swing never exceeds the angle at which it counts as having left, so it never
        // returns either.
        let start = State { angle: [Dd::new(0.0); 2], speed };
        assert_eq!(section_return(&unit, start, 20.0), None);
        let start = State { speed: speed.map(|w| w * Dd::new(2e4)), ..start };
        let back = section_return(&unit, start, 20.0).unwrap();
        let period = std::f64::consts::TAU / omega;
        assert!((back.time.hi / period - 1.0).abs() < 1e-3, "{} {period}", back.time);
        assert!(passes_until(Orbit::new(unit, start), 20.0).is_empty());
    }

    #[test]
    fn passes_come_in_order_with_their_direction() {
        let unit = Pendulum::points([1.0; 2], [1.0; 2], 1.0).map(Dd::new);
        let start = State::rest([Dd::new(3.0), Dd::new(3.0)]);
        let passes = passes_until(Orbit::new(unit, start), 10.0);
        assert!((passes[0].time.hi - 1.767_916_558_420_626_6).abs() < 1e-14, "{:?}", passes[0]);
        assert_eq!(passes[0].bob, 2);
        assert!(passes.windows(2).all(|pair| pair[0].time <= pair[1].time));
        assert!(passes.iter().any(|pass| pass.bob == 1), "the first bob passes at 6.76");
    }
}
