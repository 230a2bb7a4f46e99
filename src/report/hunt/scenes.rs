//! Scenes that an adversary would choose: pendulums of all sizes, views at every depth, turned and
//! stretched, on seams, equilibria, filaments, energy curves and grazes.

use crate::engine::{Engine, EngineError, IntegratorConfig};
use crate::physics::{Angle, Dd, Rule, Scalar, Theta};
use crate::scene::{Budget, Build, Kind, QuestionTable, Scene};
use crate::tiles::descent::{Descent, DescentStep};

/// Generator of random scenes, the same ones for the same seed.
pub(super) struct Scenes {
    random: fastrand::Rng,
}

/// The kind of place at which a view is put.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lure {
    /// Any place on the torus.
    Anywhere,
    /// A place where an angle is ±π.
    Seam,
    /// A place where both angles are multiples of a half or a quarter turn.
    Equilibrium,
    /// A place where the energy is just enough to flip.
    EnergyCurve,
    /// A place deep in a filament.
    Filament,
    /// A place where the flip times of neighbours differ, however close they are.
    Edge,
}

impl Scenes {
    /// The generator for a seed.
    pub(super) fn new(seed: u64) -> Self {
        Scenes { random: fastrand::Rng::with_seed(seed) }
    }

    /// A random power of ten, with its exponent between `least` and `most`.
    fn magnitude(&mut self, least: f64, most: f64) -> f64 {
        10f64.powf(least + (most - least) * self.random.f64())
    }

    /// Rounds a number to a few digits, so that commands stay short.
    fn round(value: f64, digits: usize) -> f64 {
        format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
    }

    fn build(&mut self) -> Build {
        let kind = self.random.choice([Kind::Points, Kind::Rods]).unwrap_or_default();
        let spread = self.random.choice([0.0, 0.5, 1.5, 3.0]).unwrap_or_default();
        let mut four = [1.0; 4];
        for number in &mut four {
            *number = Self::round(self.magnitude(-spread, spread), 3);
        }
        let [m1, m2, l1, l2] = four;
        let gravity = match self.random.u8(0..3) {
            0 => 9.81,
            1 => Self::round(self.magnitude(-2.0, 3.0), 3),
            _ => 1024.0,
        };
        if self.random.u8(0..3) == 0 {
            return Build { kind, ..Build::default() };
        }
        Build::new(kind, [m1, m2], [l1, l2], gravity)
    }

    /// The next scene and its lure; `engine` finds filaments and edges.
    pub(super) fn next(
        &mut self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        go_on: &dyn Fn() -> bool,
    ) -> Result<(Scene, Lure), EngineError> {
        let build = self.build();
        let rule = self.random.choice(Rule::ALL.map(|(_, rule)| rule)).unwrap_or_default();
        let units = self.magnitude(0.0, 300f64.log10());
        let secs = Self::round(units * build.unit_secs(), 3).clamp(1e-9, 1e6);
        let question =
            QuestionTable { rule, budget: Budget::secs(secs), ..QuestionTable::default() };
        let lures = [
            Lure::Anywhere,
            Lure::Anywhere,
            Lure::Seam,
            Lure::Equilibrium,
            Lure::EnergyCurve,
            Lure::Filament,
            Lure::Filament,
            Lure::Edge,
        ];
        let lure = self.random.choice(lures).unwrap_or(Lure::Anywhere);
        let mut scene = Scene { build, question, ..Scene::default() };
        self.look(&mut scene, lure);
        // A descent and an edge are followed upright.
        let looks = (scene.view.rotate, scene.view.stretch);
        match lure {
            Lure::Filament => self.follow(&mut scene, engine, config, go_on)?,
            Lure::Edge => self.follow_edge(&mut scene, engine, config, go_on)?,
            _ => {}
        }
        (scene.view.rotate, scene.view.stretch) = looks;
        Ok((scene, lure))
    }

    /// Puts the view at a place of the lure's kind, with a random width, rotation and stretch.
    fn look(&mut self, scene: &mut Scene, lure: Lure) {
        let pi = Theta::pi();
        let mut center = [0, 1].map(|_| Theta::from_f64(Self::round(self.angle(), 6)));
        let mut width = match self.random.u8(0..3) {
            0 => self.magnitude(-3.0, 1.0),
            1 => self.magnitude(-12.0, -3.0),
            _ => self.magnitude(-40.0, -12.0),
        };
        match lure {
            Lure::Anywhere => width = width.max(self.magnitude(-12.0, 1.0)),
            Lure::Seam => {
                let axis = usize::from(self.random.bool());
                center[axis] = pi + self.off(width);
            }
            Lure::Equilibrium => {
                for theta in &mut center {
                    let quarters = f64::from(self.random.i8(-1..=2));
                    *theta = pi.halved(1) * Theta::from_f64(quarters) + self.off(width);
                }
            }
            Lure::EnergyCurve => self.on_curve(scene, &mut center),
            Lure::Filament | Lure::Edge => width = self.magnitude(-2.0, 0.8),
        }
        let digits = (12.0 - width.log10()).ceil().max(12.0) as usize;
        scene.view.center = center.map(|theta| theta.decimal(digits));
        scene.view.width = format!("{width:.2e}");
        if self.random.u8(0..3) == 0 {
            scene.view.rotate = f64::from(self.random.i16(-180..180));
        }
        if self.random.u8(0..4) == 0 {
            scene.view.stretch = Self::round(self.magnitude(-6.0, 6.0), 2);
        }
    }

    fn angle(&mut self) -> f64 {
        (self.random.f64() - 0.5) * std::f64::consts::TAU
    }

    /// A small angle: zero, or a random distance that a view of this width may or may not show.
    fn off(&mut self, width: f64) -> Theta {
        let far = width * self.magnitude(-6.0, 0.0);
        let off = self.random.choice([0.0, far, -far]).unwrap_or_default();
        Theta::from_f64(off)
    }

    /// Moves θ2 onto the curve of just enough energy, if that exists at this θ1.
    fn on_curve(&mut self, scene: &Scene, center: &mut [Theta; 2]) {
        let (pendulum, _) = scene.build.reduced_in::<Theta>();
        let least = pendulum.least_depth(scene.question.rule);
        let cos = (least - pendulum.p * center[0].sin_cos().1) / pendulum.q;
        if cos.to_f64().abs() >= 1.0 {
            return;
        }
        // Newton's method on cos θ2, from the nearest f64.
        let mut theta = Theta::from_f64(cos.to_f64().acos());
        for _ in 0..5 {
            let (sin, now) = theta.sin_cos();
            if sin.to_f64().abs() < 1e-3 {
                return;
            }
            theta = theta + (now - cos) / sin;
        }
        center[1] = if self.random.bool() { theta } else { -theta };
    }

    /// Follows a filament down to a random depth.
    fn follow(
        &mut self,
        scene: &mut Scene,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        go_on: &dyn Fn() -> bool,
    ) -> Result<(), EngineError> {
        let least = self.magnitude(-30.0, -1.0);
        let budget = scene.question.budget;
        let target = [self.random.f64() - 0.5, self.random.f64() - 0.5];
        let mut descent = Descent::new(scene.clone(), config, target);
        while scene.view.width_rad().to_f64() > least {
            match descent.next(engine, go_on)? {
                DescentStep::Scene(next) => *scene = *next,
                DescentStep::End | DescentStep::Stopped => break,
            }
        }
        if scene.question.budget.secs > 300.0 * scene.build.unit_secs() || self.random.bool() {
            scene.question.budget = budget;
        }
        scene.question.budget.auto = false;
        Ok(())
    }

    /// Narrows the view around two neighbours whose flips differ, down to a random width.
    fn follow_edge(
        &mut self,
        scene: &mut Scene,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        go_on: &dyn Fn() -> bool,
    ) -> Result<(), EngineError> {
        let least = self.magnitude(-25.0, -6.0);
        let unit = scene.build.unit_secs();
        (scene.view.rotate, scene.view.stretch) = (0.0, 1.0);
        scene.view.width = format!("{:.2e}", scene.view.width_rad().to_f64().min(0.5));
        while scene.view.width_rad().to_f64() > least && go_on() {
            let Some(next) = super::edge(scene, engine, config, unit)? else { break };
            *scene = next;
        }
        Ok(())
    }

    /// Another random seed, for choices about a scene that are not part of it.
    pub(super) fn seed(&mut self) -> u64 {
        self.random.u64(..)
    }
}

/// The start of a pixel, from the scene's decimals: no code is shared with how pictures compute it.
pub(super) fn start(scene: &Scene, side: u32, [column, row]: [u32; 2]) -> [Theta; 2] {
    let pixel = Theta::parse(&scene.view.width).unwrap_or_default() / Theta::from_f64(side.into());
    let half = f64::from(side) / 2.0;
    let across = pixel * Theta::from_f64(f64::from(column) + 0.5 - half);
    let above = pixel * Theta::from_f64(half - f64::from(row) - 0.5);
    let above = above / Theta::from_f64(scene.view.stretch);
    let turn = Dd::new(scene.view.rotate) * Dd::PI / Dd::new(180.0);
    let (sin, cos) = turn.sin_cos();
    let [sin, cos] = [sin, cos].map(Theta::from_dd);
    let center = scene.view.center_rad();
    [center[0] + across * cos - above * sin, center[1] + across * sin + above * cos]
}
