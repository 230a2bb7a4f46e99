//! Holds an integrator of one's own, Heun's method, against the gold standard, start by start.
//!
//! `cargo run --release --example custom_integrator`

use flipmap::physics::flip::right_secs;
use flipmap::physics::integrator::rk4;
use flipmap::physics::trig::Turning;
use flipmap::physics::{Outcome, Pendulum, Rule, State, Status, oracle};

const BUDGET_SECS: f64 = 4.0;
const STEP_SECS: f64 = 1e-3;
type Step = fn(&Pendulum<f64>, &State<f64>, f64) -> State<f64>;

/// Heun's method: the mean of the slopes at both ends of an Euler step.
fn heun(pendulum: &Pendulum<f64>, state: &State<f64>, step: f64) -> State<f64> {
    let slope = |state: &State<f64>| [state.speed, pendulum.acceleration(state)];
    let moved = |[speed, rise]: [[f64; 2]; 2]| State {
        angle: [0, 1].map(|i| state.angle[i] + step * speed[i]),
        speed: [0, 1].map(|i| state.speed[i] + step * rise[i]),
    };
    let first = slope(state);
    let second = slope(&moved(first));
    moved([0, 1].map(|part| [0, 1].map(|i| 0.5 * (first[part][i] + second[part][i]))))
}

/// The first time at which the second bob passes the top, by steps of one length.
fn outcome(step: Step, pendulum: &Pendulum<f64>, start: [f64; 2]) -> Outcome {
    let turns = |state: &State<f64>| state.angle[1] / std::f64::consts::TAU + 0.5;
    let mut state = State::rest(start);
    for k in 0..(BUDGET_SECS / STEP_SECS) as u32 {
        let next = step(pendulum, &state, STEP_SECS);
        let (before, after) = (turns(&state), turns(&next));
        if before.floor() != after.floor() {
            let share = (before.round() - before) / (after - before);
            return Outcome::flipped((f64::from(k) + share) * STEP_SECS);
        }
        state = next;
    }
    Outcome::without_time(Status::Unflipped)
}

fn main() {
    let pendulum = Pendulum::points([1.0; 2], [1.0; 2], 9.81);
    let starts = (0..64).map(|k| [1.6 + 0.02 * f64::from(k % 8), 2.2 + 0.1 * f64::from(k / 8)]);
    let starts: Vec<[f64; 2]> = starts.collect();
    let rk4: Step = |pendulum, state, step| state.plus(&rk4(pendulum, state, step, Turning::Fresh));
    for (name, step) in [("heun", heun as Step), ("rk4", rk4)] {
        let is_right = |start: &&[f64; 2]| {
            let truth = oracle::outcome(&pendulum, **start, Rule::Second, BUDGET_SECS);
            let answer = outcome(step, &pendulum, **start);
            answer.status == truth.status && (answer.time - truth.time).abs() < right_secs(1.0)
        };
        println!("{name}: {} of {} right", starts.iter().filter(is_right).count(), starts.len());
    }
}
