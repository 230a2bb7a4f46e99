//! True answers of questions: a question reads the end of an orbit of the gold standard in
//! double-double as it reads an engine's.

use flipmap_engine::start::whole_turns;
use flipmap_numbers::Dd;
use flipmap_pendulum::extremum::{Extremum, Measure};
use flipmap_pendulum::passes::{Pass, passes_until};
use flipmap_pendulum::taylor::Orbit;
use flipmap_pendulum::{Accumulators, Outcome, State, Status, tangents};
use flipmap_scene::Scene;
use flipmap_scene::question::{Needs, QuestionInput};

/// The channels of the true orbit from a start; `None` if it has no answer.
pub(super) fn true_answer(scene: &Scene, start: State<Dd>) -> Option<Vec<f64>> {
    let kind = scene.question.ask.kind();
    let max_secs = scene.question.end_secs();
    let all = passes_until(orbit(scene, start), max_secs);
    let event = event(scene, &all);
    if event.is_none() && !kind.at_a_time {
        return None;
    }
    let end = event.unwrap_or(Dd::new(max_secs));
    let state = orbit(scene, start).state_at(end);
    let gathered = gathered(scene, start, &all, state, end.hi);
    if gathered.extremum[0].is_infinite() && matches!(kind.needs, Needs::Extremum(_)) {
        return None;
    }
    let pendulum = scene.build.pendulum();
    let outcome = match event {
        Some(time) => Outcome::flipped(time.hi),
        None => Outcome::without_time(Status::Unflipped),
    };
    let phase = pendulum.phase(&rounded(state));
    let ending = QuestionInput {
        pendulum: &pendulum,
        unit_secs: 1.0,
        outcome,
        phase,
        secs: end.hi,
        gathered,
    };
    Some((kind.read)(&ending)[..kind.channels.len()].to_vec())
}

fn orbit(scene: &Scene, start: State<Dd>) -> Orbit<Dd> {
    Orbit::new(scene.build.pendulum_in::<Dd>(), start)
}

fn rounded(state: State<Dd>) -> State<f64> {
    State { angle: state.angle.map(|x| x.hi), speed: state.speed.map(|x| x.hi) }
}

/// The time of the pass that ends the orbit, in s.
fn event(scene: &Scene, all: &[Pass]) -> Option<Dd> {
    let bobs = scene.question.watched().watched();
    let mut watched = all.iter().filter(|pass| bobs.contains(&(pass.bob - 1)));
    watched.nth(scene.question.ask.kind().passes as usize - 1).map(|pass| pass.time)
}

/// The quantities that the question needs, gathered from the start to a state after `secs`.
fn gathered(
    scene: &Scene,
    start: State<Dd>,
    all: &[Pass],
    state: State<Dd>,
    secs: f64,
) -> Accumulators {
    let count = |bob, anticlockwise| {
        let is = |pass: &&Pass| pass.bob == bob && pass.anticlockwise == anticlockwise;
        all.iter().filter(is).count() as u32
    };
    let needs = scene.question.ask.kind().needs;
    Accumulators {
        turns: state.angle.map(|angle| whole_turns(angle.hi)),
        passes: [count(1, true), count(1, false), count(2, true), count(2, false)],
        extremum: match needs {
            Needs::Extremum(kind) => extremum(kind, scene, start, secs),
            Needs::Outcome | Needs::End | Needs::Growth => Accumulators::NONE.extremum,
        },
        log_growth: if needs == Needs::Growth { log_growth(scene, start, secs) } else { 0.0 },
    }
}

/// The logarithm of the growth of the largest of all nudges, by central differences of orbits.
fn log_growth(scene: &Scene, start: State<Dd>, secs: f64) -> f64 {
    const NUDGE: f64 = 1e-11;
    let unit = scene.build.unit_secs();
    let column = |k: usize| {
        let [behind, ahead] = [-NUDGE, NUDGE].map(|by| {
            let mut moved = start;
            match k {
                0 | 1 => moved.angle[k] = moved.angle[k] + Dd::new(by),
                _ => moved.speed[k - 2] = moved.speed[k - 2] + Dd::new(by / unit),
            }
            orbit(scene, moved).state_at(Dd::new(secs))
        });
        let slope = |a: Dd, b: Dd| (a - b).hi / (2.0 * NUDGE);
        let angle = |i: usize| slope(ahead.angle[i], behind.angle[i]);
        let speed = |i: usize| slope(ahead.speed[i], behind.speed[i]) * unit;
        [angle(0), angle(1), speed(0), speed(1)]
    };
    tangents::largest_singular_value([0, 1, 2, 3].map(column)).ln()
}

/// The extreme of a quantity and its time in s, from its values at states a ten-thousandth of the
/// time apart.
fn extremum(kind: Extremum, scene: &Scene, start: State<Dd>, secs: f64) -> [f64; 2] {
    const STATES: u32 = 10_000;
    let pendulum = scene.build.pendulum();
    let from = pendulum.phase(&rounded(start));
    let measure = Measure::new(kind, pendulum, from);
    let mut orbit = orbit(scene, start);
    let (mut before, mut counts) = ([measure.value(&from), 0.0], kind.counts_from_release());
    let mut best = measure.begun();
    for k in 1..=STATES {
        let secs = secs * f64::from(k) / f64::from(STATES);
        let phase = pendulum.phase(&rounded(orbit.state_at(Dd::new(secs))));
        let now = [measure.value(&phase), secs];
        counts |= kind.is_beyond(now[0], before[0]);
        let turns = kind.is_beyond(before[0], now[0]);
        if counts && turns && kind.is_beyond(before[0], best[0]) {
            best = before;
        }
        before = now;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::question::QuestionName;
    use flipmap_scene::{Budget, QuestionSettings};

    fn scene(ask: QuestionName, secs: f64) -> Scene {
        let question = QuestionSettings { ask, budget: Budget::secs(secs), ..Default::default() };
        Scene { question, ..Scene::default() }
    }

    /// Both rods nearly upright: the second bob passes first, after 1.77 units of time.
    fn falling() -> State<Dd> {
        State::rest([Dd::new(3.0), Dd::new(3.0)])
    }

    #[test]
    fn events_and_times_give_the_answers() {
        let time = true_answer(&scene(QuestionName::Flip, 10.0), falling()).unwrap();
        let first = true_answer(&scene(QuestionName::First, 10.0), falling()).unwrap();
        assert_eq!(first, [2.0, time[0]], "the second bob is first");
        assert!(true_answer(&scene(QuestionName::First, 0.1), falling()).is_none(), "not yet");
        let still = true_answer(&scene(QuestionName::Flips, 0.1), falling()).unwrap();
        assert_eq!(still, [0.0; 4], "no pass is an answer, too");
        let flips = true_answer(&scene(QuestionName::Flips, 8.0), falling()).unwrap();
        let all = passes_until(orbit(&scene(QuestionName::Flips, 8.0), falling()), 8.0).len();
        assert!(all > 1 && flips.iter().sum::<f64>() == all as f64, "{flips:?}");
        let state = true_answer(&scene(QuestionName::State, 1.0), falling()).unwrap();
        let [theta1, theta2] =
            orbit(&scene(QuestionName::State, 1.0), falling()).state_at(Dd::new(1.0)).angle;
        let near = |a: f64, b: Dd| (a - b.wrapped().hi).abs() < 1e-12;
        assert!(near(state[0], theta1) && near(state[1], theta2), "{state:?}");
    }

    #[test]
    fn a_swing_in_a_normal_mode_returns_after_its_period() {
        // θ2 = √2 θ1 swings slowly, alike for all small angles; the distance is a square of them.
        let swing = State::rest([Dd::new(1e-3), Dd::new(1e-3 * 2f64.sqrt())]);
        let scene = scene(QuestionName::Return, 4.0);
        let [distance, secs] = true_answer(&scene, swing).unwrap()[..] else { panic!() };
        let slow = scene.build.unit_secs() * std::f64::consts::TAU / (2.0 - 2f64.sqrt()).sqrt();
        assert!(distance < 1e-5 && (secs / slow - 1.0).abs() < 1e-3, "{distance} {secs} {slow}");
    }
}
