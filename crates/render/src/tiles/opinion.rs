//! A second opinion on a picture whose answers come from start maps or first moments: integrates
//! some of its pixels directly.

use super::Samples;
use super::direct_check::{AnsweredPixel, DirectCheck};
use super::open_tile::OpenTile;
use super::reader::Reader;
use flipmap_engine::trust::{Opinion, TrustEngine};
use flipmap_engine::{
    Cells, Engine, EngineError, EventSpec, IntegratorConfig, Keep, Starts, Trust, run_job,
};
use flipmap_pendulum::Status;
use flipmap_scene::{Grid, Scene};

/// Maximum number of pixels that are integrated directly.
const MAX_PIXELS: usize = 8;
/// Number of random pixels from which those are chosen, because some may be forbidden or marked.
const CANDIDATES: usize = 32;

/// Integrates some pixels of a picture of `size` pixels directly, if start maps or first moments
/// answer any of them. If one contradicts its answer, `engine` marks every pixel as uncertain from
/// then on. Returns `None` for other pictures, or once `keep_going` returns false.
pub fn opinion(
    scene: &Scene,
    size: [u32; 2],
    (config, cells): (IntegratorConfig, Cells),
    engine: &mut TrustEngine<'_>,
    keep_going: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Opinion>, EngineError> {
    engine.distrust(false);
    let grid = Grid::new(scene, size);
    let Some(check) = DirectCheck::new(scene, &grid) else { return Ok(None) };
    let pixels = random_pixels(scene, size);
    let open = OpenTile::of_pixels(&grid, config, cells, &pixels, |_| None);
    let is_deep = matches!(open.starts, Starts::Deep(_));
    let is_told = |place: &usize| {
        let [column, row] = pixels[*place];
        is_deep || grid.is_beside_top(column, row)
    };
    let told: Vec<usize> = (0..pixels.len()).filter(is_told).collect();
    if told.is_empty() {
        return Ok(None);
    }
    let phase = |place: usize| grid.phase_at_first_pass(pixels[place][0], pixels[place][1]);
    let Some(samples) = answers(scene, open, config, engine, &phase, keep_going)? else {
        return Ok(None);
    };
    // In the pixels' order, which is random, unlike that of leaves.
    let is_sure = |place: &usize| {
        samples.trust(*place) != Trust::Uncertain && samples.get(*place).status != Status::Forbidden
    };
    let answered = |place: usize| AnsweredPixel {
        pixel: pixels[place],
        status: samples.get(place).status,
        values: samples.values(place).to_vec(),
    };
    let asked: Vec<_> = told.into_iter().filter(is_sure).take(MAX_PIXELS).map(answered).collect();
    let opinion = check.opinion(&asked, keep_going);
    engine.distrust(opinion.is_some_and(|opinion| opinion.contradicted > 0));
    Ok(opinion)
}

/// Computes the samples of an open tile as those of a picture; returns `None` once `keep_going`
/// returns false.
fn answers(
    scene: &Scene,
    open: OpenTile,
    config: IntegratorConfig,
    engine: &mut dyn Engine,
    phase: &dyn Fn(usize) -> Option<flipmap_pendulum::phase::Phase<f64>>,
    keep_going: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Samples>, EngineError> {
    let question = EventSpec::from(scene);
    let reader = Reader::new(scene.question.ask, &question);
    let OpenTile { samples, places, starts } = open;
    let mut samples = reader.complete(samples, phase);
    if places.is_empty() {
        return Ok(Some(samples));
    }
    let keep = Keep { ends: reader.ends(), states: false };
    let Some(result) = run_job(engine, question, config, starts, keep, &|| keep_going())? else {
        return Ok(None);
    };
    reader.fill(&result, &places, &mut samples);
    for (&place, &assurance) in places.iter().zip(&result.assurances) {
        samples.assure(place as usize, assurance);
    }
    Ok(Some(samples))
}

/// Draws random pixels; the seed depends only on the centre and width of the view.
fn random_pixels(scene: &Scene, size: [u32; 2]) -> Vec<[u32; 2]> {
    let text = scene.view.center.concat() + &scene.view.width;
    let seed =
        text.bytes().fold(0u64, |seed, byte| seed.wrapping_mul(31).wrapping_add(u64::from(byte)));
    let mut random = fastrand::Rng::with_seed(seed);
    (0..CANDIDATES).map(|_| size.map(|side| random.u32(0..side))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::outlook::outlook;
    use super::*;
    use flipmap_engine::cpu::CpuEngine;
    use flipmap_engine::depth::DepthEngine;
    use flipmap_engine::depth::sabotage::Sabotage;
    use flipmap_engine::level::BALANCED;
    use flipmap_scene::question::QuestionName;
    use flipmap_scene::{Budget, QuestionSettings, View};

    const SIZE: [u32; 2] = [32, 32];

    fn scene(center: [&str; 2], width: &str, ask: QuestionName, secs: f64) -> Scene {
        let view =
            View { center: center.map(str::to_string), width: width.into(), ..View::default() };
        let question =
            QuestionSettings { ask, budget: Budget::secs(secs), ..QuestionSettings::default() };
        Scene { view, question, ..Scene::default() }.checked().unwrap()
    }

    /// Returns a view deep enough for neighbours to move far apart.
    fn deep(ask: QuestionName, secs: f64) -> Scene {
        let center = ["-1.65907312822246439054652000777423381805419921875", "0.1"];
        scene(center, "1e-9", ask, secs)
    }

    /// Returns a view whose starts pass the top a little after their first moments.
    fn near_the_top() -> Scene {
        scene(["0.62", "-3.1365"], "1e-9", QuestionName::Flip, 20.0)
    }

    fn engine(sabotage: Option<Sabotage>) -> DepthEngine<'static> {
        let engine = DepthEngine::new(Box::new(CpuEngine::new(Some(2)).unwrap()), Some(2)).unwrap();
        match sabotage {
            Some(sabotage) => engine.sabotaged(sabotage),
            None => engine,
        }
    }

    fn opinion_on(scene: &Scene, sabotage: Option<Sabotage>) -> Opinion {
        let mut engine = TrustEngine::new(Box::new(engine(sabotage)), Some(2)).unwrap();
        let how = (BALANCED, Cells::Auto);
        opinion(scene, SIZE, how, &mut engine, &|| true).unwrap().expect("deep")
    }

    fn estimate(
        scene: &Scene,
        sabotage: Option<Sabotage>,
    ) -> flipmap_engine::trust::AccuracyEstimate {
        let how = (BALANCED, Cells::Auto);
        outlook(scene, SIZE, how, &mut engine(sabotage), &|| true).unwrap().unwrap()
    }

    const MISTAKES: [Sabotage; 2] = [Sabotage::Coefficient, Sabotage::WideLeaf];

    #[test]
    fn wrong_start_maps_are_contradicted_and_right_ones_are_not() {
        let flips = deep(QuestionName::Flip, 40.0);
        let all = MISTAKES.map(|mistake| (&flips, mistake));
        let top = near_the_top();
        for (scene, mistake) in all.into_iter().chain([(&top, Sabotage::BlindOpening)]) {
            let right = opinion_on(scene, None);
            assert!(right.asked == 8 && right.contradicted == 0, "{mistake:?}: {right:?}");
            assert_eq!(right.warning(), None);
            let wrong = opinion_on(scene, Some(mistake));
            assert!(wrong.contradicted > 0, "{mistake:?}: {wrong:?}");
            assert!(wrong.warning().unwrap().contains("contradict"));
        }
    }

    #[test]
    fn the_estimate_of_unchecked_pictures_contradicts_wrong_start_maps() {
        let flips = deep(QuestionName::Flip, 40.0);
        let all = MISTAKES.map(|mistake| (&flips, mistake));
        let top = near_the_top();
        for (scene, mistake) in all.into_iter().chain([(&top, Sabotage::BlindOpening)]) {
            let right = estimate(scene, None);
            assert!(right.opinion.asked == 2 && right.expected_right() > 0.99, "{right:?}");
            let wrong = estimate(scene, Some(mistake));
            assert!(wrong.expected_right() < 0.99, "{mistake:?}: {wrong:?}");
            assert!(wrong.warning().is_some());
        }
    }

    #[test]
    fn every_question_of_deep_views_can_be_contradicted() {
        for (ask, secs) in
            [(QuestionName::First, 40.0), (QuestionName::State, 30.0), (QuestionName::Growth, 25.0)]
        {
            let scene = deep(ask, secs);
            assert_eq!(opinion_on(&scene, None).contradicted, 0, "{ask}");
            let wrong = opinion_on(&scene, Some(Sabotage::WideLeaf));
            assert!(wrong.contradicted > 0, "{ask}: {wrong:?}");
        }
    }
}
