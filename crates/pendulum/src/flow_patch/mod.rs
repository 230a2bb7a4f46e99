//! Flow patches: cells of starts carried by the flow as polynomials, for a deep zoom's start maps.
//!
//! The pendulums of a small cell of starts stay together for a long time. Their states at any time
//! are polynomials in the position of the start within the cell ([`Jet`]), and those obey the
//! equations of motion: the same right-hand sides and steps that move one pendulum move all. A
//! patch is followed until its polynomials no longer describe the whole cell; then it is cut into
//! parts that continue, or its pixels are integrated one by one.
//!
//! Crossings are found on the polynomials too, by code of their own, so that cells followed and pixels
//! integrated one by one check each other. Where all of a patch passes the top, the moment is
//! itself a polynomial. Where a bob turns round near the top, so is the height that it reaches, and
//! the sign of the height says which starts have flipped: a graze stays one clean line however deep
//! the zoom.

mod coordinates;
mod curve;
mod dynamics;
mod event;
mod follower;
mod graze;
mod nudges;

pub use coordinates::CurveCoordinates;
pub use curve::{CurvePoint, PatchCurve};
pub use dynamics::Dynamics;
pub(crate) use graze::Graze;

use self::follower::{Follower, StepPlan};
use crate::Pendulum;
use crate::crossing::FAR;
use crate::embedded::dop853_factor;
use crate::phase::Phase;
use crate::reference::{Reference, drop_digits};
use crate::tangents::TangentMap;
use crate::transport::turns_between;
use flipmap_numbers::Real;
use flipmap_numbers::frame::Frame;
use flipmap_numbers::jet::Jet;

/// A cell of starts in motion.
#[derive(Clone, Debug)]
pub struct FlowPatch {
    /// Reduced time since the release, and the part of it that was lost to rounding.
    pub time: (f64, f64),
    /// Unit vectors and momenta of all states.
    pub phase: Phase<Jet>,
    /// Length of the next step to try.
    pub step: f64,
    /// Number of steps taken since the release, or since the patch was cut from a larger one.
    pub steps: u64,
    /// Whole turns of each bob of the middle since the release.
    turns: [i32; 2],
    /// Least distance from the top, as a sine, of the watched bobs' turns that are not in `grazes`.
    far_turns: f64,
    /// Turns near the top at which some of the cell flipped, in order.
    pub grazes: Vec<Graze>,
    /// True for each bob that is beyond the top in the middle's state during a graze; never true at
    /// the patch's end.
    beyond: [bool; 2],
    /// Tangent map of the middle from its release, where nudges are followed.
    nudges: Option<TangentMap>,
    /// Reduced time after the release in which the top is not examined: the starts that pass it so
    /// early are known beforehand.
    opening: f64,
    /// Distance from the top in rad that no bob covers within the opening.
    opening_rad: f64,
}

/// The reason for the end of a patch.
#[derive(Clone, Debug)]
pub enum PatchEnd {
    /// The polynomials no longer describe the patch.
    Spread,
    /// Something happens at the top that the polynomials cannot resolve.
    Unclear,
    /// All starts that had not yet flipped do so in one crossing.
    Passed(Box<PatchCrossing>),
    /// The whole patch has flipped in grazes.
    Grazed,
    /// The budget has been reached.
    Over,
}

/// A crossing of the top by all starts.
#[derive(Clone, Debug)]
pub struct PatchCrossing {
    time: f64,
    shift: Jet,
    phase: Phase<Jet>,
}

impl PatchCrossing {
    /// The crossing of the middle at the reduced `time`, with the delays `shift` of the other
    /// starts and all states as they pass. `None` if any start can pass before the time `since`,
    /// until which all are known to be on this side of the top: then the polynomials are wrong.
    fn new(time: f64, shift: Jet, phase: Phase<Jet>, since: f64) -> Option<Self> {
        (time - shift.spread() >= since).then_some(PatchCrossing { time, shift, phase })
    }

    /// An estimate of the truncation error of the times, and a bound on the distance of the states
    /// from the middle one.
    pub fn tail_and_spread(&self, dynamics: &Dynamics) -> [f64; 2] {
        [self.shift.tail(), dynamics.spread(&self.phase)]
    }

    /// The reduced time at which the start at a point of the cell flips, and its state then.
    pub fn flip(&self, at: [f64; 2]) -> (f64, Phase<f64>) {
        (self.time + self.shift.at(at), self.phase.map(|jet| jet.at(at)))
    }
}

/// Error allowed in a step of the middle. The polynomials' relative errors are about as large.
const STEP_TOLERANCE: f64 = 1e-15;
/// Maximum reduced time that a patch moves in a step.
const MAX_STEP: f64 = 0.5;
/// Length below which a step with two events at the top is not halved again.
const MIN_HALVED_STEP: f64 = 1e-7;
/// Reduced time within which a bob must turn round after a pass that is nearly a graze.
const GRAZE_WITHIN: f64 = 1.0;

/// The phase in the middle of the cell.
fn middle(phase: &Phase<Jet>) -> Phase<f64> {
    phase.map(|jet| jet.middle())
}

impl FlowPatch {
    /// A cell released from rest, `half` rad around the angles whose sines and cosines are
    /// `sin_cos` (to full precision).
    pub fn release(dynamics: &Dynamics, sin_cos: [(f64, f64); 2], half: f64) -> Self {
        let [(y1, x1), (y2, x2)] =
            [0, 1].map(|axis| Jet::sin_cos_around(sin_cos[axis], Jet::coordinate(axis, half)));
        let zero = Jet::constant(0.0);
        FlowPatch::begun(dynamics, [x1, y1, x2, y2, zero, zero])
    }

    /// A cell of starts thrown with speeds, around the state `middle` (to full precision); `by` are
    /// the differences of the other starts from it in both angles (rad) and both reduced speeds.
    pub fn thrown(dynamics: &Dynamics, middle: &Phase<f64>, by: [Jet; 4]) -> Self {
        let [x1, y1, x2, y2, p1, p2] = *middle;
        let [by1, by2, faster1, faster2] = by;
        let speeds = dynamics.pendulum.speeds(middle).map(Jet::constant);
        let [w1, w2] = [speeds[0] + faster1, speeds[1] + faster2];
        let (y1, x1) = Jet::sin_cos_around((y1, x1), by1);
        let (y2, x2) = Jet::sin_cos_around((y2, x2), by2);
        let Pendulum { a, b, c, .. } = dynamics.jets;
        let coupling = c * (x1 * x2 + y1 * y2);
        let momenta = [a * w1 + coupling * w2, coupling * w1 + b * w2];
        // The middle's momenta are known to more digits than its speeds give.
        let momenta = [momenta[0].with_middle(p1), momenta[1].with_middle(p2)];
        FlowPatch::begun(dynamics, [x1, y1, x2, y2, momenta[0], momenta[1]])
    }

    /// The same patch with an opening of another length.
    #[cfg(feature = "sabotage")]
    pub fn with_opening(self, opening: f64) -> Self {
        FlowPatch { opening, ..self }
    }

    /// A cell whose starts no polynomials describe.
    pub fn undescribed(dynamics: &Dynamics) -> Self {
        FlowPatch::begun(dynamics, [Jet::constant(f64::NAN); 6])
    }

    fn begun(dynamics: &Dynamics, phase: Phase<Jet>) -> Self {
        let greatest = |speed: Jet| speed.middle().abs() + speed.spread();
        let [first, second] = dynamics.jets.speeds(&phase).map(greatest);
        let fastest = first.max(second);
        let opening = dynamics.rates.length(fastest);
        FlowPatch {
            opening,
            opening_rad: dynamics.rates.near_rad(fastest, fastest, opening),
            time: (0.0, 0.0),
            phase,
            step: super::control::FIRST,
            steps: 0,
            turns: [0; 2],
            far_turns: FAR,
            grazes: Vec::new(),
            beyond: [false; 2],
            nudges: None,
        }
    }

    /// A bound on the distance of its states from the middle one, in unit vectors and scaled
    /// momenta.
    pub fn spread(&self, dynamics: &Dynamics) -> f64 {
        dynamics.spread(&self.phase)
    }

    /// An estimate of the largest truncation error of its polynomials.
    pub fn tail(&self, dynamics: &Dynamics) -> f64 {
        dynamics.tail(&self.phase)
    }

    /// Energy of its states, reduced; zero if both rods are level and at rest.
    pub fn energy(&self, dynamics: &Dynamics) -> Jet {
        let [x1, _, x2, _, p1, p2] = self.phase;
        let [w1, w2] = dynamics.jets.speeds(&self.phase);
        let Pendulum { p, q, .. } = dynamics.jets;
        Jet::constant(0.5) * (p1 * w1 + p2 * w2) - (x1 * p + x2 * q)
    }

    /// Bounds on the distance of its states from the middle one, along the two axes of its frame.
    pub fn extents(&self, dynamics: &Dynamics) -> [f64; 2] {
        let weight = dynamics.weights();
        let extents = [0, 1, 2, 3, 4, 5].map(|i| self.phase[i].extents().map(|at| at * weight[i]));
        [0, 1].map(|axis| extents.iter().map(|extent| extent[axis]).fold(0.0, f64::max))
    }

    /// The part of the patch in `frame`, all of which may have flipped already
    /// ([`FlowPatch::settled`]).
    pub fn part(&self, dynamics: &Dynamics, frame: &Frame) -> Self {
        let graze = |graze: &Graze| Graze {
            shift: graze.shift.part(frame),
            height: graze.height.part(frame),
            phase: graze.phase.map(|jet| jet.part(frame)),
            ..*graze
        };
        let grazes = self.grazes.iter().map(graze).filter(Graze::concerns_any).collect();
        let phase = self.phase.map(|jet| jet.part(frame));
        let turns = self.turns_at(&middle(&phase));
        let nudges = self.nudges_at(dynamics, frame.middle);
        FlowPatch { phase, turns, grazes, nudges, steps: 0, ..*self }
    }

    /// Whole turns of each bob, since its release, of the start that is now in the state `phase`.
    pub fn turns_at(&self, phase: &Phase<f64>) -> [i32; 2] {
        let since = turns_between(&middle(&self.phase), phase);
        [0, 1].map(|bob| self.turns[bob] + since[bob])
    }

    /// Distance from the top, as a sine, that the watched bobs of the start at a point have kept.
    pub fn clearance(&self, at: [f64; 2]) -> f64 {
        self.grazes.iter().map(|graze| graze.clearance(at)).fold(self.far_turns, f64::min)
    }

    /// Distance from the top, as a sine, that the watched bobs of all starts have kept outside
    /// grazes.
    pub fn clearance_outside_grazes(&self) -> f64 {
        self.far_turns
    }

    /// Returns true if all of the patch has flipped.
    pub(crate) fn settled(&self) -> bool {
        self.grazes.iter().any(Graze::concerns_all)
    }

    /// Returns true if the polynomials describe the patch well enough at its present time.
    pub fn holds(&self, dynamics: &Dynamics, tolerance: f64) -> bool {
        let is_described = self.phase.iter().all(|jet| jet.middle().is_finite());
        is_described && dynamics.tail(&self.phase) <= tolerance
    }

    /// Follows the flow, along a reference if there is one, until the patch ends: at the latest at
    /// `budget`, and only as long as its polynomials leave out no more than `tolerance`.
    pub fn follow(
        &mut self,
        dynamics: &Dynamics,
        budget: f64,
        tolerance: f64,
        mut reference: Option<&mut Box<dyn Reference>>,
    ) -> PatchEnd {
        let mut follower = Follower::new(self.clone(), budget, tolerance);
        let end = loop {
            let along = reference.as_deref_mut().map(AsMut::as_mut);
            let plan = match follower.plan(dynamics, along) {
                Ok(plan) => plan,
                Err(end) => break end,
            };
            let mut after = follower.carried(dynamics, plan);
            if let Some(reference) = reference.as_deref_mut() {
                let known = reference.phase(plan.length);
                after = std::array::from_fn(|i| after[i].with_middle(known[i]));
            }
            let along = reference.as_deref_mut().map(AsMut::as_mut);
            if let Some(end) = follower.take(dynamics, plan, after, along) {
                break end;
            }
            if let Some(reference) = reference.as_deref_mut() {
                drop_digits(reference, follower.spread(dynamics));
            }
        };
        *self = follower.into_patch();
        end
    }

    /// Returns true if no watched bob of any start is at the top or beyond it; during the opening,
    /// if none has been so near the top that its first moments decide.
    fn is_clear(&self, dynamics: &Dynamics) -> bool {
        let margin = if self.left_of_opening().is_some() { self.opening_rad } else { 0.0 };
        dynamics.rule.watched().iter().all(|&bob| {
            let (x, y) = (&self.phase[2 * bob], &self.phase[2 * bob + 1]);
            x.middle() > 0.0 || (y.middle().abs() > y.spread() + margin && !self.beyond[bob])
        })
    }

    /// The time left of the opening, in which the top is not examined; `None` once it is over.
    fn left_of_opening(&self) -> Option<f64> {
        let left = self.opening - self.time.0;
        (left > 1e-9 * self.opening).then_some(left)
    }

    /// Returns true if the time since the release is much longer than the opening.
    pub fn is_well_under_way(&self) -> bool {
        self.time.0 > 10.0 * self.opening
    }

    /// Plans the next step, which is as long as the error of the middle allows.
    fn plan_step(
        &self,
        dynamics: &Dynamics,
        reference: Option<&mut (dyn Reference + 'static)>,
    ) -> StepPlan {
        let start = middle(&self.phase);
        let (mut length, mut next) = (self.step.min(MAX_STEP), self.step);
        length = length.min(self.left_of_opening().unwrap_or(length));
        if let Some(reference) = reference {
            length = length.min(reference.reach());
        }
        for _ in 0..=20 {
            let (_, error) = dynamics.moved(&start, length);
            let factor = dop853_factor(error, STEP_TOLERANCE);
            let fits = factor >= 0.8;
            next = length * factor.clamp(0.2, 3.0);
            if fits || length < MIN_HALVED_STEP {
                break;
            }
            length = next;
        }
        // A step cut short by the reference says little about the next one.
        let next = if length < 0.5 * self.step { next.max(self.step) } else { next };
        StepPlan { length, next }
    }

    fn take(
        &mut self,
        dynamics: &Dynamics,
        patch_step: PatchStep,
        reference: Option<&mut (dyn Reference + 'static)>,
    ) {
        if let Some(reference) = reference {
            reference.advance(patch_step.plan.length);
        }
        self.turns = self.turns_at(&middle(&patch_step.after));
        self.nudges = self.nudges_after(dynamics, patch_step.plan.length);
        self.phase = patch_step.after;
        self.time = self.time.0.fast_two_sum(self.time.1 + patch_step.plan.length);
        self.step = patch_step.plan.next;
        self.steps += 1;
    }
}

/// A step of a patch that may be taken.
struct PatchStep {
    plan: StepPlan,
    after: Phase<Jet>,
}
