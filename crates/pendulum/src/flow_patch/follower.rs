//! Following a patch along the flow, step by step.

use super::event::PatchEvent;
use super::{Dynamics, FlowPatch, GRAZE_WITHIN, PatchEnd, PatchStep};
use crate::phase::Phase;
use crate::reference::Reference;
use flipmap_numbers::jet::Jet;

/// A patch that is being followed.
pub(super) struct Follower {
    /// The patch after the steps that were taken.
    patch: FlowPatch,
    /// The latest patch that can serve as the end: no watched bob of any start is at the top, so
    /// events alone decide which starts have passed.
    clear: FlowPatch,
    /// True once the opening is over, with no start at the top or beyond it.
    is_watching: bool,
    pass_began: Option<f64>,
    budget: f64,
    tolerance: f64,
}

/// The length of a step to try, and of the one after it.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepPlan {
    pub length: f64,
    pub next: f64,
}

impl Follower {
    /// Begins to follow a patch, at most to `budget`, as long as its polynomials leave out no more
    /// than `tolerance`.
    pub(super) fn new(patch: FlowPatch, budget: f64, tolerance: f64) -> Self {
        let is_watching = patch.left_of_opening().is_none();
        Follower { clear: patch.clone(), is_watching, patch, pass_began: None, budget, tolerance }
    }

    /// Plans the next step, or returns the reason why the patch ends here.
    pub(super) fn plan(
        &mut self,
        dynamics: &Dynamics,
        reference: Option<&mut (dyn Reference + 'static)>,
    ) -> Result<StepPlan, PatchEnd> {
        if self.patch.settled() {
            return Err(PatchEnd::Grazed);
        }
        let is_clear = self.patch.is_clear(dynamics);
        if self.pass_began.is_none() && is_clear {
            self.clear.clone_from(&self.patch);
            if self.patch.time.0 >= self.budget {
                return Err(self.stopped(PatchEnd::Over));
            }
        }
        if !self.is_watching && self.patch.left_of_opening().is_none() {
            // Some starts may have passed the top in the opening, while others are about to: it is
            // not known which.
            if !is_clear {
                return Err(self.stopped(PatchEnd::Unclear));
            }
            self.is_watching = true;
        }
        if self.pass_began.is_some_and(|began| self.patch.time.0 > began + GRAZE_WITHIN) {
            return Err(self.stopped(PatchEnd::Unclear));
        }
        Ok(self.patch.plan_step(dynamics, reference))
    }

    /// Goes back to the latest patch that can serve as the end, and returns `end`.
    fn stopped(&mut self, end: PatchEnd) -> PatchEnd {
        self.patch.clone_from(&self.clear);
        end
    }

    /// The states after a planned step.
    pub(super) fn carried(&self, dynamics: &Dynamics, plan: StepPlan) -> Phase<Jet> {
        dynamics.carried(&self.patch.phase, Jet::constant(plan.length))
    }

    /// Takes a step to the states `after`, or plans to try half of it; returns the reason for the
    /// patch's end if the step ends it.
    pub(super) fn take(
        &mut self,
        dynamics: &Dynamics,
        plan: StepPlan,
        after: Phase<Jet>,
        reference: Option<&mut (dyn Reference + 'static)>,
    ) -> Option<PatchEnd> {
        let patch_step = PatchStep { plan, after };
        let tail = dynamics.tail(&patch_step.after);
        if tail.is_nan() || tail > self.tolerance {
            return Some(self.stopped(PatchEnd::Spread));
        }
        let patch = &mut self.patch;
        let since = self.clear.time.0;
        let event = match self.is_watching {
            false => PatchEvent::Nothing,
            true => {
                let reference = reference.as_deref();
                patch.event_in(dynamics, &patch_step, since, self.tolerance, reference)
            }
        };
        match event {
            PatchEvent::Nothing => {}
            PatchEvent::FarTurn(clearance) => patch.far_turns = patch.far_turns.min(clearance),
            PatchEvent::TooMuch => {
                patch.step = plan.length * 0.5;
                return None;
            }
            PatchEvent::Unclear => return Some(self.stopped(PatchEnd::Unclear)),
            PatchEvent::Pass(pass) => return Some(PatchEnd::Passed(pass)),
            PatchEvent::NearlyGraze(bob) => {
                self.pass_began = Some(patch.time.0);
                patch.beyond[bob] = true;
            }
            PatchEvent::Back(bob) => patch.beyond[bob] = false,
            PatchEvent::Graze(graze, beyond) => {
                self.pass_began = None;
                patch.beyond[graze.bob] = beyond;
                patch.grazes.extend(graze.concerns_any().then_some(*graze));
            }
        }
        patch.take(dynamics, patch_step, reference);
        None
    }

    /// A bound on the distance of the patch's states from the middle one.
    pub(super) fn spread(&self, dynamics: &Dynamics) -> f64 {
        self.patch.spread(dynamics)
    }

    /// The patch in its last state.
    pub(super) fn into_patch(self) -> FlowPatch {
        self.patch
    }
}
