//! The numbers that hold a pendulum's state, and their values at the start.
//!
//! Fixed steps run in angles, adaptive ones in unit vectors and momenta; both in reduced units.
//! Each name has the same place in every precision. Names that end in `_low` belong to the rounding
//! remainders of the other numbers; a precision without remainders leaves these at 0.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use super::integrator_state::{Sought, carried_names};
use super::number_parts::{parts, time_parts, vectors};
use super::pace::Pace;
use super::{
    Carried, EngineError, EventSpec, FinalState, IntegratorConfig, IntegratorState, Job, Method,
    Moving, NUMBERS, Onset, Precision, Starts,
};
use flipmap_numbers::dual::Dual;
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::embedded::{Dop853, EmbeddedPair, plus};
use flipmap_pendulum::extremum::{Extremum, Measure};
use flipmap_pendulum::first_moments::FirstMoments;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::series::{MotionSeries, ORDER_F64};
use flipmap_pendulum::tangents::{TangentMap, Tangents, log_growth, released};
use flipmap_pendulum::{Accumulators, Launch, Pendulum, State, control};
use flipmap_scene::question::Needs;

/// Names of the numbers of a fixed-step state.
pub(crate) const ANGLES: [&str; 6] = ["t1", "t2", "w1", "w2", "t1_low", "t2_low"];

/// Names of the numbers of an adaptive state.
pub(crate) const PHASE: [&str; NUMBERS] = [
    "x1", "y1", "x2", "y2", "p1", "p2", "x1_low", "y1_low", "x2_low", "y2_low", "p1_low", "p2_low",
    "time", "time_low", "h",
];

/// An expansion in f64.
type Expansion = MotionSeries<f64, { ORDER_F64 + 1 }>;

/// Index of the time in an adaptive state.
pub const TIME: usize = 12;
/// Index of the time's remainder in an adaptive state.
pub(crate) const TIME_LOW: usize = 13;
/// Index of the next step's length in an adaptive state.
pub(crate) const STEP: usize = 14;

/// Returns the indices of a device's numbers and of their remainders (see
/// [`IntegratorState::number`]) for jobs that return `ends`.
pub(crate) fn places(state: &[&str], precision: Precision, ends: Needs) -> Vec<[Option<usize>; 2]> {
    let phase = [&PHASE[..], &carried_names(ends)].concat();
    let all: &[&str] = if state.contains(&"h") { &phase } else { &ANGLES };
    let place = |name: &str| all.iter().position(|&other| other == name);
    let low = |name: &str| match precision {
        Precision::Df32 => place(&format!("{name}_low")),
        _ => None,
    };
    state.iter().map(|name| [place(name), low(name)]).collect()
}

/// The state of a pendulum released from rest at `angle` (rad, within (−π, π]).
fn at_rest(config: &IntegratorConfig, angle: [Dd; 2]) -> IntegratorState {
    let mut numbers = [0.0; NUMBERS];
    if config.method.step_secs().is_some() {
        for i in 0..2 {
            [numbers[i], numbers[4 + i]] = parts(angle[i], config.precision);
        }
    } else {
        for (i, value) in vectors(config, angle).as_flattened().iter().enumerate() {
            [numbers[i], numbers[6 + i]] = parts(*value, config.precision);
        }
        numbers[STEP] = control::FIRST;
    }
    IntegratorState::new(0, numbers)
}

/// The state of a pendulum thrown with speeds; `reduced` is the pendulum in reduced units and
/// `unit_secs` its unit of time in s.
fn thrown(
    config: &IntegratorConfig,
    (reduced, unit_secs): &(Pendulum<Dd>, Dd),
    launch: &Launch,
) -> IntegratorState {
    let mut state = at_rest(config, launch.angle);
    let speed = launch.speed.map(|speed| speed * *unit_secs);
    if config.method.step_secs().is_some() {
        [state.numbers[2], state.numbers[3]] = speed.map(Dd::to_f64);
        return state;
    }
    let [[x1, y1], [x2, y2]] = vectors(config, launch.angle);
    let coupling = reduced.c * (x1 * x2 + y1 * y2);
    let momenta =
        [reduced.a * speed[0] + coupling * speed[1], coupling * speed[0] + reduced.b * speed[1]];
    for (i, momentum) in momenta.into_iter().enumerate() {
        [state.numbers[4 + i], state.numbers[10 + i]] = parts(momentum, config.precision);
    }
    state
}

/// Returns the state of a pendulum at the end of its first moments or, for fixed steps, at its
/// launch, with angles on the pendulum's side of the top.
fn beside_top(job: &Job, reduced: &(Pendulum<Dd>, Dd), moments: &FirstMoments) -> IntegratorState {
    let config = &job.config;
    if config.method.step_secs().is_some() {
        return thrown(config, reduced, &moments.launch(reduced.1));
    }
    let phase = match config.precision {
        Precision::F32 | Precision::F64 => moments.end(&reduced.0.to_f64()).map(Dd::new),
        Precision::Df32 | Precision::Dd => moments.precise_end(&reduced.0),
    };
    let mut numbers = [0.0; NUMBERS];
    for (i, value) in phase.into_iter().enumerate() {
        [numbers[i], numbers[6 + i]] = parts(value, config.precision);
    }
    [numbers[TIME], numbers[TIME_LOW]] = time_parts(config, [moments.length, 0.0]);
    numbers[STEP] = control::FIRST;
    let counts = job.question.counts() && !job.keep.ends.are_carried();
    let carried = counts.then(|| Box::new(Carried::Counts(moments.gathered())));
    IntegratorState { carried, ..IntegratorState::new(0, numbers) }
}

/// Refuses starts that do not carry the quantities that the job returns.
pub(super) fn check_carried(job: &Job) -> Result<(), EngineError> {
    let carries = |state: &IntegratorState| match (job.keep.ends, state.carried.as_deref()) {
        (Needs::Growth, carried) => matches!(carried, Some(Carried::Tangents { .. })),
        (Needs::Extremum(_), carried) => matches!(carried, Some(Carried::Extremum(_))),
        (Needs::Outcome | Needs::End, _) => true,
    };
    let is_possible = match &job.starts {
        Starts::Rest(_) | Starts::Upright(_) | Starts::Thrown(_) | Starts::Mixed { .. } => true,
        Starts::Resumed { states, .. } => states.iter().all(carries),
        Starts::Moving(moving) => match job.keep.ends {
            Needs::Growth => moving.states.iter().all(|moving| moving.nudges.is_some()),
            Needs::Extremum(_) => false,
            Needs::Outcome | Needs::End => true,
        },
        Starts::Deep(_) => !job.keep.ends.is_extreme(),
    };
    if is_possible {
        return Ok(());
    }
    let why = "what a question gathers along the way can be continued only from the release";
    Err(EngineError::Unsupported(why.to_string()))
}

/// The states in which a job's pendulums begin, with everything that they carry along.
pub(crate) fn states(job: &Job) -> Result<Vec<IntegratorState>, EngineError> {
    let (reduced, _) = job.question.reduced();
    if let (Starts::Moving(moving), Needs::Growth) = (&job.starts, job.keep.ends) {
        let pace = job.pace()?;
        let nudged = moving.states.iter().map(|moving| {
            let nudges = moving.nudges.as_ref()?;
            Some(nudged_on_its_way(&reduced, (&job.config, &pace), moving, nudges))
        });
        return Ok(nudged.flatten().collect());
    }
    let states = plain_states(job)?;
    if !job.keep.ends.are_carried() {
        return Ok(states);
    }
    let pace = Pace::new(&job.question, &job.config)?;
    let begun = |state: IntegratorState| match (&state.carried, job.keep.ends) {
        (Some(_), _) | (None, Needs::Outcome | Needs::End) => state,
        (None, Needs::Growth) => with_tangents(&reduced, (&job.config, &pace), &state),
        (None, Needs::Extremum(extremum)) => with_start(&reduced, &pace, extremum, state),
    };
    Ok(states.into_iter().map(begun).collect())
}

/// Returns a start with the search for an extreme, kept as unit vectors and momenta for fixed
/// steps, too.
fn with_start(
    reduced: &Pendulum<f64>,
    pace: &Pace,
    extremum: Extremum,
    state: IntegratorState,
) -> IntegratorState {
    let start = phase_at(reduced, pace, &state);
    let best = Measure::new(extremum, *reduced, start).begun();
    let counts = extremum.counts_from_release();
    let carried = Some(Box::new(Carried::Extremum(Sought { start, counts, best })));
    let mut numbers = state.numbers;
    if let Pace::Fixed(steps) = pace {
        numbers = [0.0; NUMBERS];
        numbers[..6].copy_from_slice(&start);
        numbers[STEP] = steps.length;
    }
    IntegratorState { numbers, carried, ..state }
}

/// Returns a start with its own tangents, kept as unit vectors and momenta for fixed steps, too.
fn with_tangents(
    reduced: &Pendulum<f64>,
    (config, pace): (&IntegratorConfig, &Pace),
    start: &IntegratorState,
) -> IntegratorState {
    let phase = phase_at(reduced, pace, start);
    let mut numbers = [0.0; NUMBERS];
    if config.precision == Precision::Dd {
        // The start keeps all its digits; the tangents need no more than f64.
        numbers = start.numbers;
    } else {
        numbers[..6].copy_from_slice(&phase);
    }
    numbers[STEP] = match pace {
        Pace::Fixed(steps) => steps.length,
        Pace::Adaptive(_) => control::FIRST,
    };
    let slopes = released(reduced, &phase).map(|number| number.slope);
    let carried = Carried::Tangents { slopes, log_scale: 0.0 };
    IntegratorState { steps: 0, numbers, carried: Some(Box::new(carried)) }
}

/// The state of a pendulum that is already in motion, with its tangents.
fn nudged_on_its_way(
    reduced: &Pendulum<f64>,
    (config, pace): (&IntegratorConfig, &Pace),
    moving: &Moving,
    nudges: &TangentMap,
) -> IntegratorState {
    let mut numbers = [0.0; NUMBERS];
    numbers[..6].copy_from_slice(&moving.phase);
    [numbers[TIME], numbers[TIME_LOW]] = time_parts(config, moving.time);
    numbers[STEP] = match pace {
        Pace::Fixed(steps) => steps.length,
        Pace::Adaptive(_) => moving.step,
    };
    let (slopes, log_scale) = nudges.slopes(reduced, &moving.phase);
    let carried = Some(Box::new(Carried::Tangents { slopes, log_scale }));
    IntegratorState { steps: 0, numbers, carried }
}

/// The states of pendulums released from rest at angles in rad, each within (−π, π].
pub(super) fn at_rest_at(config: &IntegratorConfig, angles: &[[Dd; 2]]) -> Vec<IntegratorState> {
    angles.par_iter().with_min_len(1 << 10).map(|angle| at_rest(config, *angle)).collect()
}

fn plain_states(job: &Job) -> Result<Vec<IntegratorState>, EngineError> {
    let Job { question, config, .. } = job;
    match &job.starts {
        Starts::Resumed { states, .. } => Ok(states.clone()),
        Starts::Rest(angles) => Ok(at_rest_at(config, angles)),
        Starts::Upright(upright) => Ok(at_rest_at(config, &upright.listed())),
        Starts::Thrown(launches) => {
            let reduced = question.reduced_in();
            Ok(launches.iter().map(|launch| thrown(config, &reduced, launch)).collect())
        }
        Starts::Mixed { starts, .. } => {
            let reduced = question.reduced_in();
            let state = |start: &Onset| match start {
                Onset::Launch(launch) => thrown(config, &reduced, launch),
                Onset::BesideTop(moments) => beside_top(job, &reduced, moments),
            };
            Ok(starts.iter().map(state).collect())
        }
        Starts::Moving(moving) => {
            let pace = Pace::new(question, config)?;
            let states = moving.states.iter();
            Ok(states.map(|moving| on_its_way(question, config, &pace, moving)).collect())
        }
        Starts::Deep(_) => {
            let why = "starts of a deep zoom have to be followed before they are integrated";
            Err(EngineError::Unsupported(why.to_string()))
        }
    }
}

/// The state of a pendulum that is already in motion.
fn on_its_way(
    question: &EventSpec,
    config: &IntegratorConfig,
    pace: &Pace,
    moving: &Moving,
) -> IntegratorState {
    let mut numbers = [0.0; NUMBERS];
    match pace {
        Pace::Adaptive(_) => {
            for (i, value) in moving.phase.into_iter().enumerate() {
                [numbers[i], numbers[6 + i]] = parts(Dd::new(value), config.precision);
            }
            [numbers[TIME], numbers[TIME_LOW]] = time_parts(config, moving.time);
            numbers[STEP] = moving.step;
            IntegratorState::new(0, numbers)
        }
        Pace::Fixed(steps) => {
            let (reduced, _) = question.reduced();
            // Goes back to the end of the last whole step.
            let count = (moving.time[0] / steps.length).floor();
            let back = count * steps.length - moving.time[0] - moving.time[1];
            let scale = reduced.momentum_scale().map(|scale| 1.0 / scale);
            let trial = Dop853::trial(&reduced, scale, &moving.phase, back);
            let phase = plus(&moving.phase, &trial.change);
            for i in 0..2 {
                let angle = phase[2 * i + 1].atan2(phase[2 * i]);
                [numbers[i], numbers[4 + i]] = parts(Dd::new(angle), config.precision);
                numbers[2 + i] = reduced.speeds(&phase)[i];
            }
            IntegratorState::new(count as u32, numbers)
        }
    }
}

/// The unit vectors and momenta of an adaptive state, as the nearest f64.
pub(crate) fn phase_of(numbers: &[f64; NUMBERS]) -> Phase<f64> {
    std::array::from_fn(|i| numbers[i] + numbers[6 + i])
}

/// The angles of a fixed-step state in rad, as the nearest f64.
pub(crate) fn angles_of(numbers: &[f64]) -> [f64; 2] {
    [numbers[0] + numbers[4], numbers[1] + numbers[5]]
}

/// Returns the unit vectors and momenta of a state. A state with tangents, or with the
/// search for an extreme, is kept in this form for fixed steps, too.
pub(crate) fn phase_at(
    reduced: &Pendulum<f64>,
    pace: &Pace,
    state: &IntegratorState,
) -> Phase<f64> {
    let IntegratorState { numbers, carried, .. } = state;
    match (pace, carried.as_deref()) {
        (Pace::Adaptive(_), _) => phase_of(numbers),
        (_, Some(Carried::Tangents { .. } | Carried::Extremum(_))) => phase_of(numbers),
        (Pace::Fixed(_), _) => {
            let speed = [numbers[2], numbers[3]];
            reduced.phase(&State { angle: angles_of(numbers), speed })
        }
    }
}

/// Returns the end of a pendulum: the state `left` or, if it flipped in the next step, the flip.
/// `flipped` is the moment of the flip: the reduced time for adaptive steps, the fraction of that
/// step for fixed ones.
pub(crate) fn end(
    reduced: &Pendulum<f64>,
    (config, pace): (&IntegratorConfig, &Pace),
    left: &IntegratorState,
    flipped: Option<f64>,
    clearance: f64,
) -> FinalState {
    let numbers = &left.numbers;
    let begin = phase_at(reduced, pace, left);
    let counts = left.counts();
    let (from, turns) = match pace {
        Pace::Adaptive(_) => (numbers[TIME] + numbers[TIME_LOW], counts.turns),
        Pace::Fixed(steps) => {
            let turns = angles_of(numbers).map(whole_turns);
            (f64::from(left.steps) * steps.length, turns)
        }
    };
    let time = match (pace, flipped) {
        (_, None) => from,
        (Pace::Adaptive(_), Some(time)) => time,
        (Pace::Fixed(steps), Some(fraction)) => from + fraction * steps.length,
    };
    let change = match config.method {
        // Taylor steps are too long for any other method.
        Method::Taylor { .. } => Expansion::expand(reduced, &begin).change(time - from),
        Method::Rk4 { .. } | Method::Embedded { .. } | Method::Extrapolation { .. } => {
            let scale = reduced.momentum_scale().map(|scale| 1.0 / scale);
            Dop853::trial(reduced, scale, &begin, time - from).change
        }
    };
    let gathered = Accumulators { turns, ..counts };
    FinalState { time, phase: plus(&begin, &change), clearance, gathered, ..FinalState::NOWHERE }
}

/// Returns the end of a pendulum with tangents, with the growth of the nudge that has grown most.
pub(crate) fn end_with_growth(reduced: &Pendulum<f64>, left: &IntegratorState) -> FinalState {
    let (phase, slopes) = (phase_of(&left.numbers), left.slopes());
    let state: Tangents<f64> = std::array::from_fn(|i| Dual { value: phase[i], slope: slopes[i] });
    let log_growth = log_growth(reduced, &state) + left.log_scale();
    let gathered = Accumulators { log_growth, ..Accumulators::NONE };
    FinalState {
        time: left.numbers[TIME] + left.numbers[TIME_LOW],
        phase,
        gathered,
        ..FinalState::NOWHERE
    }
}

/// The end of a pendulum whose extreme has been looked for.
pub(crate) fn end_with_extremum(left: &IntegratorState) -> FinalState {
    let (time, phase) = (left.numbers[TIME] + left.numbers[TIME_LOW], phase_of(&left.numbers));
    let gathered = Accumulators { extremum: left.sought().best, ..Accumulators::NONE };
    FinalState { time, phase, gathered, ..FinalState::NOWHERE }
}

/// Number of whole turns in an angle (rad) that began in (−π, π].
pub fn whole_turns(angle: f64) -> i32 {
    ((angle - PI) / TAU).ceil() as i32
}
