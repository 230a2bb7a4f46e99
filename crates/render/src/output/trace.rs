//! The motion of one pendulum as a table of rows at equal intervals, integrated by the gold
//! standard in double-double.

use super::trace_channels::TraceChannels;
use super::trace_table::TraceError;
use flipmap_numbers::{Dd, Exact, Scalar};
use flipmap_pendulum::first_moments::FirstPass;
use flipmap_pendulum::opening::Opening;
use flipmap_pendulum::passes::{Pass, passes_in};
use flipmap_pendulum::taylor::{Orbit, TaylorStep};
use flipmap_pendulum::{Pendulum, Rule, State};
use flipmap_scene::{Budget, Scene, SceneError, between, decimal_hint, in_rad, plain_numbers};

/// The result of [`Trace::advance`].
pub(super) enum Advance {
    /// The next row, in the order of [`Trace::columns`]; NaN where a channel has no value yet.
    Row(Vec<f64>),
    /// A step of the integration, without a row.
    Step,
    /// The end: every row has been returned.
    End,
}

/// A pendulum in motion, and the rows of its table.
///
/// ```
/// use flipmap_render::output::Trace;
/// use flipmap_scene::Scene;
///
/// let mut trace = Trace::from_text(&Scene::default(), "3,3", "2", "0.5")?;
/// let mut rows = 0;
/// trace.follow(&|_, _| true, &mut |_row| {
///     rows += 1;
///     Ok(())
/// })?;
/// assert_eq!(rows, 5);
/// assert!((trace.passes()[0].time.hi - 0.564_452_316_577_663_8).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Trace {
    pendulum: Pendulum<Dd>,
    orbit: Orbit<Dd>,
    /// The last step, while it still has rows.
    step: Option<TaylorStep<Dd>>,
    channels: TraceChannels,
    passes: Vec<Pass>,
    /// Passes in the first moments that are not in `passes` yet, and the end of the first moments
    /// in s.
    first: (Vec<Pass>, Dd),
    until: Dd,
    every: Dd,
    /// Number of the next row.
    row: u64,
    /// Energy at the start, in the pendulum's units.
    energy: Dd,
}

impl Trace {
    /// Releases a scene's pendulum at `start`: `θ1,θ2` or `θ1,θ2,ω1,ω2` in rad and rad/s, with
    /// angles also as in `-95deg,0.5pi`. The rows go from 0 to `until` in steps of `every`, both
    /// in s.
    pub fn from_text(
        scene: &Scene,
        start: &str,
        until: &str,
        every: &str,
    ) -> Result<Self, SceneError> {
        let launch = launch_from_text(start).ok_or_else(|| {
            let hint = decimal_hint(start, 2);
            let range = format!(
                "it must be two angles between -1e6 and 1e6 rad, separated by a comma, or these and \
                 two speeds between -1e6 and 1e6 rad/s{hint}"
            );
            SceneError::new("start", format!("'{start}'"), range)
        })?;
        let times = [secs_from_text("until", until)?, secs_from_text("every", every)?];
        let rows = (times[0] / times[1]).hi;
        if rows > MAX_ROWS {
            let range = format!("that gives {rows:.0e} rows in {until} s, of {MAX_ROWS:e} at most");
            return Err(SceneError::new("every", every, range));
        }
        Ok(Trace::new(scene, launch, times))
    }

    fn new(scene: &Scene, start: State<Exact>, [until, every]: [Dd; 2]) -> Self {
        let pendulum: Pendulum<Dd> = scene.build.pendulum_in();
        let (reduced, unit_secs) = scene.build.reduced_in::<Exact>();
        let bobs = Rule::Either.watched();
        let moments = Opening::new(&reduced, bobs, f64::INFINITY).precise_first_moments(&State {
            speed: start.speed.map(|speed| speed * unit_secs),
            ..start
        });
        let unit_secs = unit_secs.to_dd();
        let pass = |pass: &FirstPass| Pass {
            bob: pass.bob + 1,
            time: pass.time * unit_secs,
            anticlockwise: pass.anticlockwise,
        };
        let first = moments.passes.iter().map(pass).filter(|pass| pass.time <= until).collect();
        let start = State { angle: moments.angle, speed: start.speed.map(Exact::to_dd) };
        Trace {
            first: (first, Dd::new(moments.length) * unit_secs),
            channels: TraceChannels::new(scene, &start),
            energy: pendulum.energy(&start),
            orbit: Orbit::new(pendulum, start),
            step: None,
            passes: Vec::new(),
            row: 0,
            pendulum,
            until,
            every,
        }
    }

    /// Returns the names of the columns: time, angles, speeds, energy error, and the question's
    /// channels.
    pub fn columns(&self) -> Vec<&'static str> {
        let mut names = vec!["t", "theta1", "theta2", "omega1", "omega2", "energy_error"];
        names.extend(self.channels.names());
        names
    }

    /// Returns the passes of the top so far, in order of time.
    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// Returns the numbers of rows so far and in all.
    pub(super) fn rows(&self) -> [u64; 2] {
        [self.row, (self.until / self.every).hi as u64 + 1]
    }

    /// Returns the next row, or integrates another step.
    pub(super) fn advance(&mut self) -> Result<Advance, TraceError> {
        let time = self.every * Dd::new(self.row as f64);
        if let Some(step) = &self.step
            && time <= step.end()
            && time <= self.until
        {
            let state = step.state(time - step.start);
            self.row += 1;
            return Ok(Advance::Row(self.row_at(time, &state)));
        }
        if self.orbit.time() >= self.until {
            return Ok(Advance::End);
        }
        let step = self.orbit.step();
        if !self.orbit.state().speed[1].is_finite() {
            return Err(TraceError::NotFinite);
        }
        let told = self.passes.len();
        let (first, from) = (&mut self.first.0, self.first.1);
        self.passes.append(first);
        let is_new = |pass: &Pass| pass.time > from && pass.time <= self.until;
        self.passes.extend(passes_in(&step).into_iter().filter(is_new));
        self.channels.add(&step, &self.passes[told..]);
        self.step = Some(step);
        Ok(Advance::Step)
    }

    fn row_at(&mut self, time: Dd, state: &State<Dd>) -> Vec<f64> {
        let rise = self.pendulum.energy(state) - self.energy;
        let scale = self.pendulum.p + self.pendulum.q;
        let error = if scale.hi > 0.0 { (rise / scale).hi } else { 0.0 };
        let [theta1, theta2] = state.angle.map(|x| x.hi);
        let [omega1, omega2] = state.speed.map(|x| x.hi);
        let mut row = vec![time.hi, theta1, theta2, omega1, omega2, error];
        row.extend(self.channels.values(time, state));
        row
    }
}

/// Maximum number of rows in a table.
const MAX_ROWS: f64 = 1e8;

/// Reads a time in s.
fn secs_from_text(setting: &'static str, text: &str) -> Result<Dd, SceneError> {
    Dd::parse(&plain_numbers(text)).filter(|time| Budget::SECS.contains(&time.hi)).ok_or_else(
        || {
            let seconds = between(&Budget::SECS);
            let range =
                format!("it must be a number of seconds {seconds}{}", decimal_hint(text, 1));
            SceneError::new(setting, format!("'{text}'"), range)
        },
    )
}

/// Reads a start; `None` unless its numbers lie between -1e6 and 1e6.
fn launch_from_text(text: &str) -> Option<State<Exact>> {
    let text = plain_numbers(text);
    let numbers: Option<Vec<Exact>> =
        text.split(',').map(|part| Exact::parse(&in_rad(part))).collect();
    let numbers = numbers.filter(|all| all.iter().all(|number| number.to_f64().abs() <= 1e6))?;
    let (angle, speed) = match numbers[..] {
        [theta1, theta2] => ([theta1, theta2], [Exact::ZERO; 2]),
        [theta1, theta2, omega1, omega2] => ([theta1, theta2], [omega1, omega2]),
        _ => return None,
    };
    let near = |theta: Exact| if theta.abs() <= Exact::pi() { theta } else { theta.wrapped() };
    Some(State { angle: angle.map(near), speed })
}
