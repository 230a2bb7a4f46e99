//! The four slopes of a step of RK4, drawn as velocities of the second bob.

use super::double_simulation::pendulum;
use super::drawing::{FigureCanvas, ends};
use flipmap_pendulum::{Pendulum, State};

/// Length of the longest arrow of a slope in m.
const SLOPE_M: f64 = 0.7;

/// Returns the velocity of the second bob in m/s.
fn second_velocity(state: &State<f64>) -> [f64; 2] {
    let turn = |bob: usize| {
        let (sin, cos) = state.angle[bob].sin_cos();
        [state.speed[bob] * cos, state.speed[bob] * sin]
    };
    let (first, second) = (turn(0), turn(1));
    [first[0] + second[0], first[1] + second[1]]
}

/// Returns the states at which RK4 evaluates its four slopes in a step of `secs`.
fn rk4_stages(pendulum: &Pendulum<f64>, state: &State<f64>, secs: f64) -> [State<f64>; 4] {
    let moved = |by: f64, slope: &State<f64>| {
        let alpha = pendulum.acceleration(slope);
        let add = |from: [f64; 2], rate: [f64; 2]| [0, 1].map(|bob| from[bob] + by * rate[bob]);
        State { angle: add(state.angle, slope.speed), speed: add(state.speed, alpha) }
    };
    let second = moved(0.5 * secs, state);
    let third = moved(0.5 * secs, &second);
    [*state, second, third, moved(secs, &third)]
}

/// Draws the velocities of the second bob at the four stages of a step of `secs` from a state, each at
/// its place; the longest arrow has the same length at all times.
pub(super) fn draw(stage: &FigureCanvas, state: &State<f64>, secs: f64) {
    let colour = stage.tint.parts[3];
    let stages = rk4_stages(&pendulum(), state, secs);
    let velocities = stages.each_ref().map(second_velocity);
    let fastest = velocities.iter().map(|[x, y]| x.hypot(*y)).fold(1e-9, f64::max);
    for (k, (state, velocity)) in stages.iter().zip(velocities).enumerate() {
        let at = ends([1.0, 1.0], state.angle)[1];
        let by = velocity.map(|part| SLOPE_M * part / fastest);
        stage.arrow(at, by, colour);
        stage.label([at[0] + by[0], at[1] + by[1]], &format!("k{}", k + 1), colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::trig::Turning;
    use flipmap_pendulum::integrator::rk4;

    #[test]
    fn the_slopes_that_are_drawn_make_the_step() {
        let state = State { angle: [1.1, -0.7], speed: [2.0, -3.0] };
        let (pendulum, h) = (pendulum(), 0.05);
        let weights = [1.0, 2.0, 2.0, 1.0].map(|weight| weight * h / 6.0);
        let mut next = state;
        for (stage, weight) in rk4_stages(&pendulum, &state, h).iter().zip(weights) {
            let slope = State { angle: stage.speed, speed: pendulum.acceleration(stage) };
            let change = State {
                angle: slope.angle.map(|x| weight * x),
                speed: slope.speed.map(|x| weight * x),
            };
            next = next.plus(&change);
        }
        let step = state.plus(&rk4(&pendulum, &state, h, Turning::Fresh));
        for bob in 0..2 {
            assert!((next.angle[bob] - step.angle[bob]).abs() < 1e-13);
            assert!((next.speed[bob] - step.speed[bob]).abs() < 1e-12);
        }
    }

    #[test]
    fn the_velocity_is_that_of_the_place() {
        let state = State { angle: [1.1, -0.7], speed: [2.0, -3.0] };
        let later = [0, 1].map(|bob| state.angle[bob] + 1e-6 * state.speed[bob]);
        let [from, to] = [state.angle, later].map(|angle| ends([1.0, 1.0], angle)[1]);
        let velocity = second_velocity(&state);
        for i in 0..2 {
            assert!((velocity[i] - (to[i] - from[i]) / 1e-6).abs() < 1e-5, "{velocity:?}");
        }
    }
}
