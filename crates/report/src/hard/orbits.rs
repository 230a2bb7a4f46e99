//! Hard cases of periodic orbits on the section θ1 = 0, which a computer-assisted proof encloses.

use super::{BALANCED, HardBench, HardCase, HardFinding, Of};
use flipmap_engine::{EngineError, EventSpec, Job, Keep, Starts, Wait};
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::extremum::Extremum;
use flipmap_pendulum::passes::{SectionReturn, section_return};
use flipmap_pendulum::{Accumulators, Launch, Pendulum, Rule, State};
use flipmap_scene::question::Needs;
use flipmap_scene::{Kind, PendulumSpec, Plane, PlaneKind};

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "periodic orbits of a computer-assisted proof",
        expected: "return times within their enclosures to 1e-10, traces of the return map to 1e-5",
        why: "the proof (ChaseHendrick/double-pendulum, 2026, not peer reviewed) encloses three \
              orbits of the equal pendulum at the energies -1/2, 0 and 1/2 without trusting any \
              integrator",
        of: Of::Physics,
        run: enclosures,
    },
    HardCase {
        name: "the same orbits as returns and growth",
        expected: "nearest returns closer than 1e-7, at the periods; growth over 8 more periods at \
                   the orbits' exponents to 1 %",
        why: "an orbit that closes comes back to its start, and nudges grow along it by the larger \
              multiplier of its return map each time",
        of: Of::Cpu,
        run: answers,
    },
];

/// An orbit of the equal double pendulum with m = l = g = 1, from the section θ1 = 0 at θ2 = 0.
struct PeriodicOrbit {
    /// Total energy, 0 where both rods are level and at rest.
    energy: f64,
    /// Momentum of the second rod at the start.
    p2: &'static str,
    /// Enclosure of the return time.
    time: [f64; 2],
    /// Enclosure of the trace of the return map.
    trace: [f64; 2],
}

const ORBITS: [PeriodicOrbit; 3] = [
    PeriodicOrbit {
        energy: -0.5,
        p2: "-1.2448609709185",
        time: [3.7047745436, 3.7047745487],
        trace: [-3.23158, -3.23150],
    },
    PeriodicOrbit {
        energy: 0.0,
        p2: "-1.46237309248",
        time: [2.9534890074, 2.9534890134],
        trace: [-3.80869, -3.80863],
    },
    PeriodicOrbit {
        energy: 0.5,
        p2: "-1.627044959203",
        time: [2.5643622220, 2.5643622277],
        trace: [-3.33283, -3.33277],
    },
];

/// The pendulum of the orbits.
fn unit_build() -> PendulumSpec {
    PendulumSpec::new(Kind::Points, [1.0; 2], [1.0; 2], 1.0)
}

impl PeriodicOrbit {
    /// A start on the section beside the orbit's.
    fn launch(&self, by: [f64; 2]) -> Option<Launch> {
        let section = Plane { kind: PlaneKind::Section, energy: self.energy, ..Plane::default() };
        let pendulum: Pendulum<Dd> = unit_build().pendulum_in();
        section.launch(&pendulum, [Dd::new(by[0]), Dd::parse(self.p2)? + Dd::new(by[1])])
    }

    fn back(&self, by: [f64; 2]) -> Option<SectionReturn> {
        // Several times the return times.
        const MAX_SECS: f64 = 20.0;
        let Launch { angle, speed } = self.launch(by)?;
        section_return(&unit_build().pendulum_in(), State { angle, speed }, MAX_SECS)
    }

    /// The return time, the distance between the return and the start, and the trace of the return
    /// map by central differences.
    fn measured(&self) -> Option<(f64, f64, f64)> {
        const NUDGE: f64 = 1e-8;
        let SectionReturn { time, theta2, p2 } = self.back([0.0; 2])?;
        let open = (theta2 + Dd::TAU).hi.hypot((p2 - Dd::parse(self.p2)?).hi);
        let [ahead, behind] = [self.back([NUDGE, 0.0])?, self.back([-NUDGE, 0.0])?];
        let [above, below] = [self.back([0.0, NUDGE])?, self.back([0.0, -NUDGE])?];
        let trace = ((ahead.theta2 - behind.theta2) + (above.p2 - below.p2)).hi / (2.0 * NUDGE);
        Some((time.hi, open, trace))
    }

    /// The Lyapunov exponent of the orbit: of the return map's larger multiplier.
    fn exponent(time: f64, trace: f64) -> f64 {
        ((trace.abs() + (trace * trace - 4.0).sqrt()) / 2.0).ln() / time
    }
}

fn is_within(value: f64, [least, most]: [f64; 2], by: f64) -> bool {
    least - by <= value && value <= most + by
}

fn enclosures(_: &mut HardBench) -> Result<HardFinding, EngineError> {
    let mut held = true;
    let parts = ORBITS.iter().map(|orbit| {
        let Some((time, open, trace)) = orbit.measured() else {
            held = false;
            return format!("{} never returns", orbit.energy);
        };
        held &= is_within(time, orbit.time, 1e-10) && is_within(trace, orbit.trace, 1e-5);
        held &= open < 1e-9;
        let exponent = PeriodicOrbit::exponent(time, trace);
        format!("{}: {time:.10}, trace {trace:.6}, exponent {exponent:.6}", orbit.energy)
    });
    let measured = parts.collect::<Vec<_>>().join("; ");
    HardFinding::new(held, measured)
}

fn answers(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let nearest = Needs::Extremum(Extremum::NearestReturn);
    let (mut held, mut parts) = (true, Vec::new());
    for orbit in &ORBITS {
        let (Some(launch), Some((period, _, trace))) = (orbit.launch([0.0; 2]), orbit.measured())
        else {
            return HardFinding::new(false, format!("{} has no start", orbit.energy));
        };
        let [distance, time] = bench.ended(launch, 1.2 * period, nearest)?.extremum;
        held &= distance < 1e-7 && (time - period).abs() < 1e-6;
        // Two budgets: what the first nudges lose until they point the way of growth cancels.
        let mut log_growth = |periods: f64| {
            bench.ended(launch, periods * period, Needs::Growth).map(|end| end.log_growth)
        };
        let exponent = (log_growth(12.0)? - log_growth(4.0)?) / (8.0 * period);
        let expected = PeriodicOrbit::exponent(period, trace);
        held &= (exponent / expected - 1.0).abs() < 0.01;
        parts.push(format!(
            "{}: {distance:.0e} away after {time:.6}, exponent {exponent:.5} (of the map \
             {expected:.5})",
            orbit.energy
        ));
    }
    HardFinding::new(held, parts.join("; "))
}

impl HardBench<'_> {
    /// Integrates a thrown pendulum to the end of the budget; returns the quantities gathered.
    fn ended(
        &mut self,
        launch: Launch,
        budget_secs: f64,
        ends: Needs,
    ) -> Result<Accumulators, EngineError> {
        let rule = Rule::Neither;
        let question = EventSpec { build: unit_build(), rule, budget_secs, passes: 1 };
        let keep = Keep { ends, states: false };
        let starts = Starts::Thrown(vec![launch]);
        self.engine.submit(Job { id: 1, question, config: BALANCED, starts, keep })?;
        let finished = self.engine.poll(Wait::UntilFinished)?.pop();
        let end = finished.and_then(|job| job.ends.first().map(|end| end.gathered));
        end.ok_or_else(|| EngineError::Unsupported("the engine gave no end".to_string()))
    }
}
