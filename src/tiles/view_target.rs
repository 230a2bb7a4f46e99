//! What a window looks at.

use crate::engine::{IntegratorConfig, Question};
use crate::physics::Rule;
use crate::scene::lattice::Region;
use crate::scene::{self, Budget, Build, Scene};

/// What decides a pixel's answer, but for the budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Physics {
    /// The pendulum.
    pub build: Build,
    /// Which bob is watched.
    pub rule: Rule,
    /// How it is integrated.
    pub config: IntegratorConfig,
    /// Whether every pixel is checked.
    pub verified: bool,
}

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewTarget {
    /// Of what.
    pub physics: Physics,
    /// Simulated seconds a pixel may use.
    pub budget_secs: f64,
    /// Where.
    pub region: Region,
    /// How finely: the level of the cells to draw.
    pub level: u32,
    /// Where the pointer is, from the region's centre, rad.
    pub pointer: Option<[f64; 2]>,
}

impl ViewTarget {
    /// The pendulum and the question; the view is the lattice's affair.
    pub(super) fn scene(&self) -> Scene {
        let question =
            scene::FlipQuestion { rule: self.physics.rule, budget: Budget::secs(self.budget_secs) };
        Scene { build: self.physics.build, question, ..Scene::default() }
    }

    /// What is asked of every pixel.
    pub(super) fn question(&self) -> Question {
        Question::from(&self.scene())
    }
}
