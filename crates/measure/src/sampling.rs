//! The samples of a scene: scattered starts, close pairs, small boxes, a picture, exponents of growth.

use flipmap_engine::EngineError;
use flipmap_estimate::entropy::Boxes;
use flipmap_estimate::pairs::{PairCounts, PairScale};
use flipmap_estimate::rates::ReplicateRates;
use flipmap_estimate::scatter::scattered;
use flipmap_estimate::shares::ClassCounts;
use flipmap_estimate::survival::Lives;
use flipmap_pendulum::Status;
use flipmap_render::Watch;
use flipmap_render::tiles::{Points, Renderer, Samples};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Grid, Plane, PlaneKind, Scene, View};
use serde::{Deserialize, Serialize};

use crate::basins::{class, flip_secs, is_sure, names};
use crate::order::SurveyOrder;

/// A part of the samples, computed in one piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    /// One replicate of scattered starts.
    Starts(u32),
    /// Pairs of starts, by the number of decades that they are closer than 1 / 2π of the view.
    PairsApart(u32),
    /// Boxes of starts, by half decades.
    BoxesOf(u32),
    /// A picture of the classes.
    Picture,
    /// One replicate of exponents of growth.
    Exponents(u32),
    /// Exponents on the section with one of the energies.
    SectionAt(u32),
}

/// What a stage brought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Sampled {
    Starts { forbidden: u64, counts: ClassCounts, lives: Lives },
    Pairs(PairScale),
    Boxes(Boxes),
    Picture { classes: Vec<u8>, unsure: Vec<u32> },
    Exponents(ReplicateRates),
    Section { energy: f64, groups: Vec<ReplicateRates> },
}

impl Sampled {
    /// Returns true if it is of a stage: a kept file may be damaged or another's.
    pub(crate) fn is_of(&self, stage: Stage) -> bool {
        let replicates = REPLICATES as usize;
        match (self, stage) {
            (Sampled::Starts { .. }, Stage::Starts(_)) => true,
            (Sampled::Pairs(pairs), Stage::PairsApart(_)) => pairs.groups.len() == replicates,
            (Sampled::Boxes(boxes), Stage::BoxesOf(_)) => boxes.groups.len() == replicates,
            (Sampled::Picture { classes, unsure }, Stage::Picture) => {
                let count = PICTURE_SIDE.pow(2);
                classes.len() == count as usize && unsure.iter().all(|index| *index < count)
            }
            (Sampled::Exponents(_), Stage::Exponents(_)) => true,
            (Sampled::Section { groups, .. }, Stage::SectionAt(_)) => groups.len() == replicates,
            _ => false,
        }
    }
}

/// Number of replicates of everything.
pub(crate) const REPLICATES: u32 = 16;
/// Number of decades of distances of pairs.
const DECADES: u32 = 14;
/// Sizes of boxes, in half decades.
const HALF_DECADES: std::ops::RangeInclusive<u32> = 2..=10;
/// Pixels along a side of a box.
const BOX_PIXELS: u32 = 5;
/// Pixels along a side of the picture.
pub(crate) const PICTURE_SIDE: u32 = 1024;
/// Pixels along a side of the grid on which scattered starts lie.
const GRID_SIDE: u32 = 1 << 31;
/// Number of samples for one pair, one box, and one exponent of the view and of a section: a checked
/// exponent takes as long as some hundred checked flips.
const PAIR_SHARE: u32 = 10;
const BOX_SHARE: u32 = 2 * BOX_PIXELS * BOX_PIXELS;
const VIEW_SHARE: u32 = 64;
const SECTION_SHARE: u32 = 320;
/// Smallest distance between starts, in the units of the plane: angles in double-double have errors of
/// 1e-31.
const FINEST: f64 = 1e-27;
/// Energies of sections, as shares of P + Q, the energy of both rods pointing up.
const SECTION_ENERGIES: [f64; 9] = [-0.9, -0.7, -0.5, -0.25, 0.0, 0.5, 1.0, 2.0, 4.0];

impl Stage {
    /// All stages, in the order in which they are computed.
    pub(crate) fn all() -> Vec<Stage> {
        let starts = (0..REPLICATES).map(Stage::Starts);
        let pairs = (1..=DECADES).map(Stage::PairsApart);
        let boxes = HALF_DECADES.map(Stage::BoxesOf);
        let exponents = (0..REPLICATES).map(Stage::Exponents);
        let sections = (0..SECTION_ENERGIES.len() as u32).map(Stage::SectionAt);
        let first = starts.chain(pairs).chain(boxes).chain([Stage::Picture]);
        first.chain(exponents).chain(sections).collect()
    }

    /// Returns true if it is of use in a scene: double-double tells its starts apart, or energy is kept.
    pub(crate) fn is_useful(self, scene: &Scene) -> bool {
        match self {
            Stage::PairsApart(decades) => distance_of(scene, decades) >= FINEST,
            Stage::BoxesOf(half_decades) => side_of(scene, half_decades) >= 10.0 * FINEST,
            // With friction, energy is not constant.
            Stage::SectionAt(_) => !scene.build.has_friction(),
            Stage::Starts(_) | Stage::Picture | Stage::Exponents(_) => true,
        }
    }

    /// The name under which it is kept.
    pub(crate) fn name(self) -> String {
        match self {
            Stage::Starts(k) => format!("starts-{k}"),
            Stage::PairsApart(k) => format!("pairs-1e-{k}"),
            Stage::BoxesOf(k) => format!("boxes-{k}"),
            Stage::Picture => "picture".to_string(),
            Stage::Exponents(k) => format!("exponents-{k}"),
            Stage::SectionAt(k) => format!("section-{k}"),
        }
    }

    /// Number of starts that it computes.
    pub(crate) fn size(self, order: &SurveyOrder) -> u64 {
        let of_all = |share| u64::from(REPLICATES * per_replicate(order, share));
        match self {
            Stage::Starts(_) => u64::from(per_replicate(order, 1)),
            Stage::PairsApart(_) => 2 * of_all(PAIR_SHARE),
            Stage::BoxesOf(_) => u64::from(BOX_PIXELS * BOX_PIXELS) * of_all(BOX_SHARE),
            Stage::Picture => u64::from(PICTURE_SIDE).pow(2),
            Stage::Exponents(_) => u64::from(per_replicate(order, VIEW_SHARE)),
            Stage::SectionAt(_) => of_all(SECTION_SHARE),
        }
    }

    /// Computes the stage; `None` if `watch` stops it.
    pub(crate) fn sample(
        self,
        order: &SurveyOrder,
        renderer: &mut Renderer,
        watch: &dyn Watch,
    ) -> Result<Option<Sampled>, EngineError> {
        let sampler = Sampler { order, renderer, watch };
        match self {
            Stage::Starts(replicate) => sampler.starts(replicate),
            Stage::PairsApart(decades) => sampler.pairs(decades),
            Stage::BoxesOf(half_decades) => sampler.boxes(half_decades),
            Stage::Picture => sampler.picture(),
            Stage::Exponents(replicate) => sampler.exponents(replicate),
            Stage::SectionAt(place) => sampler.section(place),
        }
    }
}

/// Computes one stage.
struct Sampler<'a> {
    order: &'a SurveyOrder,
    renderer: &'a mut Renderer,
    watch: &'a dyn Watch,
}

type StageResult = Result<Option<Sampled>, EngineError>;

impl Sampler<'_> {
    fn ask(&self) -> QuestionName {
        self.order.scene.question.ask
    }

    /// Answers points of a scene, and returns what is made of them.
    fn answer(
        self,
        scene: &Scene,
        points: &Points,
        made: impl FnOnce(Samples) -> Sampled,
    ) -> StageResult {
        Ok(self.renderer.answers_at(scene, points, self.watch)?.map(made))
    }

    fn starts(self, replicate: u32) -> StageResult {
        let count = per_replicate(self.order, 1);
        let points = scattered_points(
            &self.order.scene,
            self.order.seed_of(0),
            replicate..replicate + 1,
            count,
        );
        let (order, ask) = (self.order, self.ask());
        self.answer(&order.scene, &points, |samples| {
            let (mut counts, mut lives) = (ClassCounts::new(names(ask).len()), Lives::default());
            let mut forbidden = 0;
            for index in 0..samples.len() {
                if samples.get(index).status == Status::Forbidden {
                    forbidden += 1;
                    continue;
                }
                let is_sure = is_sure(&samples, index);
                counts.add(class(ask, &samples, index), is_sure);
                match (flip_secs(ask, &samples, index), is_sure) {
                    (Some(secs), true) => lives.sure.push(secs),
                    (Some(secs), false) => lives.seeming.push(secs),
                    (None, true) => lives.survivors += 1,
                    (None, false) => lives.seeming_survivors += 1,
                }
            }
            Sampled::Starts { forbidden, counts, lives }
        })
    }

    fn pairs(self, decades: u32) -> StageResult {
        let SurveyOrder { scene, apart_secs, .. } = self.order;
        let epsilon = distance_of(scene, decades);
        let count = per_replicate(self.order, PAIR_SHARE);
        let seed = self.order.seed_of(1000 + u64::from(decades));
        // Half of the pairs lie side by side, half one above the other.
        let sizes = [[2, 1], [1, 2]];
        let points =
            groups_of_points(scene, seed, count, |k| ([epsilon; 2], sizes[k as usize % 2]));
        let (ask, apart_secs) = (self.ask(), *apart_secs);
        self.answer(scene, &points, |samples| {
            let pair = |k: usize| differs(ask, &samples, [2 * k, 2 * k + 1], apart_secs);
            let group = |replicate: u32| {
                let mut counts = PairCounts { total: count.into(), ..PairCounts::default() };
                let first = (replicate * count) as usize;
                for (differs, is_sure) in (first..first + count as usize).map(pair) {
                    counts.differing += u64::from(differs && is_sure);
                    counts.unsure += u64::from(!is_sure);
                    counts.seeming += u64::from(differs && !is_sure);
                }
                counts
            };
            Sampled::Pairs(PairScale { epsilon, groups: (0..REPLICATES).map(group).collect() })
        })
    }

    fn boxes(self, half_decades: u32) -> StageResult {
        let scene = &self.order.scene;
        let side = side_of(scene, half_decades);
        let pixels = BOX_PIXELS * BOX_PIXELS;
        let count = per_replicate(self.order, BOX_SHARE);
        let seed = self.order.seed_of(2000 + u64::from(half_decades));
        let pixel = side / f64::from(BOX_PIXELS);
        let points = groups_of_points(scene, seed, count, |_| ([pixel; 2], [BOX_PIXELS; 2]));
        let ask = self.ask();
        self.answer(scene, &points, |samples| {
            let one = |k: u32| {
                let mut counts = ClassCounts::new(names(ask).len());
                for index in (k * pixels) as usize..((k + 1) * pixels) as usize {
                    counts.add(class(ask, &samples, index), is_sure(&samples, index));
                }
                counts
            };
            let group = |replicate| (replicate * count..(replicate + 1) * count).map(one).collect();
            Sampled::Boxes(Boxes { side, groups: (0..REPLICATES).map(group).collect() })
        })
    }

    fn picture(self) -> StageResult {
        let ask = self.ask();
        let size = [PICTURE_SIDE; 2];
        let samples = self.renderer.render_while(&self.order.scene, size, self.watch)?;
        Ok(samples.map(|samples| {
            let count = samples.len() as u32;
            let unsure = (0..count).filter(|index| !is_sure(&samples, *index as usize)).collect();
            let class = |index: u32| class(ask, &samples, index as usize) as u8;
            Sampled::Picture { classes: (0..count).map(class).collect(), unsure }
        }))
    }

    fn exponents(self, replicate: u32) -> StageResult {
        let scene = growing(&self.order.scene);
        let count = per_replicate(self.order, VIEW_SHARE);
        let seed = self.order.seed_of(3000);
        let points = scattered_points(&scene, seed, replicate..replicate + 1, count);
        self.answer(&scene, &points, |samples| {
            Sampled::Exponents(rates(&samples, 0..samples.len()))
        })
    }

    fn section(self, place: u32) -> StageResult {
        let (scene, energy) = section_of(&self.order.scene, place);
        let count = per_replicate(self.order, SECTION_SHARE);
        let seed = self.order.seed_of(4000 + u64::from(place));
        let points = scattered_points(&scene, seed, 0..REPLICATES, count);
        self.answer(&scene, &points, |samples| {
            let group = |replicate: u32| {
                let first = (replicate * count) as usize;
                rates(&samples, first..first + count as usize)
            };
            Sampled::Section { energy, groups: (0..REPLICATES).map(group).collect() }
        })
    }
}

/// Number of points in each replicate, if each takes the place of `share` samples.
fn per_replicate(order: &SurveyOrder, share: u32) -> u32 {
    (order.samples / REPLICATES / share).max(1)
}

/// The length, in the units of the plane's axes, that distances are measured by: 1 rad for a view as wide
/// as the torus, and in proportion to the shorter side of any other.
pub(crate) fn unit(scene: &Scene) -> f64 {
    scene.view.width_rad().hi / scene.view.stretch.max(1.0) / std::f64::consts::TAU
}

/// The distance of the pairs of a stage.
fn distance_of(scene: &Scene, decades: u32) -> f64 {
    unit(scene) * 10f64.powi(-(decades as i32))
}

/// The side of the boxes of a stage.
fn side_of(scene: &Scene, half_decades: u32) -> f64 {
    unit(scene) * 10f64.powf(-0.5 * f64::from(half_decades))
}

/// Returns the pixel of a fine grid at a scattered point.
fn pixel([x, y]: [u32; 2]) -> [u32; 2] {
    [x >> 1, y >> 1]
}

/// Returns scattered starts of a scene's view.
fn scattered_points(
    scene: &Scene,
    seed: u64,
    replicates: std::ops::Range<u32>,
    count: u32,
) -> Points {
    let place =
        |replicate| (0..count).map(move |index| (0, pixel(scattered(seed, replicate, index))));
    let grids = vec![Grid::new(scene, [GRID_SIDE; 2])];
    Points { grids, pixels: replicates.flat_map(place).collect() }
}

/// Returns small grids around scattered points, `count` in each replicate; `shape` has the sides of the
/// pixels of a grid and its size.
fn groups_of_points(
    scene: &Scene,
    seed: u64,
    count: u32,
    shape: impl Fn(u32) -> ([f64; 2], [u32; 2]),
) -> Points {
    let grid = Grid::new(scene, [GRID_SIDE; 2]);
    let mut points = Points::default();
    for (replicate, index) in (0..REPLICATES).flat_map(|r| (0..count).map(move |k| (r, k))) {
        let (sides, size) = shape(index);
        points.push_all(grid.around(pixel(scattered(seed, replicate, index)), sides, size));
    }
    points
}

/// Returns whether two samples differ, and whether that is sure.
fn differs(
    ask: QuestionName,
    samples: &Samples,
    pair: [usize; 2],
    apart_secs: Option<f64>,
) -> (bool, bool) {
    let [a, b] = pair.map(|index| class(ask, samples, index));
    let times = pair.map(|index| flip_secs(ask, samples, index));
    let are_apart = match (times, apart_secs) {
        ([Some(one), Some(other)], Some(most)) => (one - other).abs() > most,
        _ => false,
    };
    (a != b || are_apart, pair.iter().all(|index| is_sure(samples, *index)))
}

/// Returns the exponents of samples; those that the energy does not allow are left out.
fn rates(samples: &Samples, range: std::ops::Range<usize>) -> ReplicateRates {
    let mut rates = ReplicateRates::default();
    for index in range {
        if samples.get(index).status != Status::Answered {
            continue;
        }
        let all = if is_sure(samples, index) { &mut rates.sure } else { &mut rates.unsure };
        all.push(samples.values(index)[0]);
    }
    rates
}

/// The scene with the question of growth.
pub(crate) fn growing(scene: &Scene) -> Scene {
    let mut growing = scene.clone();
    growing.question.ask = QuestionName::Growth;
    growing.without_unused()
}

/// Returns the scene of one section, all of it, and its energy in J.
fn section_of(scene: &Scene, place: u32) -> (Scene, f64) {
    let pendulum = scene.build.pendulum();
    let top = pendulum.p + pendulum.q;
    let energy = SECTION_ENERGIES[place as usize] * top;
    let most = (2.0 * pendulum.b * (energy + top)).sqrt();
    let plane = Plane { kind: PlaneKind::Section, energy, ..Plane::default() };
    let stretch = std::f64::consts::PI / most;
    let width = std::f64::consts::TAU.to_string();
    let view = View { width, stretch, ..View::default() };
    (Scene { plane, view, ..growing(scene) }, energy)
}
