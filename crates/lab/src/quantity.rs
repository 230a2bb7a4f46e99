//! The quantities of a double pendulum that a chart can show against one another.

use super::drawing::{ends, wrapped};
use super::energy::Energy;
use flipmap_pendulum::State;
use flipmap_scene::{Kind, PendulumSpec};

/// A quantity that changes in time; the number is 0 for the first bob and 1 for the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Time,
    Angle(usize),
    Speed(usize),
    Momentum(usize),
    Acceleration(usize),
    Kinetic,
    /// The part of the kinetic energy with both speeds.
    CrossTerm,
    Potential,
    Tension(usize),
    /// Distance between the second bobs of two twins.
    Apart,
}

/// A pendulum and its state, and the height in m above the pivot from which its potential energy is
/// counted.
#[derive(Clone, Copy)]
pub(crate) struct PendulumAt<'a> {
    pub build: &'a PendulumSpec,
    pub state: &'a State<f64>,
    pub zero_m: f64,
}

impl Quantity {
    /// All quantities, in the order of menus.
    pub(crate) const ALL: [Quantity; 15] = [
        Quantity::Time,
        Quantity::Angle(0),
        Quantity::Angle(1),
        Quantity::Speed(0),
        Quantity::Speed(1),
        Quantity::Momentum(0),
        Quantity::Momentum(1),
        Quantity::Acceleration(0),
        Quantity::Acceleration(1),
        Quantity::Kinetic,
        Quantity::CrossTerm,
        Quantity::Potential,
        Quantity::Tension(0),
        Quantity::Tension(1),
        Quantity::Apart,
    ];

    /// Returns the name with its unit, as axes show it.
    pub(crate) fn name(self) -> String {
        let (name, bob, unit) = match self {
            Quantity::Time => ("time", None, "s"),
            Quantity::Angle(bob) => ("angle θ", Some(bob), "rad"),
            Quantity::Speed(bob) => ("speed ω", Some(bob), "rad/s"),
            Quantity::Momentum(bob) => ("momentum p", Some(bob), "kg m²/s"),
            Quantity::Acceleration(bob) => ("acceleration α", Some(bob), "rad/s²"),
            Quantity::Kinetic => ("kinetic energy", None, "J"),
            Quantity::CrossTerm => ("cross term", None, "J"),
            Quantity::Potential => ("potential energy", None, "J"),
            Quantity::Tension(bob) => ("tension of rod ", Some(bob), "N"),
            Quantity::Apart => ("distance of the twins", None, "m"),
        };
        let index = bob.map_or("", |bob| ["1", "2"][bob]);
        format!("{name}{index}, {unit}")
    }

    /// Returns the value `secs` after the release, in the unit of the name; angles are from −π to π.
    /// `other` is the twin at the same moment; a pendulum without one is 0 m away from it.
    pub(crate) fn value(self, at: PendulumAt, secs: f64, other: Option<PendulumAt>) -> f64 {
        let PendulumAt { build, state, zero_m } = at;
        let State { angle, speed } = *state;
        let pendulum = build.pendulum();
        match self {
            Quantity::Time => secs,
            Quantity::Angle(bob) => wrapped(angle[bob]),
            Quantity::Speed(bob) => speed[bob],
            Quantity::Momentum(bob) => {
                let mass = pendulum.equation(state).mass[bob];
                mass[0] * speed[0] + mass[1] * speed[1]
            }
            Quantity::Acceleration(bob) => pendulum.acceleration(state)[bob],
            Quantity::Kinetic => Energy::of(build, state, zero_m).kinetic,
            Quantity::CrossTerm => pendulum.equation(state).mass[0][1] * speed[0] * speed[1],
            Quantity::Potential => Energy::of(build, state, zero_m).potential,
            Quantity::Tension(bob) => tensions(build, state)[bob],
            Quantity::Apart => {
                let bob = |at: PendulumAt| ends(at.build.lengths_m(), at.state.angle)[1];
                let ([x, y], [u, v]) = (bob(at), bob(other.unwrap_or(at)));
                (x - u).hypot(y - v)
            }
        }
    }

    /// Returns true if the values are those of an angle, which an axis marks at fractions of π.
    pub(crate) fn is_angle(self) -> bool {
        matches!(self, Quantity::Angle(_))
    }
}

/// Returns the force with which each rod pulls along itself at its upper end, in N, from the
/// accelerations of what hangs there (Newton's second law); negative if it pushes.
fn tensions(build: &PendulumSpec, state: &State<f64>) -> [f64; 2] {
    let State { angle, speed } = *state;
    let alpha = build.pendulum().acceleration(state);
    let (masses, lengths) = (build.masses_kg(), build.lengths_m());
    // A bar's mass acts at its middle.
    let share = match build.kind {
        Kind::Points => 1.0,
        Kind::Rods => 0.5,
    };
    let along = |bob: usize| [angle[bob].sin(), -angle[bob].cos()];
    // Acceleration of the end of a rod relative to its beginning.
    let end = |bob: usize| {
        let ([x, y], across) = (along(bob), [angle[bob].cos(), angle[bob].sin()]);
        let (turn, pull) = (lengths[bob] * alpha[bob], lengths[bob] * speed[bob].powi(2));
        [turn * across[0] - pull * x, turn * across[1] - pull * y]
    };
    let (first, second) = (end(0), end(1));
    let gravity = build.gravity.value();
    let force = |mass: f64, [x, y]: [f64; 2]| [mass * x, mass * (y + gravity)];
    let on_second = force(masses[1], [0, 1].map(|i| first[i] + share * second[i]));
    let on_first = force(masses[0], first.map(|x| share * x));
    let at_pivot = [0, 1].map(|i| on_first[i] + on_second[i]);
    let towards_pivot = |bob: usize, force: [f64; 2]| {
        let [x, y] = along(bob);
        -(force[0] * x + force[1] * y)
    };
    [towards_pivot(0, at_pivot), towards_pivot(1, on_second)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::hanging_m;
    use flipmap_numbers::trig::Turning;
    use flipmap_pendulum::integrator::rk4;
    use std::f64::consts::{FRAC_PI_2, SQRT_2};

    fn at<'a>(build: &'a PendulumSpec, state: &'a State<f64>) -> PendulumAt<'a> {
        PendulumAt { build, state, zero_m: hanging_m(build) }
    }

    fn builds() -> [PendulumSpec; 2] {
        [Kind::Points, Kind::Rods].map(|kind| PendulumSpec::new(kind, [1.5, 0.7], [0.8, 1.3], 9.81))
    }

    #[test]
    fn a_pendulum_at_rest_pulls_with_its_weight_and_has_no_energy() {
        for build in builds() {
            let value =
                |quantity: Quantity| quantity.value(at(&build, &State::rest([0.0; 2])), 0.0, None);
            assert!((value(Quantity::Tension(0)) - 2.2 * 9.81).abs() < 1e-12);
            assert!((value(Quantity::Tension(1)) - 0.7 * 9.81).abs() < 1e-12);
            assert!(value(Quantity::Kinetic).abs() + value(Quantity::Potential).abs() < 1e-12);
        }
    }

    #[test]
    fn tensions_accelerate_the_masses_as_they_move() {
        // The reference are second differences of places along the motion.
        let state = State { angle: [1.1, -0.7], speed: [2.0, -3.0] };
        for build in builds() {
            let (pendulum, h) = (build.pendulum(), 1e-4);
            let after = |secs: f64| state.plus(&rk4(&pendulum, &state, secs, Turning::Fresh));
            let places = |state: &State<f64>| {
                let [first, second] = ends(build.lengths_m(), state.angle);
                let half = |from: [f64; 2], to: [f64; 2]| [0, 1].map(|i| 0.5 * (from[i] + to[i]));
                match build.kind {
                    Kind::Points => [first, second],
                    Kind::Rods => [half([0.0; 2], first), half(first, second)],
                }
            };
            let [before, now, after] = [-h, 0.0, h].map(|secs| places(&after(secs)));
            let force = |bob: usize| {
                let mass = build.masses_kg()[bob];
                let pull =
                    |i: usize| (before[bob][i] + after[bob][i] - 2.0 * now[bob][i]) / (h * h);
                [mass * pull(0), mass * (pull(1) + 9.81)]
            };
            let (first, second) = (force(0), force(1));
            let along = |bob: usize, [x, y]: [f64; 2]| {
                -(x * state.angle[bob].sin() - y * state.angle[bob].cos())
            };
            let known = [along(0, [0, 1].map(|i| first[i] + second[i])), along(1, second)];
            for (bob, known) in known.into_iter().enumerate() {
                let value = Quantity::Tension(bob).value(at(&build, &state), 0.0, None);
                assert!((value - known).abs() < 1e-5 * known.abs(), "{value} for {known}");
            }
        }
    }

    #[test]
    fn twins_are_as_far_apart_as_their_second_bobs() {
        let [build, _] = builds();
        let (down, level) = (State::rest([0.0; 2]), State::rest([0.0, FRAC_PI_2]));
        let apart = |other| Quantity::Apart.value(at(&build, &down), 0.0, other);
        assert!((apart(Some(at(&build, &level))) - 1.3 * SQRT_2).abs() < 1e-12);
        assert_eq!(apart(None), 0.0);
    }

    #[test]
    fn momenta_are_the_slopes_of_the_kinetic_energy() {
        let state = State { angle: [1.1, -0.7], speed: [2.0, -3.0] };
        for build in builds() {
            for bob in 0..2 {
                let kinetic = |by: f64| {
                    let mut state = state;
                    state.speed[bob] += by;
                    Quantity::Kinetic.value(at(&build, &state), 0.0, None)
                };
                let slope = (kinetic(1e-5) - kinetic(-1e-5)) / 2e-5;
                let momentum = Quantity::Momentum(bob).value(at(&build, &state), 0.0, None);
                assert!((momentum - slope).abs() < 1e-6, "{momentum} for {slope}");
            }
        }
    }
}
