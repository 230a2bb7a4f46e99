//! Direct integration: the gold standard's answer to a start, computed from the release to the end
//! in as many digits as that needs. It shares no start map, no first moments, no rounding of
//! starts, no method and no event test with the engines.

use crate::{EventSpec, FinalState};
use flipmap_numbers::{Exact, Fixed, Scalar};
use flipmap_pendulum::taylor::Orbit;
use flipmap_pendulum::{Accumulators, Outcome, Pendulum, Rule, State, Status, oracle, tangents};
use flipmap_scene::question::Needs;

/// Approximate upper bound on the decades by which neighbours move apart per unit of time.
const DECADES_A_UNIT: f64 = 0.16;
/// Decimal digits that must be right at the end, and guard digits.
const DIGITS_AT_END: f64 = 12.0;
/// Decimal digits by which errors stay below the distance between neighbouring starts at all times,
/// so that it is decided from which of them a bob passes the top and from which it turns round.
const DIGITS_APART: f64 = 8.0;
/// Number of decades by which the displacement that measures the growth of nudges is below 1 at the
/// end.
const NUDGE_DIGITS: f64 = 8.0;

/// Returns the outcome of a start (angles in (−π, π] rad, speeds in rad/s) and its end. `ends`
/// selects the ends that the answer needs, and `apart_rad` is the distance to neighbouring starts.
/// Extremes along the motion are not computed.
pub fn answer(
    question: &EventSpec,
    ends: Needs,
    start: &State<Exact>,
    apart_rad: f64,
) -> (Outcome, FinalState) {
    let apart = DIGITS_APART - apart_rad.log10();
    match limbs(question, ends, start, apart) {
        0..=3 => Direct::<3>::new(question, start, apart).answer(ends),
        4 => Direct::<4>::new(question, start, apart).answer(ends),
        5 => Direct::<5>::new(question, start, apart).answer(ends),
        6 => Direct::<6>::new(question, start, apart).answer(ends),
        7 => Direct::<7>::new(question, start, apart).answer(ends),
        _ => Direct::<8>::new(question, start, apart).answer(ends),
    }
}

/// Returns true if direct integration of starts that are `apart_rad` away from their neighbours
/// takes seconds, because of its many digits.
pub fn takes_long(question: &EventSpec, apart_rad: f64) -> bool {
    let apart = DIGITS_APART - apart_rad.log10();
    limbs(question, Needs::Outcome, &State::rest([Exact::ZERO; 2]), apart) > MAX_LIMBS_IN_A_SECOND
}

/// Largest number of limbs in which a minute of the home pendulum takes less than a second.
const MAX_LIMBS_IN_A_SECOND: usize = 4;

/// Returns the number of limbs for the digits that a start needs: those for the growth of errors,
/// and those that tell a bob beside the top from one at the top.
fn limbs(question: &EventSpec, ends: Needs, start: &State<Exact>, apart: f64) -> usize {
    let (_, unit_secs) = question.reduced();
    let growth = DECADES_A_UNIT * question.budget_secs / unit_secs;
    let nudge = if ends == Needs::Growth { NUDGE_DIGITS } else { 0.0 };
    let beside = |angle: Exact| {
        let distance = (Exact::pi() - angle.abs()).to_f64().abs();
        if distance > 0.0 { -distance.log10() } else { 0.0 }
    };
    let beside = beside(start.angle[0]).max(beside(start.angle[1])).max(0.0);
    let digits = (DIGITS_AT_END + growth + nudge).max(apart) + beside;
    1 + (digits * std::f64::consts::LOG2_10 / 64.0).ceil().max(0.0) as usize
}

/// A start in numbers of `N` limbs, in reduced units.
struct Direct<'a, const N: usize> {
    question: &'a EventSpec,
    pendulum: Pendulum<Fixed<N>>,
    unit_secs: Fixed<N>,
    start: State<Fixed<N>>,
    budget: Fixed<N>,
    /// Decimal digits that tell neighbouring starts apart.
    apart: f64,
}

impl<'a, const N: usize> Direct<'a, N> {
    fn new(question: &'a EventSpec, start: &State<Exact>, apart: f64) -> Self {
        let (pendulum, unit_secs) = question.reduced_in::<Fixed<N>>();
        let budget = Fixed::from_f64(question.budget_secs) / unit_secs;
        let start = State {
            angle: start.angle.map(Fixed::from_theta),
            speed: start.speed.map(|speed| Fixed::from_theta(speed) * unit_secs),
        };
        let start = oracle::settled(&pendulum, &start);
        Direct { question, pendulum, unit_secs, start, budget, apart }
    }

    fn answer(&self, ends: Needs) -> (Outcome, FinalState) {
        let rule = self.question.rule;
        let outcome = match rule {
            Rule::Neither => Outcome::without_time(Status::Unflipped),
            rule => {
                let (pendulum, start) = (&self.pendulum, &self.start);
                oracle::outcome_in_bits(pendulum, start, rule, self.budget, &|at| self.bits(at))
            }
        };
        let time = if outcome.status == Status::Answered { outcome.time } else { self.budget };
        let end = match ends {
            Needs::Outcome => FinalState::NOWHERE,
            Needs::End | Needs::Growth | Needs::Extremum(_) => self.end(time, ends),
        };
        let secs = (outcome.time * self.unit_secs).to_f64();
        (Outcome { status: outcome.status, time: secs }, end)
    }

    /// The end of the motion at a reduced time.
    fn end(&self, time: Fixed<N>, ends: Needs) -> FinalState {
        let state = self.state_at(&self.start, time);
        let turns = state.angle.map(whole_turns);
        let wrapped = State { angle: state.angle.map(Fixed::wrapped), ..state };
        let log_growth = if ends == Needs::Growth { self.log_growth(&state, time) } else { 0.0 };
        FinalState {
            time: time.to_f64(),
            phase: self.pendulum.phase(&wrapped).map(Fixed::to_f64),
            gathered: Accumulators { turns, log_growth, ..Accumulators::NONE },
            ..FinalState::NOWHERE
        }
    }

    /// Number of bits that must be right in a step that begins at a reduced time: the later the
    /// step, the less time its error has to grow.
    fn bits(&self, at: f64) -> u32 {
        let left = (self.budget.to_f64() - at).max(0.0);
        let digits = (DIGITS_AT_END + DECADES_A_UNIT * left).max(self.apart);
        (digits * std::f64::consts::LOG2_10).ceil() as u32
    }

    fn state_at(&self, start: &State<Fixed<N>>, time: Fixed<N>) -> State<Fixed<N>> {
        Orbit::new(self.pendulum, *start).state_at(time)
    }

    /// Returns the natural logarithm of the growth of the nudge that grows most, from orbits beside
    /// this one.
    fn log_growth(&self, end: &State<Fixed<N>>, time: Fixed<N>) -> f64 {
        let (_, unit_secs) = self.question.reduced();
        let decades = DECADES_A_UNIT * self.question.budget_secs / unit_secs + NUDGE_DIGITS;
        let by = Fixed::parse(&format!("1e-{}", decades.ceil())).unwrap_or(Fixed::ZERO);
        let column = |k: usize| {
            let mut moved = self.start;
            let (pair, k) = if k < 2 { (&mut moved.angle, k) } else { (&mut moved.speed, k - 2) };
            pair[k] = pair[k] + by;
            let moved = self.state_at(&moved, time);
            let slope = |a: Fixed<N>, b: Fixed<N>| ((a - b) / by).to_f64();
            let [angle, speed] = [(moved.angle, end.angle), (moved.speed, end.speed)]
                .map(|(a, b)| [slope(a[0], b[0]), slope(a[1], b[1])]);
            [angle[0], angle[1], speed[0], speed[1]]
        };
        tangents::largest_singular_value([0, 1, 2, 3].map(column)).ln()
    }
}

/// Whole turns in an unwrapped angle that began in (−π, π].
fn whole_turns<const N: usize>(angle: Fixed<N>) -> i32 {
    let turn = Fixed::<N>::pi() + Fixed::pi();
    let turns = ((angle - Fixed::pi()) / turn).to_f64();
    let nearest = turns.round();
    // Near a whole number, the sign of the difference decides, to all digits.
    let beyond = angle - Fixed::pi() - turn * Fixed::from_f64(nearest);
    if beyond > Fixed::ZERO { nearest as i32 + 1 } else { nearest as i32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::flip::right_secs;
    use flipmap_scene::PendulumSpec;

    fn question(rule: Rule, budget_secs: f64) -> EventSpec {
        EventSpec { build: PendulumSpec::default(), rule, budget_secs, passes: 1 }
    }

    fn start(angle: [&str; 2]) -> State<Exact> {
        State::rest(angle.map(|text| Exact::parse(text).unwrap()))
    }

    #[test]
    fn digits_suffice_for_the_growth_of_a_hundred_seconds() {
        // Two integrations with different numbers of digits must agree.
        let (question, near) = (question(Rule::First, 100.0), start(["-1.7", "0.06"]));
        let (short, _) = answer(&question, Needs::Outcome, &near, 1.0);
        let (long, _) = Direct::<8>::new(&question, &near, 120.0).answer(Needs::Outcome);
        assert_eq!(short.status, long.status);
        assert!((short.time - long.time).abs() < 1e-6 * right_secs(question.build.unit_secs()));
        let late = start(["0.92857", "-1.80186"]);
        let question = EventSpec { rule: Rule::Second, ..question };
        let (short, _) = answer(&question, Needs::Outcome, &late, 1.0);
        let (long, _) = Direct::<8>::new(&question, &late, 120.0).answer(Needs::Outcome);
        assert!(short.status == long.status, "{short:?}, {long:?}");
        assert!((short.time - long.time).abs() < 1e-6, "{short:?}, {long:?}");
        let decades = 44.0;
        assert!(Fixed::<3>::BITS as f64 * std::f64::consts::LOG10_2 < decades, "three are too few");
    }

    #[test]
    fn whole_turns_are_told_to_the_last_digit() {
        let pi = Fixed::<4>::pi();
        let least = Fixed::<4>::from_limbs([1, 0, 0, 0]);
        let three_pi = pi + pi + pi;
        for (angle, turns) in [
            (Fixed::ZERO, 0),
            (pi, 0),
            (pi + least, 1),
            (-pi, -1),
            (-pi + least, 0),
            (three_pi, 1),
            (three_pi + least + least, 2),
        ] {
            assert_eq!(whole_turns(angle), turns, "{angle}");
        }
    }
}
