//! What the samples of a survey say.

use flipmap_estimate::boxes::{BoxDimension, Raster, dimension};
use flipmap_estimate::entropy::{Boxes, Entropy, entropy};
use flipmap_estimate::fat::{FatFractal, fat_fractal};
use flipmap_estimate::pairs::{Exponent, PairScale, exponent};
use flipmap_estimate::rates::{
    RateDistribution, ReplicateRates, distribution, regular_bound, regular_share,
};
use flipmap_estimate::shares::{ClassCounts, share};
use flipmap_estimate::survival::{Lives, SurvivalPoint, Tail, survival, tail};
use flipmap_estimate::wada::{Wada, wada};
use flipmap_estimate::{Estimate, EstimateError};
use serde::Serialize;

use crate::basins::names;
use crate::forbidden::forbidden_share;
use crate::order::{Statistic, SurveyOrder};
use crate::sampling::{PICTURE_SIDE, Sampled, unit};

/// Everything that a survey found. A statistic that was not ordered is `None`; one that could not be
/// estimated is among the missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Findings {
    /// The areas.
    pub areas: Option<Areas>,
    /// The survival.
    pub survival: Option<SurvivalFindings>,
    /// The uncertainty exponent.
    pub edges: Option<Edges>,
    /// The box-counting dimension.
    pub boxes: Option<BoxDimension>,
    /// The entropies, the largest boxes first.
    pub entropy: Option<Vec<Entropy>>,
    /// Whether three basins share one boundary.
    pub wada: Option<Wada>,
    /// The exponents of growth.
    pub growth: Option<GrowthFindings>,
    /// The exponent of a fat fractal.
    pub fat: Option<FatFractal>,
    /// What could not be estimated.
    pub missing: Vec<Missing>,
}

/// A statistic without an estimate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Missing {
    /// Name of the statistic.
    pub what: &'static str,
    /// The reason.
    pub why: String,
    /// The reason as it came.
    #[serde(skip)]
    pub error: EstimateError,
}

/// Shares of the view.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Areas {
    /// The share of each class, and what energy forbids.
    pub classes: Vec<(String, Estimate)>,
    /// Shares that flip between two times, s.
    pub flips: Vec<(f64, f64, Estimate)>,
    /// The share of starts whose answer nobody is sure of.
    pub unsure: f64,
    /// Number of starts.
    pub starts: u64,
}

/// The survival of the starts that may flip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurvivalFindings {
    /// The share not yet flipped.
    pub curve: Vec<SurvivalPoint>,
    /// The law of the tail, if there are enough late flips.
    pub tail: Option<Tail>,
}

/// The roughness of the edges.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Edges {
    /// Distances of pairs in the units of the plane, and the share of pairs whose answers differ.
    pub shares: Vec<(f64, Estimate)>,
    /// The exponents.
    pub exponent: Exponent,
    /// The share of pairs of which nobody is sure.
    pub unsure: f64,
}

/// Exponents of growth over the budget.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GrowthFindings {
    /// The distribution in the view, rates in 1/s.
    pub view: RateDistribution,
    /// The share of regular starts on sections θ1 = 0 of constant energy, weighted by dθ2 dp2.
    pub sections: Vec<SectionShare>,
}

/// The share of regular starts on a section.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SectionShare {
    /// The energy in J, from hanging at rest.
    pub energy: f64,
    /// The share of regular starts.
    pub regular: Estimate,
}

/// All samples of a survey, sorted by kind.
#[derive(Default)]
struct Sorted<'a> {
    forbidden: Vec<u64>,
    counts: Vec<ClassCounts>,
    lives: Vec<Lives>,
    pairs: Vec<PairScale>,
    boxes: Vec<Boxes>,
    picture: Option<(&'a [u8], &'a [u32])>,
    rates: Vec<ReplicateRates>,
    sections: Vec<(f64, &'a [ReplicateRates])>,
}

impl<'a> Sorted<'a> {
    fn new(samples: impl Iterator<Item = &'a Sampled>) -> Self {
        let mut sorted = Sorted::default();
        for sampled in samples {
            match sampled {
                Sampled::Starts { forbidden, counts, lives } => {
                    sorted.forbidden.push(*forbidden);
                    sorted.counts.push(counts.clone());
                    sorted.lives.push(lives.clone());
                }
                Sampled::Pairs(pairs) => sorted.pairs.push(pairs.clone()),
                Sampled::Boxes(boxes) => sorted.boxes.push(boxes.clone()),
                Sampled::Picture { classes, unsure } => sorted.picture = Some((classes, unsure)),
                Sampled::Exponents(rates) => sorted.rates.push(rates.clone()),
                Sampled::Section { energy, groups } => sorted.sections.push((*energy, groups)),
            }
        }
        sorted
    }
}

/// Estimates everything that was ordered from the samples, in the order of their stages.
pub(crate) fn findings<'a>(
    order: &SurveyOrder,
    samples: impl Iterator<Item = &'a Sampled>,
) -> Findings {
    let sorted = Sorted::new(samples);
    let mut found = Findings::default();
    for statistic in &order.of {
        let done = match statistic {
            Statistic::Areas => areas(order, &sorted).map(|areas| found.areas = Some(areas)),
            Statistic::Survival => lasting(order, &sorted).map(|it| found.survival = Some(it)),
            Statistic::Edges => edges(order, &sorted).map(|edges| found.edges = Some(edges)),
            Statistic::Boxes => box_counts(&sorted).map(|boxes| found.boxes = Some(boxes)),
            Statistic::Entropy => {
                let all = sorted.boxes.iter().map(entropy).collect::<Result<_, _>>();
                all.map(|all| found.entropy = Some(all))
            }
            Statistic::Wada => shared(&sorted).map(|wada| found.wada = Some(wada)),
            Statistic::Growth => growth(order, &sorted).map(|it| found.growth = Some(it)),
            Statistic::Fat => {
                fat_fractal(&sorted.boxes, order.seed).map(|fat| found.fat = Some(fat))
            }
        };
        if let Err(error) = done {
            let (what, why) = (statistic.name(), error.to_string());
            found.missing.push(Missing { what, why, error });
        }
    }
    found
}

/// Returns the share of the view that is forbidden: the integral where there is one.
fn forbidden(order: &SurveyOrder, sorted: &Sorted) -> Result<Estimate, EstimateError> {
    if let Some(exact) = forbidden_share(&order.scene) {
        return Ok(exact);
    }
    let count = |(forbidden, counts): (&u64, &ClassCounts)| ClassCounts {
        sure: vec![*forbidden, counts.total()],
        unsure: vec![0; 2],
    };
    let counts: Vec<ClassCounts> = sorted.forbidden.iter().zip(&sorted.counts).map(count).collect();
    share(&counts, 0)
}

/// Upper ends of the times between which flips are counted, s.
const FLIP_SECS: [f64; 12] = [1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 100.0, 300.0];

fn areas(order: &SurveyOrder, sorted: &Sorted) -> Result<Areas, EstimateError> {
    let names = names(order.scene.question.ask);
    let forbidden = forbidden(order, sorted)?;
    // The integral leaves only what may flip to chance.
    let open = 1.0 - forbidden.value;
    let of_all = |share: Estimate| {
        let at = |share: f64, open: f64| share * open;
        Estimate {
            value: at(share.value, open),
            low: at(share.low, 1.0 - forbidden.high),
            high: at(share.high, 1.0 - forbidden.low),
        }
    };
    let mut classes = Vec::new();
    for (class, name) in names.iter().enumerate() {
        classes.push((name.to_string(), of_all(share(&sorted.counts, class)?)));
    }
    classes.push(("forbidden".to_string(), forbidden));
    let budget = order.scene.question.end_secs();
    let mut ends: Vec<f64> = FLIP_SECS.into_iter().filter(|secs| *secs < budget).collect();
    ends.push(budget);
    let between: Vec<ClassCounts> =
        sorted.lives.iter().map(|lives| counts_between(lives, &ends)).collect();
    let mut flips = Vec::new();
    for (k, end) in ends.iter().enumerate() {
        let from = if k == 0 { 0.0 } else { ends[k - 1] };
        flips.push((from, *end, of_all(share(&between, k)?)));
    }
    let total: u64 = sorted.counts.iter().map(ClassCounts::total).sum();
    let starts = total + sorted.forbidden.iter().sum::<u64>();
    let unsure: u64 = sorted.counts.iter().flat_map(|counts| &counts.unsure).sum();
    Ok(Areas { classes, flips, unsure: unsure as f64 / starts.max(1) as f64, starts })
}

/// Sorts lives by the interval in which they end; the last class never does.
fn counts_between(lives: &Lives, ends: &[f64]) -> ClassCounts {
    let mut counts = ClassCounts::new(ends.len() + 1);
    let class = |secs: &f64| ends.partition_point(|end| end < secs).min(ends.len() - 1);
    lives.sure.iter().for_each(|secs| counts.add(class(secs), true));
    lives.seeming.iter().for_each(|secs| counts.add(class(secs), false));
    counts.sure[ends.len()] += lives.survivors;
    counts.unsure[ends.len()] += lives.seeming_survivors;
    counts
}

/// Number of points of a survival curve.
const CURVE_POINTS: usize = 120;

fn lasting(order: &SurveyOrder, sorted: &Sorted) -> Result<SurvivalFindings, EstimateError> {
    let budget = order.scene.question.end_secs();
    let first = 0.5 * order.scene.build.unit_secs();
    let time = |k: usize| {
        let part = k as f64 / (CURVE_POINTS - 1) as f64;
        first.min(budget) * (budget / first).max(1.0).powf(part)
    };
    let times: Vec<f64> = (0..CURVE_POINTS).map(time).collect();
    let curve = survival(&sorted.lives, &times)?;
    Ok(SurvivalFindings { curve, tail: tail(&sorted.lives, budget).ok() })
}

fn edges(order: &SurveyOrder, sorted: &Sorted) -> Result<Edges, EstimateError> {
    let coarsest = 0.05 * unit(&order.scene);
    let exponent = exponent(&sorted.pairs, coarsest, order.seed)?;
    let shares = sorted.pairs.iter().map(|pairs| (pairs.epsilon, pairs.share())).collect();
    let groups = || sorted.pairs.iter().flat_map(|pairs| &pairs.groups);
    let unsure: u64 = groups().map(|group| group.unsure).sum();
    let total: u64 = groups().map(|group| group.total).sum();
    Ok(Edges { shares, exponent, unsure: unsure as f64 / total.max(1) as f64 })
}

/// Class of pixels of which nobody is sure, where they count as rough as they can be.
const ANY: u8 = u8::MAX;

/// Counts boxes with unsure pixels as they seem and as a class of their own; the interval holds both.
fn box_counts(sorted: &Sorted) -> Result<BoxDimension, EstimateError> {
    let (classes, unsure) = sorted.picture.unwrap_or((&[], &[]));
    let side = PICTURE_SIDE as usize;
    let seeming = dimension(&Raster { classes: classes.to_vec(), side })?;
    if unsure.is_empty() {
        return Ok(seeming);
    }
    let mut marked = classes.to_vec();
    unsure.iter().for_each(|index| marked[*index as usize] = ANY);
    let most = dimension(&Raster { classes: marked, side })?;
    Ok(BoxDimension { dimension: seeming.dimension.and(most.dimension), ..seeming })
}

/// Compares merged boundaries in the picture and in every second pixel of it.
fn shared(sorted: &Sorted) -> Result<Wada, EstimateError> {
    let (classes, _) = sorted.picture.unwrap_or((&[], &[]));
    let side = PICTURE_SIDE as usize;
    let thinned = |step: usize| {
        let pixel = |k: usize| classes[k / (side / step) * step * side + k % (side / step) * step];
        let count = (side / step).pow(2);
        Raster { classes: (0..count).map(pixel).collect(), side: side / step }
    };
    wada(&[4, 2, 1].map(thinned))
}

fn growth(order: &SurveyOrder, sorted: &Sorted) -> Result<GrowthFindings, EstimateError> {
    let scene = &order.scene;
    let bound = regular_bound(scene.question.budget.secs, scene.build.unit_secs());
    let pendulum = scene.build.pendulum();
    let section = |(energy, groups): &(f64, &[ReplicateRates])| {
        let regular = regular_share(groups, bound)?;
        Ok(SectionShare { energy: energy + pendulum.p + pendulum.q, regular })
    };
    let sections = sorted.sections.iter().map(section).collect::<Result<_, _>>()?;
    Ok(GrowthFindings { view: distribution(&sorted.rates, bound)?, sections })
}
