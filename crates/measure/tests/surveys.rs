//! Surveys of small scenes: what they find, keep and refuse.

use std::sync::atomic::{AtomicU64, Ordering};

use flipmap_engine::EngineKind;
use flipmap_engine::choice::EngineRequest;
use flipmap_measure::{
    Findings, MeasureError, Statistic, Survey, SurveyFolder, SurveyOrder, table,
};
use flipmap_render::tiles::Renderer;
use flipmap_scene::Document;

fn renderer(kind: EngineKind) -> Renderer {
    let request = EngineRequest { kind: Some(kind), verify: true, ..EngineRequest::default() };
    Renderer::new(&request).unwrap()
}

fn order(text: &str, of: &[Statistic]) -> SurveyOrder {
    let scene = Document::parse(text).unwrap().scene().checked().unwrap();
    SurveyOrder { of: of.to_vec(), samples: 4800, ..SurveyOrder::of(scene) }
}

fn found(order: &SurveyOrder, kind: EngineKind) -> Findings {
    let mut survey = Survey::new(order.clone()).unwrap();
    survey.run(&mut renderer(kind), &|_, _| true).unwrap();
    survey.findings()
}

const SHORT: &str = "[question]\nbudget = 3.0";

#[test]
fn seeds_sizes_and_engines_agree_within_their_intervals() {
    let order = order(SHORT, &[Statistic::Areas, Statistic::Survival]);
    let more = |samples, seed| SurveyOrder { samples, seed, ..order.clone() };
    let all = [
        found(&more(4800, 1), EngineKind::Cpu),
        found(&more(4800, 2), EngineKind::Cpu),
        found(&more(48_000, 3), EngineKind::Cpu),
        found(&more(4800, 1), EngineKind::Gpu),
    ];
    let flips = all.each_ref().map(|found| found.areas.as_ref().unwrap().classes[0].1);
    for (a, b) in flips.iter().flat_map(|a| flips.iter().map(move |b| (a, b))) {
        assert!(a.overlaps(b), "{flips:?}");
    }
    // The same starts on two engines: the same answers.
    assert_eq!(flips[0], flips[3]);
    assert!(flips[2].half_width() < flips[0].half_width());
    let areas = all[2].areas.as_ref().unwrap();
    let sum: f64 = areas.classes.iter().map(|(_, share)| share.value).sum();
    assert!((sum - 1.0).abs() < 1e-12, "{areas:?}");
    let by_time: f64 = areas.flips.iter().map(|(_, _, share)| share.value).sum();
    assert!((by_time - areas.classes[0].1.value).abs() < 1e-12, "{areas:?}");
    let curve = &all[2].survival.as_ref().unwrap().curve;
    assert!(curve.windows(2).all(|two| two[0].share.value >= two[1].share.value));
}

#[test]
fn a_survey_that_was_stopped_goes_on_and_finds_the_same() {
    let home = tempfile::tempdir().unwrap();
    let order = order(SHORT, &[Statistic::Areas]);
    let whole = found(&order, EngineKind::Cpu);
    let within = |folder: SurveyFolder| Survey::within(order.clone(), folder).unwrap();
    let folder = SurveyFolder::create(home.path()).unwrap();
    let mut survey = within(folder.clone());
    let stop = survey.run(&mut renderer(EngineKind::Cpu), &|done, _| done < 2000);
    assert!(matches!(stop, Err(MeasureError::Stopped)), "{stop:?}");
    let mut survey = within(folder);
    let [known, all] = survey.extent();
    assert!((2000..all).contains(&known), "{known} of {all}");
    let least = AtomicU64::new(u64::MAX);
    let watch = |done: u64, _| {
        least.fetch_min(done, Ordering::Relaxed);
        true
    };
    survey.run(&mut renderer(EngineKind::Cpu), &watch).unwrap();
    assert!(least.into_inner() >= known);
    let found = survey.findings();
    assert_eq!(found, whole);
    survey.write().unwrap();
    let json = std::fs::read_to_string(home.path().join("measure.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["findings"]["areas"]["starts"], 4800);
    assert!(
        std::fs::read_to_string(home.path().join("measure.html")).unwrap().contains("forbidden")
    );
    let text = table(&found);
    assert!(text.contains("forbidden") && text.contains("0.30643"), "{text}");
}

/// Runs a survey in a folder and checks that it drew and wrote these curves.
fn written(order: SurveyOrder, curves: &[&str]) -> Findings {
    let home = tempfile::tempdir().unwrap();
    let folder = SurveyFolder::create(home.path()).unwrap();
    let mut survey = Survey::within(order, folder).unwrap();
    survey.run(&mut renderer(EngineKind::Cpu), &|_, _| true).unwrap();
    let found = survey.findings();
    assert_eq!(found.missing, []);
    survey.write().unwrap();
    for (name, ending) in curves.iter().flat_map(|name| [(name, "csv"), (name, "svg")]) {
        let text = std::fs::read_to_string(home.path().join(format!("{name}.{ending}"))).unwrap();
        assert!(text.lines().count() > 3 && !text.contains("NaN"), "{name}.{ending}: {text}");
    }
    found
}

#[test]
fn edges_of_the_home_map_are_rough() {
    let order = SurveyOrder { samples: 20_000, ..order("", &[Statistic::Edges]) };
    let found = written(order, &["edges", "exponent"]);
    // 1.81 with ten times as many pairs.
    let dimension = found.edges.unwrap().exponent.dimension;
    assert!((1.7..1.9).contains(&dimension.value) && dimension.half_width() < 0.1, "{dimension:?}");
}

#[test]
fn flips_within_two_seconds_have_a_smooth_edge() {
    let of = [Statistic::Entropy, Statistic::Fat];
    let order = SurveyOrder { samples: 9600, ..order("[question]\nbudget = 2.0", &of) };
    let fat = written(order, &["entropy", "fat"]).fat.unwrap();
    assert!(!fat.is_fat && fat.beta.contains(1.0), "{fat:?}");
}

#[test]
fn motion_is_regular_at_low_energies_and_chaotic_at_middle_ones() {
    let order =
        SurveyOrder { samples: 9600, ..order("[question]\nbudget = 8.0", &[Statistic::Growth]) };
    let growth = written(order, &["growth", "sections"]).growth.unwrap();
    let regular: Vec<f64> = growth.sections.iter().map(|one| one.regular.value).collect();
    assert!(regular[0] == 1.0 && regular[5] < 0.2 && regular[8] > regular[6], "{regular:?}");
    assert!(growth.view.mean.is_some_and(|mean| (0.8..2.0).contains(&mean.value)), "{growth:?}");
}

#[test]
fn what_cannot_be_measured_is_refused_in_one_sentence() {
    let refusal = |text: &str, of: Statistic| match Survey::new(order(text, &[of])) {
        Err(error) => error.to_string(),
        Ok(_) => String::new(),
    };
    let state = "[question]\nask = \"state\"\nat = 2.0";
    assert!(refusal(state, Statistic::Areas).contains("needs a question with classes"));
    assert_eq!(refusal(state, Statistic::Growth), "");
    assert!(refusal(SHORT, Statistic::Wada).contains("three classes"));
    let still = "[pendulum]\ngravity = 0.0";
    assert!(refusal(still, Statistic::Growth).contains("without gravity"), "it would never end");
    assert!(refusal("[question]\nbudget = 0.2", Statistic::Growth).contains("3.19"));
    let deep = "[view]\ncenter = [\"2\", \"1\"]\nwidth = \"1e-13\"";
    assert!(refusal(deep, Statistic::Areas).contains("at least 1e-12"));
    let still = "[view]\ncenter = [\"0.1\", \"0.1\"]\nwidth = \"0.01\"";
    let one_class = found(&order(still, &[Statistic::Edges]), EngineKind::Cpu);
    assert!(one_class.missing[0].why.contains("same class"), "{one_class:?}");
    let home = tempfile::tempdir().unwrap();
    std::fs::write(home.path().join("mine.txt"), "x").unwrap();
    let error = SurveyFolder::create(home.path()).unwrap_err().to_string();
    assert!(error.contains("it holds files"), "{error}");
}
