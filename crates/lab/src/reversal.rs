//! Time reversed: all speeds of a pendulum are turned round, and it is followed on its way back,
//! once by RK4 in steps of 1/120 s and once in double-double.

use super::chart::{AxisScale, Chart, ChartAxis, Curve};
use super::drawing::Tint;
use flipmap_numbers::number_text::{fixed, significant};
use flipmap_numbers::trig::Turning;
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::integrator::rk4;
use flipmap_pendulum::separation::{Growth, Reading, Ruler, SATURATED_RAD};
use flipmap_pendulum::taylor::Orbit;
use flipmap_pendulum::{Pendulum, State};
use flipmap_scene::PendulumSpec;

/// Number of RK4 steps per second, as in the lesson.
const STEPS_A_SEC: f64 = 120.0;
/// Seconds of the way back that a trail shows.
const PAST_SECS: f64 = 4.0;
/// Most seconds of the way out; the gold standard takes about a millisecond for each.
pub(super) const MAX_OUT_SECS: f64 = 120.0;

/// The ways back of a pendulum whose speeds were turned round.
#[derive(Clone, Debug)]
pub(super) struct Reversal {
    /// Seconds from the start to the turn.
    pub out_secs: f64,
    /// The way back by RK4.
    pub by_rk4: WayBack,
    /// The way back in double-double.
    pub exact: WayBack,
}

/// A way back, at equal times since the turn.
#[derive(Clone, Debug)]
pub(super) struct WayBack {
    /// The states.
    states: Vec<State<f64>>,
    /// Distances in phase space from the way out.
    readings: Vec<Reading>,
    /// The fitted growth of the distance.
    growth: Option<Growth>,
    /// Seconds from the turn to the moment at which the way is lost: the pendulum moves
    /// independently of its way out from there on.
    lost_secs: Option<f64>,
}

impl Reversal {
    /// Follows a pendulum in double-double from `start` for about `out_secs`, turns its speeds
    /// round, and follows it back by both methods.
    pub(super) fn new(build: &PendulumSpec, start: State<f64>, out_secs: f64) -> Self {
        let steps = (out_secs.min(MAX_OUT_SECS) * STEPS_A_SEC).round().max(1.0) as usize;
        let (pendulum, exact) = (build.pendulum(), build.pendulum_in::<Dd>());
        let ruler = Ruler::new(&pendulum);
        let out = exact_path(exact, wide(&start), steps);
        let turn = turned(&out[steps]);
        let by_rk4: Vec<State<Dd>> =
            rk4_path(&pendulum, &narrow(&turn), steps).iter().map(wide).collect();
        let exact = exact_path(exact, turn, steps);
        Reversal {
            out_secs: steps as f64 / STEPS_A_SEC,
            by_rk4: WayBack::along(&out, &by_rk4, &ruler),
            exact: WayBack::along(&out, &exact, &ruler),
        }
    }

    /// Returns a chart of both distances against the time since the turn, up to `now_secs`.
    pub(super) fn chart(&self, now_secs: f64, tint: &Tint) -> Chart {
        let curve = |way: &WayBack| -> Vec<[f64; 2]> {
            let past = way.readings.iter().take_while(|reading| reading.secs <= now_secs);
            let apart = past.filter(|reading| reading.separation_rad > 0.0);
            apart.map(|reading| [reading.secs, reading.separation_rad]).collect()
        };
        let mut curves = vec![
            Curve::line("RK4, 1/120 s", tint.parts[0], curve(&self.by_rk4)),
            Curve::line("double-double", tint.parts[1], curve(&self.exact)),
        ];
        if let Some(growth) = self.by_rk4.growth.filter(|growth| now_secs > growth.until_secs) {
            let line = [0.0, growth.until_secs].map(|t| [t, growth.separation_rad(t)]).to_vec();
            curves.push(Curve::guide("e^(λt)", tint.ink, line));
        }
        let lost = vec![[0.0, SATURATED_RAD], [self.out_secs, SATURATED_RAD]];
        curves.push(Curve::guide("lost", tint.faint, lost));
        Chart {
            across: ChartAxis::new(
                "time since the turn, s",
                0.0..=self.out_secs,
                AxisScale::Linear,
            ),
            up: ChartAxis::new("distance from the way out, rad", 1e-32..=1e2, AxisScale::Log),
            curves,
            marks: Vec::new(),
        }
    }

    /// Says what has been seen `secs` after the turn: when and why the way was lost, and who is back.
    pub(super) fn words(&self, secs: f64) -> String {
        let rk4 = match self.by_rk4.lost_secs.filter(|lost| *lost <= secs) {
            Some(lost) => {
                let lost = fixed(lost, 1);
                let why = self.by_rk4.growth.filter(|growth| growth.rate_per_sec > 0.0);
                let why = why.map_or(String::new(), |growth| {
                    let times = fixed(1.0 / growth.rate_per_sec, 2);
                    format!(": its errors are multiplied by e every {times} s")
                });
                format!("RK4 in steps of 1/120 s was lost {lost} s after the turn{why}.")
            }
            None if secs < self.out_secs => {
                "RK4 in steps of 1/120 s is on its way back.".to_string()
            }
            None => "RK4 in steps of 1/120 s is back as well: make the way longer.".to_string(),
        };
        if secs < self.out_secs {
            return rk4;
        }
        let home = self.exact.readings.last().map_or(0.0, |last| last.separation_rad);
        let exact = match self.exact.lost_secs {
            None => format!("In double-double it is back, {} rad off.", significant(home, 2)),
            Some(lost) => format!("In double-double it was lost after {} s.", fixed(lost, 1)),
        };
        format!("{rk4} {exact}")
    }
}

impl WayBack {
    /// Measures a way back against the way out.
    fn along(out: &[State<Dd>], back: &[State<Dd>], ruler: &Ruler) -> Self {
        let reading = |(k, state): (usize, &State<Dd>)| Reading {
            secs: k as f64 / STEPS_A_SEC,
            energy_error: 0.0,
            separation_rad: ruler.distance(&turned(state), &out[out.len() - 1 - k]),
        };
        let readings: Vec<Reading> = back.iter().enumerate().map(reading).collect();
        let apart = readings.iter().filter(|reading| reading.separation_rad > 0.0);
        let growth = Growth::fit(&apart.copied().collect::<Vec<_>>());
        let lost = readings.iter().find(|reading| reading.separation_rad > SATURATED_RAD);
        let lost_secs = lost.map(|reading| reading.secs);
        WayBack { states: back.iter().map(narrow).collect(), readings, growth, lost_secs }
    }

    /// Returns the states of the last seconds before `secs` after the turn.
    pub(super) fn past(&self, secs: f64) -> &[State<f64>] {
        let step = |secs: f64| ((secs * STEPS_A_SEC) as usize).min(self.states.len() - 1);
        &self.states[step((secs - PAST_SECS).max(0.0))..=step(secs)]
    }

    /// Returns the state `secs` after the turn, between two steps on a straight line.
    pub(super) fn state_at(&self, secs: f64) -> State<f64> {
        let last = self.states.len() - 1;
        let at = (secs * STEPS_A_SEC).clamp(0.0, last as f64);
        let (k, share) = (at.floor() as usize, at.fract());
        let (from, to) = (self.states[k], self.states[(k + 1).min(last)]);
        let between = |from: [f64; 2], to: [f64; 2]| {
            [0, 1].map(|bob| from[bob] + share * (to[bob] - from[bob]))
        };
        State { angle: between(from.angle, to.angle), speed: between(from.speed, to.speed) }
    }
}

/// Returns the states at the ends of `steps` steps, and the first.
fn rk4_path(pendulum: &Pendulum<f64>, start: &State<f64>, steps: usize) -> Vec<State<f64>> {
    let mut path = vec![*start];
    for k in 0..steps {
        let change = rk4(pendulum, &path[k], 1.0 / STEPS_A_SEC, Turning::Fresh);
        path.push(path[k].plus(&change));
    }
    path
}

/// Returns the states at the same times by Taylor expansions in double-double.
fn exact_path(pendulum: Pendulum<Dd>, start: State<Dd>, steps: usize) -> Vec<State<Dd>> {
    let mut orbit = Orbit::new(pendulum, start);
    (0..=steps).map(|k| orbit.state_at(Dd::new(k as f64) / Dd::new(STEPS_A_SEC))).collect()
}

/// Returns a state with its speeds turned round.
fn turned(state: &State<Dd>) -> State<Dd> {
    State { angle: state.angle, speed: state.speed.map(|speed| -speed) }
}

fn wide(state: &State<f64>) -> State<Dd> {
    State { angle: state.angle.map(Dd::new), speed: state.speed.map(Dd::new) }
}

fn narrow(state: &State<Dd>) -> State<f64> {
    State { angle: state.angle.map(Dd::to_f64), speed: state.speed.map(Dd::to_f64) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::EngineKind;
    use flipmap_engine::choice::EngineRequest;
    use flipmap_render::tiles::Renderer;
    use flipmap_scene::Document;

    fn reversal(out_secs: f64) -> Reversal {
        Reversal::new(&PendulumSpec::default(), State::rest([2.2, 2.5]), out_secs)
    }

    #[test]
    fn double_double_finds_back_where_rk4_is_lost() {
        let reversal = reversal(25.0);
        let home = reversal.exact.states.last().unwrap();
        assert!((home.angle[0] - 2.2).abs() < 1e-12 && (home.angle[1] - 2.5).abs() < 1e-12);
        assert_eq!(reversal.exact.lost_secs, None);
        let lost = reversal.by_rk4.lost_secs.expect("RK4 loses its way");
        assert!(lost > 3.0 && lost < 25.0, "{lost}");
        assert_eq!(reversal.words(0.5), "RK4 in steps of 1/120 s is on its way back.");
        assert!(
            reversal.words(lost + 0.1).contains("was lost")
                && !reversal.words(24.0).contains("double")
        );
        assert!(reversal.words(25.0).contains("In double-double it is back"));
        let near = self::reversal(1.0);
        assert_eq!(near.by_rk4.lost_secs, None, "a short way is found");
    }

    #[test]
    fn the_way_is_lost_when_the_growth_of_errors_says() {
        // The growth is that of two pendulums in double-double which start a hair apart at the turn.
        let reversal = reversal(30.0);
        let pendulum = PendulumSpec::default().pendulum_in::<Dd>();
        let out = exact_path(pendulum, wide(&State::rest([2.2, 2.5])), 3600);
        let turn = turned(&out[3600]);
        let mut nudged = turn;
        nudged.angle[0] = nudged.angle[0] + Dd::new(1e-18);
        let [own, other] = [turn, nudged].map(|start| exact_path(pendulum, start, 3600));
        let ruler = Ruler::new(&PendulumSpec::default().pendulum());
        let apart = |k: usize| ruler.distance(&own[k], &other[k]);
        let lost = reversal.by_rk4.lost_secs.unwrap();
        let k = (lost * STEPS_A_SEC) as usize;
        let rate = (apart(k) / apart(240)).ln() / (lost - 2.0);
        // What RK4 has made of its errors after two seconds grows from there.
        let error = reversal.by_rk4.readings[240].separation_rad;
        let horizon = 2.0 + (SATURATED_RAD / error).ln() / rate;
        assert!((horizon / lost - 1.0).abs() < 0.2, "{horizon} for {lost}");
    }

    #[test]
    fn twins_part_at_the_rate_that_the_question_growth_tells() {
        // The angle of the release in which a nudge grows most, as the question has it.
        let parted = |bob: usize| {
            let pendulum = PendulumSpec::default().pendulum_in::<Dd>();
            let own = wide(&State::rest([2.2, 2.5]));
            let mut other = own;
            other.angle[bob] = other.angle[bob] + Dd::new(1e-18);
            let steps = (25.0 * STEPS_A_SEC) as usize;
            let [own, other] = [own, other].map(|start| exact_path(pendulum, start, steps));
            let ruler = Ruler::new(&PendulumSpec::default().pendulum());
            (ruler.distance(&own[steps], &other[steps]) / 1e-18).ln() / 25.0
        };
        let text = "[question]\nask = \"growth\"\nbudget = 25.0\n\
                    [view]\ncenter = [\"2.2\", \"2.5\"]\nwidth = \"1e-9\"";
        let scene = Document::parse(text).unwrap().scene();
        let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
        let samples = Renderer::new(&request).unwrap().render(&scene, [1, 1]).unwrap();
        let (told, seen) = (samples.values(0)[0], parted(0).max(parted(1)));
        assert!((seen / told - 1.0).abs() < 0.03, "{seen} for {told}");
    }

    #[test]
    fn states_lie_between_steps() {
        let way = reversal(2.0).by_rk4;
        assert_eq!(way.state_at(0.5).angle, way.states[60].angle);
        let middle = way.state_at(0.5 + 0.5 / STEPS_A_SEC);
        assert!(
            (middle.angle[0] - 0.5 * (way.states[60].angle[0] + way.states[61].angle[0])).abs()
                < 1e-15
        );
        assert_eq!(way.state_at(99.0).angle, way.states[240].angle);
    }
}
