//! The target of a window: the physics and the part of the plane in view.

use crate::engine::{IntegratorConfig, Question};
use crate::physics::Rule;
use crate::scene::lattice::Region;
use crate::scene::{self, Budget, Build, Scene};

/// All that decides a pixel's answer, except the start and the budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Physics {
    /// The pendulum.
    pub build: Build,
    /// Choice of the watched bob.
    pub rule: Rule,
    /// Integrator config of the pixels.
    pub config: IntegratorConfig,
    /// True if every pixel is checked.
    pub verified: bool,
}

/// A view to be computed: a region of the plane, with its physics, budget and level.
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

impl ViewTarget {
    /// Returns a scene with the pendulum and the question; its view is not used, because the
    /// lattice places the samples.
    pub(super) fn scene(&self) -> Scene {
        let question = scene::QuestionTable {
            rule: self.physics.rule,
            budget: Budget::secs(self.budget_secs),
            ..Default::default()
        };
        Scene { build: self.physics.build, question, ..Scene::default() }
    }

    /// Returns the question to be answered for every pixel.
    pub(super) fn question(&self) -> Question {
        Question::from(&self.scene())
    }
}
