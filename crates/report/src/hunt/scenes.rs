//! Scenes that an adversary would choose: pendulums of all sizes, with friction or without, every
//! question on every plane, views at every depth, turned and stretched, on seams, equilibria,
//! filaments, energy curves and grazes.

use super::how::How;
use flipmap_engine::{Engine, EngineError, EngineKind, IntegratorConfig};
use flipmap_numbers::{Angle, Decimal, Exact, Scalar};
use flipmap_pendulum::Rule;
use flipmap_render::tiles::descent::{Descent, DescentStep};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Axis, Budget, Kind, PendulumSpec, Plane, PlaneKind, QuestionSettings, Scene};

/// Generator of random scenes, the same ones for the same seed.
pub(super) struct Scenes {
    random: fastrand::Rng,
}

/// The kind of place at which a view is put.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TargetRegion {
    /// Any place.
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
    /// A bob at the top, or beside it by far less than any rounding.
    BesideTop,
}

/// Smallest distance from the top at which bobs are put, as a power of ten.
const NEAREST_TOP: f64 = -50.0;
/// Largest number of a flip that is asked for.
const MAX_COUNT: u32 = 50;

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

    fn build(&mut self) -> PendulumSpec {
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
        let build = match self.random.u8(0..3) {
            0 => PendulumSpec { kind, ..PendulumSpec::default() },
            _ => PendulumSpec::new(kind, [m1, m2], [l1, l2], gravity),
        };
        PendulumSpec { friction: self.friction(), ..build }
    }

    /// Friction at both pivots, at one of them, or, most often, at none.
    fn friction(&mut self) -> [Decimal; 2] {
        if self.random.u8(0..10) < 7 {
            return [0.0.into(); 2];
        }
        let both = [0, 1].map(|_| Self::round(self.magnitude(-6.0, 3.0), 3));
        match self.random.u8(0..3) {
            0 => both,
            1 => [both[0], 0.0],
            _ => [0.0, both[1]],
        }
        .map(Decimal::from)
    }

    /// The question, of which most are first flips.
    fn question(&mut self, secs: f64) -> QuestionSettings {
        let rule = self.random.choice(Rule::ALL.map(|(_, rule)| rule)).unwrap_or_default();
        let plain = QuestionSettings { budget: Budget::secs(secs), ..QuestionSettings::default() };
        match self.random.u8(0..10) {
            0..5 => QuestionSettings { rule, ..plain },
            5 => QuestionSettings { rule, count: self.random.u32(2..=MAX_COUNT), ..plain },
            6 => QuestionSettings { ask: QuestionName::First, ..plain },
            7 => QuestionSettings { ask: QuestionName::Flips, ..plain },
            8 => QuestionSettings { ask: QuestionName::State, ..plain },
            _ => {
                let gathers = |ask: &QuestionName| ask.kind().needs.are_carried();
                let gathering = QuestionName::ALL.into_iter().filter(gathers);
                let ask = self.random.choice(gathering.collect::<Vec<_>>()).unwrap_or_default();
                // The referee follows nine orbits in many digits for growth.
                QuestionSettings { ask, budget: Budget::secs(secs.min(40.0)), ..plain }
            }
        }
    }

    /// The plane, which is most often that of both angles.
    fn plane(&mut self, build: &PendulumSpec) -> Plane {
        if self.random.u8(0..10) < 6 {
            return Plane::default();
        }
        if self.random.u8(0..4) == 0 {
            return Plane {
                kind: PlaneKind::Section,
                energy: self.energy(build),
                ..Plane::default()
            };
        }
        let mut axes = Axis::OF_STARTS;
        self.random.shuffle(&mut axes);
        let speed = 4.0 / build.unit_secs();
        let origin = [0, 1, 2, 3].map(|place| match (place < 2, self.random.u8(0..4)) {
            (_, 0) => "0".to_string(),
            (true, _) => Self::round(self.angle(), 6).to_string(),
            (false, _) => Self::round(speed * (self.random.f64() - 0.5), 4).to_string(),
        });
        Plane { kind: PlaneKind::Axes([axes[0], axes[1]]), origin, energy: 0.0 }
    }

    /// An energy of a section: at or beside one at which a bob just reaches the top, or any.
    fn energy(&mut self, build: &PendulumSpec) -> f64 {
        let pendulum = build.pendulum();
        let (p, q) = (pendulum.p, pendulum.q);
        let critical = self.random.choice([q - p, p - q, p + q]).unwrap_or(p);
        let beside = self.magnitude(-16.0, -1.0);
        match self.random.u8(0..4) {
            0 => critical,
            1 => critical * (1.0 + beside),
            2 => critical * (1.0 - beside),
            _ => Self::round((3.0 * self.random.f64() - 0.9) * (p + q), 5),
        }
        .max(-0.999 * (p + q))
    }

    /// The next scene and its lure; `engine` finds filaments and edges.
    pub(super) fn next(
        &mut self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        keep_going: &dyn Fn() -> bool,
    ) -> Result<(Scene, TargetRegion), EngineError> {
        let build = self.build();
        let units = self.magnitude(0.0, 300f64.log10());
        let secs = Self::round(units * build.unit_secs(), 3).clamp(1e-9, 1e6);
        let question = self.question(secs);
        let plane = self.plane(&build);
        let mut scene = Scene { build, question, plane, ..Scene::default() };
        let lure = self.lure(&scene);
        self.look(&mut scene, lure);
        // A descent and an edge are followed upright.
        let looks = (scene.view.rotate, scene.view.stretch);
        match lure {
            TargetRegion::Filament => self.follow(&mut scene, engine, config, keep_going)?,
            TargetRegion::Edge => self.follow_edge(&mut scene, engine, config, keep_going)?,
            _ => {}
        }
        (scene.view.rotate, scene.view.stretch) = looks;
        Ok((scene, lure))
    }

    /// A kind of place that a scene has.
    fn lure(&mut self, scene: &Scene) -> TargetRegion {
        let anywhere = [TargetRegion::Anywhere, TargetRegion::BesideTop, TargetRegion::BesideTop];
        let of_flips = [TargetRegion::Edge, TargetRegion::Edge];
        let at_rest = [TargetRegion::Seam, TargetRegion::Equilibrium, TargetRegion::EnergyCurve];
        let filaments = [TargetRegion::Filament, TargetRegion::Filament];
        let mut all = anywhere.to_vec();
        if scene.question.ask == QuestionName::Flip && scene.question.count == 1 {
            all.extend(of_flips);
        }
        if scene.plane.is_at_rest() {
            all.extend(at_rest);
        }
        if scene.is_flip_from_rest() {
            all.extend(filaments);
        }
        self.random.choice(all).unwrap_or(TargetRegion::Anywhere)
    }

    /// Draws the way in which the next window is computed.
    pub(super) fn how(&mut self, kind: Option<EngineKind>) -> How {
        How::draw(&mut self.random, kind)
    }

    /// Puts the view at a place of the lure's kind, with a random width, rotation and stretch.
    fn look(&mut self, scene: &mut Scene, lure: TargetRegion) {
        let pi = Exact::pi();
        let mut center = self.anywhere(scene);
        let mut width = match self.random.u8(0..3) {
            0 => self.magnitude(-3.0, 1.0),
            1 => self.magnitude(-12.0, -3.0),
            _ => self.magnitude(-40.0, -12.0),
        };
        match lure {
            TargetRegion::Anywhere => width = width.max(self.magnitude(-12.0, 1.0)),
            TargetRegion::Seam => {
                let axis = usize::from(self.random.bool());
                center[axis] = pi + self.off(width);
            }
            TargetRegion::Equilibrium => {
                for theta in &mut center {
                    let quarters = f64::from(self.random.i8(-1..=2));
                    *theta = pi.halved(1) * Exact::from_f64(quarters) + self.off(width);
                }
            }
            TargetRegion::EnergyCurve => self.on_curve(scene, &mut center),
            TargetRegion::Filament | TargetRegion::Edge => width = self.magnitude(-2.0, 0.8),
            TargetRegion::BesideTop => self.beside_top(scene, &mut center),
        }
        let mut digits = (12.0 - width.log10()).ceil().max(12.0) as usize;
        if lure == TargetRegion::BesideTop {
            digits = digits.max(60);
        }
        scene.view.center = center.map(|x| x.decimal(digits));
        scene.view.width = format!("{width:.2e}");
        if self.random.u8(0..3) == 0 {
            scene.view.rotate = f64::from(self.random.i16(-180..180));
        }
        if self.random.u8(0..4) == 0 {
            scene.view.stretch = Self::round(self.magnitude(-6.0, 6.0), 2);
        }
    }

    /// Any place of a plane, in the units of its axes.
    fn anywhere(&mut self, scene: &Scene) -> [Exact; 2] {
        let unit_secs = scene.build.unit_secs();
        let pendulum = scene.build.pendulum();
        scene.plane.axes().map(|axis| {
            let share = 2.0 * self.random.f64() - 1.0;
            let value = match axis {
                Axis::Theta1 | Axis::Theta2 => self.angle(),
                Axis::Omega1 | Axis::Omega2 => 6.0 * share / unit_secs,
                Axis::Momentum2 => {
                    let kinetic = scene.plane.energy + pendulum.p + pendulum.q;
                    share * (2.0 * pendulum.b * kinetic.max(0.0)).sqrt()
                }
            };
            Exact::from_f64(Self::round(value, 6))
        })
    }

    /// Puts a bob at the top or beside it, by the view's centre or by the plane's origin.
    fn beside_top(&mut self, scene: &mut Scene, center: &mut [Exact; 2]) {
        let far = Exact::parse(&format!("{:e}", self.magnitude(NEAREST_TOP, -1.0)));
        let far = far.unwrap_or(Exact::ZERO);
        let off = self.random.choice([Exact::ZERO, far, -far]).unwrap_or_default();
        let top = (Exact::pi() + off).wrapped();
        let axis = self.random.choice([Axis::Theta1, Axis::Theta2]).unwrap_or(Axis::Theta2);
        match scene.plane.axes().iter().position(|other| *other == axis) {
            Some(place) => center[place] = top,
            None if scene.plane.kind == PlaneKind::Section => center[0] = top,
            None => {
                let place = usize::from(axis == Axis::Theta2);
                scene.plane.origin[place] = top.decimal(100);
            }
        }
    }

    fn angle(&mut self) -> f64 {
        (self.random.f64() - 0.5) * std::f64::consts::TAU
    }

    /// A small angle: zero, or a random distance that a view of this width may or may not show.
    fn off(&mut self, width: f64) -> Exact {
        let far = width * self.magnitude(-6.0, 0.0);
        let off = self.random.choice([0.0, far, -far]).unwrap_or_default();
        Exact::from_f64(off)
    }

    /// Moves θ2 onto the curve of just enough energy, if that exists at this θ1.
    fn on_curve(&mut self, scene: &Scene, center: &mut [Exact; 2]) {
        let (pendulum, _) = scene.build.reduced_in::<Exact>();
        let least = pendulum.least_depth(scene.question.rule);
        let cos = (least - pendulum.p * center[0].sin_cos().1) / pendulum.q;
        if cos.to_f64().abs() >= 1.0 {
            return;
        }
        // Newton's method on cos θ2, from the nearest f64.
        let mut theta = Exact::from_f64(cos.to_f64().acos());
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
        keep_going: &dyn Fn() -> bool,
    ) -> Result<(), EngineError> {
        let least = self.magnitude(-30.0, -1.0);
        let budget = scene.question.budget;
        let target = [self.random.f64() - 0.5, self.random.f64() - 0.5];
        let mut descent = Descent::new(scene.clone(), config, target);
        while scene.view.width_rad().to_f64() > least {
            match descent.next(engine, keep_going)? {
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
        keep_going: &dyn Fn() -> bool,
    ) -> Result<(), EngineError> {
        let least = self.magnitude(-25.0, -6.0);
        let unit = scene.build.unit_secs();
        (scene.view.rotate, scene.view.stretch) = (0.0, 1.0);
        scene.view.width = format!("{:.2e}", scene.view.width_rad().to_f64().min(0.5));
        while scene.view.width_rad().to_f64() > least && keep_going() {
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
