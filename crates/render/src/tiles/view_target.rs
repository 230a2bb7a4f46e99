//! The target of a window: the physics and the part of the plane in view.

use flipmap_engine::{EventSpec, IntegratorConfig};
use flipmap_scene::lattice::Region;
use flipmap_scene::{Budget, PendulumSpec, Plane, QuestionSettings, Scene};

/// All that decides a pixel's answer, except the start and the budget of a search for a flip.
#[derive(Clone, Debug, PartialEq)]
pub struct Physics {
    /// The pendulum.
    pub build: PendulumSpec,
    /// The question. If it asks for a time, it has the default budget here, because a larger budget
    /// only adds answers.
    pub question: QuestionSettings,
    /// The plane of starts.
    pub plane: Plane,
    /// Integrator config of the pixels.
    pub config: IntegratorConfig,
    /// True if every pixel is checked.
    pub verified: bool,
}

impl Physics {
    /// Returns the physics of a scene's pixels.
    pub fn of(scene: &Scene, config: IntegratorConfig, verified: bool) -> Self {
        let Scene { build, mut question, ref plane, .. } = *scene;
        if question.ask.is_time() {
            question.budget = Budget::default();
        }
        Physics { build, question, plane: plane.clone(), config, verified }
    }

    /// Returns true if the mirror images of cells have equal samples.
    pub(crate) fn mirrors(&self) -> bool {
        self.plane.is_symmetric() && self.question.ask.kind().is_even
    }

    /// Returns true if jobs return states, to be resumed with a larger budget. Checked pixels start
    /// at the release instead, and answers to questions that do not ask for a time are computed
    /// again.
    pub(super) fn keeps_states(&self) -> bool {
        self.question.ask.is_time() && !self.verified
    }
}

/// A view to be computed: a region of the plane, with its physics, budget and level.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewTarget {
    /// Physics of the pixels.
    pub physics: Physics,
    /// Simulated seconds that a pixel may use.
    pub budget_secs: f64,
    /// Region of the plane in view.
    pub region: Region,
    /// Lattice level of the cells to draw.
    pub level: u32,
    /// Offset of the pointer from the region's centre, rad.
    pub pointer: Option<[f64; 2]>,
    /// Number of finer levels of which the samples at edges are computed once all else is known.
    pub refinements: u32,
}

impl ViewTarget {
    /// Returns the target with samples twice as far apart, a quarter of the work, for a view that
    /// will soon change.
    pub fn coarser(self) -> Self {
        ViewTarget { level: self.level.saturating_sub(1), ..self }
    }

    /// Returns true if another target differs at most in its pointer and its number of refinements.
    pub(super) fn is_same_view(&self, other: &ViewTarget) -> bool {
        let ViewTarget { pointer, refinements, .. } = *self;
        ViewTarget { pointer, refinements, ..other.clone() } == *self
    }

    /// Returns a scene with the pendulum, the question and the plane; its view is not used, because
    /// the lattice places the samples.
    pub(super) fn scene(&self) -> Scene {
        let Physics { build, question, ref plane, .. } = self.physics;
        let question = QuestionSettings { budget: Budget::secs(self.budget_secs), ..question };
        Scene { build, question, plane: plane.clone(), ..Scene::default() }
    }

    /// Returns the question to be answered for every pixel.
    pub(super) fn question(&self) -> EventSpec {
        EventSpec::from(&self.scene())
    }
}
