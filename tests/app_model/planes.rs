//! Other questions and planes in the window.

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;
use flipmap_engine::choice::{EngineRequest, IntegrationSetting};
use flipmap_engine::{Accuracy, EngineKind, IntegratorConfig, Method, Precision};
use flipmap_scene::lattice::Cell;
use flipmap_scene::{Document, RunTable, location};
use flipmap_window::folders::Folders;
use flipmap_window::model::AppModel;

use crate::{click, counts, home, model, model_of, notices, options, place, press, settle, until};

#[test]
fn another_question_on_another_plane_is_shown_flown_and_left_again() {
    let scene = "flipmap:center=2,-1.5;width=3;budget=4;ask=state;plane=first;origin=0,2.5,0,-1";
    let mut desktop = home();
    desktop.event(Event::Paste(scene.to_string()));
    settle(&mut desktop);
    let here = location::parse(&place(&desktop)).unwrap();
    let asked = location::parse(scene).unwrap();
    assert_eq!((here.question.ask, &here.plane), (asked.question.ask, &asked.plane));
    assert!((here.view.width_rad().hi - 3.0).abs() < 1e-9, "{}", here.view.width);
    let middle: f64 = here.view.center[1].parse().unwrap();
    assert!((middle + 1.5).abs() < 1e-9);
    let name = "Map around θ1 2.0000 rad, ω1 -1.5000 rad/s, 3 rad wide";
    assert!(desktop.query_by_label_contains(name).is_some());

    press(&mut desktop, Modifiers::NONE, Key::P);
    let pin = desktop.state().state.pins.selected().unwrap();
    let [start, beside] = pin.start.launches;
    assert!((start.angle[0].hi - 2.0).abs() < 0.02 && (start.speed[0].hi + 1.5).abs() < 0.02);
    assert_eq!((start.angle[1].hi, start.speed[1].hi), (2.5, -1.0));
    assert!(beside.angle[0].hi > start.angle[0].hi, "the ghost starts one pixel to the right");
    click(&mut desktop, "Numbers");
    desktop.run_steps(30);
    let speeds = desktop.query_all_by_label_contains("ω2 −1.000000 rad/s");
    assert_eq!(speeds.count(), 1, "its speeds are told");

    press(&mut desktop, Modifiers::NONE, Key::D);
    assert!(notices(&desktop).contains("`ask` is state"), "{}", notices(&desktop));
    desktop.event(Event::Paste("flipmap:center=0,0;width=6.28".to_string()));
    settle(&mut desktop);
    let pin = desktop.state().state.pins.selected().unwrap();
    assert_eq!((pin.start.place, pin.start.launches[0]), (None, start), "it flies on, off the map");
}

#[test]
fn no_answer_to_another_question_is_shown_while_an_engine_opens() {
    let mut desktop = home();
    for (ask, accuracy) in [("state", Accuracy::Balanced), ("flip", Accuracy::Fast)] {
        let view = format!("flipmap:center=0,0;width=6;budget=0.5;ask={ask}");
        desktop.event(Event::Paste(view));
        desktop.step();
        let channels = desktop.state().state.question.ask.kind().channels.len();
        let shown = |model: &mut AppModel| {
            let explorer = &mut model.compute.explorer;
            let before =
                explorer.known_before(Cell::WHOLE).map(|(known, _)| known.samples.channels());
            let now = explorer.known(Cell::WHOLE).map(|(known, _)| known.samples.channels());
            [before, now].into_iter().flatten().collect::<Vec<_>>()
        };
        let model = desktop.state_mut();
        assert!(!shown(model).is_empty(), "the question has just changed");
        let (kind, setting) = (Some(EngineKind::Cpu), IntegrationSetting::Accuracy(accuracy));
        let request = EngineRequest { kind, setting, ..EngineRequest::default() };
        model.compute.reopen(request.answering(&model.state.question));
        model.work();
        assert!(shown(model).iter().all(|known| *known == channels), "{ask}: {:?}", shown(model));
        settle(&mut desktop);
        assert!(shown(desktop.state_mut()).contains(&channels), "{ask}");
    }
}

#[test]
fn every_method_answers_every_question() {
    let asked = location::parse("flipmap:center=0,0;width=6;budget=0.5;ask=return").unwrap();
    let document = Document::default().with_scene(asked);
    let mut options = options(Folders::none(), Some(document.clone()));
    let method = Method::Taylor { tolerance: 1e-15 };
    let taylor =
        IntegrationSetting::Explicit(IntegratorConfig { method, precision: Precision::F64 });
    options.request.setting = taylor;
    options.run = Some(RunTable { method: Some("taylor".to_string()), ..RunTable::default() });
    let fast = IntegrationSetting::Accuracy(Accuracy::Fast);
    for (desktop, setting) in
        [(model_of(&options), taylor), (model(Folders::none(), Some(document)), fast)]
    {
        assert_eq!(desktop.state().state.integration.spec.setting, setting);
        let counts = counts(&desktop);
        assert_eq!(counts.forbidden, 0, "every pendulum may return: {counts:?}");
        assert!(counts.simulated > 10_000);
    }
}

#[test]
fn a_view_of_counts_stays_as_wide_as_numbers_can_tell_starts_apart() {
    let mut desktop = home();
    let deep = "flipmap:center=3,4;width=1e-30;budget=0.1;plane=speeds;ask=flips";
    desktop.event(Event::Paste(deep.to_string()));
    // The notice goes by itself, perhaps before the map is complete.
    until(&mut desktop, "the notice", |desktop| notices(desktop).contains("The view stays wider"));
    settle(&mut desktop);
    let width = location::parse(&place(&desktop)).unwrap().view.width_rad().hi;
    assert!((1e-12..1e-1).contains(&width), "{width:e}");
}
