//! True answers of pixels by the referee, in as many digits as it takes until two of them agree, and the
//! verdict on a given answer.

use super::referee::{MotionEnd, Referee};
use super::start::start;
use flipmap_engine::{EventSpec, FinalState};
use flipmap_numbers::{Angle, Dd, Exact, Fixed, Scalar};
use flipmap_pendulum::opening::from_top;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::{Accumulators, Outcome, Pendulum, Rule, State, Status, oracle, tangents};
use flipmap_render::tiles::reader::Reader;
use flipmap_scene::question::MAX_CHANNELS;
use flipmap_scene::question::Needs;
use flipmap_scene::{PlaneKind, Scene};

/// Function that returns true when the referee should give up.
pub(super) type GiveUp<'a> = &'a (dyn Fn() -> bool + Sync);

/// An answer: a status, and the values of the question's channels.
pub(super) type Answer = (Status, [f64; MAX_CHANNELS]);

/// The referee's verdict on an answer.
pub(super) enum RefereeVerdict {
    Right,
    Wrong(Answer),
    Untold,
}

/// A scene whose pixels are judged.
pub(super) struct Judged<'a> {
    scene: &'a Scene,
    question: EventSpec,
    reader: Reader,
    side: u32,
    /// True if f64 cannot distinguish the pixels well enough to judge them.
    pub deep: bool,
}

/// The digits of an integration: columns of the extrapolation, and error allowed in a step.
type Digits = (usize, f64);

/// Distance from the top in rad below which only long numbers tell a bob's side.
const BESIDE_TOP: f64 = 1e-20;
/// Decades by which neighbours move apart per unit of time, at most.
const DECADES_A_UNIT: f64 = 0.16;

impl<'a> Judged<'a> {
    /// A checked scene, in windows of `side` × `side` pixels.
    pub(super) fn new(scene: &'a Scene, side: u32) -> Self {
        let question = EventSpec::from(scene);
        let reader = Reader::new(scene.question.ask, &question);
        let width = scene.view.width_rad().to_f64() / scene.view.stretch.max(1.0);
        Judged { scene, question, reader, side, deep: width < 1e-9 }
    }

    /// Judges the answer of a pixel.
    pub(super) fn verdict(
        &self,
        pixel: [u32; 2],
        given: &Answer,
        give_up: GiveUp,
    ) -> RefereeVerdict {
        let Some(start) = start(self.scene, self.side, pixel) else {
            return match given.0 {
                Status::Forbidden => RefereeVerdict::Right,
                _ => RefereeVerdict::Wrong((Status::Forbidden, [0.0; MAX_CHANNELS])),
            };
        };
        let judge = |truth: Option<Answer>, other: Option<Answer>| match (truth, other) {
            (Some(truth), Some(other)) if self.is_same(&truth, &other, 0.01) => {
                let right = self.is_same(given, &truth, 1.0);
                Some(if right { RefereeVerdict::Right } else { RefereeVerdict::Wrong(truth) })
            }
            _ => None,
        };
        let nearest = start.angle.map(|angle| from_top(angle).to_f64().abs());
        let is_lost = nearest.iter().any(|&by| by > 0.0 && by < BESIDE_TOP);
        if !self.deep && !is_lost {
            // Far fewer digits than the truth has, but a wrong answer is not confirmed by accident.
            let agrees =
                |truth: Option<Answer>| truth.is_some_and(|truth| self.is_same(given, &truth, 0.2));
            if self.reader.ends() != Needs::Growth
                && (agrees(self.truth::<f64>(&start, (8, 5e-14), give_up))
                    || agrees(self.truth::<Dd>(&start, (11, 1e-27), give_up)))
            {
                return RefereeVerdict::Right;
            }
            let short = self.truth::<Fixed<3>>(&start, (13, 1e-33), give_up);
            let long = self.truth::<Fixed<4>>(&start, (16, 1e-50), give_up);
            if let Some(verdict) = judge(long, short) {
                return verdict;
            }
        }
        let long = self.truth::<Fixed<6>>(&start, (22, 1e-85), give_up);
        let longest = self.truth::<Fixed<8>>(&start, (28, 1e-120), give_up);
        judge(longest, long).unwrap_or(RefereeVerdict::Untold)
    }

    /// Returns true if two answers agree within `share` of what is right.
    fn is_same(&self, a: &Answer, b: &Answer, share: f64) -> bool {
        let kind = self.scene.question.ask.kind();
        // An extreme may be one of two that are as far.
        let count = if self.reader.ends().is_extreme() { 1 } else { kind.channels.len() };
        let unit_secs = self.scene.build.unit_secs();
        let mut channels = kind.channels[..count].iter().zip(a.1.iter().zip(b.1));
        a.0 == b.0
            && (a.0 != Status::Answered
                || channels.all(|(channel, (a, b))| channel.is_right(*a, b, share, unit_secs)))
    }

    /// The answer to a start in a number type's digits, or `None` if it cannot be decided in them.
    fn truth<T: Scalar + Angle>(
        &self,
        start: &State<Exact>,
        digits: Digits,
        give_up: GiveUp,
    ) -> Option<Answer> {
        if self.is_forbidden(start) {
            return Some((Status::Forbidden, [0.0; MAX_CHANNELS]));
        }
        let at_rest = start.speed == [Exact::ZERO; 2];
        if at_rest && oracle::is_balanced(start.angle) && self.question.rule != Rule::Neither {
            let end = FinalState { time: 0.0, ..FinalState::NOWHERE };
            return Some(self.reader.read(&Outcome::without_time(Status::Unflipped), &end));
        }
        let (exact, unit_secs) = self.scene.build.reduced_in::<Exact>();
        let pendulum = exact.map(T::from_theta);
        let phase = phase_of(&exact, start, unit_secs).map(T::from_theta);
        let bobs = match self.question.rule {
            Rule::Neither => Rule::Either.watched(),
            rule => rule.watched(),
        };
        let passes =
            if self.question.rule == Rule::Neither { u32::MAX } else { self.question.passes };
        let budget = Exact::from_f64(self.question.budget_secs) / unit_secs;
        let extremum = match self.reader.ends() {
            Needs::Extremum(extremum) => Some(extremum),
            Needs::Outcome | Needs::End | Needs::Growth => None,
        };
        let referee = Referee {
            pendulum,
            extremum,
            bobs,
            passes,
            budget: T::from_theta(budget),
            columns: digits.0,
            tolerance: digits.1,
            give_up,
        };
        let end = referee.end(&phase)?;
        let log_growth = match self.reader.ends() {
            Needs::Growth => self.log_growth(&referee, start, &end)?,
            Needs::Outcome | Needs::End | Needs::Extremum(_) => 0.0,
        };
        Some(self.answer(&end, log_growth, unit_secs.to_f64()))
    }

    fn answer<T: Scalar>(&self, end: &MotionEnd<T>, log_growth: f64, unit_secs: f64) -> Answer {
        let [first_left, first_right, second_left, second_right] = end.passes.map(i64::from);
        let turns = [first_left - first_right, second_left - second_right].map(|by| by as i32);
        let gathered =
            Accumulators { turns, passes: end.passes, extremum: end.extremum, log_growth };
        let time = end.time.to_f64();
        let outcome = match end.flipped {
            true => Outcome::flipped(time * unit_secs),
            false => Outcome::without_time(Status::Unflipped),
        };
        let end =
            FinalState { time, phase: end.phase.map(T::to_f64), gathered, ..FinalState::NOWHERE };
        self.reader.read(&outcome, &end)
    }

    fn is_forbidden(&self, start: &State<Exact>) -> bool {
        let rule = self.question.rule;
        let pendulum = self.scene.build.pendulum_in::<Exact>();
        let energy = match self.scene.plane.kind {
            PlaneKind::Section => Exact::from_f64(self.scene.plane.energy),
            PlaneKind::Axes(_) => pendulum.energy(start),
        };
        rule != Rule::Neither && pendulum.forbids_depth(rule, -energy)
    }

    /// Natural logarithm of the growth of the largest of all nudges, by motions that begin beside this
    /// one; `None` if they cannot be followed in these digits.
    fn log_growth<T: Scalar + Angle>(
        &self,
        referee: &Referee<T>,
        start: &State<Exact>,
        end: &MotionEnd<T>,
    ) -> Option<f64> {
        let (exact, unit_secs) = self.scene.build.reduced_in::<Exact>();
        let units = self.question.budget_secs / unit_secs.to_f64();
        let exponent = (DECADES_A_UNIT * units).ceil() + 8.0;
        if 10f64.powf(-exponent) < 1e4 * referee.tolerance {
            return None;
        }
        let by = Exact::parse(&format!("1e-{exponent}"))?;
        let plain = Referee { bobs: &[], give_up: referee.give_up, ..*referee };
        let column = |k: usize| {
            let mut moved = *start;
            match k {
                0 | 1 => moved.angle[k] = moved.angle[k] + by,
                _ => moved.speed[k - 2] = moved.speed[k - 2] + by / unit_secs,
            }
            let phase = phase_of(&exact, &moved, unit_secs).map(T::from_theta);
            let moved = plain.end(&phase)?.phase;
            Some(difference(&referee.pendulum, &end.phase, &moved, T::from_theta(by)))
        };
        let columns = [column(0)?, column(1)?, column(2)?, column(3)?];
        Some(tangents::largest_singular_value(columns).ln())
    }
}

/// The differences of two near states in both angles and both reduced speeds, over `by`.
fn difference<T: Scalar>(
    pendulum: &Pendulum<T>,
    from: &Phase<T>,
    to: &Phase<T>,
    by: T,
) -> [f64; 4] {
    let turned = |bob: usize| {
        let (x, y) = (2 * bob, 2 * bob + 1);
        from[x] * to[y] - from[y] * to[x]
    };
    let (before, after) = (pendulum.speeds(from), pendulum.speeds(to));
    [turned(0), turned(1), after[0] - before[0], after[1] - before[1]].map(|d| (d / by).to_f64())
}

/// Unit vectors and momenta of a start, reduced. Beside the top, the distance from there has more digits
/// than the angle.
fn phase_of(pendulum: &Pendulum<Exact>, start: &State<Exact>, unit_secs: Exact) -> Phase<Exact> {
    let vectors = start.angle.map(|angle| {
        let (sin, cos) = from_top(angle).sin_cos();
        [-cos, -sin]
    });
    let [[x1, y1], [x2, y2]] = vectors;
    let [w1, w2] = start.speed.map(|speed| speed * unit_secs);
    let coupling = pendulum.c * (x1 * x2 + y1 * y2);
    [x1, y1, x2, y2, pendulum.a * w1 + coupling * w2, coupling * w1 + pendulum.b * w2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::Budget;
    use flipmap_scene::question::QuestionName;

    const SIDE: u32 = 4;

    /// A scene around (−2, 3), 10⁻³ rad wide, with another question.
    fn asked(ask: QuestionName) -> Scene {
        let mut scene = Scene::default();
        scene.view.center = ["-2".into(), "3".into()];
        scene.view.width = "1e-3".into();
        scene.question.ask = ask;
        scene.question.budget = Budget::secs(2.0);
        scene.checked().unwrap()
    }

    #[test]
    fn every_channel_of_every_question_can_be_wrong() {
        for ask in QuestionName::ALL {
            let (kind, scene) = (ask.kind(), asked(ask));
            let judged = Judged::new(&scene, SIDE);
            let start = start(&scene, SIDE, [1, 2]).unwrap();
            let truth = judged.truth::<Dd>(&start, (11, 1e-27), &|| false).unwrap();
            assert_eq!(truth.0, Status::Answered, "{}", kind.name);
            assert!(judged.is_same(&truth, &truth, 1.0), "{}", kind.name);
            assert!(!judged.is_same(&(Status::Unflipped, truth.1), &truth, 1.0), "{}", kind.name);
            let count = if judged.reader.ends().is_extreme() { 1 } else { kind.channels.len() };
            for (k, channel) in kind.channels[..count].iter().enumerate() {
                let mut moved = truth;
                moved.1[k] += 2.0 * channel.right * truth.1[k].abs().max(1.0) + 1e-3;
                assert!(!judged.is_same(&moved, &truth, 1.0), "{}: {}", kind.name, channel.name);
            }
        }
    }
}
