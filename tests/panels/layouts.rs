//! The layout never panics, whatever the window's size and scale and wherever the wheel is turned.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Event, Modifiers, MouseWheelUnit, Pos2, TouchPhase, Vec2, pos2, vec2};
use egui_kittest::Harness;
use flipmap_engine::EngineKind;
use flipmap_engine::choice::EngineRequest;
use flipmap_numbers::{Exact, Scalar};
use flipmap_scene::Scene;
use flipmap_screen::pin_start::PinStart;
use flipmap_window::folders::Folders;
use flipmap_window::model::{AppModel, WindowOptions};
use flipmap_window::panels::pendulum::pendulum_card;
use flipmap_window::panels::status::{StatusLine, status_line};
use flipmap_window::pins::{PinAction, Pins};
use proptest::prelude::*;

/// The state of a window in a frame: size in pixels, scale, and a turn of the wheel at some place.
#[derive(Clone, Copy, Debug)]
struct Moment {
    size: [f32; 2],
    scale: f32,
    pointer: [f32; 2],
    wheel: [f32; 2],
    click: bool,
}

fn moments() -> impl Strategy<Value = Vec<Moment>> {
    // Small sides are as likely as large ones.
    let side = || prop_oneof![1f32..40.0, 1f32..400.0, 1f32..3000.0];
    let moment = (
        [side(), side()],
        0.5f32..3.0,
        [0f32..1.0, 0f32..1.0],
        [-500f32..500.0, -3000f32..3000.0],
        any::<bool>(),
    );
    let moment = moment.prop_map(|(size, scale, pointer, wheel, click)| Moment {
        size,
        scale,
        pointer,
        wheel,
        click,
    });
    proptest::collection::vec(moment, 1..8)
}

/// Shows some frames of each moment.
fn live<S>(harness: &mut Harness<'_, S>, moments: &[Moment]) {
    for moment in moments {
        let Moment { size: [width, height], scale, pointer, wheel, click } = *moment;
        harness.set_pixels_per_point(scale);
        harness.set_size(vec2(width, height) / scale);
        harness.run_steps(1);
        let at: Pos2 = pos2(pointer[0] * width / scale, pointer[1] * height / scale);
        harness.event(Event::PointerMoved(at));
        harness.event(Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            delta: Vec2::from(wheel),
            phase: TouchPhase::Move,
            modifiers: Modifiers::NONE,
            source: egui::MouseWheelSource::Wheel,
        });
        for pressed in [true, false].into_iter().filter(|_| click) {
            let button = egui::PointerButton::Primary;
            let modifiers = Modifiers::NONE;
            harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        harness.run_steps(3);
    }
}

/// A pin that has flown to its end.
fn flown() -> Pins {
    let mut pins = Pins::new(&Scene::default());
    let start = [3.0, 3.0].map(Exact::from_f64);
    let next = [start[0] + Exact::from_f64(1e-3), start[1]];
    pins.add(PinStart::at_rest([start, next]), None, || ()).unwrap();
    let begun = Instant::now();
    while pins.iter().any(|pin| pin.flight.record().ending.is_none()) {
        assert!(begun.elapsed() < Duration::from_secs(60), "the flight never ends");
        pins.advance(0.0);
        std::thread::sleep(Duration::from_millis(1));
    }
    pins.apply(PinAction::Scrub(10.0));
    pins
}

/// A window with a pinned pendulum, whose engine computes nothing: only the layout is tested.
fn window() -> Harness<'static, AppModel> {
    let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
    let folders = Folders::none();
    let options = WindowOptions {
        document: None,
        run: None,
        request,
        folders,
        set_up: None,
        stats: None,
        film_command: None,
    };
    let model = AppModel::new(&options, Arc::new(|| ()));
    let mut window = Harness::builder()
        .with_context_setup(flipmap_lab::typeface::install)
        .with_size([720.0, 440.0])
        .build_ui_state(
            |ui, model: &mut AppModel| {
                model.state.tick(ui.input(|input| input.time));
                model.show(ui);
            },
            model,
        );
    let size = [720.0, 440.0];
    let click = Moment { size, scale: 1.0, pointer: [0.2, 0.4], wheel: [0.0; 2], click: true };
    live(&mut window, &[click]);
    assert!(!window.state().state.pins.is_empty(), "a pendulum is pinned");
    window
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn the_pendulum_panel_is_laid_out_anywhere(moments in moments()) {
        let mut harness = Harness::builder().with_context_setup(flipmap_lab::typeface::install).with_size([340.0, 704.0]).build_ui_state(
            |ui, pins: &mut Pins| {
                egui::ScrollArea::vertical().show(ui, |ui| pendulum_card(ui, pins, &|_| None));
            },
            flown(),
        );
        live(&mut harness, &moments);
    }

    #[test]
    fn the_status_line_is_laid_out_anywhere(moments in moments(), engine in "[ -~]{0,300}") {
        let text = |text: &str| Some((text.to_string(), text.to_string()));
        let status = StatusLine {
            width: 1e-300,
            unit: "rad",
            depth: text("depth"),
            warning: text(&engine),
            doing: Some(engine.clone()),
            sure: (engine.clone(), engine),
            ..StatusLine::default()
        };
        let mut harness = Harness::builder().with_context_setup(flipmap_lab::typeface::install)
            .build_ui_state(|ui, status: &mut StatusLine| status_line(ui, status), status);
        live(&mut harness, &moments);
    }

    #[test]
    fn the_window_is_laid_out_anywhere(moments in moments()) {
        // Without clicks, which could begin an export.
        let looks = moments.into_iter().map(|moment| Moment { click: false, ..moment });
        live(&mut window(), &looks.collect::<Vec<_>>());
    }
}
